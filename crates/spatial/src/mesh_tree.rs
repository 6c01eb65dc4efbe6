//! The tree of a mesh that several instances share.

use crate::query::Inner;
use crate::tree::{Tree, triangle_bounds};
use crate::triangle::Slot;
use crate::{Bounds, TriangleMesh};
use glam::{DAffine3, DVec3};
use obvhs::ray::RayHit as NodeHit;

/// Triangles in object space, stored once however often they are placed.
#[derive(Debug)]
pub(crate) struct MeshTree {
    pub(crate) tree: Tree,
    pub(crate) slots: Vec<Slot>,
    /// Boxes around parts of the mesh, for bounds under transforms: centre and half size of each.
    parts: Vec<(DVec3, DVec3)>,
}

impl MeshTree {
    pub(crate) fn build(mesh: &TriangleMesh) -> Self {
        let vertices = |t: usize| mesh.triangles[t].map(|v| mesh.positions[v as usize]);
        let boxes: Vec<Bounds> = (0..mesh.triangles.len())
            .map(|t| triangle_bounds(vertices(t)))
            .collect();
        let (tree, order) = Tree::build(&boxes);
        let slots = order
            .iter()
            .map(|t| Slot::triangle(vertices(*t as usize), 0, *t))
            .collect();
        Self {
            parts: tree.upper_boxes(),
            tree,
            slots,
        }
    }

    /// Corners of a box around the mesh under a transform.
    ///
    /// From the boxes two levels down, so that it costs as little for a million triangles as for a hundred, and is
    /// hardly larger than the tightest box even for a mesh that is turned. `None` without triangles.
    pub(crate) fn bounds(&self, m: &DAffine3) -> Option<(DVec3, DVec3)> {
        let axes = m.matrix3;
        let around = |(center, half): &(DVec3, DVec3)| {
            let center = m.transform_point3(*center);
            let reach = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
            (center - reach, center + reach)
        };
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        self.parts.iter().map(around).reduce(join)
    }

    /// Scaled distance at which a ray in object space meets the mesh; infinity when it does not.
    pub(crate) fn intersect(&self, o: DVec3, d: DVec3, limit: f64, scale: f32, t_max: f32, inner: &mut Inner) -> f32 {
        let Some(prepared) = self.tree.ray(o, d, false, limit, scale) else {
            return f32::INFINITY;
        };
        let mut nearest = NodeHit::none();
        let hit = self.tree.bvh.ray_traverse(prepared.nodes, &mut nearest, |nodes, id| {
            self.slots[id].intersect(&prepared.triangles, nodes.tmax)
        });
        if !hit {
            return f32::INFINITY;
        }
        let t = ((f64::from(nearest.t / scale) + prepared.shift) as f32) * scale;
        if t < t_max {
            let slot = &self.slots[nearest.primitive_id as usize];
            *inner = Inner {
                primitive: slot.primitive(),
                uv: slot.barycentrics(&prepared.triangles),
            };
        }
        t
    }

    /// Whether a ray in object space meets the mesh before `limit`.
    pub(crate) fn occluded(&self, o: DVec3, d: DVec3, limit: f64, scale: f32) -> bool {
        let Some(prepared) = self.tree.ray(o, d, false, limit, scale) else {
            return false;
        };
        !self.tree.bvh.ray_traverse_miss(prepared.nodes, |nodes, id| {
            self.slots[id].intersect(&prepared.triangles, nodes.tmax)
        })
    }
}
