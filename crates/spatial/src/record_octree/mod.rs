//! The record octree: which spheres may hold a point, for caches of irradiance.
//!
//! A record is a sphere, the place where it holds. It is in every leaf that its sphere overlaps, so that a point asks one
//! leaf alone. A leaf with more records than `cell_records` is cut into eight where that separates any: not below the
//! smallest radius in it, not deeper than 24 levels, and not where the tree would hold more than 64 places a record. Once
//! it does, records stay in the node that they have come to, which points ask on their way to the leaf.
//!
//! The octree answers with rows, in the order of insertion. Spheres are stored once; what records are worth is none of
//! its business. The same insertions in the same order give the same tree. There is no removal: whoever changes records
//! builds anew, which takes microseconds a record.
//!
//! Source: Ward, Rubinstein and Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
//! Differs: they keep a record in the one node whose size fits it, and visit several nodes for each point.

#[cfg(test)]
mod tests;
mod validate;

use crate::Bounds;
use glam::Vec3;

pub use validate::InvalidRecordOctree;

/// Children that a record may be in, in the mean, for a leaf to be cut. Over a surface, which has four children of eight, at four
/// a child would have as many records as the leaf. Measured against just below eight: look-ups among 10,000 and 100,000 records take
/// 0.64 and 0.13 of the time, and the octree a quarter of the memory.
const MOST_COPIES: f32 = 2.5;

/// Levels below the root at most.
const MOST_LEVELS: u32 = 24;
/// Places in leaves that the tree holds for each record at most, beside those of [`FREE_PLACES`].
const PLACES_PER_RECORD: usize = 64;
/// Places that a tree of any size may have.
const FREE_PLACES: usize = 4096;
/// Spheres and root are this much larger for the test of overlap than they are, so that rounding loses none.
const SLACK: f32 = 1e-5;

/// Row of a node without children.
const NO_CHILD: u32 = u32::MAX;

/// An octree over spheres, which answers with their rows.
///
/// ```
/// use glam::Vec3;
/// use spatial::{Bounds, RecordOctree};
///
/// let room = Bounds { min: Vec3::ZERO, max: Vec3::splat(3.0) };
/// let mut octree = RecordOctree::new(&room, 8);
/// let near = octree.insert(Vec3::ONE, 0.5)?;
/// octree.insert(Vec3::splat(2.9), 0.1)?;
/// let found: Vec<u32> = octree.containing(Vec3::new(1.0, 1.0, 1.4)).collect();
/// assert_eq!(found, [near]);
/// # Ok::<(), spatial::RecordOctreeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RecordOctree {
    centre: Vec3,
    /// Half an edge of the root.
    half: f32,
    cell_records: usize,
    spheres: Vec<Sphere>,
    /// The root first; children stand together.
    nodes: Vec<Node>,
    /// Rows in all nodes together.
    places: usize,
}

/// Where a record holds.
#[derive(Clone, Copy, Debug)]
struct Sphere {
    position: Vec3,
    radius: f32,
}

/// A cell of the octree.
#[derive(Clone, Debug)]
struct Node {
    /// First of eight children, or [`NO_CHILD`].
    children: u32,
    /// Ascending; of a node with children only those that the tree had no room for in leaves.
    rows: Vec<u32>,
    /// Rows at which a leaf is to be cut: grows where cutting separated nothing.
    full_at: usize,
}

/// Why a record cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordOctreeError {
    /// A coordinate is infinite or not a number.
    #[error("the position of a record is not finite; such records must not be stored")]
    PositionNotFinite,
    /// A record that holds nowhere, or everywhere.
    #[error("the radius of a record must be positive and finite")]
    BadRadius,
    /// Its sphere lies outside of the box that the octree was made for.
    #[error("the record lies outside of the scene")]
    Outside,
    /// Rows are `u32`.
    #[error("there are more records than an octree holds ({})", u32::MAX - 1)]
    TooMany,
}

