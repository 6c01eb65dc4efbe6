//! Surface scattering: how light leaves a point that it reached, as `eval`, `sample` and `pdf`.
//!
//! Slices and values only: nothing here knows of scenes, rays or entities. A [`Bsdf`] is a small `Copy` value that the
//! caller builds at a hit from material parameters and uses in the local frame, where z is the shading normal and both
//! directions point away from the surface.
//!
//! Four decisions shape the crate:
//!
//! - **Every lobe is S or D**, by [`lobe_class`] alone, and says so in what it evaluates ([`LobeValues`]) and samples
//!   ([`BsdfSample::class`]). Photon maps, caches and path tracing split light by it, so they can't disagree.
//! - **`eval` and `pdf` are one formula.** A weight is their ratio; what light sampling combines by multiple importance
//!   is the density that really was drawn from. Chi-square tests hold every sampler to it.
//! - **Both directions of transport agree.** Multiple scattering between microfacets is added in reciprocal form, and
//!   [`Transport`] says who pays the η² of refraction, so photons and eye paths converge to the same image.
//! - **No energy is lost.** White metal (of GGX) and plastic, clear glass and their mixtures under a coat return a
//!   uniform field unchanged, rough or smooth.
//!
//! It deliberately has no spectra (metals are integrated to RGB, see [`Metal`]; dispersion draws a wavelength for RGB
//! light, see [`SampledWavelength`]), no polarisation, no textures, and no correction for shading normals, which needs the
//! geometric normal and is the caller's.
//!
//! ```
//! use glam::{Vec2, Vec3};
//! use scattering::{Bsdf, ConductorBsdf, Metal, Microsurface, Transport};
//!
//! let gold = Metal::from_name("gold").expect("a listed metal");
//! let bsdf = Bsdf::Conductor(ConductorBsdf::new(gold.into(), Microsurface::from_roughness(0.4, 0.05)));
//! let wo = Vec3::new(0.6, 0.0, 0.8);
//! let sample = bsdf.sample(wo, 0.5, Vec2::new(0.1, 0.3), Transport::Radiance).expect("a direction above");
//! let value = bsdf.eval(wo, sample.wi, Transport::Radiance).total();
//! assert!((sample.weight.r - value.r / sample.pdf).abs() < 1e-5);
//! assert!(bsdf.has_diffuse() && sample.weight.r > sample.weight.b);
//! ```

mod beckmann;
mod bsdf;
mod coated_metal;
mod conductor;
mod dielectric;
mod diffuse;
mod dispersion;
mod energy;
mod fresnel;
mod ggx;
mod interior;
mod lobe;
mod loss_table;
mod metals;
mod microsurface;
mod normals;
mod plastic;
mod principled;
mod reflectance;
mod rough_dielectric;
mod sheen;
#[cfg(test)]
mod tests;

pub use bsdf::Bsdf;
pub use conductor::{ConductorBsdf, ConductorFresnel};
pub use dielectric::{DielectricBsdf, SMOOTH_SPREAD};
pub use diffuse::DiffuseBsdf;
pub use dispersion::{Dispersion, SampledWavelength};
pub use fresnel::{
    average_fresnel_conductor, average_fresnel_dielectric, fresnel_conductor, fresnel_dielectric, schlick,
};
pub use interior::{Crossing, Interior, InteriorList};
pub use lobe::{BsdfSample, LobeClass, LobeValues, Transport};
pub use metals::Metal;
pub use microsurface::{Microsurface, SMOOTH_ALPHA, lobe_class};
pub use normals::NormalDistribution;
pub use plastic::PlasticBsdf;
pub use principled::{PrincipledBsdf, PrincipledParameters};
