//! Composes scenes with a vocabulary of its own, as a program with other components would.
//!
//! `layering_case flatten --json [--variant /W{v=x}] [--set /W.Camera.fov=7.5] [--no-payloads] root.ron`
//! prints the composed scene, or what is wrong with it and exits with 1. It is how the composition is
//! compared with other implementations: its components are those of the comparison, nothing else.

#![allow(clippy::print_stdout, reason = "its output is what it is for")]

use std::path::Path;
use std::process::ExitCode;

use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use glam::DVec3;
use scene_format::{Options, Schema, Targets, errors_json, flatten_json, load};

macro_rules! components {
    ($($name:ident { $($field:ident: $kind:ty),* $(,)? })*) => {
        $(
            #[doc = concat!("`", stringify!($name), "` of the comparison.")]
            #[derive(Reflect, Clone, Debug, Default)]
            #[reflect(Default)]
            struct $name {
                $($field: $kind,)*
            }
        )*

        /// Marks the registered types that are components.
        fn is_component(type_id: std::any::TypeId) -> bool {
            [$(std::any::TypeId::of::<$name>()),*].contains(&type_id)
        }

        fn registry() -> TypeRegistry {
            let mut registry = TypeRegistry::new();
            $(registry.register::<$name>();)*
            registry
        }
    };
}

components! {
    Transform { translate: DVec3, rotate: DVec3, scale: DVec3 }
    Camera { fov: f64, fstop: f64, focus: f64 }
    Light { intensity: f64, color: DVec3, samples: i64 }
    Material { roughness: f64, base_color: DVec3, model: String }
    Shape { radius: f64, segments: i64, smooth: bool, kind: String }
    Medium { density: f64, phase: String }
    RenderSettings { photons: i64, integrator: String, gamma: f64 }
    MotionBlur { enabled: bool, shutter: f64 }
    MaterialBinding { target: Targets }
    LightLinks { include: Targets, exclude: Targets }
}

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
    let registry = registry();
    let schema = match Schema::new(&registry, |found| is_component(found.type_id())) {
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
