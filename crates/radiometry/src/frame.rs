use glam::Vec3;

/// An orthonormal, right-handed basis around a unit normal, which is its z axis.
///
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent, world space, unit length.
    pub x: Vec3,
    /// Second tangent, world space, unit length.
    pub y: Vec3,
    /// The normal, world space, unit length.
    pub z: Vec3,
}

impl Frame {
    /// Builds a basis whose z axis is the unit vector `n`. Exact for every direction, the poles included.
    #[inline]
    #[must_use]
    pub fn from_normal(n: Vec3) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            x: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            y: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            z: n,
        }
    }

    /// World-space direction of a local one.
    #[inline]
    #[must_use]
    pub fn world_from_local(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// Local direction of a world-space one.
    #[inline]
    #[must_use]
    pub fn local_from_world(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed_everywhere() {
        for i in 0..1000_u32 {
            let p = crate::SampleStream::new(1, crate::StageKey::new("frame"), 0, i).draw_2d(0, 0);
            for n in [crate::warp::sample_uniform_sphere(p), Vec3::Z, Vec3::NEG_Z, Vec3::X] {
                let f = Frame::from_normal(n);
                assert!((f.x.length() - 1.0).abs() < 1e-5 && (f.y.length() - 1.0).abs() < 1e-5);
                assert!(f.x.dot(f.y).abs() < 1e-5 && f.x.dot(n).abs() < 1e-5 && f.y.dot(n).abs() < 1e-5);
                assert!(f.x.cross(f.y).dot(n) > 0.999);
            }
        }
    }
}
