use crate::{
    BsdfSample, ConductorBsdf, DielectricBsdf, DiffuseBsdf, LobeClass, LobeValues, PlasticBsdf, PrincipledBsdf,
    Transport,
};
use glam::{Vec2, Vec3};
use radiometry::Rgb;

/// The scattering function of a surface at a point.
///
/// Directions are unit vectors in the local shading frame (z is the shading normal) and point away from the surface.
/// What to do where shading and geometric normal disagree is left to the caller. 96 bytes at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bsdf {
    /// Scatters nothing: the body of a black emitter.
    #[default]
    Black,
    /// A Lambertian surface.
    Diffuse(DiffuseBsdf),
    /// A metal.
    Conductor(ConductorBsdf),
    /// Glass.
    Dielectric(DielectricBsdf),
    /// A matt base under a clear coat.
    Plastic(PlasticBsdf),
    /// The layered model of glTF.
    Principled(PrincipledBsdf),
}

const _: () = assert!(size_of::<Bsdf>() <= 96);

impl Bsdf {
    /// True when a lobe counts as D: photons are stored here, irradiance is cached here.
    #[inline]
    #[must_use]
    pub fn has_diffuse(&self) -> bool {
        match self {
            Self::Black => false,
            Self::Diffuse(_) => true,
            Self::Conductor(b) => b.surface().class() == LobeClass::Diffuse,
            Self::Dielectric(b) => b.surface().class() == LobeClass::Diffuse,
            Self::Plastic(_) => true,
            Self::Principled(b) => b.has_class(LobeClass::Diffuse),
        }
    }

    /// Smallest GGX width of the D lobes; 1 where they are matt alone, and 0 where one of them passes light to the other
    /// side. Tells how far irradiance is from all that a reflection needs to know.
    #[inline]
    #[must_use]
    pub fn sharpest_diffuse(&self) -> f32 {
        let width = |surface: crate::Microsurface| match surface.class() {
            LobeClass::Diffuse => surface.alpha(),
            LobeClass::Specular => 1.0,
        };
        match self {
            Self::Black | Self::Diffuse(_) => 1.0,
            Self::Conductor(b) => width(b.surface()),
            Self::Dielectric(b) if b.surface().class() == LobeClass::Diffuse => 0.0,
            Self::Dielectric(_) => 1.0,
            Self::Plastic(b) => width(b.surface()),
            Self::Principled(b) => b.sharpest_diffuse(),
        }
    }

    /// True when a lobe counts as S.
    #[inline]
    #[must_use]
    pub fn has_specular(&self) -> bool {
        match self {
            Self::Black | Self::Diffuse(_) => false,
            Self::Conductor(b) => b.surface().class() == LobeClass::Specular,
            Self::Dielectric(b) => b.surface().class() == LobeClass::Specular,
            Self::Plastic(b) => b.surface().class() == LobeClass::Specular,
            Self::Principled(b) => b.has_class(LobeClass::Specular),
        }
    }

