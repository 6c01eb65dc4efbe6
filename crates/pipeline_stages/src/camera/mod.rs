//! Camera rays: a wave of them at a time, through the reconstruction filter.
//!
//! Scene: `Camera` on the prim that `Render.camera` names; `Film.filter`, `Film.filter_radius`.
//! Sets: `PrepareStages` (plans the waves), `GenerateRays`, `PerturbFilm`.
//! Reads the film's sample counts, settings, camera. Writes batches with their rays and paths, `RenderClock`.
//!
//! A wave is a run of pixels in the film's storage order, with as many samples a pixel as fit; a pass is all pixels. A
//! sample is a function of (seed, pixel, sample index), so neither the size of a wave nor that of a tile changes a bit.
//! Filter importance sampling (Ernst, Stamminger and Greiner, "Filter Importance Sampling", 2006): a sample touches its
//! own pixel only.

mod generate;
mod perturb_film;

use bevy_app::{App, Plugin};
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use pipeline_core::{PerturbSystems, Prepare, PrepareSystems, RenderPass, RenderSystems};
use radiometry::StageKey;

/// Key of the random numbers of the film position.
const CAMERA_STAGE: StageKey = StageKey::new("camera");

/// Key of the random numbers of camera paths after the lens.
const PATH_STAGE: StageKey = StageKey::new("path");

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct CameraSystems;

/// Most paths of a wave. Larger waves have fewer moments at which one thread waits for the others, smaller ones stay in
/// the cache; `cargo bench --bench wavefront` tells (see the decisions in `crates/ARCHITECTURE.md`).
const WAVE_PATHS: usize = 1 << 17;

/// Most paths of a batch, the unit of work of one thread.
const BATCH_PATHS: usize = 1 << 10;

/// How the image is cut into waves. Written by `plan_waves`.
#[derive(Resource, Clone, Copy, Debug)]
struct WavePlan {
    pixels: usize,
    pixels_per_wave: usize,
    pixels_per_batch: usize,
    samples_per_pass: u32,
}

/// Adds the camera.
pub struct CameraPlugin;

impl Plugin for CameraPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Prepare,
            generate::plan_waves
                .in_set(PrepareSystems::PrepareStages)
                .in_set(CameraSystems),
        )
        .add_systems(
            RenderPass,
            (
                generate::generate_rays.in_set(RenderSystems::GenerateRays),
                perturb_film::sample_filter.in_set(PerturbSystems::PerturbFilm),
            )
                .in_set(CameraSystems),
        );
    }
}
