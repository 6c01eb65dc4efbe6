use glam::{DVec3, Vec3};

/// An axis-aligned box in world space, metres. Empty when `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// True when the box contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Middle of the box; the origin when it is empty.
    #[must_use]
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        (self.min.as_dvec3() + self.max.as_dvec3()).as_vec3() * 0.5
    }

    /// Length of the diagonal, metres; 0 when the box is empty.
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        (self.max.as_dvec3() - self.min.as_dvec3()).length() as f32
    }

    /// Smallest box around this one and `other`.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Smallest box around this one and the point `p`.
    #[must_use]
    pub fn extend(&self, p: Vec3) -> Self {
        Self {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    /// True when no coordinate is larger than `most`, and none is a NaN.
    pub(crate) fn lies_within(&self, most: f32) -> bool {
        self.min.abs().cmple(Vec3::splat(most)).all() && self.max.abs().cmple(Vec3::splat(most)).all()
    }

    /// Smallest single-precision box around a double-precision one.
    pub(crate) fn around(min: DVec3, max: DVec3) -> Self {
        Self {
            min: Vec3::from_array(min.to_array().map(|x| round_toward(x, f64::NEG_INFINITY))),
            max: Vec3::from_array(max.to_array().map(|x| round_toward(x, f64::INFINITY))),
        }
    }
}

/// The nearest single-precision number on the side of `target`.
fn round_toward(x: f64, target: f64) -> f32 {
    let nearest = x as f32;
    if target < x && f64::from(nearest) > x {
        nearest.next_down()
    } else if target > x && f64::from(nearest) < x {
        nearest.next_up()
    } else {
        nearest
    }
}
