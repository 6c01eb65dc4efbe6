//! Torus around Y.

use super::polynomial::quartic_roots;
use super::{LocalPoint, ShapeHit, atan2, share_of_turn, turn};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::{PI, TAU};

/// Tube of radius `minor` around the circle of radius `major`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torus {
    pub(super) major: f64,
    pub(super) minor: f64,
}

impl Torus {
    pub(super) fn new(major: f64, minor: f64) -> Self {
        Self { major, minor }
    }

    /// `o` must be the point of the line that is nearest to the centre.
    pub(super) fn intersect(&self, o: DVec3, d: DVec3, range: (f64, f64)) -> Option<ShapeHit> {
        // In units of the major radius, along a unit direction; o·d = 0 drops two terms of
        // (|p|² + R² − r²)² = 4R²(x² + z²).
        let length = d.length();
        let (o, d) = (o / self.major, d / length);
        let to_unit = length / self.major;
        let ratio = self.minor / self.major;
        let reach_sq = (1.0 + ratio) * (1.0 + ratio) - o.length_squared();
        if !(reach_sq > 0.0) {
            return None;
        }
        // Inside the sphere around it, and between the planes that touch it above and below.
        let reach = reach_sq.sqrt() * (1.0 + 1e-9) + 1e-12;
        let (mut low, mut high) = (-reach, reach);
        if d.y != 0.0 {
            let (middle, half) = (-o.y / d.y, ratio * (1.0 + 1e-9) / d.y.abs());
            low = low.max(middle - half);
            high = high.min(middle + half);
        } else if o.y.abs() > ratio {
            return None;
        }
        let low = low.max(range.0 * to_unit);
        let high = high.min(range.1 * to_unit);
        let k = o.length_squared() + 1.0 - ratio * ratio;
        let coefficients = [
            k * k - 4.0 * (o.x * o.x + o.z * o.z),
            -8.0 * (o.x * d.x + o.z * d.z),
            2.0 * k - 4.0 * (d.x * d.x + d.z * d.z),
            0.0,
            1.0,
        ];
        let (roots, count) = quartic_roots(&coefficients, low, high);
        let t = roots[..count].first()? / to_unit;
        (t > range.0 && t < range.1).then_some(ShapeHit { t, face: 0 })
    }

    /// Unit vector from the axis toward `q`, in the plane y = 0, and the distance from the axis.
    fn radial(q: DVec3) -> (DVec3, f64) {
        let radius = (q.x * q.x + q.z * q.z).sqrt();
        if radius > 0.0 {
            (DVec3::new(q.x / radius, 0.0, q.z / radius), radius)
        } else {
            (DVec3::X, 0.0)
        }
    }

    pub(super) fn project(&self, q: DVec3) -> LocalPoint {
        let (radial, _) = Self::radial(q);
        let n = (q - radial * self.major).try_normalize().unwrap_or(DVec3::Y);
        let u = share_of_turn(radial.z, radial.x);
        let v = 0.5 + atan2(n.y, n.dot(radial)) / TAU;
        LocalPoint {
            p: radial * self.major + n * self.minor,
            n,
            uv: Vec2::new(u as f32, v as f32),
        }
    }

    pub(super) fn point(&self, u: DVec2) -> (DVec3, DVec3) {
        let (cos, sin) = turn(u.x);
        let (tube_cos, tube_sin) = turn(u.y);
        let radial = DVec3::new(cos, 0.0, sin);
        let n = radial * tube_cos + DVec3::Y * tube_sin;
        let area = 4.0 * PI * PI * self.minor * (self.major + self.minor * tube_cos);
        (radial * self.major + n * self.minor, n * area)
    }

    pub(super) fn parameters(&self, p: DVec3) -> DVec2 {
        let (radial, radius) = Self::radial(p);
        DVec2::new(
            share_of_turn(radial.x, radial.z),
            share_of_turn(radius - self.major, p.y),
        )
    }
}
