use crate::{BsdfSample, LobeClass};
use glam::{Vec2, Vec3};
use radiometry::{Rgb, warp};
use std::f32::consts::FRAC_1_PI;

/// A Lambertian surface, seen from either side: f = albedo/π for directions on the side of `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseBsdf {
    albedo: Rgb,
}

impl DiffuseBsdf {
    /// Builds the surface from its reflectance, each channel in [0, 1].
    #[inline]
    #[must_use]
    pub const fn new(albedo: Rgb) -> Self {
        Self { albedo }
    }

    /// Fraction of light that is reflected, the same for every direction.
    #[inline]
    #[must_use]
    pub const fn albedo(&self) -> Rgb {
        self.albedo
    }

    /// `f·|cosθ_i|`.
    #[inline]
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.albedo * self.pdf(wo, wi)
    }

    /// `|cosθ_i|/π` on the side of `wo`.
    #[inline]
    pub(crate) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z * wi.z > 0.0 { wi.z.abs() * FRAC_1_PI } else { 0.0 }
    }

    #[inline]
    pub(crate) fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        let mut wi = warp::sample_cosine_hemisphere(u);
        let pdf = wi.z * FRAC_1_PI;
        if pdf <= 0.0 || wo.z == 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        Some(BsdfSample {
            wi,
            weight: self.albedo,
            pdf,
            class: LobeClass::Diffuse,
            transmitted: false,
            eta_sq_scale: 1.0,
        })
    }
}
