use crate::driver::trace_paths;
use crate::schedules::{
    Bounce, BounceSystems, CachePass, CacheSystems, Finish, FinishSystems, Load, LoadSystems, PerturbSystems,
    PhotonPass, PhotonSystems, Prepare, PrepareSystems, RenderPass, RenderSystems,
};
use crate::{Cancellation, Counters, Progress, RenderClock, Report};
use bevy_app::{App, Plugin};
use bevy_ecs::reflect::AppTypeRegistry;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor,
};

/// Adds the schedules with their sets in order, and the resources that every stage may use.
pub struct CorePlugin;

impl Plugin for CorePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<AppTypeRegistry>()
            .init_resource::<Report>()
            .init_resource::<Counters>()
            .init_resource::<Progress>()
            .init_resource::<Cancellation>()
            .init_resource::<RenderClock>();
        app.add_schedule(schedule(Load))
            .add_schedule(schedule(Prepare))
            .add_schedule(schedule(PhotonPass))
            .add_schedule(schedule(CachePass))
            .add_schedule(schedule(RenderPass))
            .add_schedule(schedule(Bounce))
            .add_schedule(schedule(Finish));
        app.configure_sets(
            Load,
            (LoadSystems::Compose, LoadSystems::Spawn, LoadSystems::ImportAssets).chain(),
        )
        .configure_sets(
            Prepare,
            (
                PrepareSystems::OpenShutter,
                PrepareSystems::ResolveTransforms,
                PrepareSystems::BuildAcceleration,
                PrepareSystems::BuildTables,
                PrepareSystems::PrepareStages,
            )
                .chain(),
        )
        .configure_sets(
            PhotonPass,
            (
                PhotonSystems::EmitPhotons,
                PhotonSystems::TracePhotons,
                PhotonSystems::StorePhotons,
                PhotonSystems::RevisePhotons,
                PhotonSystems::BuildPhotonMaps,
                PhotonSystems::DeriveFromMaps,
            )
                .chain(),
        )
        .configure_sets(
            CachePass,
            (
                CacheSystems::GenerateRays,
                CacheSystems::Intersect,
                CacheSystems::LookUp,
                CacheSystems::Sample,
                CacheSystems::Insert,
                CacheSystems::Maintain,
            )
                .chain(),
        )
        .configure_sets(
            RenderPass,
            (
                RenderSystems::GenerateRays,
                RenderSystems::PerturbRays,
                RenderSystems::TracePaths,
                RenderSystems::Accumulate,
                RenderSystems::EndPass,
            )
                .chain(),
        )
        .configure_sets(
            RenderPass,
            (
                PerturbSystems::PerturbFilm,
                PerturbSystems::PerturbTime,
                PerturbSystems::PerturbLens,
            )
                .chain()
                .in_set(RenderSystems::PerturbRays),
        )
        .configure_sets(
            Bounce,
            (
                BounceSystems::Intersect,
                BounceSystems::LookUp,
                BounceSystems::Shade,
                BounceSystems::Scatter,
            )
                .chain(),
        )
        .configure_sets(Finish, (FinishSystems::Resolve, FinishSystems::Write).chain())
        .add_systems(RenderPass, trace_paths.in_set(RenderSystems::TracePaths));
    }
}

/// An empty schedule that runs on one thread and refuses to be built with an ambiguous order.
fn schedule(label: impl ScheduleLabel) -> Schedule {
    let mut schedule = Schedule::new(label);
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    schedule
}
