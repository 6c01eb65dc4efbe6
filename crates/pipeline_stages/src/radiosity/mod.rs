//! Radiosity: light that matt surfaces exchange, solved once for patches of all of them.
//!
//! Scene: `"/Render": Def(LightTransport: (indirect: Radiosity), Radiosity: (patch_size: 0.05))`, or as what gather rays see:
//! `LightTransport: (indirect: FinalGather), FinalGather: (incoming: Radiosity)`.
//! Sets: `PrepareStages` (`plan_radiosity`, `solve_radiosity`, `store_patches`), `LookUp` (`look_up_radiosity`).
//! Reads the scene's tables. Writes patches, which are entities, [`SolvedPatches`], and contributions.
//! Counters: `radiosity/patches`, `radiosity/form factors`, `radiosity/rounds`, `radiosity/look-ups without a patch`.
//!
//! A patch is a point that stands for the surface around it, on one side. Light sampling finds what reaches it from lights of
//! all kinds; rays over its hemisphere, by the cosine, find the patches that it sees, over mirrors and through glass too.
//! Then light goes around until less than `tolerance` of it is missing. Read directly, the solution is smooth and cheap, and
//! blurs whatever is smaller than a patch; read by gather rays it is one reflection away, and fine in detail.
//!
//! Limits: surfaces that move carry no patches, neither reflect light to others, and are seen by a few rays instead. D lobes
//! that are not Lambertian send their light alike to all sides. Alpha lets light through as it does for all rays. Light over
//! S surfaces onto patches is found by chance, as a tracer finds it: a small lamp behind glass makes spots.
//! `Render.max_depth` is counted from patches that the eye sees straight; S surfaces before them do not count.
//! Sources: see `transport::radiosity`.

mod look_up;
mod plan;
mod solve;
mod store;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::{Bounce, BounceSystems, Prepare, PrepareSystems};
use pipeline_data::{Contributions, PatchDemand, SolvedPatches};
use scene_format::{Range, Unit};

pub use look_up::RadiosityContribution;

/// Settings of radiosity, on the prim that carries `Render`; used when `LightTransport.indirect` or `FinalGather.incoming` is
/// `Radiosity`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Radiosity {
    /// Side of a patch in metres: smaller ones show finer shadows, and take longer by the inverse square. Without one, so
    /// that the scene has about 4,000 times two sides.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub patch_size: Option<f32>,
    /// Rays that look for the patches that a patch sees, and light samples: more make the light less uneven.
    #[reflect(@Range::closed(1.0, 65_536.0))]
    pub rays: u32,
    /// Share of the exchanged light that may be estimated instead of exchanged: what comes after many reflections.
    #[reflect(@Range::closed(0.000_001, 0.5))]
    pub tolerance: f32,
}

impl Default for Radiosity {
    fn default() -> Self {
        Self {
            patch_size: None,
            rays: 256,
            tolerance: 0.01,
        }
    }
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct RadiositySystems;

/// Adds radiosity.
pub struct RadiosityPlugin;

impl Plugin for RadiosityPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Radiosity>().init_resource::<PatchDemand>();
        Contributions::register::<RadiosityContribution>(app);
        app.add_systems(
            Prepare,
            (plan::plan_radiosity, solve::solve_radiosity, store::store_patches)
                .chain()
                .in_set(PrepareSystems::PrepareStages)
                .in_set(RadiositySystems),
        )
        .add_systems(
            Bounce,
            look_up::look_up_radiosity
                .in_set(BounceSystems::LookUp)
                .in_set(RadiositySystems)
                .run_if(resource_exists::<SolvedPatches>),
        );
    }
}
