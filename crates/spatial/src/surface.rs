//! From a hit to the point on the surface: position refined, error bounded, normals, texture coordinates.

use crate::placed::{Pose, round_point};
use crate::ray_scene::Prepared;
use crate::{Bounds, Ray, RayHit, RayScene, SurfacePoint, TriangleMesh};
use glam::{DVec3, Vec2, Vec3};

/// A triangle of an instance, in world space and double precision.
pub(crate) struct WorldTriangle {
    pub(crate) vertices: [DVec3; 3],
    /// Twice the area vector, outward.
    pub(crate) area_vector: DVec3,
}

impl WorldTriangle {
    /// - `rounded`: whether the tree holds world-space vertices, rounded to single precision.
    pub(crate) fn new(pose: &Pose, mesh: &TriangleMesh, triangle: u32, rounded: bool) -> Self {
        let vertices = mesh.triangles[triangle as usize].map(|v| {
            let p = mesh.positions[v as usize];
            if rounded {
                pose.world_vertex(p).as_dvec3()
            } else {
                pose.world_from_object.transform_point3(p.as_dvec3())
            }
        });
        let [a, b, c] = vertices;
        let n = (b - a).cross(c - a);
        Self {
            vertices,
            area_vector: if pose.mirrored { -n } else { n },
        }
    }

    /// The point with these weights of the second and third vertex, rounded, and its error.
    pub(crate) fn point(&self, uv: Vec2) -> (Vec3, f32) {
        let [a, b, c] = self.vertices;
        let uv = uv.as_dvec2();
        let p = a + (b - a) * uv.x + (c - a) * uv.y;
        let magnitude = a.abs().max(b.abs()).max(c.abs()).max_element();
        round_point(p, magnitude)
    }

    pub(crate) fn bounds(&self) -> Bounds {
        self.vertices
            .iter()
            .fold(Bounds::EMPTY, |all, v| all.union(&Bounds::around(*v, *v)))
    }

    /// Unit normal; of a triangle without an area, an arbitrary one.
    pub(crate) fn normal(&self) -> Vec3 {
        unit(self.area_vector)
    }
}

/// Normalises, whatever the length; zero and NaN become +Z.
pub(crate) fn unit(v: DVec3) -> Vec3 {
    let largest = v.abs().max_element();
    (v / largest).try_normalize().unwrap_or(DVec3::Z).as_vec3()
}

/// Texture coordinates of a point of a triangle: the file's, else the barycentric weights.
pub(crate) fn mesh_uv(mesh: &TriangleMesh, triangle: u32, uv: Vec2) -> Vec2 {
    let Some(uvs) = &mesh.uvs else { return uv };
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| uvs[v as usize]);
    a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y
}

/// Interpolated shading normal, in the hemisphere of `ng`.
///
/// A triangle whose normals as a whole point backward has its winding against them: they are turned around. Where
/// interpolation alone carries a normal past the horizon, it is bent back to it.
fn mesh_normal(pose: &Pose, mesh: &TriangleMesh, triangle: u32, uv: Vec2, ng: Vec3) -> Vec3 {
    let Some(normals) = &mesh.normals else { return ng };
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| normals[v as usize].as_dvec3().normalize_or_zero());
    let ng = ng.as_dvec3();
    let weights = uv.as_dvec2();
    let blend = a * (1.0 - weights.x - weights.y) + b * weights.x + c * weights.y;
    let facing = pose.world_normal(a + b + c).dot(ng);
    let world = pose.world_normal(if facing < 0.0 { -blend } else { blend });
    let Some(ns) = (world / world.abs().max_element()).try_normalize() else {
        return ng.as_vec3();
    };
    above_horizon(ns, ng)
}

/// Bends a shading normal back to the horizon where it has sunk below; both unit length.
pub(crate) fn above_horizon(ns: DVec3, ng: DVec3) -> Vec3 {
    let cos = ns.dot(ng);
    if cos >= HORIZON {
        return ns.as_vec3();
    }
    unit(ns + ng * (HORIZON - cos))
}

/// Smallest cosine between shading and geometric normal.
const HORIZON: f64 = 1e-3;

impl RayScene {
    /// Works out the surface point of a hit: position, error bound, normals, texture coordinates.
    ///
    /// The position does not come from `ray.at(t)`, whose error grows with the distance: it is taken onto the surface
    /// in double precision and rounded once.
    ///
    /// - `ray`, `hit`: a ray and what [`RayScene::intersect`] returned for it.
    ///
    /// # Panics
    ///
    /// When the hit names an instance or a triangle that does not exist.
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &RayHit) -> SurfacePoint {
        let instance = &self.instances[hit.instance as usize];
        let pose = &*instance.at(ray.time);
        let (p, error, ng, ns, uv) = match &self.geometries[instance.geometry as usize] {
            Prepared::Solid(solid) => {
                let along = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t);
                let local = solid.project(pose.object_from_world.transform_point3(along), hit.primitive);
                let (p, error) = pose.world_point(local.p);
                let n = unit(pose.world_normal(local.n));
                (p, error, n, n, local.uv)
            }
            Prepared::Mesh { mesh, tree } => {
                let triangle = WorldTriangle::new(pose, mesh, hit.primitive, tree.is_none());
                let (p, error) = triangle.point(hit.uv);
                let ng = triangle.normal();
                let ns = mesh_normal(pose, mesh, hit.primitive, hit.uv, ng);
                (p, error, ng, ns, mesh_uv(mesh, hit.primitive, hit.uv))
            }
        };
        SurfacePoint {
            p,
            error,
            ng,
            ns,
            uv,
            instance: hit.instance,
            primitive: hit.primitive,
            time: ray.time,
        }
    }

    /// Area of an instance in world space, m², its transform when the shutter opens included; both sides of a surface
    /// count once.
    ///
    /// # Panics
    ///
    /// When there is no such instance.
    #[must_use]
    pub fn instance_area(&self, instance: u32) -> f64 {
        let placed = &self.instances[instance as usize];
        match &self.geometries[placed.geometry as usize] {
            Prepared::Solid(solid) => {
                let cofactor = placed.opening.cofactor();
                (0..solid.faces()).map(|face| solid.face_area(face, &cofactor)).sum()
            }
            Prepared::Mesh { mesh, tree } => (0..mesh.triangles.len() as u32)
                .map(|t| {
                    WorldTriangle::new(&placed.opening, mesh, t, tree.is_none())
                        .area_vector
                        .length()
                        * 0.5
                })
                .sum(),
        }
    }
}