    /// Tells whether a lobe passes light to the other side.
    #[inline]
    #[must_use]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Black | Self::Diffuse(_) | Self::Conductor(_) | Self::Plastic(_) => false,
            Self::Dielectric(_) => true,
            Self::Principled(b) => b.transmits(),
        }
    }

    /// True when light that passes is in another medium, with an index of refraction and an absorption of its own, and
    /// not behind a pane.
    #[inline]
    #[must_use]
    pub fn has_inside(&self) -> bool {
        match self {
            Self::Black | Self::Diffuse(_) | Self::Conductor(_) | Self::Plastic(_) => false,
            Self::Dielectric(b) => !b.is_thin(),
            Self::Principled(b) => b.has_inside(),
        }
    }

    /// Index of refraction of the inside relative to the outside; `None` where there is no inside.
    #[inline]
    #[must_use]
    pub fn interior_ior(&self) -> Option<f32> {
        match self {
            Self::Dielectric(b) if !b.is_thin() => Some(b.ior),
            Self::Principled(b) if b.has_inside() => Some(b.ior()),
            _ => None,
        }
    }

    /// The same surface between other media.
    ///
    /// - `ior`: index of the inside relative to the outside, > 0. Without effect where there is no inside.
    #[must_use]
    pub fn with_relative_ior(&self, ior: f32) -> Self {
        match self {
            Self::Dielectric(b) if !b.is_thin() => Self::Dielectric(b.with_ior(ior)),
            Self::Principled(b) if b.has_inside() => Self::Principled(b.with_solid_ior(ior)),
            other => *other,
        }
    }

    /// True when a lobe is not delta, so that `eval` can be anything but zero.
    #[inline]
    #[must_use]
    pub fn needs_light_sampling(&self) -> bool {
        match self {
            Self::Black => false,
            Self::Diffuse(_) => true,
            Self::Conductor(b) => !b.surface().is_smooth(),
            Self::Dielectric(b) => !b.surface().is_smooth(),
            Self::Plastic(_) => true,
            Self::Principled(b) => b.needs_light_sampling(),
        }
    }

    /// True when a lobe is delta, so that no light can be connected through it: a mirror, clear glass, a smooth coat.
    #[inline]
    #[must_use]
    pub fn has_delta(&self) -> bool {
        match self {
            Self::Black | Self::Diffuse(_) => false,
            Self::Conductor(b) => b.surface().is_smooth(),
            Self::Dielectric(b) => b.surface().is_smooth(),
            Self::Plastic(b) => b.surface().is_smooth(),
            Self::Principled(b) => b.has_delta(),
        }
    }

    /// Evaluates `f(ω_o, ω_i)·|cosθ_i|` of the non-delta lobes, by class, in sr⁻¹; delta lobes contribute zero.
    ///
    /// Under [`Transport::Flux`] it is the adjoint:
    /// `eval(ω_o, ω_i, Flux)/|cosθ_i| = eval(ω_i, ω_o, Radiance)/|cosθ_o|`.
    #[inline]
    #[must_use]
    pub fn eval(&self, wo: Vec3, wi: Vec3, transport: Transport) -> LobeValues {
        match self {
            Self::Black => LobeValues::default(),
            Self::Diffuse(b) => LobeValues::of_class(LobeClass::Diffuse, b.eval(wo, wi)),
            Self::Conductor(b) => LobeValues::of_class(b.surface().class(), b.eval_and_pdf(wo, wi).0),
            Self::Dielectric(b) => LobeValues::of_class(b.surface().class(), b.eval_and_pdf(wo, wi, transport).0),
            Self::Plastic(b) => b.eval_and_pdf(wo, wi).0,
            Self::Principled(b) => b.eval_and_pdf(wo, wi, transport).0,
        }
    }

    /// Density per solid angle with which [`Bsdf::sample`] returns `wi`; delta lobes contribute zero.
    ///
    /// It integrates to one less the share of delta lobes and of draws that return `None`. It is the same for both
    /// kinds of transport.
    #[inline]
    #[must_use]
    pub fn pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
        match self {
            Self::Black => 0.0,
            Self::Diffuse(b) => b.pdf(wo, wi),
            Self::Conductor(b) => b.eval_and_pdf(wo, wi).1,
            Self::Dielectric(b) => b.eval_and_pdf(wo, wi, transport).1,
            Self::Plastic(b) => b.eval_and_pdf(wo, wi).1,
            Self::Principled(b) => b.eval_and_pdf(wo, wi, transport).1,
        }
    }

    /// [`Bsdf::eval`] and [`Bsdf::pdf`] at the price of one: what multiple importance sampling of a light needs.
    #[inline]
    #[must_use]
    pub fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (LobeValues, f32) {
        let (class, (value, pdf)) = match self {
            Self::Black => return (LobeValues::default(), 0.0),
            Self::Diffuse(b) => (LobeClass::Diffuse, (b.eval(wo, wi), b.pdf(wo, wi))),
            Self::Conductor(b) => (b.surface().class(), b.eval_and_pdf(wo, wi)),
            Self::Dielectric(b) => (b.surface().class(), b.eval_and_pdf(wo, wi, transport)),
            Self::Plastic(b) => return b.eval_and_pdf(wo, wi),
            Self::Principled(b) => return b.eval_and_pdf(wo, wi, transport),
        };
        (LobeValues::of_class(class, value), pdf)
    }

    /// Draws a direction roughly in proportion to `f·|cosθ_i|`.
    ///
    /// - `u_lobe`: in [0, 1), chooses among lobes, and with its low bits among classes.
    /// - `u`: in [0, 1)², chooses within one.
    /// - returns `None` where the path ends: nothing scatters, or the drawn direction lies below the surface.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        match self {
            Self::Black => None,
            Self::Diffuse(b) => b.sample(wo, u),
            Self::Conductor(b) => b.sample(wo, u_lobe, u),
            Self::Dielectric(b) => b.sample(wo, u_lobe, u, transport),
            Self::Plastic(b) => b.sample(wo, u_lobe, u),
            Self::Principled(b) => b.sample(wo, u_lobe, u, transport),
        }
    }

    /// Estimates the directional albedo: the share of light that is scattered at all, for the albedo output layer.
    ///
    /// Exact for diffuse and smooth surfaces; for rough ones the Fresnel term is taken at the macroscopic normal. The
    /// η² of radiance is left out, so clear glass has albedo one.
    #[must_use]
    pub fn albedo(&self, wo: Vec3) -> Rgb {
        match self {
            Self::Black => Rgb::BLACK,
            Self::Diffuse(b) => b.albedo(),
            Self::Conductor(b) => b.albedo(wo),
            Self::Dielectric(b) => b.albedo(wo),
            Self::Plastic(b) => b.albedo(wo),
            Self::Principled(b) => b.albedo(wo),
        }
    }
}
