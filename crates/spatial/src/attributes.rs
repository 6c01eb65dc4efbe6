//! What is worked out at a surface point only for whom it matters: further texture coordinates, colours, tangents.

use crate::ray_scene::Prepared;
use crate::surface::{WorldTriangle, above_horizon};
use crate::{RayScene, SurfacePoint, TriangleMesh};
use glam::{DVec3, Vec2, Vec3, Vec4};
use std::ops::{Add, Mul};

impl WorldTriangle {
    /// Weights of the second and third vertex at a point of the triangle; zero where it has no area.
    pub(crate) fn weights(&self, p: DVec3) -> Vec2 {
        let [a, b, c] = self.vertices;
        let (along, across, q) = (b - a, c - a, p - a);
        let n = along.cross(across);
        let area_sq = n.length_squared();
        if area_sq == 0.0 {
            return Vec2::ZERO;
        }
        let second = (q.cross(across).dot(n) / area_sq).clamp(0.0, 1.0);
        let third = (along.cross(q).dot(n) / area_sq).clamp(0.0, 1.0 - second);
        Vec2::new(second as f32, third as f32)
    }
}

/// The value at a point of a triangle of an attribute that the vertices have.
pub(crate) fn blend<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(
    mesh: &TriangleMesh,
    values: &[T],
    triangle: u32,
    weights: Vec2,
) -> T {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|vertex| values[vertex as usize]);
    a * (1.0 - weights.x - weights.y) + b * weights.x + c * weights.y
}

impl RayScene {
    /// The mesh that a point lies on, its triangle in the world, and the weights of the second and third vertex.
    fn on_triangle(&self, point: &SurfacePoint) -> Option<(&TriangleMesh, WorldTriangle, Vec2)> {
        let instance = &self.instances[point.instance as usize];
        let Prepared::Mesh { mesh, tree } = &self.geometries[instance.geometry as usize] else {
            return None;
        };
        let triangle = WorldTriangle::new(&instance.at(point.time), mesh, point.primitive, tree.is_none());
        let weights = triangle.weights(point.p.as_dvec3());
        Some((mesh, triangle, weights))
    }

    /// Texture coordinates of a surface point in one of the sets of its mesh.
    ///
    /// - `set`: from 0; one that is not there, and every one of a shape, is the first.
    ///
    /// # Panics
    ///
    /// When the point is not of this scene.
    #[must_use]
    pub fn uv_set(&self, point: &SurfacePoint, set: u32) -> Vec2 {
        if set == 0 {
            return point.uv;
        }
        let found = self
            .on_triangle(point)
            .and_then(|(mesh, _, weights)| Some(blend(mesh, mesh.uv_set(set)?, point.primitive, weights)));
        found.unwrap_or(point.uv)
    }

    /// Colour and coverage of the vertices at a surface point; one where the geometry has none.
    ///
    /// # Panics
    ///
    /// When the point is not of this scene.
    #[must_use]
    pub fn vertex_colour(&self, point: &SurfacePoint) -> Vec4 {
        let found = self
            .on_triangle(point)
            .and_then(|(mesh, _, weights)| Some(blend(mesh, mesh.colours.as_deref()?, point.primitive, weights)));
        found.unwrap_or(Vec4::ONE)
    }

    /// How a surface point moves in world space as its texture coordinates grow: dp/du and dp/dv, metres.
    ///
    /// On a mesh they are those of the triangle, so they jump from one to the next.
    ///
    /// - `set`: the set of texture coordinates, from 0.
    /// - returns `None` where the mesh has no such set, or the coordinates of the triangle enclose no area; and at the
    ///   poles of a sphere.
    ///
    /// # Panics
    ///
    /// When the point is not of this scene.
    #[must_use]
    pub fn tangents(&self, point: &SurfacePoint, set: u32) -> Option<(DVec3, DVec3)> {
        let instance = &self.instances[point.instance as usize];
        if let Prepared::Solid(solid) = &self.geometries[instance.geometry as usize] {
            let pose = &*instance.at(point.time);
            let local = pose.object_from_world.transform_point3(point.p.as_dvec3());
            let (dpdu, dpdv) = solid.tangents(point.primitive, local)?;
            let to_world = |v| pose.world_from_object.transform_vector3(v);
            return Some((to_world(dpdu), to_world(dpdv)));
        }
        let (mesh, triangle, _) = self.on_triangle(point)?;
        let uvs = mesh.uv_set(set)?;
        let [a, b, c] = mesh.triangles[point.primitive as usize].map(|vertex| uvs[vertex as usize].as_dvec2());
        let (along, across) = (b - a, c - a);
        let area = along.perp_dot(across);
        if area == 0.0 {
            return None;
        }
        let [p, q, r] = triangle.vertices;
        let (to_second, to_third) = (q - p, r - p);
        let dpdu = (to_second * across.y - to_third * along.y) / area;
        let dpdv = (to_third * along.x - to_second * across.x) / area;
        (dpdu.is_finite() && dpdv.is_finite()).then_some((dpdu, dpdv))
    }

    /// The mesh that an instance places; `None` for a shape.
    ///
    /// # Panics
    ///
    /// When there is no such instance.
    #[must_use]
    pub fn mesh(&self, instance: u32) -> Option<&TriangleMesh> {
        match &self.geometries[self.instances[instance as usize].geometry as usize] {
            Prepared::Solid(_) => None,
            Prepared::Mesh { mesh, .. } => Some(mesh),
        }
    }
}

impl SurfacePoint {
    /// The shading normal that a normal map says, world space, unit length, in the hemisphere of `ng`.
    ///
    /// - `dpdu`, `dpdv`: to the right and upward in the map, world space, of any length. They are made perpendicular to the
    ///   shading normal, and to each other; only the side of `dpdv` matters, so that mirrored maps keep their sense.
    /// - `tilt`: the normal in that frame, of any length; (0, 0, 1) leaves the shading normal as it is.
    #[must_use]
    pub fn tilted_normal(&self, dpdu: DVec3, dpdv: DVec3, tilt: Vec3) -> Vec3 {
        if tilt.x == 0.0 && tilt.y == 0.0 && tilt.z > 0.0 {
            return self.ns;
        }
        let n = self.ns.as_dvec3();
        let largest = dpdu.abs().max_element();
        let Some(right) = (dpdu / largest).reject_from_normalized(n).try_normalize() else {
            return self.ns;
        };
        let up = n.cross(right);
        let up = if up.dot(dpdv) < 0.0 { -up } else { up };
        let tilt = tilt.as_dvec3();
        match (right * tilt.x + up * tilt.y + n * tilt.z).try_normalize() {
            Some(tilted) => above_horizon(tilted, self.ng.as_dvec3()),
            None => self.ns,
        }
    }
}
