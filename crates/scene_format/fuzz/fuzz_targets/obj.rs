//! Any bytes as an OBJ file: translated, read as a layer, and its meshes read.
#![no_main]

mod model;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| model::read_model("model.obj", bytes));
