//! Load: a scene file becomes entities.
//!
//! Scene: every scene; nothing switches it off.
//! Sets: [`LoadSystems`] in order. `compose_scene` reads the [`RenderRequest`](pipeline_data::RenderRequest) and
//! composes the file into [`ComposedScene`]; `spawn_prims` turns every rendered prim into an entity with
//! [`PrimIndex`](pipeline_data::PrimIndex) and the components that the scene writes, as they are at the scene's frame;
//! `import_meshes` brings the files that `Mesh` names into the [`MeshStore`](pipeline_data::MeshStore), each once, and
//! mixes their bytes into the scene's hash; `import_environments` does the same with the pictures of
//! `EnvironmentLight` ([`EnvironmentMaps`]), `import_textures` with those of materials
//! ([`TextureStore`]).
//!
//! What a scene may say is what plug-ins registered: see [`is_scene_component`](pipeline_data::vocabulary::is_scene_component). What is wrong goes to the
//! [`Report`](pipeline_core::Report) with place and remedy; the following systems then find no scene and do nothing.
//!
//! Counters: `load/prims`, `load/triangles`, `load/textures`.
//!
//! Limits: components with samples over time are taken at the frame; only `geometry` looks at other times. Meshes are Wavefront and glTF files;
//! neither skins nor morph targets move them.

mod compose;
mod environment;
mod import;
mod spawn;
#[cfg(test)]
mod tests;
mod textures;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use pipeline_core::{Load, LoadSystems};
use pipeline_data::vocabulary::VocabularyPlugin;
use pipeline_data::{ComposedScene, EnvironmentMaps, TextureStore};

/// Reads the scene file of the render request. Brings the core vocabulary with it.
pub struct LoadPlugin;

impl Plugin for LoadPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<VocabularyPlugin>() {
            app.add_plugins(VocabularyPlugin);
        }
        app.init_resource::<EnvironmentMaps>()
            .init_resource::<TextureStore>()
            .add_systems(
                Load,
                (
                    compose::compose_scene.in_set(LoadSystems::Compose),
                    spawn::spawn_prims
                        .in_set(LoadSystems::Spawn)
                        .run_if(resource_exists::<ComposedScene>),
                    (
                        import::import_meshes,
                        environment::import_environments,
                        textures::import_textures,
                    )
                        .chain()
                        .in_set(LoadSystems::ImportAssets)
                        .run_if(resource_exists::<ComposedScene>),
                ),
            );
    }
}
