use crate::schedules::{
    Bounce, BounceSystems, CachePass, CacheSystems, Finish, FinishSystems, Load, LoadSystems, PerturbSystems,
    PhotonPass, PhotonSystems, Prepare, PrepareSystems, RenderPass, RenderSystems,
};
use bevy_app::App;
use bevy_ecs::schedule::{InternedSystemSet, ScheduleLabel, Schedules, SystemSet};
use std::fmt::Debug;

/// One schedule with its sets in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScheduleDescription {
    /// Name of the schedule's label.
    pub name: String,
    /// Its sets, in the order they run; systems outside any of them stand last, under an empty name.
    pub sets: Vec<SetDescription>,
}

/// One set with its systems in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetDescription {
    /// Name of the set's variant.
    pub name: String,
    /// Full paths of its systems, in the order they run.
    pub systems: Vec<String>,
}

/// Lists schedules, sets and systems in the order they run.
///
/// # Errors
/// A schedule that cannot be built, with bevy's reason: an ambiguity names both systems.
pub fn describe_schedules(app: &mut App) -> Result<Vec<ScheduleDescription>, String> {
    use BounceSystems as B;
    use PerturbSystems as P;
    use RenderSystems as R;
    Ok(vec![
        describe(
            app,
            Load,
            &sets(&[LoadSystems::Compose, LoadSystems::Spawn, LoadSystems::ImportAssets]),
        )?,
        describe(
            app,
            Prepare,
            &sets(&[
                PrepareSystems::OpenShutter,
                PrepareSystems::ResolveTransforms,
                PrepareSystems::BuildAcceleration,
                PrepareSystems::BuildTables,
                PrepareSystems::PrepareStages,
            ]),
        )?,
        describe(
            app,
            PhotonPass,
            &sets(&[
                PhotonSystems::EmitPhotons,
                PhotonSystems::TracePhotons,
                PhotonSystems::StorePhotons,
                PhotonSystems::RevisePhotons,
                PhotonSystems::BuildPhotonMaps,
                PhotonSystems::DeriveFromMaps,
            ]),
        )?,
        describe(
            app,
            CachePass,
            &sets(&[
                CacheSystems::GenerateRays,
                CacheSystems::Intersect,
                CacheSystems::LookUp,
                CacheSystems::Sample,
                CacheSystems::Insert,
                CacheSystems::Maintain,
            ]),
        )?,
        describe(
            app,
            RenderPass,
            &[
                sets(&[R::GenerateRays]),
                sets(&[P::PerturbFilm, P::PerturbTime, P::PerturbLens]),
                sets(&[R::TracePaths, R::Accumulate, R::EndPass]),
            ]
            .concat(),
        )?,
        describe(app, Bounce, &sets(&[B::Intersect, B::LookUp, B::Shade, B::Scatter]))?,
        describe(app, Finish, &sets(&[FinishSystems::Resolve, FinishSystems::Write]))?,
    ])
}

type NamedSet = (String, InternedSystemSet);

fn sets<S: SystemSet + Debug + Clone>(sets: &[S]) -> Vec<NamedSet> {
    sets.iter().map(|set| (format!("{set:?}"), set.intern())).collect()
}

fn describe(
    app: &mut App,
    label: impl ScheduleLabel + Clone,
    sets: &[NamedSet],
) -> Result<ScheduleDescription, String> {
    let name = format!("{label:?}");
    let world = app.world_mut();
    let Some(mut schedule) = world.resource_mut::<Schedules>().remove(label) else {
        return Ok(ScheduleDescription { name, sets: Vec::new() });
    };
    let built = schedule.initialize(world).map_err(|error| {
        let reason = error.to_string(schedule.graph(), world);
        format!("schedule {name} cannot be built: {reason}")
    });
    let order: Vec<_> = schedule
        .systems()
        .map(|systems| systems.map(|(key, system)| (key, system.name().to_string())).collect())
        .unwrap_or_default();
    let mut described = Vec::new();
    let mut seen = Vec::new();
    for (set_name, set) in sets {
        let members = schedule.graph().systems_in_set(*set).ok();
        let in_set: Vec<_> = order
            .iter()
            .filter(|(key, _)| members.is_some_and(|m| m.contains(key)))
            .collect();
        seen.extend(in_set.iter().map(|(key, _)| *key));
        described.push(SetDescription {
            name: set_name.clone(),
            systems: in_set.into_iter().map(|(_, name)| name.clone()).collect(),
        });
    }
    let outside: Vec<String> = order
        .iter()
        .filter(|(key, _)| !seen.contains(key))
        .map(|(_, name)| name.clone())
        .collect();
    if !outside.is_empty() {
        described.push(SetDescription {
            name: String::new(),
            systems: outside,
        });
    }
    world.resource_mut::<Schedules>().insert(schedule);
    built?;
    Ok(ScheduleDescription { name, sets: described })
}