impl RecordOctree {
    /// An octree without records.
    ///
    /// - `bounds`: of the scene, metres; points outside of it find nothing. An empty box counts as one around the origin.
    /// - `cell_records`: records of a leaf before it is cut, at least 1. Fewer make finer cells.
    #[must_use]
    pub fn new(bounds: &Bounds, cell_records: usize) -> Self {
        let centre = bounds.center();
        let extent = if bounds.is_empty() {
            0.0
        } else {
            0.5 * (bounds.max - bounds.min).max_element()
        };
        let half = extent.max(centre.abs().max_element() * SLACK).max(f32::MIN_POSITIVE);
        let is_sound = centre.is_finite() && half.is_finite();
        let cell_records = cell_records.max(1);
        Self {
            centre: if is_sound { centre } else { Vec3::ZERO },
            half: if is_sound { half * (1.0 + 4.0 * SLACK) } else { 1e15 },
            cell_records,
            spheres: Vec::new(),
            nodes: vec![Node::leaf(Vec::new(), cell_records)],
            places: 0,
        }
    }

    /// Adds a record and returns its row: the number of those before it.
    ///
    /// - `position`: metres.
    /// - `radius`: metres, > 0.
    ///
    /// # Errors
    /// A sphere that is not finite, holds nothing, or lies outside of the box of the octree.
    ///
    /// Cost: a visit of every cell that the sphere overlaps.
    pub fn insert(&mut self, position: Vec3, radius: f32) -> Result<u32, RecordOctreeError> {
        self.accepts(position, radius)?;
        let row = self.spheres.len() as u32;
        self.spheres.push(Sphere { position, radius });
        self.insert_below(row, 0, self.centre, self.half, 0);
        Ok(row)
    }

