//! The caustic photon map: photons that met only specular surfaces, stored where they land.
//!
//! Scene: `"/Render": Def(CausticPhotonMap: (photons: 50000, nearest: 50), LightTransport: (caustic: PhotonMap))`
//! Sets: `PrepareStages` (`plan_photons`), `EmitPhotons`, `TracePhotons`, `StorePhotons`, `BuildPhotonMaps`, `LookUp`
//! (`gather_caustics`).
//! Reads the transport scene and the settings. Writes photon entities ([`Photon`] with
//! [`CausticPhoton`](pipeline_data::CausticPhoton)), the tree over them, and contributions.
//! Counters: `photon_map/photons emitted`, `photon_map/photons stored`, `photon_map/lookups`.
//!
//! Emission is aimed at the specular objects, in fixed batches, until enough photons are stored. All of the photons of
//! the batches are kept, so that no photon is favoured. A photon's numbers depend on its path number alone and photons are
//! stored in (path, bounce) order: the map is the same whatever the threads.
//!
//! Limits: one map for all passes; bias by blur over the radius, at edges, and where surfaces curve within it.
//! Source: Jensen, "Global Illumination using Photon Maps", EGWR 1996.

mod build;
mod emit;
mod gather;
mod plan;
mod settings;
mod store;
#[cfg(test)]
mod tests;
mod trace;

use bevy_app::{App, Plugin};
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::common_conditions::resource_exists;
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy_ecs::system::Res;
use pipeline_core::{Bounce, BounceSystems, PhotonPass, PhotonSystems, Prepare, PrepareSystems};
use pipeline_data::{Contributions, Photon};
use transport::{DensitySettings, EmittedPhoton};

pub use build::{CausticMap, caustic_map};
pub use gather::CausticContribution;
pub use settings::{CausticPhotonMap, PhotonFilter};
pub use store::{PhotonPool, store_in_pool};

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct PhotonMapSystems;

/// Photon paths emitted by one run of `PhotonPass`.
const BATCH_PATHS: u32 = 1 << 14;

/// At most this many times the wanted photons are emitted.
const MAX_EMITTED_RATIO: u64 = 100;

/// Share of the photons that leaves uniformly, aimed at nothing: the defence against bad aim.
const UNIFORM_SHARE: f32 = 0.1;

/// The photons in the making. Present from `plan_photons` until the map is built.
#[derive(Resource)]
struct PhotonRun {
    /// Photons to store.
    wanted: u64,
    /// Paths emitted so far.
    emitted: u32,
    /// The batch that is under way.
    batch: Vec<Option<EmittedPhoton>>,
    /// Photons that landed, in (path, bounce) order; flux not yet divided by the number emitted.
    landed: Vec<Photon>,
    /// Set by `trace_photons` after the last batch.
    is_over: bool,
    /// How the map is read.
    density: DensitySettings,
}

impl PhotonRun {
    fn new(wanted: u64, density: DensitySettings) -> Self {
        Self {
            wanted,
            emitted: 0,
            batch: Vec::new(),
            landed: Vec::new(),
            is_over: false,
            density,
        }
    }

    /// True when enough photons have landed, or too many were emitted for more to be worth waiting for.
    fn has_enough(&self) -> bool {
        let most = self
            .wanted
            .saturating_mul(MAX_EMITTED_RATIO)
            .min(u64::from(u32::MAX - BATCH_PATHS));
        self.landed.len() as u64 >= self.wanted || u64::from(self.emitted) >= most
    }
}

fn emission_is_over(run: Option<Res<PhotonRun>>) -> bool {
    run.is_some_and(|run| run.is_over)
}

/// Adds the caustic photon map.
pub struct PhotonMapPlugin;

impl Plugin for PhotonMapPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<CausticPhotonMap>();
        Contributions::register::<CausticContribution>(app);
        app.add_systems(
            Prepare,
            plan::plan_photons
                .in_set(PrepareSystems::PrepareStages)
                .in_set(PhotonMapSystems),
        )
        .add_systems(
            PhotonPass,
            (
                emit::emit_photons.in_set(PhotonSystems::EmitPhotons),
                trace::trace_photons.in_set(PhotonSystems::TracePhotons),
                store::store_photons
                    .in_set(PhotonSystems::StorePhotons)
                    .run_if(emission_is_over),
                build::build_photon_map
                    .in_set(PhotonSystems::BuildPhotonMaps)
                    .run_if(emission_is_over),
            )
                .in_set(PhotonMapSystems)
                .run_if(resource_exists::<PhotonRun>),
        )
        .add_systems(
            Bounce,
            gather::gather_caustics
                .in_set(BounceSystems::LookUp)
                .in_set(PhotonMapSystems)
                .run_if(resource_exists::<CausticMap>),
        );
    }
}
