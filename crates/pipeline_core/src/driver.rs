use crate::{Bounce, CachePass, Cancellation, Finish, Load, PhotonPass, Prepare, Progress, RenderPass, Report};
use bevy_app::App;
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::world::World;
use std::time::{Duration, Instant};

/// What drives the schedules after [`Prepare`]. Stages write it, [`render`] reads it.
#[derive(Resource, Clone, Debug, Default)]
pub struct RenderClock {
    /// Number of stages that still want [`PhotonPass`] to run.
    pub photons_pending: u32,
    /// Number of stages that still want [`CachePass`] to run.
    pub records_pending: u32,
    /// Paths of the current wave that live; [`Bounce`] runs while there are any.
    pub live_paths: u64,
    /// Bounce that [`Bounce`] runs for, from 0.
    pub bounce: u32,
    /// Waves that are rendered; begins with those that a resumed film already has.
    pub waves_done: u64,
    /// Waves of the whole image, all samples included.
    pub waves_total: u64,
    /// Waves that make a whole pass: one more sample, or a few, in every pixel.
    pub waves_per_pass: u64,
    /// Stop before the first pass that would start later than this after the start of loading.
    pub time_limit: Option<Duration>,
    /// Set by a stage at the end of a pass once the image is as good as was asked for: the render is complete then.
    pub is_converged: bool,
    /// Load and prepare only.
    pub check_only: bool,
    /// Make the photons of the first pass, and render nothing.
    pub photons_only: bool,
    /// Make the records of the first pass, and the photons that they may read, and render nothing.
    pub records_only: bool,
    /// Refuse a scene that loading or preparing warns about.
    pub strict: bool,
}

/// How a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every sample was taken, a stage was content, or the time limit came; the files are written.
    Finished,
    /// Somebody asked to stop; what there was is written.
    Interrupted,
    /// The scene is bad, or has warnings and the clock is strict; [`Report`] says why. Nothing was written.
    BadScene,
    /// The image could not be written; [`Report`] says why.
    WriteFailed,
}

/// Runs the schedules from [`Load`] to [`Finish`].
///
/// An interruption is noticed between photon batches, between rounds of a cache and between waves, the time limit between passes: it ends on whole
/// passes, and one pass with samples to take is always rendered.
pub fn render(app: &mut App) -> Outcome {
    let started = Instant::now();
    let world = app.world_mut();
    for (stage, run) in [
        ("loading", run::<Load> as fn(&mut World)),
        ("preparing", run::<Prepare>),
    ] {
        world.resource::<Progress>().start(stage, "", 0);
        run(world);
        if world.resource::<Report>().failed() {
            return Outcome::BadScene;
        }
    }
    if world.resource::<RenderClock>().strict && !world.resource::<Report>().warnings().is_empty() {
        return Outcome::BadScene;
    }
    if world.resource::<RenderClock>().check_only {
        return Outcome::Finished;
    }
    let cancellation = world.resource::<Cancellation>().clone();
    run_photon_passes(world, &cancellation);
    let made = || {
        if cancellation.is_requested() {
            Outcome::Interrupted
        } else {
            Outcome::Finished
        }
    };
    if world.resource::<RenderClock>().photons_only {
        return made();
    }
    run_cache_passes(world, &cancellation);
    let clock = world.resource::<RenderClock>();
    if clock.records_only {
        return made();
    }
    let (total, per_pass, limit) = (clock.waves_total, clock.waves_per_pass.max(1), clock.time_limit);
    let first_stop = clock.waves_done + per_pass;
    let progress = world.resource::<Progress>().clone();
    progress.start("rendering", "waves", total);
    while !cancellation.is_requested() {
        let clock = world.resource::<RenderClock>();
        let done = clock.waves_done;
        progress.set_done(done);
        let out_of_time = done >= first_stop
            && done.is_multiple_of(per_pass)
            && limit.is_some_and(|limit| started.elapsed() >= limit);
        if clock.is_converged {
            world.resource_mut::<RenderClock>().waves_total = done;
            break;
        }
        if done >= total || out_of_time {
            break;
        }
        run_photon_passes(world, &cancellation);
        run_cache_passes(world, &cancellation);
        if cancellation.is_requested() {
            break;
        }
        world.run_schedule(RenderPass);
        world.resource_mut::<RenderClock>().waves_done += 1;
    }
    let clock = world.resource::<RenderClock>();
    let interrupted = clock.waves_done < clock.waves_total && cancellation.is_requested();
    progress.start("writing", "", 0);
    world.run_schedule(Finish);
    match (world.resource::<Report>().failed(), interrupted) {
        (true, _) => Outcome::WriteFailed,
        (false, true) => Outcome::Interrupted,
        (false, false) => Outcome::Finished,
    }
}

/// Runs [`PhotonPass`] until no stage wants it any more: before the first wave, and before those whose photons are new.
fn run_photon_passes(world: &mut World, cancellation: &Cancellation) {
    while world.resource::<RenderClock>().photons_pending > 0 && !cancellation.is_requested() {
        world.run_schedule(PhotonPass);
    }
}

/// Runs [`CachePass`] until no stage wants it any more: after photons that it may read.
fn run_cache_passes(world: &mut World, cancellation: &Cancellation) {
    while world.resource::<RenderClock>().records_pending > 0 && !cancellation.is_requested() {
        world.run_schedule(CachePass);
    }
}

fn run<S: ScheduleLabel + Default>(world: &mut World) {
    world.run_schedule(S::default());
}

/// Runs [`Bounce`] until no path of the wave lives.
///
/// Stands in [`RenderSystems::TracePaths`](crate::RenderSystems); exclusive, since it runs a schedule.
pub(crate) fn trace_paths(world: &mut World) {
    world.resource_mut::<RenderClock>().bounce = 0;
    while world.resource::<RenderClock>().live_paths > 0 {
        world.run_schedule(Bounce);
        world.resource_mut::<RenderClock>().bounce += 1;
    }
}
