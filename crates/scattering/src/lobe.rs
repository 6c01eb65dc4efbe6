use glam::Vec3;
use radiometry::{Rgb, math};
use std::ops::{Add, Mul};

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
    /// `f·|cosθ_i|/pdf`, of all lobes of the class together, over the probability of crediting the direction to the
    /// class; for a delta lobe its factor over the probability of choosing it.
    pub weight: Rgb,
    /// Density of `wi` per solid angle, over all non-delta lobes of both classes; `f32::INFINITY` for a delta lobe.
    pub pdf: f32,
    /// Class that the direction is credited to. Where lobes of both classes overlap it is drawn in proportion to what
    /// they carry, so the mean of the weights of one class is what its lobes reflect, whichever lobe was sampled.
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

impl BsdfSample {
    /// A number in [0, 1) from the low bits of `u_lobe`, which choosing among lobes has not used up.
    #[inline]
    pub(crate) fn class_number(u_lobe: f32) -> f32 {
        math::fract(u_lobe * 1024.0)
    }

    /// A direction on which lobes of both classes may overlap; `None` when nothing could have drawn it or it carries
    /// nothing.
    ///
    /// - `u_class`: in [0, 1), chooses the class.
    #[inline]
    pub(crate) fn from_lobes(wi: Vec3, values: LobeValues, pdf: f32, u_class: f32) -> Option<Self> {
        let (specular, diffuse) = (values.specular.mean(), values.diffuse.mean());
        let total = specular + diffuse;
        if total <= 0.0 {
            return None;
        }
        if diffuse <= 0.0 || u_class * total < specular {
            Self::from_value(wi, values.specular * (total / specular), pdf, LobeClass::Specular)
        } else {
            Self::from_value(wi, values.diffuse * (total / diffuse), pdf, LobeClass::Diffuse)
        }
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

impl Add for LobeValues {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            specular: self.specular + other.specular,
            diffuse: self.diffuse + other.diffuse,
        }
    }
}

impl Mul<f32> for LobeValues {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self {
            specular: self.specular * factor,
            diffuse: self.diffuse * factor,
        }
    }
}
