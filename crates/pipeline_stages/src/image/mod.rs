//! The image: film sums, auxiliary channels, files and checkpoints.
//!
//! Scene: `Film: (resolution: …, exposure: …, tone_map: …)` on the render prim.
//! Sets: `PrepareStages` (`allocate_film`), `Shade` (`record_first_hits`), `Accumulate` (`accumulate_batches`,
//! `estimate_error`), `Resolve` (`resolve_film`), `Write` (`write_images`).
//! Reads the contributions of every term, and which records of another view a cache began with. Writes the film and the files that the request names.
//! Counters: `image/samples`, `image/rejected samples` (NaN, negative or infinite; dropped at this one guard).
//!
//! Sums are exact (fixed point), so no order of waves, tiles or threads changes a bit. An interrupted render leaves a
//! checkpoint beside its first output, `<file>.partial`; `resume` goes on from there to the same bits. Every file is
//! written beside its place and renamed, so a full disk or a pulled plug leaves the old one.

mod accumulate;
mod allocate;
mod converge;
mod first_hits;
mod resolve;
mod write;

pub use converge::EstimatedError;

use bevy_app::{App, Plugin};
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use pipeline_core::{
    Bounce, BounceSystems, Finish, FinishSystems, Prepare, PrepareSystems, RenderClock, RenderPass, RenderSystems,
};

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct ImageSystems;

/// Adds the image.
pub struct ImagePlugin;

impl Plugin for ImagePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Prepare,
            allocate::allocate_film
                .in_set(PrepareSystems::PrepareStages)
                .in_set(ImageSystems),
        )
        .add_systems(
            Bounce,
            first_hits::record_first_hits
                .in_set(BounceSystems::Shade)
                .in_set(ImageSystems)
                .run_if(|clock: bevy_ecs::system::Res<RenderClock>| clock.bounce == 0),
        )
        .add_systems(
            RenderPass,
            (accumulate::accumulate_batches, converge::estimate_error)
                .chain()
                .in_set(RenderSystems::Accumulate)
                .in_set(ImageSystems),
        )
        .add_systems(
            Finish,
            (
                resolve::resolve_film.in_set(FinishSystems::Resolve),
                write::write_images.in_set(FinishSystems::Write),
            )
                .in_set(ImageSystems),
        );
    }
}
