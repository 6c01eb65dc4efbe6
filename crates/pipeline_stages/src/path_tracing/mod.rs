//! Path tracing: one bounce of any batch of paths.
//!
//! Scene: `Render: (max_depth: …)`, `LightTransport: (…)` on the render prim.
//! Sets: `Intersect` (`intersect_rays`), `Shade` (`shade_emitters`, `sample_lights`), `Scatter` (`scatter_paths`).
//! Reads the transport scene and the settings. Writes hits, contributions, and paths with their rays.
//! Counters: `path_tracing/rays`, rays that were traced to their nearest hit.
//!
//! Everything is done by pure functions of `transport`; the systems here walk the batches of the wave in parallel. With
//! every term traced this is unbiased path tracing with next-event estimation, multiple importance sampling and Russian
//! roulette.
//!
//! Source: Kajiya, "The Rendering Equation", SIGGRAPH 1986; Veach and Guibas, SIGGRAPH 1995.

mod emitters;
mod intersect;
mod lights;
mod scatter;

use bevy_app::{App, Plugin};
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use pipeline_core::{Bounce, BounceSystems};
use pipeline_data::Contributions;

pub use emitters::EmissionContribution;
pub use lights::DirectLightContribution;

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct PathTracingSystems;

/// Adds path tracing.
pub struct PathTracingPlugin;

impl Plugin for PathTracingPlugin {
    fn build(&self, app: &mut App) {
        Contributions::register::<EmissionContribution>(app);
        Contributions::register::<DirectLightContribution>(app);
        app.add_systems(
            Bounce,
            (
                intersect::intersect_rays.in_set(BounceSystems::Intersect),
                emitters::shade_emitters.in_set(BounceSystems::Shade),
                lights::sample_lights.in_set(BounceSystems::Shade),
                scatter::scatter_paths.in_set(BounceSystems::Scatter),
            )
                .in_set(PathTracingSystems),
        );
    }
}
