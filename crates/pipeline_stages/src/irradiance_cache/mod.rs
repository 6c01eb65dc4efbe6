//! Irradiance cache: indirect light computed well at few places, and interpolated between them.
//!
//! Scene: `"/Render": Def(LightTransport: (indirect: IrradianceCache), IrradianceCache: (rays: 1000))`
//! Sets: `PrepareStages` (`plan_cache`), `DeriveFromMaps` (`renew_records`), all of `CachePass` (`generate_rays`,
//! `find_sites`, `choose_sites`, `sample_records`, `insert_records`, `maintain_octree`), `LookUp` (`look_up_irradiance`).
//! Reads the transport scene, the settings, the camera, and photon maps where `incoming` says so. Writes entities with
//! [`IrradianceRecord`](pipeline_data::IrradianceRecord), the cache over them, and contributions.
//! Counters: `irradiance_cache/records`, `irradiance_cache/rays`, `irradiance_cache/lookups`, of these
//! `irradiance_cache/missing` where no record held, and `irradiance_cache/unsuited`.
//!
//! Before the first wave the cache is filled, coarse to fine over the image: camera rays 32 pixels apart, then 16, and so on
//! to one, are followed along S lobes to where the eye asks for indirect light. Where nothing in the cache tells, a record is
//! made. All places of a round are judged by the same cache, thinned in a fixed order so that neighbours do not compute the
//! same, sampled in parallel, and inserted in a fixed order. After that the cache is only read. A record's random numbers depend
//! on its number alone, so the image is the same whatever the threads.
//!
//! Rays of records go on as paths, but where they end they read those records that there are already, a sparse and wide subset
//! of them: light of many reflections then has the noise of their mean, not that of a single path.
//!
//! What the cache is not asked, and what no record tells of, is traced: glossy D lobes, normal maps, things that move,
//! and places that only a lens or a moment shows. The cache is filled through a pinhole, at random moments.
//!
//! Limits: light that changes faster than records follow is blurred, as shadows of indirect light at contacts. `max_depth` is
//! counted from the record. The records of a crop are not those of the whole picture.
//! Source: see [`transport::IrradianceCache`].

mod fill;
mod insert;
mod look_up;
mod plan;
mod sample;
mod sites;
#[cfg(test)]
mod tests;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use fill::CacheFill;
use pipeline_core::{
    Bounce, BounceSystems, CachePass, CacheSystems, PhotonPass, PhotonSystems, Prepare, PrepareSystems,
};
use pipeline_data::{Contributions, PhotonDemand};
use plan::CachePlan;
use scene_format::Range;

pub use look_up::IrradianceContribution;

/// Settings of the irradiance cache, on the prim that carries `Render`; used when `LightTransport.indirect` is
/// `IrradianceCache`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct IrradianceCache {
    /// Rays over the hemisphere of each record. Four times as many halve the blotches and take four times as long.
    #[reflect(@Range::closed(16.0, 65_536.0))]
    pub rays: u32,
    /// A record is made where none has more weight than this, which is within 1/`min_weight` of its range. Higher makes more
    /// records and follows light better.
    #[reflect(@Range::closed(2.0, 1000.0))]
    pub min_weight: f32,
    /// Records of an octree cell before it is cut into eight. Changes the time of a lookup, not the picture.
    #[reflect(@Range::closed(1.0, 1024.0))]
    pub cell_records: u32,
    /// Extrapolate records by the gradients of their light, and weigh them smoothly. Off: as irradiance caching was at first,
    /// to compare.
    pub gradients: bool,
    /// Ask whether a record can be seen from where it is used, and lies in the same plane. Off: records are used through walls and
    /// around corners; shows what the test is for.
    pub validity: bool,
    /// Least radius within which a record holds, in pixels. Higher makes fewer records in corners, and blurs them.
    #[reflect(@Range::closed(0.1, 100.0))]
    pub min_spacing: f32,
    /// Largest radius within which a record holds, in pixels.
    #[reflect(@Range::closed(1.0, 10_000.0))]
    pub max_spacing: f32,
    /// Where the light at the ends of rays comes from.
    pub incoming: IncomingLight,
}

impl Default for IrradianceCache {
    fn default() -> Self {
        Self {
            rays: 1000,
            min_weight: 10.0,
            cell_records: 8,
            gradients: true,
            validity: true,
            min_spacing: 1.5,
            max_spacing: 40.0,
            incoming: IncomingLight::default(),
        }
    }
}

/// Where the light at the ends of the rays of a record comes from.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum IncomingLight {
    /// Paths with light sampling, which read the records that there are already for light of further reflections.
    #[default]
    PathTrace,
    /// The photon maps, as in final gathering.
    PhotonGather,
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct IrradianceCacheSystems;

/// Adds the irradiance cache.
pub struct IrradianceCachePlugin;

impl Plugin for IrradianceCachePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<IrradianceCache>().init_resource::<PhotonDemand>();
        Contributions::register::<IrradianceContribution>(app);
        app.add_systems(
            Prepare,
            plan::plan_cache
                .in_set(PrepareSystems::PrepareStages)
                .in_set(IrradianceCacheSystems),
        )
        .add_systems(
            PhotonPass,
            plan::renew_records
                .in_set(PhotonSystems::DeriveFromMaps)
                .in_set(IrradianceCacheSystems)
                .run_if(plan::has_new_photons),
        )
        .add_systems(
            CachePass,
            (
                fill::generate_rays.in_set(CacheSystems::GenerateRays),
                sites::find_sites.in_set(CacheSystems::Intersect),
                sites::choose_sites.in_set(CacheSystems::LookUp),
                sample::sample_records.in_set(CacheSystems::Sample),
                insert::insert_records.in_set(CacheSystems::Insert),
                insert::maintain_octree.in_set(CacheSystems::Maintain),
            )
                .in_set(IrradianceCacheSystems)
                .run_if(resource_exists::<CacheFill>),
        )
        .add_systems(
            Bounce,
            look_up::look_up_irradiance
                .in_set(BounceSystems::LookUp)
                .in_set(IrradianceCacheSystems)
                .run_if(resource_exists::<CachePlan>),
        );
    }
}
