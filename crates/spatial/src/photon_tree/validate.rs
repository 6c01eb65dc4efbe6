//! The structure check, for tests and for hunting errors.

use super::PhotonTree;
use super::node::{BUCKET, Bounds, Bucket, Node, WIDTH};

/// What is wrong with a [`PhotonTree`]: always an error in this crate, never in its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidPhotonTree {
    /// Buckets, nodes and levels do not have the sizes that follow from the number of photons.
    #[error("the sizes of the tree's arrays do not fit its number of photons")]
    Shape,
    /// The rows are not a permutation, or not ascending within a bucket.
    #[error("the row at slot {slot} is out of range, repeated or out of order")]
    Row {
        /// The first such slot.
        slot: u32,
    },
    /// A lane in use is not finite, or an unused one is not NaN.
    #[error("the position at slot {slot} is not what the number of photons requires")]
    Position {
        /// The first such slot.
        slot: u32,
    },
    /// A box is not the smallest around its photons, or its smallest row is wrong.
    #[error("the bounds of child {lane} of node {node} are not those of its photons")]
    Bounds {
        /// Index among the inner nodes.
        node: usize,
        /// Which of the four children.
        lane: usize,
    },
}

impl PhotonTree {
    /// Checks every invariant of the structure.
    ///
    /// # Errors
    ///
    /// The first violation found, buckets before nodes.
    ///
    /// Cost: O(N), allocates N bytes.
    pub fn validate(&self) -> Result<(), InvalidPhotonTree> {
        self.validate_shape()?;
        self.validate_rows()?;
        self.validate_positions()?;
        self.validate_bounds()
    }

    /// Returns the index of the first node above a level, which is where the level ends.
    fn level_end(&self, level: usize) -> usize {
        let next = self.levels.get(level + 1);
        next.copied().unwrap_or(self.nodes.len())
    }

    fn validate_shape(&self) -> Result<(), InvalidPhotonTree> {
        let mut sound = self.buckets.len() == self.len().div_ceil(BUCKET);
        let mut below = self.buckets.len();
        for (level, &start) in self.levels.iter().enumerate() {
            let count = self.level_end(level).checked_sub(start);
            sound &= count == Some(below.div_ceil(WIDTH));
            below = below.div_ceil(WIDTH);
        }
        sound &= self.levels.first() == Some(&0) && below == usize::from(!self.is_empty());
        sound.then_some(()).ok_or(InvalidPhotonTree::Shape)
    }

    fn validate_rows(&self) -> Result<(), InvalidPhotonTree> {
        let mut seen = vec![false; self.len()];
        for (slot, &row) in self.rows.iter().enumerate() {
            let fresh = seen
                .get_mut(row as usize)
                .is_some_and(|seen| !std::mem::replace(seen, true));
            let ascending = slot % BUCKET == 0 || self.rows[slot - 1] < row;
            if !(fresh && ascending) {
                return Err(InvalidPhotonTree::Row { slot: slot as u32 });
            }
        }
        Ok(())
    }

    fn validate_positions(&self) -> Result<(), InvalidPhotonTree> {
        for slot in 0..self.buckets.len() * BUCKET {
            let position = self.buckets[slot / BUCKET].position(slot % BUCKET);
            let sound = match slot < self.len() {
                true => position.is_finite(),
                false => position.is_nan_mask().all(),
            };
            if !sound {
                return Err(InvalidPhotonTree::Position { slot: slot as u32 });
            }
        }
        Ok(())
    }

    fn validate_bounds(&self) -> Result<(), InvalidPhotonTree> {
        for level in 0..self.levels.len() {
            let start = self.levels[level];
            for node in start..self.level_end(level) {
                for lane in 0..WIDTH {
                    let mut expected = Node::EMPTY;
                    if let Some((bounds, first_row)) = self.child(level, (node - start) * WIDTH + lane) {
                        expected.set(lane, bounds, first_row);
                    }
                    if !same_lane(&self.nodes[node], &expected, lane) {
                        return Err(InvalidPhotonTree::Bounds { node, lane });
                    }
                }
            }
        }
        Ok(())
    }

    /// Returns box and smallest row of a child of the given level by its index in the level below.
    fn child(&self, level: usize, index: usize) -> Option<(Bounds, u32)> {
        if let Some(below) = level.checked_sub(1) {
            let children = &self.nodes[self.levels[below]..self.levels[level]];
            let child = children.get(index)?;
            let first_row = child.first_row.into_iter().fold(u32::MAX, u32::min);
            Some((child.bounds(), first_row))
        } else {
            let bounds = self.buckets.get(index).map(Bucket::bounds)?;
            Some((bounds, *self.rows.get(index * BUCKET)?))
        }
    }
}

/// Returns whether two nodes say the same about a child; missing ones are alike.
fn same_lane(a: &Node, b: &Node, lane: usize) -> bool {
    let same = |a: f32, b: f32| a == b || (a.is_nan() && b.is_nan());
    a.first_row[lane] == b.first_row[lane]
        && (0..3).all(|axis| same(a.min[axis][lane], b.min[axis][lane]) && same(a.max[axis][lane], b.max[axis][lane]))
}
