use super::PhotonRun;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, Progress, RenderClock, Report, record_items};
use pipeline_data::{Photon, RenderSettings, TransportScene};
use radiometry::SampleStream;
use rayon::prelude::*;
use transport::{MapKinds, PHOTON_STAGE, trace_photon};

/// Photon paths that one task follows.
const TASK_PATHS: usize = 512;

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
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    emitted: Local<EmittedCounter>,
    progress: Res<Progress>,
    mut clock: ResMut<RenderClock>,
    mut report: ResMut<Report>,
) {
    let first = run.emitted;
    // The eye has an event of its own where the photon is read.
    let max_depth = settings.methods.max_depth.saturating_sub(1);
    let follow = |(task, photons): (usize, &[_])| {
        let mut landed = Vec::new();
        for (i, photon) in photons.iter().enumerate() {
            let Some(photon) = photon else { continue };
            let path = first + (task * TASK_PATHS + i) as u32;
            let stream = SampleStream::new(settings.seed, PHOTON_STAGE, 0, path);
            trace_photon(
                &scene.0,
                photon,
                MapKinds::CAUSTIC,
                max_depth,
                path,
                &stream,
                |deposit| {
                    landed.push(Photon::from(deposit));
                },
            );
        }
        landed
    };
    let landed: Vec<Vec<Photon>> = run.batch.par_chunks(TASK_PATHS).enumerate().map(follow).collect();
    run.landed.extend(landed.into_iter().flatten());
    run.emitted += run.batch.len() as u32;
    emitted.0.add(run.batch.len() as u64);
    record_items(run.batch.len());
    progress.set_done((run.landed.len() as u64).min(run.wanted));
    if run.has_enough() {
        run.is_over = true;
        clock.photons_pending -= 1;
        if (run.landed.len() as u64) < run.wanted {
            report.warn(format!(
                "warning[few-photons]: {} of {} caustic photons are stored after {} were emitted; the caustic is coarser than asked for\n  \
                 = little light reaches specular surfaces; ask for fewer photons, or set `LightTransport.caustic` to `Trace` or `Off`",
                run.landed.len(),
                run.wanted,
                run.emitted
            ));
        }
    }
}
