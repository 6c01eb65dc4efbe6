use glam::{Vec2, Vec3};
use radiometry::math;
use std::f32::consts::{FRAC_1_PI, TAU};

/// The isotropic GGX distribution of microfacet normals, with Smith's masking.
///
/// Every method wants `wo.z > 0`. Masking is kept in the form S(ω) = √(α² + (1 − α²) cos²θ), for which
/// G₁(ω) = 2 cosθ/(cosθ + S(ω)): nothing divides by a cosine, so grazing directions stay finite.
///
/// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz, "Understanding
/// the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    alpha: f32,
    alpha_sq: f32,
}

impl Ggx {
    #[inline]
    pub(crate) fn new(alpha: f32) -> Self {
        Self {
            alpha,
            alpha_sq: alpha * alpha,
        }
    }

    /// Density of normals: `D(h) = 1/(π α² ((h_x² + h_y²)/α² + h_z²)²)`, normalised as `∫ D(h) h_z dh = 1`.
    ///
    /// Built on the tangential components, which keep their precision where `1 − h_z²` has none.
    #[inline]
    pub(crate) fn density(self, h: Vec3) -> f32 {
        let t = (h.x * h.x + h.y * h.y) / self.alpha_sq + h.z * h.z;
        FRAC_1_PI / (self.alpha_sq * t * t)
    }

    /// S(ω) = √(α² + (1 − α²) cos²θ).
    #[inline]
    pub(crate) fn spread(self, cos_theta: f32) -> f32 {
        (self.alpha_sq + (1.0 - self.alpha_sq) * cos_theta * cos_theta).sqrt()
    }

    /// Masking of one direction: G₁ = 2 cosθ/(cosθ + S).
    #[inline]
    pub(crate) fn masking(self, cos_theta: f32) -> f32 {
        2.0 * cos_theta / (cos_theta + self.spread(cos_theta))
    }

    /// `G₁(ω_o)/cosθ_o`, which stays finite at grazing angles.
    #[inline]
    pub(crate) fn masking_over_cos(self, cos_o: f32) -> f32 {
        2.0 / (cos_o + self.spread(cos_o))
    }

    /// `G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i)` of two directions on one side, height-correlated:
    /// `1/(2 (cosθ_o S(ω_i) + cosθ_i S(ω_o)))`.
    #[inline]
    pub(crate) fn visibility(self, cos_o: f32, cos_i: f32) -> f32 {
        0.5 / (cos_o * self.spread(cos_i) + cos_i * self.spread(cos_o))
    }

    /// Samples a normal among those visible from `wo`; density `G₁(ω_o) (ω_o·h) D(h)/cosθ_o` per solid angle.
    ///
    /// Source: Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
    #[inline]
    pub(crate) fn sample_visible_normal(self, wo: Vec3, u: Vec2) -> Vec3 {
        let (sin, cos) = math::sin_cos(TAU * u.x);
        self.visible_normal(wo, Vec2::new(cos, sin), u.y)
    }

    /// As [`Self::sample_visible_normal`], for a given azimuth.
    #[inline]
    pub(crate) fn visible_normal(self, wo: Vec3, azimuth: Vec2, u: f32) -> Vec3 {
        let w = Vec3::new(wo.x * self.alpha, wo.y * self.alpha, wo.z).normalize();
        let z = (1.0 - u) * (1.0 + w.z) - w.z;
        let sin_theta = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let cap = Vec3::new(sin_theta * azimuth.x, sin_theta * azimuth.y, z);
        let h = cap + w;
        Vec3::new(h.x * self.alpha, h.y * self.alpha, h.z.max(0.0)).normalize_or(Vec3::Z)
    }
}
