//! Instances with their transforms both ways, and the rounding that comes with them.

use crate::{Bounds, Instance, SpatialError};
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// Share of the coordinates that double-precision transforms may be off by, with much to spare.
const TRANSFORM_ERROR: f64 = 1e-13;

/// An instance with both directions of its transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) geometry: u32,
    pub(crate) world_from_object: DAffine3,
    pub(crate) object_from_world: DAffine3,
    pub(crate) bounds: Bounds,
    pub(crate) mirrored: bool,
}

/// Transforms with a smaller volume than this share of the box of their axes count as singular.
const SINGULAR: f64 = 1e-12;

impl Placed {
    pub(crate) fn new(row: usize, instance: &Instance, geometries: usize) -> Result<Self, SpatialError> {
        let m = instance.world_from_object;
        if instance.geometry as usize >= geometries {
            return Err(SpatialError::UnknownGeometry {
                instance: row,
                geometry: instance.geometry,
                count: geometries,
            });
        }
        if !m.is_finite() {
            return Err(SpatialError::NonFiniteTransform { instance: row });
        }
        let axes = m.matrix3;
        let volume = axes.determinant();
        let object_from_world = m.inverse();
        let most = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
        if !(volume.abs() > SINGULAR * most) || !object_from_world.is_finite() {
            return Err(SpatialError::SingularTransform { instance: row });
        }
        Ok(Self {
            geometry: instance.geometry,
            world_from_object: m,
            object_from_world,
            bounds: Bounds::EMPTY,
            mirrored: volume < 0.0,
        })
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
