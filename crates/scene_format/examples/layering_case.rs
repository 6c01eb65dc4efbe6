//! Composes scenes with a vocabulary of its own, as a program with other components would.
//!
//! `layering_case flatten --json [--variant /W{v=x}] [--set /W.Camera.fov=7.5] [--no-payloads] root.ron`
//! prints the composed scene, or what is wrong with it and exits with 1. It is how the composition is
//! compared with other implementations: its components are those of the comparison, nothing else.

#![allow(clippy::print_stdout, reason = "its output is what it is for")]

use std::path::Path;
use std::process::ExitCode;

use scene_format::{Options, Schema, errors_json, flatten_json, load};

#[path = "../tests/corpus/vocabulary.rs"]
mod vocabulary;

const USAGE: &str = "usage: layering_case flatten --json [--variant V] [--set S] [--no-payloads] SCENE";

fn main() -> ExitCode {
    let mut options = Options {
        check_targets: false,
        ..Options::default()
    };
    let mut scene = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "flatten" | "--json" => {}
            "--variant" => options.variants.extend(arguments.next()),
            "--set" => options.sets.extend(arguments.next()),
            "--no-payloads" => options.load_payloads = false,
            _ => scene = Some(argument),
        }
    }
    let Some(scene) = scene else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let registry = vocabulary::registry();
    let schema = match Schema::new(&registry, vocabulary::is_component) {
        Ok(schema) => schema,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    match load(Path::new(&scene), &schema, &options) {
        Ok(scene) => {
            println!("{}", flatten_json(&scene));
            ExitCode::SUCCESS
        }
        Err(refusal) => {
            eprint!("{refusal}");
            println!("{}", errors_json(&refusal));
            ExitCode::FAILURE
        }
    }
}
