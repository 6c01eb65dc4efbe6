//! Warps of the unit square, each with the density of what it returns.

use crate::math;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, TAU};

/// Samples the unit disc uniformly; density 1/π.
///
/// Source: Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997.
#[inline]
#[must_use]
pub fn sample_unit_disc(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = math::sin_cos(phi);
    Vec2::new(r * cos, r * sin)
}

/// Samples the hemisphere around +z in proportion to cosθ; density per solid angle cosθ/π.
#[inline]
#[must_use]
pub fn sample_cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = sample_unit_disc(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of [`sample_cosine_hemisphere`], per solid angle.
#[inline]
#[must_use]
pub fn pdf_cosine_hemisphere(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Samples the unit sphere uniformly; density per solid angle 1/(4π).
#[inline]
#[must_use]
pub fn sample_uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = math::sin_cos(TAU * u.y);
    Vec3::new(r * cos, r * sin, z)
}

/// Density of [`sample_uniform_sphere`], per solid angle.
pub const PDF_UNIFORM_SPHERE: f32 = FRAC_1_PI / 4.0;

/// Samples the cone around +z uniformly per solid angle.
///
/// - `one_minus_cos_max`: `1 − cosθ_max` of the cone's half-angle, in (0, 2]. Passed as a difference because the cosine
///   itself has no precision left for the narrow cones that small, far objects subtend.
#[inline]
#[must_use]
pub fn sample_uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let one_minus_cos = u.x * one_minus_cos_max;
    let sin_theta = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (sin, cos) = math::sin_cos(TAU * u.y);
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - one_minus_cos)
}

/// 1 − cosθ of the cone that a sphere of `radius` subtends from `distance`; 2 (all directions) from inside it.
#[inline]
#[must_use]
pub fn one_minus_cos_of_sphere(radius: f32, distance: f32) -> f32 {
    if distance <= radius {
        return 2.0;
    }
    let sin_sq = (radius / distance) * (radius / distance);
    sin_sq / (1.0 + (1.0 - sin_sq).max(0.0).sqrt())
}

/// Samples barycentric coordinates (b0, b1) uniformly over a triangle; density 1/area.
///
/// Source: Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
#[inline]
#[must_use]
pub fn sample_triangle(u: Vec2) -> Vec2 {
    if u.y > u.x {
        Vec2::new(0.5 * u.x, u.y - 0.5 * u.x)
    } else {
        Vec2::new(u.x - 0.5 * u.y, 0.5 * u.y)
    }
}

/// Converts a density per area into one per solid angle, seen from `distance_sq` under `cos_theta` at the surface.
///
/// Returns infinity for a surface seen edge on, so that what is divided by it vanishes.
#[inline]
#[must_use]
pub fn solid_angle_pdf(pdf_area: f32, distance_sq: f32, cos_theta: f32) -> f32 {
    pdf_area * distance_sq / cos_theta.abs()
}

/// Power heuristic with exponent 2: weight of the technique with density `a` against one with density `b`.
///
/// Source: Veach and Guibas 1995. Computed as 1/(1 + (b/a)²), which neither overflows nor divides by zero.
#[inline]
#[must_use]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    if a.is_infinite() {
        return 1.0;
    }
    if a > 0.0 {
        let ratio = b / a;
        1.0 / (1.0 + ratio * ratio)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SampleStream, StageKey};

    fn points(n: u32) -> impl Iterator<Item = Vec2> {
        (0..n).map(|i| SampleStream::new(11, StageKey::new("warp"), 0, i).draw_2d(0, 0))
    }

    #[test]
    fn moments_of_every_warp_are_those_of_its_density() {
        let n = 1 << 14;
        let mean = |f: &dyn Fn(Vec2) -> f32| points(n).map(|u| f64::from(f(u))).sum::<f64>() / f64::from(n);
        // Second moments have closed forms; low-discrepancy points meet them well within 1e-3.
        assert!((mean(&|u| sample_unit_disc(u).length_squared()) - 0.5).abs() < 1e-3);
        assert!((mean(&|u| sample_cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-3);
        assert!((mean(&|u| sample_uniform_sphere(u).z.powi(2)) - 1.0 / 3.0).abs() < 1e-3);
        assert!((mean(&|u| sample_uniform_cone(u, 0.25).z) - 0.875).abs() < 1e-3);
        assert!((mean(&|u| sample_triangle(u).x) - 1.0 / 3.0).abs() < 1e-3);
        assert!((mean(&|u| sample_triangle(u).y * sample_triangle(u).x) - 1.0 / 12.0).abs() < 1e-3);
    }

    #[test]
    fn a_far_sphere_keeps_its_solid_angle() {
        let far = one_minus_cos_of_sphere(1e-3, 1e3);
        let expected = 0.5e-12;
        assert!((far - expected).abs() < 1e-3 * expected);
        assert_eq!(one_minus_cos_of_sphere(1.0, 0.5), 2.0);
    }

    #[test]
    fn heuristics_add_up_to_one_and_stand_infinities() {
        for (a, b) in [(1.0, 2.0), (1e-20, 1e20), (3.0, 0.0)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-6);
        }
        assert_eq!(power_heuristic(f32::INFINITY, 1.0), 1.0);
        assert_eq!(power_heuristic(1.0, f32::INFINITY), 0.0);
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
    }
}
