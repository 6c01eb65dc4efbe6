//! Any bytes as a glTF file, text or binary: translated, read as a layer, and its meshes read.
#![no_main]

mod model;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let name = if bytes.starts_with(b"glTF") { "model.glb" } else { "model.gltf" };
    model::read_model(name, bytes);
});
