//! Uniform choice in the solid angle of a rectangle.

use crate::placed::Pose;
use glam::{DVec2, DVec3};
use radiometry::math;
use std::f64::consts::TAU;

/// A rectangle in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    corner: DVec3,
    /// Unit vectors along the sides.
    x: DVec3,
    y: DVec3,
    size: DVec2,
}

/// Smaller solid angles are sampled by area, which is as good there and keeps its digits.
const SMALLEST: f64 = 1e-3;
/// So are larger ones, where the hemisphere is almost full and the map degenerates.
const LARGEST: f64 = 6.22;
/// How far, relative to its sides, the corners may be off a right angle.
const TOLERANCE: f64 = 1e-6;

/// The rectangle seen from a point. Coordinates along x, y and away from the viewer.
struct View {
    low: DVec2,
    high: DVec2,
    /// Negative.
    z: f64,
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl Rectangle {
    /// From a corner and the two sides that start there; `None` when they are not at a right angle.
    pub(super) fn new(corner: DVec3, ex: DVec3, ey: DVec3) -> Option<Self> {
        let size = DVec2::new(ex.length(), ey.length());
        let upright = ex.dot(ey).abs() <= TOLERANCE * size.x * size.y;
        (upright && size.x > 0.0 && size.y > 0.0).then(|| Self {
            corner,
            x: ex / size.x,
            y: ey / size.y,
            size,
        })
    }

    pub(super) fn of_quad(pose: &Pose, half: DVec2) -> Option<Self> {
        let m = &pose.world_from_object;
        let corner = m.transform_point3(DVec3::new(-half.x, -half.y, 0.0));
        Self::new(
            corner,
            m.matrix3.x_axis * (2.0 * half.x),
            m.matrix3.y_axis * (2.0 * half.y),
        )
    }

    pub(super) fn solid_angle(&self, from: DVec3) -> Option<f64> {
        self.view(from).map(|view| view.solid_angle)
    }

    fn view(&self, from: DVec3) -> Option<View> {
        let d = self.corner - from;
        let low = DVec2::new(d.dot(self.x), d.dot(self.y));
        let high = low + self.size;
        let z = -d.dot(self.x.cross(self.y)).abs();
        let unit = |v: DVec2| v / v.length();
        // Normals of the four planes through the point and an edge; the components that are not zero.
        let n0 = unit(DVec2::new(z, -low.y));
        let n1 = unit(DVec2::new(-z, high.x));
        let n2 = unit(DVec2::new(-z, high.y));
        let n3 = unit(DVec2::new(z, -low.x));
        let angle = |a: DVec2, b: DVec2| math::acos_f64(-a.y * b.y);
        let (g0, g1, g2, g3) = (angle(n0, n1), angle(n1, n2), angle(n2, n3), angle(n3, n0));
        let k = TAU - g2 - g3;
        let solid_angle = g0 + g1 - k;
        (solid_angle > SMALLEST && solid_angle < LARGEST).then_some(View {
            low,
            high,
            z,
            b0: n0.y,
            b1: n2.y,
            k,
            solid_angle,
        })
    }

    /// Chooses a point, as shares of the sides in [0, 1]²; `None` when the solid angle is too small or too large.
    ///
    /// Source: Ureña, Fajardo, King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013.
    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<DVec2> {
        let v = self.view(from)?;
        let (sin, cos) = math::sin_cos_f64(u.x * v.solid_angle + v.k);
        let f = (cos * v.b0 - v.b1) / sin;
        let c = (1.0_f64.copysign(f) / (f * f + v.b0 * v.b0).sqrt()).clamp(-1.0, 1.0);
        let x = (-(c * v.z) / (1.0 - c * c).max(1e-300).sqrt()).clamp(v.low.x, v.high.x);
        let d_sq = x * x + v.z * v.z;
        let height = |y: f64| y / (d_sq + y * y).sqrt();
        let (h0, h1) = (height(v.low.y), height(v.high.y));
        let h = h0 + u.y * (h1 - h0);
        let rest = 1.0 - h * h;
        let y = if rest > 1e-12 {
            h * (d_sq / rest).sqrt()
        } else {
            v.high.y
        };
        let y = y.clamp(v.low.y, v.high.y);
        Some(((DVec2::new(x, y) - v.low) / self.size).clamp(DVec2::ZERO, DVec2::ONE))
    }
}
