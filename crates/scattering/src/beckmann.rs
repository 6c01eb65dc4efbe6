use glam::{Vec2, Vec3};
use radiometry::math;
use std::f32::consts::{FRAC_1_PI, FRAC_2_SQRT_PI};

/// The isotropic Beckmann distribution of microfacet normals, with Smith's masking: slopes are normally distributed with
/// variance α²/2, so its highlights have no tail.
///
/// Every method wants `cosθ > 0`. Masking is kept in the form of the area that a unit of surface shows to ω,
/// A(ω) = cosθ (1 + Λ(ω)) = ½ (cosθ erfc(−a) + α sinθ e^(−a²)/√π), a = cotθ/α, for which G₁(ω) = cosθ/A(ω): nothing
/// divides by a cosine, so grazing directions stay finite. This is exact, where Walter et al. give a rational
/// approximation of it.
///
/// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz, "Understanding
/// the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beckmann {
    alpha: f32,
}

impl Beckmann {
    #[inline]
    pub(crate) fn new(alpha: f32) -> Self {
        Self { alpha }
    }

    /// Density of normals: `D(h) = exp(−tan²θ/α²)/(π α² cos⁴θ)`, normalised as `∫ D(h) h_z dh = 1`.
    #[inline]
    pub(crate) fn density(self, h: Vec3) -> f32 {
        let cos_sq = h.z * h.z;
        let alpha_sq = self.alpha * self.alpha;
        let exponent = (h.x * h.x + h.y * h.y) / (alpha_sq * cos_sq);
        // From here on it is 0 in single precision, and 0/0 at the horizon.
        if exponent > LARGEST_EXPONENT {
            return 0.0;
        }
        FRAC_1_PI * math::exp(-exponent) / (alpha_sq * cos_sq * cos_sq)
    }

    /// A(ω), in [cosθ, 1].
    #[inline]
    fn shown_area(self, cos_theta: f32) -> f32 {
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
        let spread = self.alpha * sin_theta;
        Slopes {
            cos: cos_theta,
            sin: spread,
        }
        .cumulative(cos_theta / spread)
    }

    /// `G₁(ω_o)/cosθ_o`, which stays finite at grazing angles.
    #[inline]
    pub(crate) fn masking_over_cos(self, cos_o: f32) -> f32 {
        1.0 / self.shown_area(cos_o)
    }

    /// `G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i)` of two directions on one side, height-correlated:
    /// `1/(4 (cosθ_i A(ω_o) + cosθ_o A(ω_i) − cosθ_o cosθ_i))`.
    #[inline]
    pub(crate) fn visibility(self, cos_o: f32, cos_i: f32) -> f32 {
        0.25 / (cos_i * self.shown_area(cos_o) + cos_o * self.shown_area(cos_i) - cos_o * cos_i)
    }

    /// Samples a normal among those visible from `wo`; density `G₁(ω_o) (ω_o·h) D(h)/cosθ_o` per solid angle.
    ///
    /// The surface is stretched to α = 1, where the slope along the view and the one across it are independent.
    ///
    /// Source: Heitz and d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals",
    /// EGSR 2014; inverted by Newton's method here.
    pub(crate) fn sample_visible_normal(self, wo: Vec3, u: Vec2) -> Vec3 {
        let w = Vec3::new(wo.x * self.alpha, wo.y * self.alpha, wo.z).normalize();
        let sin = w.truncate().length();
        let azimuth = w.truncate().normalize_or(Vec2::X);
        let along = Slopes { cos: w.z, sin }.quantile(u.x);
        let across = Slopes { cos: 1.0, sin: 0.0 }.quantile(u.y);
        let slope = self.alpha * azimuth.rotate(Vec2::new(along, across));
        Vec3::new(-slope.x, -slope.y, 1.0).normalize()
    }
}

/// `exp(−87)` is the last that is not subnormal.
const LARGEST_EXPONENT: f32 = 87.0;

/// Slopes x along the view of a surface of α = 1, as seen from an angle: density in proportion to
/// `(cosθ − x sinθ) e^(−x²)/√π`, x ≤ cotθ.
#[derive(Clone, Copy)]
struct Slopes {
    cos: f32,
    sin: f32,
}

impl Slopes {
    /// Integral of the density up to a slope, not normalised.
    #[inline]
    fn cumulative(self, x: f32) -> f32 {
        0.5 * (self.cos * math::erfc(-x) + self.sin * gaussian(x))
    }

