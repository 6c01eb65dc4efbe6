//! The two queries: the nearest hit, and whether there is any.

use crate::ray_scene::Prepared;
use crate::tree::TreeRay;
use crate::triangle::Slot;
use crate::{Ray, RayHit, RayScene};
use glam::{DVec3, Vec2};
use obvhs::ray::RayHit as NodeHit;

/// What a walk remembers of the nearest hit inside a shape or an instanced mesh.
#[derive(Clone, Copy, Default)]
pub(crate) struct Inner {
    pub(crate) primitive: u32,
    pub(crate) uv: Vec2,
}

impl RayScene {
    #[inline(always)]
    fn tree_ray(&self, ray: &Ray) -> Option<TreeRay> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        self.tree.ray(o, d, true, f64::from(ray.t_max), self.scale)
    }

    /// Finds the nearest surface that a ray meets at a distance in (0, `t_max`); both sides of surfaces count.
    ///
    /// Of several at the same distance, one: always the same. A ray that is not finite meets nothing.
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<RayHit> {
        let prepared = self.tree_ray(ray)?;
        let mut nearest = NodeHit::none();
        let mut inner = Inner::default();
        let hit = self.tree.bvh.ray_traverse(prepared.nodes, &mut nearest, |nodes, id| {
            let slot = &self.slots[id];
            if slot.is_triangle() {
                slot.intersect(&prepared.triangles, nodes.tmax)
            } else {
                self.intersect_other(slot, &prepared, ray.time, nodes.tmax, &mut inner)
            }
        });
        if !hit {
            return None;
        }
        let slot = &self.slots[nearest.primitive_id as usize];
        let (primitive, uv) = if slot.is_triangle() {
            (slot.primitive(), slot.barycentrics(&prepared.triangles))
        } else {
            (inner.primitive, inner.uv)
        };
        Some(RayHit {
            t: (f64::from(nearest.t / self.scale) + prepared.shift) as f32,
            instance: slot.instance(),
            primitive,
            uv,
        })
    }

    /// Answers whether a ray meets any surface at a distance in (0, `t_max`).
    ///
    /// Faster than [`RayScene::intersect`], for it stops at the first.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let Some(prepared) = self.tree_ray(ray) else {
            return false;
        };
        !self.tree.bvh.ray_traverse_miss(prepared.nodes, |nodes, id| {
            let slot = &self.slots[id];
            if slot.is_triangle() {
                slot.intersect(&prepared.triangles, nodes.tmax)
            } else if self.occluded_by_other(slot, &prepared, ray.time, nodes.tmax) {
                0.0
            } else {
                f32::INFINITY
            }
        })
    }

    /// Takes the ray into the space of the instance in a slot.
    #[inline]
    fn object_ray(&self, slot: &Slot, world: &TreeRay, time: f32) -> (&Prepared, DVec3, DVec3) {
        let instance = &self.instances[slot.instance() as usize];
        let pose = instance.at(time);
        let (o, d) = world.triangles.exact();
        (
            &self.geometries[instance.geometry as usize],
            pose.object_from_world.transform_point3(o),
            pose.object_from_world.transform_vector3(d),
        )
    }

    /// Meets the shape or instanced mesh in a slot; distances are scaled.
    #[inline(never)]
    fn intersect_other(&self, slot: &Slot, world: &TreeRay, time: f32, t_max: f32, inner: &mut Inner) -> f32 {
        let (geometry, o, d) = self.object_ray(slot, world, time);
        let limit = f64::from(t_max / self.scale);
        match geometry {
            Prepared::Solid(solid) => {
                let Some(hit) = solid.intersect(o, d, limit) else {
                    return f32::INFINITY;
                };
                let t = hit.t as f32 * self.scale;
                if t < t_max {
                    *inner = Inner {
                        primitive: hit.face,
                        uv: Vec2::ZERO,
                    };
                }
                t
            }
            Prepared::Mesh { tree: Some(mesh), .. } => mesh.intersect(o, d, limit, self.scale, t_max, inner),
            Prepared::Mesh { tree: None, .. } => f32::INFINITY,
        }
    }

    /// Whether the shape or instanced mesh in a slot is met within the scaled distance `t_max`.
    #[inline(never)]
    fn occluded_by_other(&self, slot: &Slot, world: &TreeRay, time: f32, t_max: f32) -> bool {
        let (geometry, o, d) = self.object_ray(slot, world, time);
        let limit = f64::from(t_max / self.scale);
        match geometry {
            // Rounded as in `intersect_other`, so that both queries agree on what is within the limit.
            Prepared::Solid(solid) => solid
                .intersect(o, d, limit)
                .is_some_and(|hit| (hit.t as f32 * self.scale) < t_max),
            Prepared::Mesh { tree: Some(mesh), .. } => mesh.occluded(o, d, limit, self.scale),
            Prepared::Mesh { tree: None, .. } => false,
        }
    }
}
