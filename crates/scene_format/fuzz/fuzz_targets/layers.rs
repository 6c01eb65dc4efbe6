//! Several files that name each other: the bytes are cut at zero bytes, the first file is the root.
#![no_main]

#[path = "../../tests/corpus/vocabulary.rs"]
mod vocabulary;

use libfuzzer_sys::fuzz_target;
use scene_format::{Limits, Options, Schema, flatten_json, load};

const NAMES: [&str; 4] = ["root.ron", "a.ron", "b.ron", "lib/c.ron"];

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("a folder for the files");
    std::fs::create_dir(folder.path().join("lib")).expect("a new folder is empty");
    for (name, text) in NAMES.iter().zip(bytes.split(|&byte| byte == 0)) {
        std::fs::write(folder.path().join(name), text).expect("the folder is writable");
    }
    let registry = vocabulary::registry();
    let schema = Schema::new(&registry, vocabulary::is_component).expect("the vocabulary is sound");
    let options = Options {
        check_targets: false,
        // A fuzzer looks for panics, and finds more of them when each run is short.
        limits: Limits {
            index_nodes: 2_000,
            prims: 2_000,
            ..Limits::default()
        },
        ..Options::default()
    };
    match load(&folder.path().join("root.ron"), &schema, &options) {
        Ok(scene) => {
            flatten_json(&scene);
        }
        Err(refusal) => assert!(refusal.render(true).contains("error")),
    }
});
