//! The scene as rays see it: one tree over everything, built once and then only read.

use crate::mesh_tree::MeshTree;
use crate::placed::Placed;
use crate::shapes::Solid;
use crate::tree::{MAX_DEPTH, Tree, triangle_bounds};
use crate::triangle::Slot;
use crate::{Bounds, Geometry, Instance, SpatialError, TriangleMesh};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Coordinates beyond this are refused, metres: squares and products of areas overflow in single precision long before
/// coordinates do, in the builder of the trees first of all.
pub const MOST_DISTANT: f32 = 1e15;

/// Geometry prepared for ray queries.
///
/// One tree in world space holds triangles, analytic shapes and instanced meshes side by side. A mesh with a single
/// instance lies in it triangle by triangle; a mesh with several, or one that moves, is stored once, in a tree of its own,
/// and rays are taken into its space. Queries are read-only and lock-free; share the scene between threads.
///
/// Deterministic: the same input yields the same bits.
#[derive(Debug)]
pub struct RayScene {
    pub(crate) tree: Tree,
    /// In the order of the tree's leaves.
    pub(crate) slots: Vec<Slot>,
    pub(crate) geometries: Vec<Prepared>,
    pub(crate) instances: Vec<Placed>,
    /// Factor on distances while the tree is walked.
    pub(crate) scale: f32,
}

/// A geometry in the form that queries need.
#[derive(Debug)]
pub(crate) enum Prepared {
    Solid(Arc<Solid>),
    Mesh {
        mesh: Arc<TriangleMesh>,
        /// Present when several instances share the mesh, or one that moves has it.
        tree: Option<Box<MeshTree>>,
    },
}

impl RayScene {
    /// Prepares geometries and their instances.
    ///
    /// - `geometries`: what instances name by row; unused ones cost nothing.
    /// - `instances`: hits name them by row.
    ///
    /// # Errors
    ///
    /// Those of [`SpatialError`]: singular or non-finite transforms, rows out of range, non-finite vertices, shapes
    /// without an extent, anything further than 10¹⁵ m from the origin.
    ///
    /// Cost: O(n log n) in triangles, about 1 µs each; single-threaded, deterministic.
    pub fn build(geometries: Vec<Geometry>, instances: Vec<Instance>) -> Result<Self, SpatialError> {
        let mut placed = Vec::with_capacity(instances.len());
        let mut uses = vec![0_u32; geometries.len()];
        for (row, instance) in instances.iter().enumerate() {
            placed.push(Placed::new(row, instance, geometries.len())?);
            uses[instance.geometry as usize] += 1;
        }
        for instance in placed.iter().filter(|instance| instance.moves()) {
            // A moving mesh stays in its own space, in a tree of its own.
            uses[instance.geometry as usize] += 1;
        }
        let prepared = prepare(geometries, &uses)?;
        let mut slots = Vec::new();
        let mut boxes = Vec::new();
        for (row, instance) in placed.iter_mut().enumerate() {
            let id = row as u32;
            let mut add = |slot: Slot, bounds: Bounds| {
                slots.push(slot);
                boxes.push(bounds);
                bounds
            };
            instance.bounds = match &prepared[instance.geometry as usize] {
                Prepared::Solid(solid) => add(Slot::other(id), around(instance.keys(), |m| Some(solid.bounds(m)))),
                Prepared::Mesh { mesh, tree: None } => {
                    let mut all = Bounds::EMPTY;
                    for (t, triangle) in mesh.triangles.iter().enumerate() {
                        let v = triangle.map(|v| instance.opening.world_vertex(mesh.positions[v as usize]));
                        all = all.union(&add(Slot::triangle(v, id, t as u32), triangle_bounds(v)));
                    }
                    all
                }
                Prepared::Mesh { tree: Some(tree), .. } => {
                    let bounds = around(instance.keys(), |m| tree.bounds(m));
                    if bounds.is_empty() {
                        bounds
                    } else {
                        add(Slot::other(id), bounds)
                    }
                }
            };
            if !instance.bounds.is_empty() && !instance.bounds.lies_within(MOST_DISTANT) {
                return Err(SpatialError::Overflow { instance: row });
            }
        }
        if slots.len() >= 1 << 31 {
            return Err(SpatialError::TooManyPrimitives { count: slots.len() });
        }
        let (tree, order) = Tree::build(&boxes);
        Ok(Self {
            scale: tree.distance_scale(),
            tree,
            slots: order.iter().map(|i| slots[*i as usize]).collect(),
            geometries: prepared,
            instances: placed,
        })
    }

