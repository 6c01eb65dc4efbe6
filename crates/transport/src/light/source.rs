use super::Environment;
use crate::frame::MovingFrame;
use radiometry::Rgb;
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// Cosine of the half-angle within which it shines with full intensity.
    pub cos_inner: f32,
    /// Cosine of the half-angle beyond which it is dark, at most `cos_inner`.
    pub cos_outer: f32,
}

impl SpotCone {
    /// Share of the intensity on the axis that is sent at an angle, in [0, 1].
    #[inline]
    #[must_use]
    pub fn falloff(&self, cos: f32) -> f32 {
        if cos < self.cos_outer {
            return 0.0;
        }
        if cos >= self.cos_inner {
            return 1.0;
        }
        let t = (cos - self.cos_outer) / (self.cos_inner - self.cos_outer);
        t * t * (3.0 - 2.0 * t)
    }

    /// 1 − cos of the outer half-angle.
    pub(crate) fn one_minus_cos(&self) -> f32 {
        1.0 - self.cos_outer
    }
}
