//! Uniform choice in the cone that a sphere subtends.

use crate::placed::Pose;
use glam::{DVec2, DVec3};
use radiometry::math;
use std::f64::consts::TAU;

/// A sphere in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    center: DVec3,
    radius: f64,
}

/// How far lengths and angles of axes may be off for a transform to count as keeping angles.
const TOLERANCE: f64 = 1e-6;

/// The factor by which a transform scales, if it scales all directions alike and keeps angles.
pub(super) fn uniform_scale(pose: &Pose) -> Option<f64> {
    let a = &pose.world_from_object.matrix3;
    let scale_sq = a.x_axis.length_squared();
    let alike = [a.y_axis, a.z_axis]
        .iter()
        .all(|c| (c.length_squared() - scale_sq).abs() <= TOLERANCE * scale_sq);
    let upright = [(a.x_axis, a.y_axis), (a.y_axis, a.z_axis), (a.z_axis, a.x_axis)]
        .iter()
        .all(|(p, q)| p.dot(*q).abs() <= TOLERANCE * scale_sq);
    (alike && upright).then(|| scale_sq.sqrt())
}

impl Ball {
    /// `None` when the transform makes it an ellipsoid.
    pub(super) fn new(pose: &Pose, radius: f64) -> Option<Self> {
        uniform_scale(pose).map(|scale| Self {
            center: pose.world_from_object.translation,
            radius: radius * scale,
        })
    }

    /// 1 − cosθ of the cone's half-angle and the squared sine of it; `None` from inside.
    fn cone(&self, from: DVec3) -> Option<(f64, f64)> {
        let distance_sq = from.distance_squared(self.center);
        let sin_sq = self.radius * self.radius / distance_sq;
        if !(sin_sq < 1.0 - 1e-7) {
            return None;
        }
        Some((sin_sq / (1.0 + (1.0 - sin_sq).sqrt()), sin_sq))
    }

    pub(super) fn solid_angle(&self, from: DVec3) -> Option<f64> {
        self.cone(from).map(|(one_minus_cos, _)| TAU * one_minus_cos)
    }

    /// The point where a uniformly chosen direction of the cone first meets the sphere.
    ///
    /// Source: Shirley, Wang, Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", 1996; the point by
    /// its angle at the centre, as in Pharr et al., "Physically Based Rendering", 4th ed., section 6.2.4.
    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<DVec3> {
        let (one_minus_cos_max, sin_sq_max) = self.cone(from)?;
        let one_minus_cos = u.x * one_minus_cos_max;
        let sin_sq = one_minus_cos * (2.0 - one_minus_cos);
        let inward = (1.0 - sin_sq / sin_sq_max).max(0.0).sqrt();
        let cos_center = (sin_sq / sin_sq_max.sqrt() + (1.0 - one_minus_cos) * inward).min(1.0);
        let sin_center = (1.0 - cos_center * cos_center).max(0.0).sqrt();
        let toward = (from - self.center).normalize();
        let (a, b) = toward.any_orthonormal_pair();
        let (sin, cos) = math::sin_cos_f64(TAU * u.y);
        let n = a * (sin_center * cos) + b * (sin_center * sin) + toward * cos_center;
        Some(self.center + n * self.radius)
    }
}
