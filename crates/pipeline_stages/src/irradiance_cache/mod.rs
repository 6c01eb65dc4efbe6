//! Irradiance cache: indirect light computed well at few places, and interpolated between them.
//!
//! Scene: `"/Render": Def(LightTransport: (indirect: IrradianceCache), IrradianceCache: (rays: 1000))`
//! Sets: `PrepareStages` (`plan_cache`, `reload_records`), `DeriveFromMaps` (`renew_records`), all of `CachePass`
//! (`generate_rays`, `find_sites`, `choose_sites`, `sample_records`, `insert_records`, `maintain_octree`), `LookUp`
//! (`look_up_irradiance`). Reads the transport scene, the settings, the camera, and photon maps where `incoming` says so.
//! Writes entities with [`IrradianceRecord`](pipeline_data::IrradianceRecord), the cache over them, their keys, which
//! records of another view they began with, whether photons are wanted, contributions, and the film layer `record_density`: records of each square metre around what is seen first, m⁻²
//! ([`RecordDensity`]). Counters: `irradiance_cache/records` that were made, `irradiance_cache/reused` from a file,
//! `irradiance_cache/rays`, `irradiance_cache/lookups`, of these `irradiance_cache/missing` where no record held, and
//! `irradiance_cache/unsuited`.
//!
//! Before the first wave the cache is filled, coarse to fine over the image: camera rays 32 pixels apart, then 16, and so on
//! to one, are followed along S lobes to where the eye asks for indirect light. Where nothing in the cache tells, a record is
//! made. All places of a round are judged by the same cache, thinned in a fixed order so that neighbours do not compute the
//! same, sampled in parallel, and inserted in a fixed order. After that the cache is only read. A record's random numbers depend
//! on its place in that order alone, so the image is the same whatever the threads.
//!
//! Rays of records do not go on as paths: where they end they read deeper records, sparse and wide, for the light of further
//! reflections, which then has the noise of their mean, not that of a single path. Deep records lie where rays of those
//! that the eye reads end, behind the camera as well, and are made first: the deepest of paths to the end, those of the next
//! depth by reading them. The eye reads none of them.
//!
//! Records can be kept in a file (`pipeline records`, `run --records`). Two keys say what they are worth elsewhere: one of their
//! light, which must agree, and one of the view. For the same view none is missing, and the image has the same bits; for another
//! they are inserted first, and the filling adds what it lacks. Spacings count in pixels of the view that a record was made for,
//! and photons that it read were aimed at what that view sees.
//!
//! What the cache is not asked, and what no record tells of, is traced: glossy D lobes, normal maps, things that move,
//! and places that only a lens or a moment shows. The cache is filled through a pinhole, at random moments.
//!
//! Limits: light that changes faster than records follow is blurred, as shadows of indirect light at contacts. `max_depth`
//! does not count mirrors on the way to a record. Records that read progressive photon maps are new in every pass and cannot
//! be kept. The records of a crop are not those of the whole picture. Source: see [`transport::IrradianceCache`].

mod density;
mod fill;
mod insert;
mod look_up;
mod plan;
mod reload;
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
use pipeline_data::{Contributions, DebugLayers, PhotonDemand};
use plan::CachePlan;
use scene_format::Range;

pub use density::RecordDensity;
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
    /// with the harmonic mean for its metric, to compare.
    pub gradients: bool,
    /// Ask whether a record can be seen from where it is used, and lies in the same plane. Off: records are used through
    /// walls and around corners; shows what the test is for.
    pub validity: bool,
    /// Least radius within which a record holds, in pixels. Higher makes fewer records in corners, and blurs them.
    #[reflect(@Range::closed(0.1, 100.0))]
    pub min_spacing: f32,
    /// Largest radius within which a record holds, in pixels.
    #[reflect(@Range::closed(1.0, 10_000.0))]
    pub max_spacing: f32,
    /// Where the light at the ends of rays comes from.
    pub incoming: IncomingLight,
    /// How far from its place a record holds.
    pub metric: ErrorMetric,
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
            metric: ErrorMetric::default(),
        }
    }
}

/// How the distance is found within which a record holds.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum ErrorMetric {
    /// By how fast the gradient of the light changes over the surface, in the light of what is seen of it.
    #[default]
    OcclusionHessian,
    /// By the harmonic mean of the distances of what is around.
    HarmonicMean,
}

impl From<ErrorMetric> for transport::ErrorMetric {
    fn from(metric: ErrorMetric) -> Self {
        match metric {
            ErrorMetric::OcclusionHessian => Self::OcclusionHessian,
            ErrorMetric::HarmonicMean => Self::HarmonicMean,
        }
    }
}

/// Where the light at the ends of the rays of a record comes from.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum IncomingLight {
    /// Paths with light sampling, which read deeper records for light of further reflections.
    #[default]
    PathTrace,
    /// The photon maps, as in final gathering.
    PhotonGather,
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct IrradianceCacheSystems;

/// Where records are taken from a file, once it is known which photons they read. Between this and
/// [`IrradianceCacheSystems`], whoever makes photons prepares.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct RecordFileSystems;

/// Adds the irradiance cache.
pub struct IrradianceCachePlugin;

impl Plugin for IrradianceCachePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<IrradianceCache>().init_resource::<PhotonDemand>();
        Contributions::register::<IrradianceContribution>(app);
        DebugLayers::register::<RecordDensity>(app);
        app.add_systems(
            Prepare,
            plan::plan_cache
                .in_set(PrepareSystems::PrepareStages)
                .in_set(IrradianceCacheSystems),
        )
        .add_systems(
            Prepare,
            reload::reload_records
                .in_set(PrepareSystems::PrepareStages)
                .in_set(RecordFileSystems),
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