    /// Whether [`RecordOctree::insert`] would take a record.
    ///
    /// # Errors
    /// As there.
    pub fn accepts(&self, position: Vec3, radius: f32) -> Result<(), RecordOctreeError> {
        if !position.is_finite() {
            return Err(RecordOctreeError::PositionNotFinite);
        }
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(RecordOctreeError::BadRadius);
        }
        if !(Sphere { position, radius }).overlaps(self.centre, self.half) {
            return Err(RecordOctreeError::Outside);
        }
        if self.spheres.len() >= u32::MAX as usize {
            return Err(RecordOctreeError::TooMany);
        }
        Ok(())
    }

    /// Number of records.
    #[must_use]
    pub fn len(&self) -> usize {
        self.spheres.len()
    }

    /// True when there are no records.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Rows of the records that may hold a point: all whose sphere contains it are among them, each once.
    ///
    /// Cost: O(depth), and as many rows as the leaf has.
    #[inline]
    pub fn candidates(&self, position: Vec3) -> impl Iterator<Item = u32> {
        // Also false for a point that is no number.
        let is_inside = (position - self.centre).abs().max_element() <= self.half;
        let mut cell = is_inside.then_some((&self.nodes[0], self.centre, self.half));
        let way = std::iter::from_fn(move || {
            let (node, centre, half) = cell?;
            cell = (node.children != NO_CHILD).then(|| {
                let octant = position.cmpge(centre).bitmask();
                let child = &self.nodes[(node.children + octant) as usize];
                (child, child_centre(centre, 0.5 * half, octant), 0.5 * half)
            });
            Some(&node.rows)
        });
        way.flatten().copied()
    }

    /// Rows of the records whose sphere contains a point.
    pub fn containing(&self, position: Vec3) -> impl Iterator<Item = u32> {
        let holds = move |row: &u32| {
            let sphere = &self.spheres[*row as usize];
            sphere.position.distance_squared(position) < sphere.radius * sphere.radius
        };
        self.candidates(position).filter(holds)
    }

    /// Memory in bytes, about.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let rows: usize = self.nodes.iter().map(|node| node.rows.capacity()).sum();
        self.nodes.capacity() * size_of::<Node>()
            + rows * size_of::<u32>()
            + self.spheres.capacity() * size_of::<Sphere>()
            + size_of::<Self>()
    }

    fn insert_below(&mut self, row: u32, node: usize, centre: Vec3, half: f32, level: u32) {
        let children = self.nodes[node].children;
        let has_room = self.places + 8 <= self.most_places();
        if children != NO_CHILD && has_room {
            let sphere = self.spheres[row as usize];
            for octant in 0..8 {
                let middle = child_centre(centre, 0.5 * half, octant);
                if sphere.overlaps(middle, 0.5 * half) {
                    self.insert_below(row, (children + octant) as usize, middle, 0.5 * half, level + 1);
                }
            }
            return;
        }
        let leaf = &mut self.nodes[node];
        leaf.rows.push(row);
        self.places += 1;
        if children == NO_CHILD && leaf.rows.len() > leaf.full_at {
            self.cut(node, centre, half, level);
        }
    }

    /// Places that the tree may have now.
    fn most_places(&self) -> usize {
        FREE_PLACES + PLACES_PER_RECORD * self.spheres.len()
    }

    /// Cuts a leaf into eight, and these again where they are full.
    fn cut(&mut self, node: usize, centre: Vec3, half: f32, level: u32) {
        let rows = std::mem::take(&mut self.nodes[node].rows);
        let smallest = rows.iter().map(|row| self.spheres[*row as usize].radius);
        let smallest = smallest.fold(f32::INFINITY, f32::min);
        let quarter = 0.5 * half;
        let shares: [Vec<u32>; 8] = std::array::from_fn(|octant| {
            let middle = child_centre(centre, quarter, octant as u32);
            let overlaps = |row: &u32| self.spheres[*row as usize].overlaps(middle, quarter);
            rows.iter().copied().filter(overlaps).collect()
        });
        let places = shares.iter().map(Vec::len).sum::<usize>();
        // Below a quarter of an ulp of the place, cells have no centre of their own.
        let is_resolved = quarter > centre.abs().max_element() * f32::EPSILON;
        let separates = places as f32 <= MOST_COPIES * rows.len() as f32 && 2.0 * half >= smallest && is_resolved;
        if !separates || level >= MOST_LEVELS || self.places + places - rows.len() > self.most_places() {
            let leaf = &mut self.nodes[node];
            leaf.full_at = rows.len().saturating_mul(2);
            leaf.rows = rows;
            return;
        }
        let Ok(first) = u32::try_from(self.nodes.len()) else {
            self.nodes[node].rows = rows;
            return;
        };
        self.places = self.places + places - rows.len();
        self.nodes[node].children = first;
        self.nodes
            .extend(shares.into_iter().map(|rows| Node::leaf(rows, self.cell_records)));
        for octant in 0..8_u32 {
            let child = (first + octant) as usize;
            if self.nodes[child].rows.len() > self.cell_records {
                let middle = child_centre(centre, quarter, octant);
                self.cut(child, middle, quarter, level + 1);
            }
        }
    }
}

impl Node {
    fn leaf(rows: Vec<u32>, full_at: usize) -> Self {
        Self {
            children: NO_CHILD,
            rows,
            full_at,
        }
    }
}

impl Sphere {
    /// True when it overlaps a cube, or nearly so.
    fn overlaps(&self, centre: Vec3, half: f32) -> bool {
        let offset = (self.position - centre).abs();
        let rounding = SLACK * (half + self.radius) + 4.0 * f32::EPSILON * self.position.abs().max_element();
        let outside = (offset - Vec3::splat(half)).max(Vec3::ZERO);
        let reach = self.radius + rounding;
        // Of what is very far away the squares are infinite, and tell nothing.
        outside.max_element() <= reach && outside.length_squared() <= reach * reach
    }
}

/// Centre of a child cell: bit k of `octant` is set where it lies on the upper side along axis k.
fn child_centre(centre: Vec3, half: f32, octant: u32) -> Vec3 {
    let side = |bit: u32| if octant >> bit & 1 == 1 { half } else { -half };
    centre + Vec3::new(side(0), side(1), side(2))
}
