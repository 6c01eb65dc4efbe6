//! Sphere around the origin.

use super::{LocalPoint, ShapeHit, atan2, first_inside, share_of_turn, turn};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::{FRAC_1_PI, TAU};

/// `o` must be the point of the line that is nearest to the centre.
pub(super) fn intersect(radius: f64, o: DVec3, d: DVec3, range: (f64, f64)) -> Option<ShapeHit> {
    let below = radius * radius - o.length_squared();
    if !(below >= 0.0) {
        return None;
    }
    let half_chord = (below / d.length_squared()).sqrt();
    let t = first_inside(-half_chord, half_chord, range)?;
    Some(ShapeHit { t, face: 0 })
}

pub(super) fn project(radius: f64, q: DVec3) -> LocalPoint {
    let n = q.try_normalize().unwrap_or(DVec3::Y);
    let u = 0.5 + 0.5 * FRAC_1_PI * atan2(n.x, n.z);
    let v = 0.5 + FRAC_1_PI * atan2(n.y, (n.x * n.x + n.z * n.z).sqrt());
    LocalPoint {
        p: n * radius,
        n,
        uv: Vec2::new(u as f32, v as f32),
    }
}

/// Archimedes: the area between two parallel planes depends on their distance alone.
pub(super) fn point(radius: f64, u: DVec2) -> (DVec3, DVec3) {
    let (cos, sin) = turn(u.x);
    let y = 1.0 - 2.0 * u.y;
    let ring = (4.0 * u.y * (1.0 - u.y)).max(0.0).sqrt();
    let n = DVec3::new(ring * cos, y, ring * sin);
    (n * radius, n * (2.0 * TAU * radius * radius))
}

pub(super) fn parameters(_radius: f64, p: DVec3) -> DVec2 {
    let n = p.try_normalize().unwrap_or(DVec3::Y);
    DVec2::new(share_of_turn(n.x, n.z), 0.5 - 0.5 * n.y)
}
