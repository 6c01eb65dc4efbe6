//! One file of any bytes as a scene: an answer, no panic.
#![no_main]

#[path = "../../tests/corpus/vocabulary.rs"]
mod vocabulary;

use libfuzzer_sys::fuzz_target;
use scene_format::{Options, Schema, explain, flatten_json, flatten_ron, load_str};

fuzz_target!(|text: &str| {
    let registry = vocabulary::registry();
    let schema = Schema::new(&registry, vocabulary::is_component).expect("the vocabulary is sound");
    let options = Options {
        check_targets: false,
        ..Options::default()
    };
    match load_str("scene.ron", text, &schema, &options) {
        Ok(scene) => {
            let flat = flatten_ron(&scene);
            let again = load_str("scene.ron", &flat, &schema, &options).expect("a flat scene is right");
            assert_eq!(again.hash, scene.hash, "a flat scene is the same scene");
            flatten_json(&scene);
            for prim in &scene.prims {
                for component in &prim.components {
                    for field in &component.fields {
                        let question = format!("{}.{}.{}", prim.path, component.name, field.name);
                        explain(&scene, &question).expect("every field can be explained");
                    }
                }
            }
        }
        Err(refusal) => assert!(refusal.render(true).contains("error")),
    }
});
