use super::CAMERA_STAGE;
use bevy_ecs::prelude::*;
use film::FilterSampler;
use pipeline_core::record_items;
use pipeline_data::{CameraFrame, FilmBatch, FilmSums, RayStream, RenderSettings};
use rayon::prelude::*;

/// Moves each ray to a place of its pixel's filter, chosen in proportion to the filter.
pub(super) fn sample_filter(
    mut batches: Query<(&mut FilmBatch, &mut RayStream)>,
    film: Res<FilmSums>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
    mut filter: Local<Option<FilterSampler>>,
) {
    let filter = match &mut *filter {
        Some(filter) if filter.kind() == settings.filter && filter.radius() == settings.filter_radius => filter,
        stale => stale.insert(FilterSampler::new(settings.filter, settings.filter_radius)),
    };
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(batch, rays)| {
            for (slot, ray) in rays.0.iter_mut().enumerate() {
                let stream = batch.sample_stream(slot, CAMERA_STAGE, &film.0, &settings);
                batch.film_position[slot] += filter.sample(stream.draw_2d(0, 0));
                *ray = camera.0.ray(batch.film_position[slot], 0.0);
            }
            rays.0.len()
        })
        .sum();
    record_items(paths);
}
