use super::run::{EmissionRun, PhotonPlan, PhotonRun};
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, Progress, Report, record_items};
use pipeline_data::{BuiltPhotonMaps, TransportScene};

/// The counter of this system, asked for once.
pub(super) struct EmittedCounter(Counter);

impl FromWorld for EmittedCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("photon_map/photons emitted"))
    }
}

/// Follows the photons of the batch to where they land.
pub(super) fn trace_photons(
    mut run: ResMut<PhotonRun>,
    plan: Res<PhotonPlan>,
    scene: Res<TransportScene>,
    built: Option<Res<BuiltPhotonMaps>>,
    emitted: Local<EmittedCounter>,
    progress: Res<Progress>,
    mut report: ResMut<Report>,
) {
    let Some(emission) = run.emissions.front_mut() else {
        return;
    };
    let batch = std::mem::take(&mut emission.batch);
    let landed = emission.aim.trace_batch(
        &scene.0,
        &batch,
        emission.wanted(),
        &plan,
        emission.pass,
        emission.emitted,
    );
    emission.take_in(&landed);
    emitted.0.add(batch.len() as u64);
    record_items(batch.len());
    if emission.wanted().is_empty()
        && let Some(over) = run.emissions.pop_front()
    {
        if built.is_none() {
            warn_of_few_photons(&over, &mut report);
        }
        run.landed.extend(over.maps);
    }
    // Later passes belong to the progress of rendering.
    if built.is_none() {
        progress.set_done(run.landed_count());
    }
}

fn warn_of_few_photons(emission: &EmissionRun, report: &mut Report) {
    for map in &emission.maps {
        let (kind, landed, wanted) = (map.plan.kind.name(), map.photons.len(), map.plan.wanted);
        if map.plan.batches.is_some() || landed as u64 >= wanted {
            continue;
        }
        let emitted = map.emitted.unwrap_or_default();
        report.warn(format!(
            "warning[few-photons]: {landed} of {wanted} {kind} photons are stored after {emitted} were emitted; their light is coarser than \
             asked for\n  = little light takes such ways here; ask for fewer photons, or choose another method in `LightTransport`"
        ));
    }
}
