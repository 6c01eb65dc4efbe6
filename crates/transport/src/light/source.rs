use super::Environment;
use crate::frame::MovingFrame;
use glam::Vec3;
use radiometry::{Rgb, math};
use std::sync::Arc;
use texture::Texture;

/// A light, as the tables are built from it.
#[derive(Clone, Debug)]
pub enum LightSource {
    /// A point that shines alike in all directions.
    Point {
        /// Where it is; its axes do not matter.
        frame: MovingFrame,
        /// W·sr⁻¹.
        intensity: Rgb,
    },
    /// A point that shines into a cone along −Z of its frame.
    Spot {
        /// Where it is and shines.
        frame: MovingFrame,
        /// W·sr⁻¹ on the axis.
        intensity: Rgb,
        /// Its edge.
        cone: SpotCone,
    },
    /// A surface that shines by Lambert's law.
    Area {
        /// Row of the instance whose surface shines.
        instance: u32,
        /// W·m⁻²·sr⁻¹.
        radiance: Rgb,
        /// Radiance from point to point, in place of `radiance`, which is then its mean, for the choice of lights.
        texture: Option<Arc<Texture>>,
        /// Shines on both sides; otherwise on that of the geometric normal.
        two_sided: bool,
    },
    /// A disc infinitely far away, whose light travels along −Z of its frame.
    Distant {
        /// Its rotation; where it is does not matter.
        frame: MovingFrame,
        /// W·m⁻² on a plane that faces it.
        irradiance: Rgb,
        /// Half the angle that it subtends, radians, in [0, π/2); 0 is a point that no ray meets by chance.
        half_angle: f32,
    },
    /// All directions in which there is nothing else.
    Environment(Environment),
}

/// How a spot light fades towards the edge of its cone: a smoothstep in the cosine of the angle to the axis.
///
/// Kept as 1 − cos, since below a degree cosines in single precision have few digits left, and below 0.02° none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// 1 − cos of the half-angle within which it shines with full intensity.
    one_minus_cos_inner: f32,
    /// 1 − cos of the half-angle beyond which it is dark, at least that of the inner.
    one_minus_cos_outer: f32,
}

impl SpotCone {
    /// - `inner`, `outer`: half-angles in radians, 0 ≤ `inner` ≤ `outer` ≤ π.
    #[must_use]
    pub fn from_half_angles(inner: f32, outer: f32) -> Self {
        // 1 − cos θ = 2 sin²(θ/2).
        let one_minus_cos = |angle: f32| 2.0 * math::sin(0.5 * angle) * math::sin(0.5 * angle);
        Self {
            one_minus_cos_inner: one_minus_cos(inner),
            one_minus_cos_outer: one_minus_cos(outer),
        }
    }

    /// Share of the intensity on the axis that is sent in a direction, in [0, 1]. Both are of unit length.
    #[inline]
    #[must_use]
    pub fn falloff(&self, direction: Vec3, axis: Vec3) -> f32 {
        // 1 − cos of a small angle through its chord: |a − b|² = 2 (1 − cos).
        let one_minus_cos = 0.5 * (direction - axis).length_squared();
        if one_minus_cos > self.one_minus_cos_outer {
            return 0.0;
        }
        if one_minus_cos <= self.one_minus_cos_inner {
            return 1.0;
        }
        let t = (self.one_minus_cos_outer - one_minus_cos) / (self.one_minus_cos_outer - self.one_minus_cos_inner);
        t * t * (3.0 - 2.0 * t)
    }

    /// The solid angle that would hold all of its light at the intensity on the axis, sr: Φ = Ω I.
    #[must_use]
    pub fn solid_angle(&self) -> f32 {
        std::f32::consts::PI * (self.one_minus_cos_inner + self.one_minus_cos_outer)
    }

    /// 1 − cos of the outer half-angle.
    pub(crate) fn one_minus_cos(&self) -> f32 {
        self.one_minus_cos_outer
    }
}
