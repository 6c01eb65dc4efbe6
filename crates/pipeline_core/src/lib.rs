//! The frame that the renderer's stages hang in: schedules, system sets, profiler, progress and cancellation.
//!
//! The crate knows nothing of light. It says *when* things happen: [`CorePlugin`] adds the schedules with their sets in
//! order, [`render`] runs them from loading to writing, and every system that any stage adds is timed by the
//! [`Profile`], shown by [`describe_schedules`] and interrupted by [`Cancellation`] without knowing of it.
//!
//! - A stage is a [`bevy_app::Plugin`] that adds systems to a set of a schedule. Nothing here names a stage.
//! - Schedules run single-threaded; data parallelism lives inside the systems. A frame of twenty systems then costs
//!   microseconds of scheduling instead of tens of them.
//! - Two systems that could run in either order are an error when a schedule is built.
//!
//! It deliberately offers no asset server, no events and no window: a render is a batch job.
//!
//! ```
//! use bevy_app::App;
//! use bevy_ecs::prelude::*;
//! use pipeline_core::{CorePlugin, Prepare, PrepareSystems, Report};
//!
//! fn warn_of_nothing(mut report: ResMut<Report>) {
//!     report.warn("nothing to prepare".into());
//! }
//!
//! let mut app = App::empty();
//! app.add_plugins(CorePlugin);
//! app.add_systems(Prepare, warn_of_nothing.in_set(PrepareSystems::BuildTables));
//! app.world_mut().run_schedule(Prepare);
//! assert_eq!(app.world().resource::<Report>().warnings().len(), 1);
//! ```

mod cancel;
mod describe;
mod driver;
mod plugin;
mod profile;
mod profile_layer;
mod progress;
mod report;
mod schedules;

pub use cancel::Cancellation;
pub use describe::{ScheduleDescription, SetDescription, describe_schedules};
pub use driver::{Outcome, RenderClock, render};
pub use plugin::CorePlugin;
pub use profile::{Profile, SystemRow, TraceEvent, record_items};
pub use profile_layer::ProfileLayer;
pub use progress::{Progress, ProgressReading};
pub use report::{Counter, Counters, Report};
pub use schedules::{
    Bounce, BounceSystems, CachePass, CacheSystems, Finish, FinishSystems, Load, LoadSystems, PerturbSystems,
    PhotonPass, PhotonSystems, Prepare, PrepareSystems, RenderPass, RenderSystems,
};
