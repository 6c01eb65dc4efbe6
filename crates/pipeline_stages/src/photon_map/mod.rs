//! Photon maps: photons from the lights, stored where they land on diffuse surfaces and gathered there.
//!
//! Scene: `"/Render": Def(CausticPhotonMap: (photons: 50000, nearest: 50), LightTransport: (caustic: PhotonMap))`, and
//! likewise `DirectPhotonMap` with `direct: PhotonMap`, `IndirectPhotonMap` with `indirect: PhotonMap`.
//! Sets: `PrepareStages` (`plan_photons`), `EmitPhotons`, `TracePhotons`, `StorePhotons`, `BuildPhotonMaps`, `LookUp`
//! (`gather_photons`), `EndPass` (`ask_for_photons`).
//! Reads the transport scene, the settings and what other stages demand. Writes photon entities ([`Photon`](pipeline_data::Photon) with a
//! [`PhotonMarker`](pipeline_data::PhotonMarker)), the maps over them, and contributions.
//! Counters: `photon_map/photons emitted`, `photon_map/photons stored`, `photon_map/lookups`.
//!
//! What has happened to a photon since its light decides its map: nothing, specular events alone, or any diffuse one.
//! Caustic photons are emitted by themselves, aimed at the specular objects; direct and indirect ones share their paths, and
//! are aimed at what the camera sees where few of them would land there. Emission goes on in fixed batches until enough
//! photons are stored. All of the photons of the batches are kept, so that no photon is favoured. A photon's numbers depend
//! on its pass and path number alone and photons are stored in (path, bounce) order: the map is the same whatever the threads.
//!
//! Once built, each map looks for the walls around its photons, so that no light leaks through them.
//!
//! Photons that an earlier run wrote to a file are stored instead of traced where the request names it, to the same bits.
//!
//! Progressive maps are made anew for every pass, from a number of paths that a first batch decides, and read with a radius
//! that shrinks with the number of the pass: passes can be resumed and shared out.
//!
//! Limits: bias by blur over the radius, at edges, and where surfaces curve within it. Photons have no time; walls that move
//! are looked for where they are at half the time of the shutter.
//! Source: Jensen, "Global Illumination using Photon Maps", EGWR 1996; Knaus and Zwicker, ACM TOG 30(3), 2011.

mod build;
mod emit;
mod gather;
mod plan;
mod repeat;
mod run;
mod settings;
mod store;
#[cfg(test)]
mod tests;
mod trace;

use bevy_app::{App, Plugin};
use bevy_ecs::schedule::common_conditions::{not, resource_exists};
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy_ecs::system::Res;
use pipeline_core::{
    Bounce, BounceSystems, PhotonPass, PhotonSystems, Prepare, PrepareSystems, RenderPass, RenderSystems,
};
use pipeline_data::{BuiltPhotonMaps, CausticPhoton, Contributions, DirectPhoton, IndirectPhoton, PhotonDemand};
use run::{PhotonPlan, PhotonRun};

pub use build::{look_for_walls, photon_map};
pub use gather::PhotonContribution;
pub use plan::photon_key;
pub use settings::{CausticPhotonMap, DirectPhotonMap, IndirectPhotonMap, PhotonFilter, PhotonMapSettings};
pub use store::{PhotonPool, store_in_pool};

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct PhotonMapSystems;

fn photons_have_landed(run: Option<Res<PhotonRun>>) -> bool {
    run.is_some_and(|run| run.is_over())
}

/// Adds the photon maps.
pub struct PhotonMapPlugin;

impl Plugin for PhotonMapPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<DirectPhotonMap>()
            .register_type::<CausticPhotonMap>()
            .register_type::<IndirectPhotonMap>()
            .init_resource::<PhotonDemand>();
        Contributions::register::<PhotonContribution<DirectPhoton>>(app);
        Contributions::register::<PhotonContribution<CausticPhoton>>(app);
        Contributions::register::<PhotonContribution<IndirectPhoton>>(app);
        app.add_systems(
            Prepare,
            plan::plan_photons
                .in_set(PrepareSystems::PrepareStages)
                .in_set(PhotonMapSystems),
        )
        .add_systems(
            PhotonPass,
            (
                (
                    emit::begin_photons.run_if(not(resource_exists::<PhotonRun>)),
                    emit::emit_photons,
                )
                    .chain()
                    .in_set(PhotonSystems::EmitPhotons),
                trace::trace_photons.in_set(PhotonSystems::TracePhotons),
                (
                    store::store_photons::<DirectPhoton>,
                    store::store_photons::<CausticPhoton>,
                    store::store_photons::<IndirectPhoton>,
                )
                    .chain()
                    .in_set(PhotonSystems::StorePhotons)
                    .run_if(photons_have_landed),
                (
                    build::make_room_for_maps.run_if(not(resource_exists::<BuiltPhotonMaps>)),
                    build::build_photon_map::<DirectPhoton>,
                    build::build_photon_map::<CausticPhoton>,
                    build::build_photon_map::<IndirectPhoton>,
                    build::probe_walls::<DirectPhoton>,
                    build::probe_walls::<CausticPhoton>,
                    build::probe_walls::<IndirectPhoton>,
                    build::finish_photons,
                )
                    .chain()
                    .in_set(PhotonSystems::BuildPhotonMaps)
                    .run_if(photons_have_landed),
            )
                .in_set(PhotonMapSystems)
                .run_if(resource_exists::<PhotonPlan>),
        )
        .add_systems(
            RenderPass,
            repeat::ask_for_photons
                .in_set(RenderSystems::EndPass)
                .in_set(PhotonMapSystems)
                .run_if(resource_exists::<PhotonPlan>),
        )
        .add_systems(
            Bounce,
            (
                gather::gather_photons::<DirectPhoton>.run_if(gather::is_read::<DirectPhoton>),
                gather::gather_photons::<CausticPhoton>.run_if(gather::is_read::<CausticPhoton>),
                gather::gather_photons::<IndirectPhoton>.run_if(gather::is_read::<IndirectPhoton>),
            )
                .in_set(BounceSystems::LookUp)
                .in_set(PhotonMapSystems),
        );
    }
}
