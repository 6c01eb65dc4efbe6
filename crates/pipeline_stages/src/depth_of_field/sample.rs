use super::LENS_STAGE;
use super::lens::ThinLens;
use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{CameraFrame, FilmBatch, FilmSums, RayStream, RenderSettings};
use rayon::prelude::*;

/// Sends each ray through a place of the lens of its own.
pub(super) fn sample_lens(
    mut batches: Query<(&FilmBatch, &mut RayStream)>,
    film: Res<FilmSums>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
    lens: Res<ThinLens>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(batch, rays)| {
            for (slot, ray) in rays.0.iter_mut().enumerate() {
                let stream = batch.sample_stream(slot, LENS_STAGE, &film.0, &settings);
                *ray = lens.bend(ray, &camera.0.frame.at(ray.time), stream.draw_2d(0, 0));
            }
            rays.0.len()
        })
        .sum();
    record_items(paths);
}
