//! The components of the comparison with other implementations of composition: nothing of a renderer.

use bevy_reflect::{Reflect, TypeRegistration, TypeRegistry, std_traits::ReflectDefault};
use glam::DVec3;
use scene_format::Targets;

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

        /// Tells which of the registered types are components.
        pub(crate) fn is_component(found: &TypeRegistration) -> bool {
            [$(std::any::TypeId::of::<$name>()),*].contains(&found.type_id())
        }

        pub(crate) fn registry() -> TypeRegistry {
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
