//! Instances with their transforms both ways, and the rounding that comes with them.

use crate::{Bounds, Instance, Placement, SpatialError};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::borrow::Cow;
use std::sync::Arc;

/// Share of the coordinates that double-precision transforms may be off by, with much to spare.
const TRANSFORM_ERROR: f64 = 1e-13;

/// Both directions of the transform of an instance at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) world_from_object: DAffine3,
    pub(crate) object_from_world: DAffine3,
    pub(crate) mirrored: bool,
}

/// An instance in the scene.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) geometry: u32,
    /// Around it at all times.
    pub(crate) bounds: Bounds,
    /// When the shutter opens.
    pub(crate) opening: Pose,
    motion: Option<Arc<[DAffine3]>>,
}

/// Transforms with a smaller volume than this share of the box of their axes count as singular.
const SINGULAR: f64 = 1e-12;

impl Placed {
    pub(crate) fn new(row: usize, instance: &Instance, geometries: usize) -> Result<Self, SpatialError> {
        if instance.geometry as usize >= geometries {
            return Err(SpatialError::UnknownGeometry {
                instance: row,
                geometry: instance.geometry,
                count: geometries,
            });
        }
        let (opening, motion) = match &instance.placement {
            Placement::Fixed(m) => (*m, None),
            Placement::Moving(keys) => {
                let [first, ..] = **keys else {
                    return Err(SpatialError::NonFiniteTransform { instance: row });
                };
                check_motion(row, keys)?;
                (first, (keys.len() > 1).then(|| Arc::clone(keys)))
            }
        };
        Ok(Self {
            geometry: instance.geometry,
            bounds: Bounds::EMPTY,
            opening: Pose::new(row, &opening)?,
            motion,
        })
    }

    /// True when it moves while the shutter is open.
    pub(crate) fn moves(&self) -> bool {
        self.motion.is_some()
    }

    /// Where it is at a time in [0, 1] of the shutter.
    #[inline]
    pub(crate) fn at(&self, time: f32) -> Cow<'_, Pose> {
        match &self.motion {
            None => Cow::Borrowed(&self.opening),
            Some(keys) => Cow::Owned(Pose::unchecked(between(keys, time))),
        }
    }

    /// The transforms between which all points move in straight lines.
    pub(crate) fn keys(&self) -> &[DAffine3] {
        match &self.motion {
            None => std::slice::from_ref(&self.opening.world_from_object),
            Some(keys) => keys,
        }
    }
}

/// Checks every key, and that the instance is not turned inside out on the way from one to the next.
fn check_motion(row: usize, keys: &[DAffine3]) -> Result<(), SpatialError> {
    let first = Pose::new(row, &keys[0])?;
    for pair in keys.windows(2) {
        for share in [0.25, 0.5, 0.75, 1.0] {
            if Pose::new(row, &straight_between(&pair[0], &pair[1], share))?.mirrored != first.mirrored {
                return Err(SpatialError::SingularTransform { instance: row });
            }
        }
    }
    Ok(())
}

/// The transform between evenly spaced keys.
fn between(keys: &[DAffine3], time: f32) -> DAffine3 {
    let last = keys.len() - 1;
    let along = f64::from(time.clamp(0.0, 1.0)) * last as f64;
    let index = (along as usize).min(last - 1);
    straight_between(&keys[index], &keys[index + 1], along - index as f64)
}

/// The transform under which every point is on the straight way between its places under two others.
///
/// - `share`: of the way from `a` to `b`, in [0, 1].
#[must_use]
pub fn straight_between(a: &DAffine3, b: &DAffine3, share: f64) -> DAffine3 {
    DAffine3 {
        matrix3: a.matrix3 * (1.0 - share) + b.matrix3 * share,
        translation: a.translation * (1.0 - share) + b.translation * share,
    }
}

impl Pose {
    fn new(row: usize, m: &DAffine3) -> Result<Self, SpatialError> {
        if !m.is_finite() {
            return Err(SpatialError::NonFiniteTransform { instance: row });
        }
        let axes = m.matrix3;
        let volume = axes.determinant();
        let most = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
        let pose = Self::unchecked(*m);
        if !(volume.abs() > SINGULAR * most) || !pose.object_from_world.is_finite() {
            return Err(SpatialError::SingularTransform { instance: row });
        }
        Ok(pose)
    }

    fn unchecked(m: DAffine3) -> Self {
        Self {
            world_from_object: m,
            object_from_world: m.inverse(),
            mirrored: m.matrix3.determinant() < 0.0,
        }
    }

    /// World-space vertex of a mesh. Rounded the same way wherever it is needed, so that all agree on the triangle.
    #[inline]
    pub(crate) fn world_vertex(&self, v: Vec3) -> Vec3 {
        self.world_from_object.transform_point3(v.as_dvec3()).as_vec3()
    }

    /// World-space normal, of any length, of an object-space one: by the inverse transpose, so that outside stays outside.
    #[inline]
    pub(crate) fn world_normal(&self, n: DVec3) -> DVec3 {
        self.object_from_world.matrix3.transpose() * n
    }

    /// Rounds a point of the instance to single precision in world space, and bounds how far that moves it.
    pub(crate) fn world_point(&self, object: DVec3) -> (Vec3, f32) {
        let m = &self.world_from_object;
        let exact = m.transform_point3(object);
        round_point(exact, self.magnitude(object))
    }

    /// Sum of the sizes of the terms that make up a world-space coordinate.
    fn magnitude(&self, object: DVec3) -> f64 {
        let m = &self.world_from_object;
        let a = &m.matrix3;
        let terms = a.x_axis.abs() * object.x.abs() + a.y_axis.abs() * object.y.abs() + a.z_axis.abs() * object.z.abs();
        (terms + m.translation.abs()).max_element()
    }

    /// Cofactor matrix of the transform: takes area vectors to world space, their outward sense apart.
    pub(crate) fn cofactor(&self) -> DMat3 {
        self.object_from_world.matrix3.transpose() * self.world_from_object.matrix3.determinant()
    }
}

/// Rounds a point to single precision and bounds how far that moves it; `magnitude` is that of its terms.
pub(crate) fn round_point(exact: DVec3, magnitude: f64) -> (Vec3, f32) {
    let p = exact.as_vec3();
    let error = (p.as_dvec3() - exact).length() + magnitude * TRANSFORM_ERROR;
    // One step up covers the rounding of the bound itself.
    (p, (error as f32).next_up())
}