    /// The slope below which a share `u` in [0, 1) of all lies.
    ///
    /// Newton's method from the mode, where the integral turns from convex to concave: so it nears the solution from
    /// one side, and needs no bracket.
    fn quantile(self, u: f32) -> f32 {
        /// Enough for the ends of the range, where each step only halves the error; about five elsewhere.
        const STEPS: usize = 16;
        /// Of slope: far below the width of a pixel of any lobe.
        const TOLERANCE: f32 = 1e-5;
        let steepest = self.cos / self.sin;
        let target = u.max(f32::EPSILON * 0.5) * self.cumulative(steepest);
        let mut x = -self.sin / (self.cos + (self.cos * self.cos + 2.0 * self.sin * self.sin).sqrt());
        for _ in 0..STEPS {
            let density = (self.cos - x * self.sin) * gaussian(x);
            let step = (target - self.cumulative(x)) / density.max(f32::MIN_POSITIVE);
            x = (x + step).min(steepest);
            if step.abs() < TOLERANCE {
                break;
            }
        }
        x
    }
}

/// `e^(−x²)/√π`.
#[inline]
fn gaussian(x: f32) -> f32 {
    0.5 * FRAC_2_SQRT_PI * math::exp(-x * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    const ALPHAS: [f32; 5] = [0.01, 0.1, 0.25, 0.6, 1.0];

    /// Midpoint rule over the hemisphere, denser towards the pole by the square.
    fn integrate(f: impl Fn(Vec3) -> f32) -> f64 {
        let (rows, columns) = (2000, 64);
        let mut sum = 0.0;
        for row in 0..rows {
            let t = (row as f32 + 0.5) / rows as f32;
            let (sin_theta, cos_theta) = math::sin_cos(0.5 * PI * t * t);
            for column in 0..columns {
                let (sin, cos) = math::sin_cos(2.0 * PI * (column as f32 + 0.5) / columns as f32);
                let h = Vec3::new(sin_theta * cos, sin_theta * sin, cos_theta);
                sum += f64::from(f(h) * sin_theta * PI * t);
            }
        }
        sum * f64::from(2.0 * PI) / f64::from(rows * columns)
    }

    #[test]
    fn normals_cover_the_surface_once() {
        for alpha in ALPHAS {
            let covered = integrate(|h| Beckmann::new(alpha).density(h) * h.z);
            assert!((covered - 1.0).abs() < 1e-3, "α {alpha}: {covered}");
        }
    }

    #[test]
    fn visible_normals_cover_the_view_once() {
        for alpha in ALPHAS {
            let beckmann = Beckmann::new(alpha);
            for mu in [1.0_f32, 0.7, 0.2, 0.02] {
                let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                let seen = integrate(|h| beckmann.density(h) * wo.dot(h).max(0.0)) as f32;
                let share = seen * beckmann.masking_over_cos(mu);
                assert!((share - 1.0).abs() < 5e-3, "α {alpha} at {mu}: {share}");
            }
        }
    }

    #[test]
    fn masking_is_that_of_walter() {
        // Walter et al. 2007, equation 27: off by 0.35 % at most.
        for alpha in ALPHAS {
            for mu in [0.99_f32, 0.7, 0.3, 0.1, 0.01] {
                let a = mu / (alpha * (1.0 - mu * mu).sqrt());
                let rational = if a < 1.6 {
                    (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
                } else {
                    1.0
                };
                let exact = mu * Beckmann::new(alpha).masking_over_cos(mu);
                assert!(
                    (exact - rational).abs() < 0.0035,
                    "α {alpha} at {mu}: {exact} {rational}"
                );
            }
        }
    }

    #[test]
    fn quantiles_invert_the_integral() {
        for sin in [0.0_f32, 1e-3, 0.3, 0.9, 0.999_999, 1.0] {
            let slopes = Slopes {
                cos: (1.0 - sin * sin).sqrt(),
                sin,
            };
            let all = slopes.cumulative(slopes.cos / slopes.sin);
            for u in [0.0, 1e-6, 0.01, 0.3, 0.5, 0.77, 0.999, 1.0 - 1e-6, 1.0 - f32::EPSILON] {
                let found = slopes.cumulative(slopes.quantile(u)) / all;
                assert!((found - u).abs() < 1e-5, "sine {sin}, {u}: {found}");
            }
        }
    }

    #[test]
    fn grazing_directions_stay_finite() {
        for alpha in ALPHAS {
            let beckmann = Beckmann::new(alpha);
            assert!(beckmann.visibility(1e-6, 1e-6).is_finite() && beckmann.masking_over_cos(1e-6).is_finite());
            assert_eq!(beckmann.density(Vec3::X), 0.0);
            let h = beckmann.sample_visible_normal(Vec3::new(1.0, 0.0, 1e-6), Vec2::new(0.999_999_9, 0.0));
            assert!(h.is_normalized() && h.z > 0.0, "α {alpha}: {h}");
        }
    }
}
