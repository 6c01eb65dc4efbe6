//! The components that models are translated to, as small copies, and how to read a layer with them.

use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use glam::{DMat4, DQuat, DVec3, Vec3};

use crate::{AssetPath, Options, Range, Required, Scene, Schema, Target, load_str};

macro_rules! components {
    ($($(#[$mark:meta])* $name:ident { $($(#[$field_mark:meta])* $field:ident: $kind:ty,)* })*) => {
        $($(#[$mark])*
        #[derive(Reflect, Clone, Debug, Default)]
        #[reflect(Default)]
        pub(super) struct $name {
            $($(#[$field_mark])* pub(super) $field: $kind,)*
        })*

        pub(super) fn registry() -> TypeRegistry {
            let mut registry = TypeRegistry::new();
            $(registry.register::<$name>();)*
            registry
        }
    };
}

components! {
    Transform {
        translate: DVec3,
        scale: DVec3,
        quaternion: Option<DQuat>,
        matrix: Option<DMat4>,
    }
    Mesh {
        #[reflect(@Required)]
        file: AssetPath,
        mesh: Option<String>,
        primitive: Option<u32>,
    }
    MaterialBinding {
        target: Target,
    }
    Diffuse {
        #[reflect(@Range::closed(0.0, 1.0))]
        albedo: Vec3,
    }
    Conductor {
        #[reflect(@Range::closed(0.0, 1.0))]
        f0: Option<Vec3>,
        #[reflect(@Range::closed(0.0, 1.0))]
        roughness: f32,
    }
    Dielectric {
        #[reflect(@Range::closed(0.25, 4.0))]
        ior: f32,
        #[reflect(@Range::closed(0.0, 1.0))]
        roughness: f32,
        #[reflect(@Range::closed(0.0, 1.0))]
        tint: Vec3,
        #[reflect(@Range::at_least(0.0))]
        absorption: Vec3,
        thin: bool,
    }
    Emission {
        #[reflect(@Range::at_least(0.0))]
        radiance: Vec3,
        two_sided: bool,
    }
    PointLight {
        #[reflect(@Range::at_least(0.0))]
        intensity: Option<Vec3>,
    }
    SpotLight {
        #[reflect(@Range::at_least(0.0))]
        intensity: Option<Vec3>,
        inner_angle: f32,
        outer_angle: f32,
    }
    Camera {
        #[reflect(@Range::closed(0.01, 179.0))]
        fov: f32,
    }
}

/// `DistantLight` is missing, so that there is a component to miss.
pub(super) fn with_schema<T>(use_it: impl FnOnce(&Schema<'_>) -> T) -> T {
    let registry = registry();
    let own = concat!(module_path!(), "::");
    let schema = Schema::new(&registry, |found| {
        found.type_info().type_path().starts_with(own) && found.contains::<ReflectDefault>()
    });
    use_it(&schema.expect("the vocabulary is sound"))
}

/// Reads a layer that must be right.
pub(super) fn compose(text: &str) -> Scene {
    let options = Options {
        check_assets: false,
        ..Options::default()
    };
    with_schema(|schema| match load_str("model", text, schema, &options) {
        Ok(scene) => scene,
        Err(errors) => panic!("{errors}\n{text}"),
    })
}

/// Gives a component of a prim as it is read.
pub(super) fn component<T: Reflect + Clone>(scene: &Scene, path: &str, name: &str) -> T {
    let prim = scene.prims.iter().find(|prim| prim.path == path);
    let prim = prim.unwrap_or_else(|| panic!("no {path} among {:?}", paths(scene)));
    let found = prim.component(name).unwrap_or_else(|| panic!("{path} has no {name}"));
    with_schema(|schema| found.build(schema, 0.0).downcast_ref::<T>().expect("its type").clone())
}

pub(super) fn paths(scene: &Scene) -> Vec<&str> {
    scene.prims.iter().map(|prim| prim.path.as_str()).collect()
}
