//! What a scene file can say: the components of the core vocabulary, by theme.
//!
//! Their names, fields, units and defaults are public. Scenes outside of this repository use them, so a change here is
//! a change of the file format; adding is free. The doc comments are what `pipeline schema` prints. Every component is
//! written by `load`, one for each prim that carries it, and read by the stages of `Prepare`; none is read in an inner
//! loop.
//!
//! Conventions: right-handed, Y up, metres; degrees in files. Colours are linear RGB with Rec.709 primaries. Light is
//! radiometric. Whatever places a prim is in `f64`, so that a scene ten kilometres away keeps its precision.
//!
//! Deliberately absent is what no stage renders yet, volumes, and what belongs to one stage alone, which registers it:
//! lenses, shutters, photon maps.

mod camera;
mod film;
mod findings;
mod geometry;
mod light;
mod material;
mod principled;
mod render;
mod stage_settings;
mod structure;
#[cfg(test)]
mod tests;
mod texture;

pub use camera::Camera;
pub use film::{Film, FilterKind, ToneMap};
pub use findings::{Findings, SceneReport, component_place, field_place};
pub use geometry::{
    Band, Cuboid, Cylinder, Disc, GeometryComponents, GeometryComponentsItem, GeometrySource, Mesh, Quad, Sphere, Torus,
};
pub use light::{DistantLight, Emission, EnvironmentLight, PointLight, SpotLight};
pub use material::{Conductor, Dielectric, Diffuse, NormalDistribution, Plastic};
pub use principled::Principled;
pub use render::{CausticMethod, DirectMethod, IndirectMethod, LightTransport, Render, SpecularMethod};
pub use stage_settings::stage_settings;
pub use structure::{LookAt, MaterialBinding, Transform};
pub use texture::{TextureChannel, TextureEncoding, TextureFilter, TextureMap, TextureWrap};

use bevy_app::{App, Plugin};
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::TypeRegistration;
use bevy_reflect::std_traits::ReflectDefault;

/// Tells whether scenes may use a registered type: a component that has a default, of the program or of a plug-in.
///
/// The components of `bevy_ecs` itself are not for scenes. Whoever builds a [`Schema`](scene_format::Schema) asks this, so that `run`, `check`
/// and `schema` agree.
#[must_use]
pub fn is_scene_component(found: &TypeRegistration) -> bool {
    found.contains::<ReflectComponent>()
        && found.contains::<ReflectDefault>()
        && !found.type_info().type_path().starts_with("bevy_")
}

/// Registers every component of the core vocabulary, so that scenes can name it.
pub struct VocabularyPlugin;

impl Plugin for VocabularyPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Transform>()
            .register_type::<LookAt>()
            .register_type::<MaterialBinding>()
            .register_type::<Sphere>()
            .register_type::<Quad>()
            .register_type::<Disc>()
            .register_type::<Cuboid>()
            .register_type::<Cylinder>()
            .register_type::<Torus>()
            .register_type::<Band>()
            .register_type::<Mesh>()
            .register_type::<Diffuse>()
            .register_type::<Conductor>()
            .register_type::<Dielectric>()
            .register_type::<Plastic>()
            .register_type::<Principled>()
            .register_type::<Emission>()
            .register_type::<PointLight>()
            .register_type::<SpotLight>()
            .register_type::<DistantLight>()
            .register_type::<EnvironmentLight>()
            .register_type::<Camera>()
            .register_type::<Film>()
            .register_type::<Render>()
            .register_type::<LightTransport>();
    }
}
