//! The structure check, for tests and for hunting errors.

use super::{MOST_LEVELS, NO_CHILD, RecordOctree, child_centre};
use glam::Vec3;

/// What is wrong with a [`RecordOctree`]: always an error in this crate, never in its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidRecordOctree {
    /// A leaf and the nodes above it lack a record whose sphere overlaps the leaf or have one twice, or the leaf has one
    /// that does not overlap it.
    #[error("leaf {node} has not just the records that overlap it")]
    Rows {
        /// Index of the node.
        node: usize,
    },
    /// A node has children that do not exist.
    #[error("node {node} has children that do not exist")]
    Children {
        /// Index of the node.
        node: usize,
    },
    /// A node lies deeper than any may.
    #[error("node {node} lies too deep")]
    Depth {
        /// Index of the node.
        node: usize,
    },
    /// Nodes that no way leads to, or a wrong count of rows.
    #[error("the octree has {found} nodes and rows in reach, and counts {counted}")]
    Count {
        /// What a walk through the tree found.
        found: usize,
        /// What the tree says.
        counted: usize,
    },
}

impl RecordOctree {
    /// Checks every invariant of the structure.
    ///
    /// # Errors
    /// The first violation found.
    ///
    /// Cost: O(leaves × records).
    pub fn validate(&self) -> Result<(), InvalidRecordOctree> {
        let (mut nodes, mut places) = (0, 0);
        let mut open = vec![(0_usize, self.centre, self.half, 0_u32, Vec::new())];
        while let Some((node, centre, half, level, mut above)) = open.pop() {
            nodes += 1;
            if level > MOST_LEVELS + 1 {
                return Err(InvalidRecordOctree::Depth { node });
            }
            let cell = &self.nodes[node];
            places += cell.rows.len();
            if cell.children == NO_CHILD {
                self.validate_leaf(node, centre, half, &above)?;
                continue;
            }
            above.extend(&cell.rows);
            let first = cell.children as usize;
            if first + 8 > self.nodes.len() || first <= node {
                return Err(InvalidRecordOctree::Children { node });
            }
            let child = |octant: u32| {
                let middle = child_centre(centre, 0.5 * half, octant);
                (first + octant as usize, middle, 0.5 * half, level + 1, above.clone())
            };
            open.extend((0..8).map(child));
        }
        let (found, counted) = (nodes + places, self.nodes.len() + self.places);
        if found == counted {
            Ok(())
        } else {
            Err(InvalidRecordOctree::Count { found, counted })
        }
    }

    fn validate_leaf(&self, node: usize, centre: Vec3, half: f32, above: &[u32]) -> Result<(), InvalidRecordOctree> {
        let own = &self.nodes[node].rows;
        let mut held = vec![0_u8; self.len()];
        for row in own.iter().chain(above) {
            held[*row as usize] += 1;
        }
        let overlaps = |row: u32| self.spheres[row as usize].overlaps(centre, half);
        let is_sound = |row: u32| match held[row as usize] {
            0 => !overlaps(row),
            1 => true,
            _ => false,
        };
        if (0..self.len() as u32).all(is_sound) && own.iter().all(|row| overlaps(*row)) && own.is_sorted() {
            Ok(())
        } else {
            Err(InvalidRecordOctree::Rows { node })
        }
    }
}
