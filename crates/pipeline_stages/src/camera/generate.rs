use super::{BATCH_PATHS, PATH_STAGE, WAVE_PATHS, WavePlan};
use bevy_ecs::prelude::*;
use glam::Vec2;
use pipeline_core::{RenderClock, Report, record_items};
use pipeline_data::{CameraFrame, FilmBatch, FilmSums, PathStream, ProgressivePasses, RayStream, RenderSettings};
use rayon::prelude::*;
use transport::Path;

/// Cuts the image into waves.
pub(super) fn plan_waves(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    film: Option<Res<FilmSums>>,
    progressive: Option<Res<ProgressivePasses>>,
    mut clock: ResMut<RenderClock>,
    report: Res<Report>,
) {
    let (Some(settings), Some(film), false) = (settings, film, report.failed()) else {
        return;
    };
    let pixels = film.0.pixel_count();
    // A power of two of samples keeps each pixel's share of a pass an aligned run of its sequences.
    let fitting = (WAVE_PATHS / pixels.max(1)).clamp(1, BATCH_PATHS);
    let samples_per_pass = match progressive {
        Some(passes) => passes.samples_per_pass,
        None => (1_u32 << fitting.ilog2()).min(settings.samples.max(1).next_power_of_two()),
    };
    let pixels_per_batch = (BATCH_PATHS / samples_per_pass as usize).max(1);
    let batches_per_wave = WAVE_PATHS / BATCH_PATHS;
    let plan = WavePlan {
        pixels,
        pixels_per_wave: pixels_per_batch * batches_per_wave,
        pixels_per_batch,
        samples_per_pass,
    };
    clock.waves_per_pass = pixels.div_ceil(plan.pixels_per_wave) as u64;
    clock.waves_total = clock.waves_per_pass * u64::from(settings.samples.div_ceil(samples_per_pass));
    // A resumed film has its whole passes behind it.
    let has = (0..film.0.pixel_count())
        .map(|pixel| film.0.sample_count(pixel))
        .min()
        .unwrap_or(0);
    clock.waves_done = (clock.waves_per_pass * u64::from(has / samples_per_pass)).min(clock.waves_total);
    commands.insert_resource(plan);
}

/// Starts the paths of the next wave: for each of its pixels, the samples that are still to be taken in this pass.
pub(super) fn generate_rays(
    mut commands: Commands,
    mut batches: Query<(Entity, &mut FilmBatch, &mut RayStream, &mut PathStream)>,
    plan: Res<WavePlan>,
    film: Res<FilmSums>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
    mut clock: ResMut<RenderClock>,
) {
    let pass = clock.waves_done / clock.waves_per_pass;
    let start = (clock.waves_done % clock.waves_per_pass) as usize * plan.pixels_per_wave;
    let end = (start + plan.pixels_per_wave).min(plan.pixels);
    let samples_end = ((pass + 1) * u64::from(plan.samples_per_pass)).min(u64::from(settings.samples)) as u32;
    let fill = |first: usize, batch: &mut FilmBatch, rays: &mut RayStream, paths: &mut PathStream| {
        let pixels = first..(first + plan.pixels_per_batch).min(end);
        fill_batch(pixels, samples_end, &film.0, &settings, &camera, batch, rays, paths);
    };
    let wanted = (end - start).div_ceil(plan.pixels_per_batch);
    let mut pool: Vec<_> = batches.iter_mut().collect();
    pool.sort_unstable_by_key(|(entity, ..)| *entity);
    for (entity, ..) in pool.iter().skip(wanted) {
        commands.entity(*entity).despawn();
    }
    let reused = pool.len().min(wanted);
    let mut live: usize = pool
        .par_iter_mut()
        .take(wanted)
        .enumerate()
        .map(|(i, (_, batch, rays, paths))| {
            fill(start + i * plan.pixels_per_batch, batch, rays, paths);
            paths.0.len()
        })
        .sum();
    for i in reused..wanted {
        let (mut batch, mut rays, mut paths) = <(FilmBatch, RayStream, PathStream)>::default();
        fill(start + i * plan.pixels_per_batch, &mut batch, &mut rays, &mut paths);
        live += paths.0.len();
        commands.spawn((batch, rays, paths));
    }
    clock.live_paths = live as u64;
    record_items(live);
}

#[expect(
    clippy::too_many_arguments,
    reason = "three streams of one batch, and what fills them"
)]
fn fill_batch(
    pixels: std::ops::Range<usize>,
    samples_end: u32,
    film: &film::Film,
    settings: &RenderSettings,
    camera: &CameraFrame,
    batch: &mut FilmBatch,
    rays: &mut RayStream,
    paths: &mut PathStream,
) {
    batch.first_pixel = pixels.start;
    batch.pixel_of_slot.clear();
    batch.sample_of_slot.clear();
    batch.film_position.clear();
    rays.0.clear();
    paths.0.clear();
    for storage in pixels.clone() {
        let pixel = film.pixel_of(storage);
        for sample in film.sample_count(storage)..samples_end {
            let slot = batch.pixel_of_slot.len() as u32;
            let position = Vec2::new(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5);
            batch.pixel_of_slot.push((storage - pixels.start) as u32);
            batch.sample_of_slot.push(sample);
            batch.film_position.push(position);
            rays.0.push(camera.0.ray(position, 0.0));
            let stream = batch.sample_stream(slot as usize, PATH_STAGE, film, settings);
            paths.0.push(Path::from_eye(slot, stream));
        }
    }
}
