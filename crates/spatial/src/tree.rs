//! Builds bounding volume hierarchies and prepares rays to walk them.

use crate::triangle::TriangleRay;
use crate::{Bounds, median_split};
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use radiometry::hash_u64;

/// A hierarchy over boxes, whose leaves are runs of `order`.
#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) bvh: CwBvh,
    /// Around all boxes, unpadded.
    pub(crate) bounds: Bounds,
    center: DVec3,
    /// Of a sphere around all boxes.
    radius: f64,
}

/// The share of the tree's extent by which boxes grow, so that rounding in the slab test never misses what touches
/// their faces: the test is good to 4 half-units in the last place of the distance from the origin, which [`Tree::ray`]
/// keeps below 8 radii.
const PADDING: f64 = 1.0 / (1 << 19) as f64;

/// Distance, in radii, beyond which an origin is moved along its ray up to the tree.
const FAR: f64 = 6.0;

/// Direction components smaller than this are treated as this in slab tests, where they would divide by zero.
const MIN_DIRECTION: f64 = 1.0 / (1_u64 << 40) as f64;

/// A ray in the space of a tree, in the forms that its parts need.
pub(crate) struct TreeRay {
    /// For the nodes: distances times `scale`.
    pub(crate) nodes: obvhs::ray::Ray,
    /// For the triangles.
    pub(crate) triangles: TriangleRay,
    /// How far the origin was moved along the ray.
    pub(crate) shift: f64,
}

impl Tree {
    /// Builds a tree and returns it with the order in which its leaves name the boxes.
    ///
    /// Deterministic: single-threaded, ties broken by position.
    pub(crate) fn build(boxes: &[Bounds]) -> (Self, Vec<u32>) {
        let bounds = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        let (low, high) = if bounds.is_empty() {
            (DVec3::ZERO, DVec3::ZERO)
        } else {
            (bounds.min.as_dvec3(), bounds.max.as_dvec3())
        };
        let radius = ((high - low).length() * 0.5).max(f64::from(f32::MIN_POSITIVE));
        // Coordinates have a last place of their own, which the padding must reach at least.
        let coordinate = low.abs().max(high.abs()).max_element();
        let pad = radius * PADDING + coordinate * f64::from(f32::EPSILON);
        let padded: Vec<Aabb> = boxes
            .iter()
            .map(|b| {
                let grown = Bounds::around(b.min.as_dvec3() - pad, b.max.as_dvec3() + pad);
                Aabb::new(Vec3A::from(grown.min), Vec3A::from(grown.max))
            })
            .collect();
        let mut bvh = build_cwbvh(&padded);
        let order = std::mem::take(&mut bvh.primitive_indices);
        let tree = Self {
            bvh,
            bounds,
            center: (low + high) * 0.5,
            radius,
        };
        (tree, order)
    }

    /// The power of two by which distances are multiplied while nodes are walked.
    ///
    /// The node test of obvhs drops boxes that end before a distance of 10⁻⁴, which would be a large part of a small
    /// scene. In these units that is 10⁻¹⁶ of the tree, and as a power of two the scale costs no precision.
    pub(crate) fn distance_scale(&self) -> f32 {
        let exponent = ((self.radius as f32).to_bits() >> 23) as i32 - 127;
        let scaled = (40 - exponent).clamp(-80, 80);
        f32::from_bits(((scaled + 127) as u32) << 23)
    }

    /// Brings a ray into the forms that a walk needs.
    ///
    /// - `o`, `d`: in the tree's space; `d` of any length, in which distances are counted.
    /// - `exact`: whether single precision holds `o` without rounding.
    /// - `t_max`: in lengths of `d`.
    /// - returns `None` when the ray ends before the tree, or is not finite.
    #[inline(always)]
    pub(crate) fn ray(&self, o: DVec3, d: DVec3, exact: bool, t_max: f64, scale: f32) -> Option<TreeRay> {
        let to_center = self.center - o;
        let mut origin = o;
        let mut shift = 0.0;
        let mut exact = exact;
        if to_center.length_squared() > (FAR * self.radius) * (FAR * self.radius) {
            // From far off, rounding would outgrow the padding: start shortly before the tree instead.
            let d_sq = d.length_squared();
            shift = (to_center.dot(d) - 2.0 * self.radius * d_sq.sqrt()) / d_sq;
            if !(shift >= 0.0) {
                // Pointing away, or no direction at all.
                return None;
            }
            if shift >= t_max {
                return None;
            }
            origin = o + d * shift;
            exact = false;
        }
        if !(origin.is_finite() && d.is_finite()) {
            return None;
        }
        let d32 = d.as_vec3();
        let smallest = (f64::from(d32.abs().max_element()) * MIN_DIRECTION) as f32;
        let apart = |x: f32| if x.abs() < smallest { smallest } else { x };
        let walked = Vec3A::new(apart(d32.x), apart(d32.y), apart(d32.z)) / scale;
        let origin32 = origin.as_vec3();
        let nodes = obvhs::ray::Ray {
            origin: Vec3A::from(origin32),
            direction: walked,
            inv_direction: Vec3A::ONE / walked,
            tmin: 0.0,
            tmax: ((t_max - shift) as f32) * scale,
        };
        let triangles = TriangleRay::new(origin32, d32, origin, d, exact, scale);
        Some(TreeRay {
            nodes,
            triangles,
            shift,
        })
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.bvh.nodes.capacity() * size_of::<obvhs::cwbvh::node::CwBvhNode>()
    }

