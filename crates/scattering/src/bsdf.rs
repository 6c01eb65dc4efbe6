use crate::{ConductorBsdf, DielectricBsdf, DiffuseBsdf};
use glam::{Vec2, Vec3};
use radiometry::Rgb;

/// What is carried along a path: it decides whether refraction scales by η².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, on paths from the eye: `wo` points towards the eye, light comes from `wi`.
    Radiance,
    /// Flux, on paths from a light: `wo` points back to where the photon came from, it goes on along `wi`.
    Flux,
}

impl Transport {
    /// Factor of a refraction with `η = n_t/n_i` as seen from `wo`: 1/η² for radiance, 1 for flux.
    #[inline]
    #[must_use]
    pub fn refraction_scale(self, eta: f32) -> f32 {
        match self {
            Self::Radiance => 1.0 / (eta * eta),
            Self::Flux => 1.0,
        }
    }
}

/// Class of a lobe in the classification of paths, decided by [`lobe_class`](crate::lobe_class).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LobeClass {
    /// S: delta, or narrow enough to be followed like a mirror.
    Specular,
    /// D: the rest; photons are stored on it.
    Diffuse,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit length, local frame, pointing away from the surface.
    pub wi: Vec3,
    /// `f·|cosθ_i|/pdf`, of all lobes together; for a delta lobe its factor over the probability of choosing it.
    pub weight: Rgb,
    /// Density of `wi` per solid angle, over all non-delta lobes; `f32::INFINITY` for a delta lobe.
    pub pdf: f32,
    /// Class of the lobe that the direction was drawn from.
    pub class: LobeClass,
    /// True when `wi` lies on the other side of the surface than `wo`.
    pub transmitted: bool,
    /// The factor that refraction put into `weight`, 1 where it put none. Russian roulette divides it out, since it
    /// says nothing of how much light will be left once the path leaves the medium again.
    pub eta_sq_scale: f32,
}

impl BsdfSample {
    /// True when the direction came from a delta lobe, which light sampling can't find.
    #[inline]
    #[must_use]
    pub fn is_delta(&self) -> bool {
        self.pdf == f32::INFINITY
    }

    /// The mirror direction of `wo`.
    #[inline]
    pub(crate) fn delta_reflection(wo: Vec3, weight: Rgb) -> Self {
        Self {
            wi: Vec3::new(-wo.x, -wo.y, wo.z),
            weight,
            pdf: f32::INFINITY,
            class: LobeClass::Specular,
            transmitted: false,
            eta_sq_scale: 1.0,
        }
    }

    /// A reflected direction with `f·|cosθ_i| = value`; `None` when nothing could have drawn it.
    #[inline]
    pub(crate) fn from_value(wi: Vec3, value: Rgb, pdf: f32, class: LobeClass) -> Option<Self> {
        (pdf > 0.0 && pdf.is_finite()).then(|| Self {
            wi,
            weight: value * (1.0 / pdf),
            pdf,
            class,
            transmitted: false,
            eta_sq_scale: 1.0,
        })
    }
}

/// `f·|cosθ_i|` of the non-delta lobes, by class.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeValues {
    /// Of the S lobes.
    pub specular: Rgb,
    /// Of the D lobes.
    pub diffuse: Rgb,
}

impl LobeValues {
    /// Puts a value under its class.
    #[inline]
    #[must_use]
    pub fn of_class(class: LobeClass, value: Rgb) -> Self {
        match class {
            LobeClass::Specular => Self {
                specular: value,
                diffuse: Rgb::BLACK,
            },
            LobeClass::Diffuse => Self {
                specular: Rgb::BLACK,
                diffuse: value,
            },
        }
    }

    /// Both classes together.
    #[inline]
    #[must_use]
    pub fn total(self) -> Rgb {
        self.specular + self.diffuse
    }
}

/// The scattering function of a surface at a point.
///
/// Directions are unit vectors in the local shading frame (z is the shading normal) and point away from the surface.
/// What to do where shading and geometric normal disagree is left to the caller. 64 bytes at most.
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
}

const _: () = assert!(size_of::<Bsdf>() <= 64);

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
        }
    }

    /// Tells whether a lobe passes light to the other side.
    #[inline]
    #[must_use]
    pub fn transmits(&self) -> bool {
        matches!(self, Self::Dielectric(_))
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
        };
        (LobeValues::of_class(class, value), pdf)
    }

    /// Draws a direction roughly in proportion to `f·|cosθ_i|`.
    ///
    /// - `u_lobe`: in [0, 1), chooses among lobes.
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
        }
    }
}
