//! Light transport on plain data: light tables and emission, photon and path steps, density estimates.
//!
//! This crate is where the physics of the renderer stands. It knows no entities and no schedules: a step takes a path and
//! the [`Scene`] and says what it contributes and where it goes on. The stages call these functions from their systems;
//! a fused loop can call the same functions one after the other for one path and gets the same bits.
//!
//! - [`PathClass`] and [`Methods`] decide, for every path, which layer it belongs to and which estimator may count it:
//!   exactly one does.
//! - [`LightTable`] chooses lights by what they may send to a point, and samples each by solid angle or area.
//! - [`PathMedium`] knows what a path travels in: nested and overlapping media, and its wavelength after dispersion.
//! - [`Material`] is what a surface is made of, and [`SurfaceInputs`] what of it changes from point to point.
//! - [`arrive`], [`emitted_light`], [`sample_direct_light`] and [`scatter`] are one bounce of a path from the eye.
//! - [`EmissionSampler`] and [`trace_photon`] are the life of a photon; [`PhotonMap`] estimates radiance from where
//!   photons landed, [`PhotonMaps`] holds one of each [`MapKind`].
//! - [`PatchField`] and [`FormFactors`] are radiosity: what matt surfaces exchange, solved for patches.
//! - [`gather_indirect`] asks photon maps or patches what gather rays see.
//! - [`IrradianceCache`] interpolates indirect light between records of what a [`Hemisphere`] of rays saw.
//!
//! It deliberately has no volumes yet, and it never decides anything by thread or time.
//!
//! ```
//! use transport::{Event, Layer, Methods, PathClass};
//! let on_wall = PathClass::EYE.after(Event::Diffuse);
//! let through_glass = on_wall.after(Event::Specular).after(Event::Specular);
//! assert_eq!(through_glass.layer(), Layer::Caustic);
//! assert!(Methods::TRACED.counts_traced_light(through_glass));
//! ```

mod camera;
mod density;
mod emission;
mod frame;
mod gather;
mod guide;
mod irradiance;
mod light;
mod medium;
mod path;
mod path_class;
mod photon;
mod photon_maps;
mod projection;
mod radiosity;
mod reflectance;
mod scene;
mod textures;
mod thinning;
mod vertex;
mod visible;
mod wall;

pub use camera::Camera;
pub use density::{
    DensityFilter, DensityScratch, DensitySettings, Estimate, PhotonColumns, PhotonMap, PhotonSurface,
    progressive_shrink,
};
pub use emission::{EmissionSampler, EmittedPhoton};
pub use frame::MovingFrame;
pub use gather::{GatherMethods, GatherScratch, Incoming, gather_indirect};
pub use guide::Guide;
pub use irradiance::{
    CacheAnswer, CacheSettings, ErrorMetric, Hemisphere, HemisphereSample, Interpolated, IrradianceCache,
    IrradianceRecord, RecordRays, RgbGradient, Site, Spacing, find_deep_sites, find_sites, reflect_irradiance,
    summarize,
};
pub use light::{Environment, EnvironmentMap, LightSample, LightSource, LightTable, SpotCone};
pub use medium::PathMedium;
pub use path::{Path, arrive, emitted_light, sample_direct_light, sample_direct_light_at, scatter, scatter_at};
pub use path_class::{CausticMethod, DirectMethod, Event, IndirectMethod, Layer, Methods, PathClass};
pub use photon::{Deposit, MapKind, MapKinds, PHOTON_STAGE, trace_photon};
pub use photon_maps::{IrradianceMap, PhotonMaps, PhotonMapsScratch};
pub use projection::{MAX_TARGETS, TargetSphere, cluster_targets};
pub use radiosity::{
    ExchangeError, ExchangeSettings, FormFactors, Patch, PatchField, PatchIrradiance, PatchRow, PatchScratch,
    PlaceError, PlaceSettings, Solution, cast_row, find_direct, find_form_factors,
};
pub use scene::{Material, Scene};
pub use textures::{Coverage, Input, NormalMap, PrincipledInputs, SurfaceInputs, TexturedBsdf, TexturedSurface};
pub use thinning::{PhotonRows, thin_photons};
pub use vertex::Vertex;
pub use visible::{landing_share, visible_targets};
pub use wall::Walls;