    /// Checks that every one of `count` primitives lies in exactly one leaf.
    pub(crate) fn check_leaves(&self, count: usize) -> Result<(), String> {
        let mut seen = vec![0_u32; count];
        for node in &self.bvh.nodes {
            for child in (0..8).filter(|c| !node.is_child_empty(*c) && node.is_leaf(*c)) {
                let (first, n) = node.child_primitives(child);
                for id in first..first + n {
                    match seen.get_mut(id as usize) {
                        Some(times) => *times += 1,
                        None => return Err(format!("a leaf names primitive {id} of {count}")),
                    }
                }
            }
        }
        match seen.iter().position(|times| *times != 1) {
            Some(id) => Err(format!("primitive {id} lies in {} leaves", seen[id])),
            None => Ok(()),
        }
    }

    /// Centres and half sizes of boxes that together contain everything: those of the children of the root's children.
    pub(crate) fn upper_boxes(&self) -> Vec<(DVec3, DVec3)> {
        let mut boxes = Vec::new();
        let mut open = vec![(0_usize, 0_u32)];
        while let Some((index, level)) = open.pop() {
            let Some(node) = self.bvh.nodes.get(index) else {
                continue;
            };
            for child in (0..8).filter(|c| !node.is_child_empty(*c)) {
                if level == 0 && !node.is_leaf(child) {
                    open.push((node.child_node_index(child) as usize, level + 1));
                    continue;
                }
                let b = node.child_aabb(child);
                let (low, high) = (b.min.as_dvec3(), b.max.as_dvec3());
                boxes.push(((low + high) * 0.5, (high - low) * 0.5));
            }
        }
        boxes
    }

    /// Levels of the tree, which walks hold on a stack of 32.
    pub(crate) fn depth(&self) -> usize {
        depth(&self.bvh)
    }
}

/// The deepest tree that a walk can take.
pub(crate) const MAX_DEPTH: usize = 31;

/// As many boxes in the same place make clustering take quadratic time, and its trees as deep as they are many.
const MOST_IN_ONE_PLACE: usize = 64;

fn build_cwbvh(boxes: &[Aabb]) -> CwBvh {
    if boxes.is_empty() {
        return CwBvh::default();
    }
    let params = BvhBuildParams::medium_build();
    let widen = |binary: &Bvh2| bvh2_to_cwbvh(binary, params.max_prims_per_leaf.clamp(1, 3), true, false);
    let mut bvh = None;
    if most_in_one_place(boxes) <= MOST_IN_ONE_PLACE {
        let indices = (0..boxes.len() as u32).collect();
        let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
            params.ploc_search_distance,
            boxes,
            indices,
            params.sort_precision,
            params.search_depth_threshold,
        );
        ReinsertionOptimizer::default().run(&mut binary, params.reinsertion_batch_ratio, None);
        if binary_depth(&binary) <= MAX_BINARY_DEPTH {
            bvh = Some(widen(&binary)).filter(|wide| depth(wide) <= MAX_DEPTH);
        }
    }
    let mut bvh = bvh.unwrap_or_else(|| widen(&median_split::build(boxes)));
    bvh.nodes.shrink_to_fit();
    bvh
}

/// Size of the largest group of equal boxes (of equal hashes, to be exact: a collision only costs quality).
fn most_in_one_place(boxes: &[Aabb]) -> usize {
    let hash = |b: &Aabb| {
        let mix = |h: u64, x: f32| hash_u64(h ^ u64::from(x.to_bits()));
        b.min.to_array().into_iter().chain(b.max.to_array()).fold(0, mix)
    };
    let mut hashes: Vec<u64> = boxes.iter().map(hash).collect();
    hashes.sort_unstable();
    hashes.chunk_by(|a, b| a == b).map(<[u64]>::len).max().unwrap_or(0)
}

/// Deeper binary trees are not converted: obvhs does that by recursion.
const MAX_BINARY_DEPTH: usize = 256;

fn binary_depth(tree: &Bvh2) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = &tree.nodes[index];
        if !node.is_leaf() {
            open.extend([
                (node.first_index as usize, level + 1),
                (node.first_index as usize + 1, level + 1),
            ]);
        }
    }
    deepest
}

fn depth(bvh: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, level)) = open.pop() {
        let Some(node) = bvh.nodes.get(index) else { continue };
        deepest = deepest.max(level);
        for child in 0..8 {
            if !node.is_child_empty(child) && !node.is_leaf(child) {
                open.push((node.child_node_index(child) as usize, level + 1));
            }
        }
    }
    deepest
}

/// Box around three points.
pub(crate) fn triangle_bounds(vertices: [Vec3; 3]) -> Bounds {
    vertices.iter().fold(Bounds::EMPTY, |all, v| all.extend(*v))
}
