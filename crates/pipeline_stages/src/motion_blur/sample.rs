use super::SHUTTER_STAGE;
use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{CameraFrame, FilmBatch, FilmSums, RayStream, RenderSettings};
use rayon::prelude::*;

/// Shoots each ray at a time of its own, evenly over the shutter interval, from where the camera is then.
pub(super) fn sample_shutter(
    mut batches: Query<(&FilmBatch, &mut RayStream)>,
    film: Res<FilmSums>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(batch, rays)| {
            for (slot, ray) in rays.0.iter_mut().enumerate() {
                let stream = batch.sample_stream(slot, SHUTTER_STAGE, &film.0, &settings);
                *ray = camera.0.ray(batch.film_position[slot], stream.draw_1d(0, 0));
            }
            rays.0.len()
        })
        .sum();
    record_items(paths);
}
