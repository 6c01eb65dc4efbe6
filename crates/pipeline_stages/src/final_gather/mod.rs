//! Final gathering: indirect light by rays over the hemisphere that read the photon maps where they end.
//!
//! Scene: `"/Render": Def(LightTransport: (indirect: FinalGather), FinalGather: (rays: 64))`
//! Sets: `PrepareStages` (`plan_gathering`), `DeriveFromMaps` (`precompute_irradiance`), `LookUp` (`gather_indirect`).
//! Reads the photon maps, all three of them, or the patches of radiosity. Writes contributions, and irradiance beside the maps.
//! Counters: `final_gather/rays`, `final_gather/irradiance records`.
//!
//! Every diffuse point that the eye sees, directly or in mirrors, sends out rays by its BSDF. At the first diffuse surface
//! each of them meets, over mirrors and glass or not, the maps say what is reflected towards it. A ray no longer than the
//! radius of that estimate goes on as a path instead, so that corners stay clean. The samples of a pixel and the rays of a
//! sample are one stratified sequence, so 16 samples of 16 rays gather as well as 1 of 256.
//!
//! Limits: the bias of the photon maps, one reflection away.
//! Source: Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001; Christensen, Journal of Graphics Tools 4(3), 1999.

mod gather;
mod plan;
mod precompute;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::{Bounce, BounceSystems, PhotonPass, PhotonSystems, Prepare, PrepareSystems};
use pipeline_data::{Contributions, PatchDemand, PhotonDemand};
use plan::GatherPlan;
use scene_format::Range;

pub use gather::GatherContribution;

/// Settings of final gathering, on the prim that carries `Render`; used when `LightTransport.indirect` is `FinalGather`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct FinalGather {
    /// Rays from each diffuse point that a sample sees. What counts is this times `Render.samples`.
    #[reflect(@Range::closed(1.0, 65_536.0))]
    pub rays: u32,
    /// Where the light at the ends of rays comes from.
    pub incoming: GatherSource,
    /// Compute irradiance beforehand beside every fourth photon, and let rays read the nearest: several times faster, at the
    /// price of light that changes in small steps, which many rays average out. Progressive maps are read as they are.
    pub precomputed: bool,
}

impl Default for FinalGather {
    fn default() -> Self {
        Self {
            rays: 256,
            incoming: GatherSource::default(),
            precomputed: true,
        }
    }
}

/// Where the light at the ends of gather rays comes from.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum GatherSource {
    /// The photon maps.
    #[default]
    Photons,
    /// The patches of radiosity, of matt surfaces all over: smooth, and the same from everywhere. Settings are those of
    /// `Radiosity`.
    Radiosity,
    /// Paths that go on: without bias, and slow.
    Path,
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct FinalGatherSystems;

/// Adds final gathering.
pub struct FinalGatherPlugin;

impl Plugin for FinalGatherPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<FinalGather>()
            .init_resource::<PhotonDemand>()
            .init_resource::<PatchDemand>();
        Contributions::register::<GatherContribution>(app);
        app.add_systems(
            Prepare,
            plan::plan_gathering
                .in_set(PrepareSystems::PrepareStages)
                .in_set(FinalGatherSystems),
        )
        .add_systems(
            PhotonPass,
            precompute::precompute_irradiance
                .in_set(PhotonSystems::DeriveFromMaps)
                .in_set(FinalGatherSystems)
                .run_if(plan::precomputes),
        )
        .add_systems(
            Bounce,
            gather::gather_indirect
                .in_set(BounceSystems::LookUp)
                .in_set(FinalGatherSystems)
                .run_if(resource_exists::<GatherPlan>),
        );
    }
}
