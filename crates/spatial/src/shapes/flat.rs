//! Rectangle and disc in the plane z = 0, facing +Z.

use super::{LocalPoint, ShapeHit, share_of_turn, turn};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::PI;

pub(super) fn intersect(
    o: DVec3,
    d: DVec3,
    (low, high): (f64, f64),
    inside: impl Fn(DVec3) -> bool,
) -> Option<ShapeHit> {
    let t = -o.z / d.z;
    (t > low && t < high && inside(o + d * t)).then_some(ShapeHit { t, face: 0 })
}

pub(super) fn project_to_quad(half: DVec2, q: DVec3) -> LocalPoint {
    let p = q.truncate().clamp(-half, half);
    LocalPoint {
        p: p.extend(0.0),
        n: DVec3::Z,
        uv: (p / (2.0 * half) + 0.5).as_vec2(),
    }
}

pub(super) fn project_to_disc(radius: f64, q: DVec3) -> LocalPoint {
    let p = q.truncate().clamp_length_max(radius);
    LocalPoint {
        p: p.extend(0.0),
        n: DVec3::Z,
        uv: (p / (2.0 * radius) + 0.5).as_vec2().clamp(Vec2::ZERO, Vec2::ONE),
    }
}

pub(super) fn point_of_quad(half: DVec2, u: DVec2) -> (DVec3, DVec3) {
    let p = (2.0 * u - 1.0) * half;
    (p.extend(0.0), DVec3::Z * (4.0 * half.x * half.y))
}

pub(super) fn parameters_of_quad(half: DVec2, p: DVec3) -> DVec2 {
    (p.truncate() / half + 1.0) * 0.5
}

pub(super) fn point_of_disc(radius: f64, u: DVec2) -> (DVec3, DVec3) {
    let (cos, sin) = turn(u.x);
    let r = radius * u.y.sqrt();
    (DVec3::new(r * cos, r * sin, 0.0), DVec3::Z * (PI * radius * radius))
}

pub(super) fn parameters_of_disc(radius: f64, p: DVec3) -> DVec2 {
    let share = (p.x * p.x + p.y * p.y) / (radius * radius);
    DVec2::new(share_of_turn(p.x, p.y), share)
}