    /// Box around everything, world space; empty for an empty scene.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.tree.bounds
    }

    /// Box around one instance, world space, over the time of the shutter; empty for a mesh without triangles. Tight, but for a mesh that several
    /// instances share: its box may be a few per cent larger.
    ///
    /// # Panics
    ///
    /// When there is no such instance.
    #[must_use]
    pub fn instance_bounds(&self, instance: u32) -> Bounds {
        self.instances[instance as usize].bounds
    }

    /// True when an instance moves while the shutter is open.
    #[must_use]
    pub fn moves(&self, instance: u32) -> bool {
        self.instances[instance as usize].moves()
    }

    /// How many instances there are.
    #[must_use]
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }

    /// Memory of trees and prepared geometry, the meshes that are shared with the caller included.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let geometry = |g: &Prepared| match g {
            Prepared::Solid(_) => size_of::<Solid>(),
            Prepared::Mesh { mesh, tree } => {
                let uv_sets = mesh.more_uvs.len() + usize::from(mesh.uvs.is_some());
                let vertex = 12
                    + mesh.normals.as_ref().map_or(0, |_| 12)
                    + mesh.colours.as_ref().map_or(0, |_| 16)
                    + 8 * uv_sets;
                let own = mesh.positions.len() * vertex + mesh.triangles.len() * 12;
                own + tree
                    .as_ref()
                    .map_or(0, |t| t.tree.memory_bytes() + t.slots.len() * size_of::<Slot>())
            }
        };
        self.tree.memory_bytes()
            + self.slots.len() * size_of::<Slot>()
            + self.instances.len() * size_of::<Placed>()
            + self.geometries.iter().map(geometry).sum::<usize>()
    }

    /// Checks the invariants of the trees: every primitive in exactly one leaf, depth within the stack of a walk.
    ///
    /// # Errors
    ///
    /// What does not hold. For tests: [`RayScene::build`] never yields such a scene.
    pub fn validate(&self) -> Result<(), String> {
        let trees = self.geometries.iter().filter_map(|g| match g {
            Prepared::Mesh { tree: Some(t), .. } => Some((&t.tree, t.slots.len())),
            _ => None,
        });
        for (tree, slots) in trees.chain([(&self.tree, self.slots.len())]) {
            if tree.depth() > MAX_DEPTH {
                return Err(format!("a tree of {} levels, more than {MAX_DEPTH}", tree.depth()));
            }
            tree.check_leaves(slots)?;
        }
        Ok(())
    }
}

/// A box around a geometry under each of some transforms. As points move in straight lines from one to the next, it holds
/// all that is between.
fn around(keys: &[DAffine3], bounds: impl Fn(&DAffine3) -> Option<(DVec3, DVec3)>) -> Bounds {
    keys.iter()
        .filter_map(bounds)
        .fold(Bounds::EMPTY, |all, (low, high)| all.union(&Bounds::around(low, high)))
}

fn prepare(geometries: Vec<Geometry>, uses: &[u32]) -> Result<Vec<Prepared>, SpatialError> {
    let prepare_one = |(row, geometry): (usize, Geometry)| match geometry {
        Geometry::Shape(shape) => match Solid::new(&shape) {
            Ok(solid) => Ok(Prepared::Solid(Arc::new(solid))),
            Err(reason) => Err(SpatialError::InvalidShape { geometry: row, reason }),
        },
        Geometry::Mesh(mesh) => {
            mesh.check(row)?;
            if mesh.triangles.len() >= 1 << 31 {
                return Err(SpatialError::TooManyPrimitives {
                    count: mesh.triangles.len(),
                });
            }
            let tree = (uses[row] > 1).then(|| Box::new(MeshTree::build(&mesh)));
            Ok(Prepared::Mesh { mesh, tree })
        }
    };
    geometries.into_iter().enumerate().map(prepare_one).collect()
}
