//! The components that models are translated to, as small copies, and how to read a layer with them.

use bevy_reflect::{Reflect, ReflectDeserialize, TypeRegistry, std_traits::ReflectDefault};
use glam::{DMat4, DQuat, DVec3, Vec2, Vec3};
use serde::Deserialize;

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
        albedo_texture: Option<TextureMap>,
    }
    Principled {
        #[reflect(@Range::closed(0.0, 1.0))]
        base_color: Vec3,
        base_color_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        metallic: f32,
        metallic_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        roughness: f32,
        roughness_texture: Option<TextureMap>,
        #[reflect(@Range::closed(1.0, 4.0))]
        ior: f32,
        #[reflect(@Range::closed(0.0, 1.0))]
        specular: f32,
        specular_texture: Option<TextureMap>,
        #[reflect(@Range::at_least(0.0))]
        specular_color: Vec3,
        specular_color_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        transmission: f32,
        transmission_texture: Option<TextureMap>,
        #[reflect(@Range::at_least(0.0))]
        thickness: f32,
        #[reflect(@Range::closed(0.0, 1.0))]
        attenuation_color: Vec3,
        #[reflect(@Range::above(0.0))]
        attenuation_distance: Option<f32>,
        #[reflect(@Range::closed(0.0, 1.0))]
        clearcoat: f32,
        clearcoat_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        clearcoat_roughness: f32,
        clearcoat_roughness_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        sheen: Vec3,
        sheen_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        sheen_roughness: f32,
        sheen_roughness_texture: Option<TextureMap>,
        #[reflect(@Range::at_least(0.0))]
        emission: Vec3,
        emission_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        alpha: f32,
        alpha_texture: Option<TextureMap>,
        #[reflect(@Range::closed(0.0, 1.0))]
        alpha_cutoff: Option<f32>,
        normal_texture: Option<TextureMap>,
        normal_scale: f32,
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

#[derive(Reflect, Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
#[reflect(Deserialize)]
pub(super) struct TextureMap {
    pub(super) file: AssetPath,
    pub(super) image: Option<u32>,
    pub(super) uv_set: u32,
    pub(super) wrap_u: Wrap,
    pub(super) wrap_v: Wrap,
    pub(super) filter: Filter,
    pub(super) translate: Vec2,
    pub(super) rotate: f32,
    pub(super) scale: Option<Vec2>,
    pub(super) channel: Channel,
    pub(super) factor: Option<Vec3>,
}

#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub(super) enum Wrap {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub(super) enum Filter {
    #[default]
    Linear,
    Nearest,
}

#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub(super) enum Channel {
    #[default]
    R,
    G,
    B,
    A,
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
