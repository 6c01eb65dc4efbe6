use super::{BATCH_PATHS, PhotonRun, UNIFORM_SHARE};
use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{RenderSettings, TransportScene};
use radiometry::SampleStream;
use rayon::prelude::*;
use transport::{EmissionSampler, PHOTON_STAGE};

/// Emits the next batch of photons.
pub(super) fn emit_photons(mut run: ResMut<PhotonRun>, scene: Res<TransportScene>, settings: Res<RenderSettings>) {
    let sampler = EmissionSampler::aimed(&scene.0.lights, scene.0.specular_targets(), UNIFORM_SHARE);
    let first = run.emitted;
    (first..first + BATCH_PATHS)
        .into_par_iter()
        .map(|path| sampler.emit(&SampleStream::new(settings.seed, PHOTON_STAGE, 0, path)))
        .collect_into_vec(&mut run.batch);
    record_items(run.batch.len());
}
