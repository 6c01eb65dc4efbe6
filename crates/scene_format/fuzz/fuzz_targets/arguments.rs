//! Arguments of the command line: a text as `--set` and as `--variant`.
#![no_main]

#[path = "../../tests/corpus/vocabulary.rs"]
mod vocabulary;

use libfuzzer_sys::fuzz_target;
use scene_format::{Options, Schema, explain, load_str};

const SCENE: &str = r#"Layer(prims: {"/W": Def(Camera: (fov: 35), Light: (), LightLinks: (exclude: ["/W"]),
    variants: {"v": {"x": (Camera: (fov: 1)), "y": (children: {"K": Def()})}})})"#;

fuzz_target!(|text: &str| {
    let registry = vocabulary::registry();
    let schema = Schema::new(&registry, vocabulary::is_component).expect("the vocabulary is sound");
    for (sets, variants) in [(vec![text.to_owned()], vec![]), (vec![], vec![text.to_owned()])] {
        let options = Options {
            sets,
            variants,
            ..Options::default()
        };
        match load_str("scene.ron", SCENE, &schema, &options) {
            Ok(scene) => drop(explain(&scene, text)),
            Err(refusal) => assert!(refusal.render(true).contains("error")),
        }
    }
});
