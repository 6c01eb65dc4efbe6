//! The photon tree: the nearest photons to a point, for density estimates.
//!
//! A k-d tree cut at medians, its leaves buckets of 32 photons. Buckets are full but for the last, and nodes have four children at computed places, so the shape follows from the number of photons and no pointer is stored: positions and rows take 16 bytes a photon, nodes 1.2.
//!
//! Photons stand in *query order*: neighbours in space are neighbours in memory. A place in that order is a *slot*, and queries answer with slots. Whoever needs flux and direction copies those columns to query order once ([`PhotonTree::in_query_order`]) and indexes them by slot; [`PhotonTree::rows`] leads back to the rows of the input.
//!
//! What is found depends on the positions and the query alone: of photons at one distance the smaller row is nearer, medians are by coordinate and then row, threads share the work at fixed splits, and no order is left to a library's unstable sort. Pruning is exact in `f32` (see `Node::distances_sq`).
//!
//! There is no insertion and no removal: whoever changes photons rebuilds. What the photons are worth, and hence any estimate, is none of this module's business.

mod build;
mod nearest;
mod node;
mod scratch;
mod search;
#[cfg(test)]
mod tests;
mod validate;

use glam::Vec3;

use node::{BUCKET, Bucket, Node};
pub use scratch::{Nearest, NearestScratch, Neighbour};
pub use validate::InvalidPhotonTree;

/// A k-d tree over photon positions, which answers with slots in query order.
///
/// ```
/// use glam::Vec3;
/// use spatial::{NearestScratch, PhotonTree};
///
/// let positions = [Vec3::X, Vec3::ZERO, Vec3::Y * 3.0];
/// let flux = [1.0, 2.0, 4.0];
///
/// let tree = PhotonTree::build(&positions)?;
/// let mut flux_by_slot = Vec::new();
/// tree.in_query_order(&flux, &mut flux_by_slot);
///
/// let mut scratch = NearestScratch::new();
/// let nearest = tree.nearest(Vec3::ZERO, 2, f32::INFINITY, &mut scratch);
/// assert_eq!(nearest.kth().map(|photon| photon.dist_sq), Some(1.0));
/// let inside: f32 = nearest.inside().map(|photon| flux_by_slot[photon.slot as usize]).sum();
/// assert_eq!(inside, 2.0);
/// # Ok::<(), spatial::PhotonTreeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PhotonTree {
    /// Positions in query order.
    buckets: Vec<Bucket>,
    /// Input row by slot.
    rows: Vec<u32>,
    /// Inner nodes, the lowest level first, the root last. Child `lane` of node `i` of a level is number `4 i + lane` of the level below.
    nodes: Vec<Node>,
    /// Where each level starts in `nodes`.
    levels: Vec<usize>,
}

/// Why a photon tree cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PhotonTreeError {
    /// A coordinate is infinite or not a number, and so has no place in a tree.
    #[error("the position of photon {row} is not finite; such photons must not be stored")]
    NotFinite {
        /// The first such row.
        row: u32,
    },
    /// Rows and slots are `u32`, and one value is kept free.
    #[error("{len} photons are more than a tree holds ({}); trace fewer", u32::MAX - 1)]
    TooMany {
        /// How many photons there are.
        len: usize,
    },
}

impl PhotonTree {
    /// Builds the tree of photons at these positions; a photon's row is its place in the slice.
    ///
    /// Source: medians along the widest axis after Friedman, Bentley, Finkel, ACM TOMS 1977.
    ///
    /// # Errors
    ///
    /// A position that is not finite; more than `u32::MAX - 1` of them.
    ///
    /// Cost: O(N log N) on the current rayon pool, 16 bytes a photon besides the tree. Deterministic whatever the number of threads.
    pub fn build(positions: &[Vec3]) -> Result<Self, PhotonTreeError> {
        Self::from_fn(positions.len(), |row| positions[row])
    }

    /// Builds the tree of `len` photons whose positions are returned by row, which spares copying them out of larger records.
    ///
    /// - `position`: called once for each row below `len`, in any order and from several threads.
    ///
    /// # Errors
    ///
    /// As [`PhotonTree::build`].
    pub fn from_fn(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> Result<Self, PhotonTreeError> {
        build::build(len, position)
    }

    /// Returns the number of photons.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns whether there are no photons.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the permutation to query order: the input row by slot.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Returns the position of the photon in a slot, bit for bit as given.
    ///
    /// # Panics
    ///
    /// If `slot` is far beyond the number of photons; just beyond it, the position is NaN.
    pub fn position(&self, slot: u32) -> Vec3 {
        let slot = slot as usize;
        self.buckets[slot / BUCKET].position(slot % BUCKET)
    }

    /// Copies a column from row order to query order, to be indexed by slot.
    ///
    /// - `out`: is replaced; its memory is reused.
    ///
    /// # Panics
    ///
    /// If `column` has fewer rows than the tree has photons.
    pub fn in_query_order<T: Copy>(&self, column: &[T], out: &mut Vec<T>) {
        out.clear();
        out.extend(self.rows.iter().map(|&row| column[row as usize]));
    }

    /// Returns the memory of the tree in bytes, about 17.2 a photon.
    pub fn memory_bytes(&self) -> usize {
        self.buckets.capacity() * size_of::<Bucket>()
            + self.rows.capacity() * size_of::<u32>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.levels.capacity() * size_of::<usize>()
            + size_of::<Self>()
    }
}
