use super::plan::CachePlan;
use bevy_ecs::prelude::*;
use glam::{UVec2, Vec2};
use pipeline_core::{Progress, RenderClock, record_items};
use pipeline_data::{CameraFrame, ProgressivePasses, RECORD_DEPTHS, RenderSettings};
use radiometry::{SampleStream, StageKey};
use spatial::Ray;
use transport::{IrradianceRecord, Path, Site};

/// Key of the random numbers of places on the film.
const FILM_STAGE: StageKey = StageKey::new("irradiance_cache/film");
/// Key of those of the paths from there.
const PATH_STAGE: StageKey = StageKey::new("irradiance_cache/paths");

/// Distances between camera rays, in pixels. Rays are at random places of their pixels, so that the last rounds find what those
/// before them have missed; they cost little.
const STEPS: [u32; 10] = [32, 16, 8, 4, 2, 1, 1, 1, 1, 1];

/// Camera rays of the levels by which deep places are found, about: these are places of the scene, not of the picture.
const DEEP_RAYS: [u64; 3] = [256, 1024, 4096];

/// Levels of all depths.
const LEVELS: usize = (RECORD_DEPTHS - 1) * DEEP_RAYS.len() + STEPS.len();

/// Most camera rays at a time, so that memory does not grow with the picture.
const WAVE_RAYS: u32 = 1 << 16;

/// How far the filling of the cache is. Present while it goes on.
#[derive(Resource, Debug, Default)]
pub(super) struct CacheFill {
    /// Pass of the render whose photons are read; 0 where they are the same in all.
    pub(super) generation: u32,
    /// Whether records of an earlier pass were dropped for these.
    pub(super) is_renewed: bool,
    /// Of the next wave: the deepest records come first.
    pub(super) level: usize,
    /// Of the records of this wave.
    pub(super) depth: usize,
    /// First cell of the next wave.
    pub(super) next_cell: u32,
    /// Pixels between the camera rays of this wave.
    pub(super) step: u32,
    /// Camera rays that were just made.
    pub(super) rays: Vec<(Path, Ray)>,
    /// Places of this wave that no record tells of yet.
    pub(super) missing: Vec<Site>,
    /// Those of them that get a record in this round.
    pub(super) chosen: Vec<Site>,
    /// Their records.
    pub(super) sampled: Vec<IrradianceRecord>,
    /// Number of the next record, by depth.
    pub(super) next_number: [u32; RECORD_DEPTHS],
    /// Of the random numbers of the next record, by depth: those that were refused have had some, too.
    pub(super) next_stream: [u32; RECORD_DEPTHS],
    /// Number of the first record that is made here, by depth; those before it come from a file.
    pub(super) first_number: [u32; RECORD_DEPTHS],
}

impl CacheFill {
    /// - `is_deep`: whether records of all depths are asked for, or only those that the eye reads.
    /// - `is_renewed`: see [`CacheFill::is_renewed`].
    pub(super) fn new(is_deep: bool, is_renewed: bool) -> Self {
        Self {
            is_renewed,
            level: if is_deep { 0 } else { LEVELS - STEPS.len() },
            ..Self::default()
        }
    }

    /// Goes on after records that there are already.
    ///
    /// - `records`: how many, by depth.
    /// - `is_complete`: whether none is missing.
    pub(super) fn after(self, records: [u32; RECORD_DEPTHS], is_complete: bool) -> Self {
        Self {
            level: if is_complete { LEVELS } else { self.level },
            next_number: records,
            next_stream: records,
            first_number: records,
            ..self
        }
    }

    /// Depth of the records of the next wave, and the distance between its camera rays in pixels.
    fn next_level(&self, pixels: u64) -> (usize, u32) {
        let (turn, level) = (self.level / DEEP_RAYS.len(), self.level % DEEP_RAYS.len());
        if turn < RECORD_DEPTHS - 1 {
            (
                RECORD_DEPTHS - 1 - turn,
                ((pixels / DEEP_RAYS[level]).isqrt() as u32).max(1),
            )
        } else {
            (0, STEPS[self.level + STEPS.len() - LEVELS])
        }
    }

    /// True when nothing is missing at any level.
    pub(super) fn is_over(&self) -> bool {
        self.level >= LEVELS && self.missing.is_empty()
    }
}

/// Sends out the camera rays of the next wave, once the last one misses nothing any more.
pub(super) fn generate_rays(
    mut fill: ResMut<CacheFill>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
    progress: Res<Progress>,
    plan: Res<CachePlan>,
    (clock, passes): (Res<RenderClock>, Option<Res<ProgressivePasses>>),
) {
    let fill = &mut *fill;
    if fill.step == 0 {
        // The pass is that of the render, so that one that was resumed has the same records.
        if plan.reads_photons && passes.is_some() {
            fill.generation = (clock.waves_done / clock.waves_per_pass.max(1)) as u32;
        }
        if !fill.is_renewed {
            progress.start("records", "levels", LEVELS as u64);
            progress.set_done(fill.level as u64);
        }
    }
    if !fill.missing.is_empty() || fill.is_over() {
        return;
    }
    let level = fill.level as u32;
    let size = settings.crop_max - settings.crop_min;
    let (depth, step) = fill.next_level(u64::from(size.x) * u64::from(size.y));
    (fill.depth, fill.step) = (depth, step);
    let cells = UVec2::new(size.x.div_ceil(step), size.y.div_ceil(step));
    let end = (cells.x * cells.y).min(fill.next_cell + WAVE_RAYS);
    let ray = |cell: u32| {
        let corner = settings.crop_min + UVec2::new(cell % cells.x, cell / cells.x) * step;
        let domain = u64::from(corner.y) * u64::from(settings.resolution.x) + u64::from(corner.x);
        let film = SampleStream::new(settings.seed, FILM_STAGE, domain, level);
        let place = corner.as_vec2() + film.draw_2d(0, 0) * step as f32;
        let place = place.min(settings.crop_max.as_vec2() - Vec2::splat(1e-3));
        let stream = SampleStream::new(settings.seed, PATH_STAGE, domain, level);
        (Path::from_eye(0, stream), camera.0.ray(place, film.draw_1d(0, 1)))
    };
    fill.rays = (fill.next_cell..end).map(ray).collect();
    record_items(fill.rays.len());
    fill.next_cell = end;
    if end == cells.x * cells.y {
        fill.next_cell = 0;
        fill.level += 1;
        if !fill.is_renewed {
            progress.set_done(fill.level as u64 - 1);
        }
    }
}
