//! Tables: materials, lights, camera and settings, checked and by row.
//!
//! Scene: exactly one prim with `Render`, beside it `Film` and `LightTransport`; a `Camera`; `Diffuse`, `Conductor`,
//! `Dielectric`, `Plastic`, `Principled` and `MaterialBinding`; `Emission`, `PointLight`, `SpotLight`,
//! `DistantLight`, `EnvironmentLight`.
//! Set: [`PrepareSystems::BuildTables`]. `resolve_settings` joins scene and command line into
//! [`RenderSettings`](pipeline_data::RenderSettings) and [`CameraFrame`](pipeline_data::CameraFrame);
//! `build_material_table` finds the material of every instance; `list_lights` turns emission and power into radiance and
//! intensity; `join_tables` takes the ray scene and hands all of it over as
//! [`TransportScene`](pipeline_data::TransportScene), unless there was an error.
//!
//! What a surface is made of: its own material component, else the nearest `MaterialBinding` at or above its prim, else
//! black if it has `Emission`, else `Diffuse` with its defaults.
//!
//! Counters: `tables/materials`, `tables/lights`.
//!
//! Fields that end in `_texture` take the place of the plain field, from the
//! [`TextureStore`](pipeline_data::TextureStore); a material on a mesh with colours gets a second row, which they multiply.
//!
//! Limits: one environment. After this set nothing but writing fails: whatever could is refused here.

mod frame;
mod inputs;
mod join;
mod lights;
mod materials;
mod settings;
mod surface;
#[cfg(test)]
mod tests;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use pipeline_core::{Prepare, PrepareSystems};
use pipeline_data::ComposedScene;

/// Builds the tables that light transport reads.
pub struct TablesPlugin;

impl Plugin for TablesPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<materials::MaterialTable>()
            .init_resource::<lights::LightList>()
            .add_systems(
                Prepare,
                (
                    settings::resolve_settings,
                    materials::build_material_table,
                    lights::list_lights,
                    join::join_tables,
                )
                    .chain()
                    .in_set(PrepareSystems::BuildTables)
                    .run_if(resource_exists::<ComposedScene>),
            );
    }
}
