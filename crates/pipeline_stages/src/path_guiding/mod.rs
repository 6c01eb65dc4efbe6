//! Path guiding: paths drawn to where photons say that light comes from.
//!
//! Scene: `"/Render": Def(PathGuiding: (mix: 0.5))`, with `LightTransport.indirect: PathTrace`.
//! Sets: `PrepareStages` (`plan_guiding`), `LookUp` (`guide_paths`).
//! Reads the indirect photon map and, where caustics are traced, the caustic one. Writes the guides of the wave, which
//! `path_tracing` draws directions with.
//! Counters: `path_guiding/guides`.
//!
//! Light that comes straight from lamps is found by sampling these, so direct photons have no say. Photons of a scene are too
//! few to tell light that is even from light that is not: there, guided paths have somewhat more noise than plain ones.
//!
//! Limits: surfaces that scatter by one Lambertian lobe; others are traced as ever.
//! Source: Jensen, "Importance Driven Path Tracing using the Photon Map", Rendering Techniques 1995.

mod guide;
mod plan;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::{Bounce, BounceSystems, Prepare, PrepareSystems};
use pipeline_data::PhotonDemand;
use plan::GuidePlan;
use scene_format::Range;

/// Photons guide the paths of indirect light. On the prim that carries `Render`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct PathGuiding {
    /// Photons to store of each kind that guides; where a photon map has settings of its own, these count.
    #[reflect(@Range::at_least(1.0))]
    pub photons: u32,
    /// Share of the directions that photons choose. Higher trusts them more; at any value the picture is without bias.
    #[reflect(@Range::closed(0.0, 0.95))]
    pub mix: f32,
}

impl Default for PathGuiding {
    fn default() -> Self {
        Self {
            photons: 100_000,
            mix: 0.5,
        }
    }
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct PathGuidingSystems;

/// Adds path guiding.
pub struct PathGuidingPlugin;

impl Plugin for PathGuidingPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PathGuiding>().init_resource::<PhotonDemand>();
        app.add_systems(
            Prepare,
            plan::plan_guiding
                .in_set(PrepareSystems::PrepareStages)
                .in_set(PathGuidingSystems),
        )
        .add_systems(
            Bounce,
            guide::guide_paths
                .in_set(BounceSystems::LookUp)
                .in_set(PathGuidingSystems)
                .run_if(resource_exists::<GuidePlan>),
        );
    }
}
