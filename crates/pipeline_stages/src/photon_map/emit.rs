use super::run::{PhotonPlan, PhotonRun};
use bevy_ecs::prelude::*;
use pipeline_core::{Progress, RenderClock, record_items};
use pipeline_data::{BuiltPhotonMaps, TransportScene};

/// Begins the photons of a pass.
///
/// The pass is that of the render, so that one that was resumed, or that another machine renders, has the same photons.
pub(super) fn begin_photons(
    mut commands: Commands,
    plan: Res<PhotonPlan>,
    clock: Res<RenderClock>,
    built: Option<Res<BuiltPhotonMaps>>,
    progress: Res<Progress>,
) {
    let pass = (clock.waves_done / clock.waves_per_pass.max(1)) as u32;
    if built.is_none() {
        let maps = plan.emissions.iter().flat_map(|emission| &emission.maps);
        progress.start("photons", "photons", maps.map(|map| map.wanted).sum());
    }
    commands.insert_resource(match &plan.reloaded {
        Some(maps) => PhotonRun::reloaded(&plan, maps),
        None => PhotonRun::new(&plan, pass, built.is_none()),
    });
}

/// Emits the next batch of photons.
pub(super) fn emit_photons(mut run: ResMut<PhotonRun>, plan: Res<PhotonPlan>, scene: Res<TransportScene>) {
    let Some(emission) = run.emissions.front_mut() else {
        return;
    };
    emission.batch = emission
        .aim
        .emit_batch(&scene.0.lights, plan.seed, emission.pass, emission.emitted);
    record_items(emission.batch.len());
}
