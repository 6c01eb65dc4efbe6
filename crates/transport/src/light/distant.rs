use crate::frame::MovingFrame;
use glam::{Vec2, Vec3};
use radiometry::{Frame, Rgb, math, warp};

/// A disc infinitely far away.
pub(crate) struct DistantDisc {
    frame: MovingFrame,
    /// Radiance of the disc; irradiance of a point.
    pub(crate) radiance: Rgb,
    /// 1 − cos of its half-angle; 0 for a point.
    one_minus_cos: f32,
}

impl DistantDisc {
    pub(super) fn new(frame: MovingFrame, irradiance: Rgb, half_angle: f32) -> Self {
        let (sin, cos) = math::sin_cos(half_angle);
        // E = ∫ L cosθ dω = π L sin² of the half-angle.
        let projected = std::f32::consts::PI * sin * sin;
        let one_minus_cos = sin * sin / (1.0 + cos);
        let is_point = projected < 1e-10;
        Self {
            frame,
            radiance: if is_point {
                irradiance
            } else {
                irradiance * (1.0 / projected)
            },
            one_minus_cos: if is_point { 0.0 } else { one_minus_cos },
        }
    }

    pub(crate) fn is_point(&self) -> bool {
        self.one_minus_cos == 0.0
    }

    /// A unit direction towards it and its density per solid angle; 1 for a point.
    #[inline]
    pub(crate) fn sample(&self, u: Vec2, time: f32) -> (Vec3, f32) {
        let axis = self.frame.back(time);
        if self.is_point() {
            return (axis, 1.0);
        }
        let local = warp::sample_uniform_cone(u, self.one_minus_cos);
        let direction = Frame::from_normal(axis).world_from_local(local).normalize();
        (direction, self.pdf())
    }

    pub(super) fn pdf(&self) -> f32 {
        1.0 / (std::f32::consts::TAU * self.one_minus_cos)
    }

    /// True where a direction meets the disc; never for a point.
    #[inline]
    pub(super) fn holds(&self, direction: Vec3, time: f32) -> bool {
        // 1 − cos of a small angle through its chord: |a − b|² = 2 (1 − cos).
        0.5 * (direction - self.frame.back(time)).length_squared() < self.one_minus_cos
    }
}
