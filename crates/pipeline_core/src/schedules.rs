use bevy_ecs::schedule::{ScheduleLabel, SystemSet};

/// Runs once a scene: file to entities. May fail.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Load;

/// Runs when geometry, materials or lights changed: entities to tables. May fail; nothing after it does but writing.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Prepare;

/// Runs until no stage wants more photons (see [`RenderClock::photons_pending`](crate::RenderClock)); each run emits one
/// fixed batch.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct PhotonPass;

/// Runs after the photons of a pass until no stage wants more records (see
/// [`RenderClock::records_pending`](crate::RenderClock)): coarse to fine over the image, a bounded piece of work each time.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct CachePass;

/// Runs once for every wave of camera paths.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct RenderPass;

/// Runs once for every bounce of a wave, while a path lives. Serves any batch of paths.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Bounce;

/// Runs at the end, or on interruption: film to files. May fail.
#[derive(ScheduleLabel, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Finish;

/// The order inside [`Load`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum LoadSystems {
    /// After it, the composed scene is a resource.
    Compose,
    /// After it, every rendered prim is an entity with its components.
    Spawn,
    /// After it, every file that a component names is in memory.
    ImportAssets,
}

/// The order inside [`Prepare`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum PrepareSystems {
    /// After it, the interval of time that the picture covers is known.
    OpenShutter,
    /// After it, every prim has its place in the world.
    ResolveTransforms,
    /// After it, rays can be traced.
    BuildAcceleration,
    /// After it, lights and materials can be looked up by row.
    BuildTables,
    /// After it, whatever else a stage derives from the tables (radii, film, camera) stands.
    PrepareStages,
}

/// The order inside [`PhotonPass`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum PhotonSystems {
    /// After it, a batch of photons has left the lights.
    EmitPhotons,
    /// After it, each photon of the batch has run its course and its deposits are listed.
    TracePhotons,
    /// After it, stored photons are entities.
    StorePhotons,
    /// After it, whatever stages change about stored photons is done: they are as the maps will have them.
    RevisePhotons,
    /// After it, photon maps can be queried.
    BuildPhotonMaps,
    /// After it, whatever stages compute from photon maps beforehand stands.
    DeriveFromMaps,
}

/// The order inside [`CachePass`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum CacheSystems {
    /// After it, camera rays lead to where the cache may be asked.
    GenerateRays,
    /// After it, the places are known where they ask.
    Intersect,
    /// After it, those places are chosen that nothing in the cache tells of.
    LookUp,
    /// After it, what is to be kept of these places is computed.
    Sample,
    /// After it, it is entities.
    Insert,
    /// After it, the cache can be asked for it.
    Maintain,
}

/// The order inside [`RenderPass`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum RenderSystems {
    /// After it, every path of the wave has a camera ray through its pixel.
    GenerateRays,
    /// After it, lens, shutter and film have moved the rays; see [`PerturbSystems`].
    PerturbRays,
    /// After it, no path of the wave lives: it runs [`Bounce`].
    TracePaths,
    /// After it, the contributions of the wave are on the film.
    Accumulate,
    /// After it, whatever changes from pass to pass has been asked for; runs after every wave.
    EndPass,
}

/// The chain inside [`RenderSystems::PerturbRays`], so that plug-ins can share it.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum PerturbSystems {
    /// After it, rays go through their place on the film.
    PerturbFilm,
    /// After it, rays have their time in the shutter interval.
    PerturbTime,
    /// After it, rays start on the lens.
    PerturbLens,
}

/// The order inside [`Bounce`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum BounceSystems {
    /// After it, every ray has its hit.
    Intersect,
    /// After it, photon maps and caches have contributed at the hits.
    LookUp,
    /// After it, emission and direct light have contributed at the hits.
    Shade,
    /// After it, paths go on in a new direction, or are gone.
    Scatter,
}

/// The order inside [`Finish`].
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum FinishSystems {
    /// After it, the image stands in memory.
    Resolve,
    /// After it, the files are written.
    Write,
}
