//! Axis-aligned box around the origin. Faces: +X, −X, +Y, −Y, +Z, −Z.

use super::{LocalPoint, ShapeHit};
use glam::{DVec2, DVec3};

pub(super) fn intersect(half: DVec3, o: DVec3, d: DVec3, (low, high): (f64, f64)) -> Option<ShapeHit> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut enter_face, mut leave_face) = (0, 0);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if o[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let reach = half[axis] / d[axis].abs();
        let middle = -o[axis] / d[axis];
        // Going up an axis, the line enters by the negative face and leaves by the positive one.
        let up = u32::from(d[axis] > 0.0);
        if middle - reach > enter {
            enter = middle - reach;
            enter_face = 2 * axis as u32 + up;
        }
        if middle + reach < leave {
            leave = middle + reach;
            leave_face = 2 * axis as u32 + (1 - up);
        }
    }
    if enter > leave {
        return None;
    }
    if enter > low {
        return (enter < high).then_some(ShapeHit {
            t: enter,
            face: enter_face,
        });
    }
    (leave > low && leave < high).then_some(ShapeHit {
        t: leave,
        face: leave_face,
    })
}

fn axis_and_sign(face: u32) -> (usize, f64) {
    let face = face.min(5);
    ((face / 2) as usize, if face.is_multiple_of(2) { 1.0 } else { -1.0 })
}

pub(super) fn project(half: DVec3, q: DVec3, face: u32) -> LocalPoint {
    let (axis, sign) = axis_and_sign(face);
    let mut p = q.clamp(-half, half);
    p[axis] = sign * half[axis];
    let mut n = DVec3::ZERO;
    n[axis] = sign;
    LocalPoint {
        p,
        n,
        uv: parameters(half, face, p).clamp(DVec2::ZERO, DVec2::ONE).as_vec2(),
    }
}

pub(super) fn point(half: DVec3, face: u32, u: DVec2) -> (DVec3, DVec3) {
    let (axis, sign) = axis_and_sign(face);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut p, mut n) = (DVec3::ZERO, DVec3::ZERO);
    p[axis] = sign * half[axis];
    p[i] = (2.0 * u.x - 1.0) * half[i];
    p[j] = (2.0 * u.y - 1.0) * half[j];
    n[axis] = sign * 4.0 * half[i] * half[j];
    (p, n)
}

pub(super) fn parameters(half: DVec3, face: u32, p: DVec3) -> DVec2 {
    let (axis, _) = axis_and_sign(face);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    (DVec2::new(p[i] / half[i], p[j] / half[j]) + 1.0) * 0.5
}

pub(super) fn tangents(half: DVec3, face: u32) -> (DVec3, DVec3) {
    let (axis, _) = axis_and_sign(face);
    let along = |axis: usize| DVec3::AXES[axis] * (2.0 * half[axis]);
    (along((axis + 1) % 3), along((axis + 2) % 3))
}
