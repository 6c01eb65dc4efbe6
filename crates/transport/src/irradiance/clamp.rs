use super::IrradianceRecord;
use spatial::{Bounds, RecordOctree, RecordOctreeError};
use std::collections::VecDeque;

/// Records in each other's range, so that ranges can be lowered to what neighbours have found.
///
/// Rays of a record may miss a small thing that those of a neighbour met. By the triangle inequality nothing is further from
/// a place than from a neighbour and the way there: `r_i ≤ r_j + s |x_i − x_j|`, where s is one if ranges are distances.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    /// Over spheres of ranges as they were when records came, each divided by the slope: further out no range is lowered.
    octree: RecordOctree,
    /// s: by how much a range may grow with the distance.
    slope: f32,
}

/// Records of a leaf before it is cut; ranges overlap by the hundred.
const CELL_RECORDS: usize = 64;

impl Neighbours {
    pub(super) fn new(bounds: &Bounds, slope: f32) -> Self {
        Self {
            octree: RecordOctree::new(bounds, CELL_RECORDS),
            slope,
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.octree.memory_bytes()
    }

    /// Adds records whose ranges are as they should be.
    pub(super) fn add(&mut self, records: &[IrradianceRecord]) -> Result<(), RecordOctreeError> {
        for record in records {
            self.octree.insert(record.position, record.range / self.slope)?;
        }
        Ok(())
    }

    /// Adds the records from row `first` on, and lowers ranges until nothing changes any more.
    ///
    /// Looked at are those in whose range a new record lies. An old one that lies in the range of a new one, but not the other
    /// way round, is left to the records between the two.
    ///
    /// Cost: for each new record those in whose range it lies, a few hundred.
    pub(super) fn lower_ranges(
        &mut self,
        records: &mut [IrradianceRecord],
        first: usize,
    ) -> Result<(), RecordOctreeError> {
        self.add(&records[first..])?;
        let mut open: VecDeque<u32> = (first as u32..records.len() as u32).collect();
        let mut is_open = vec![false; records.len()];
        is_open[first..].fill(true);
        while let Some(row) = open.pop_front() {
            is_open[row as usize] = false;
            let IrradianceRecord {
                position, mut range, ..
            } = records[row as usize];
            // Those in whose range it lies: they lower it, and it lowers them.
            for other in self.octree.containing(position) {
                let distance = records[other as usize].position.distance(position);
                range = range.min(records[other as usize].range + self.slope * distance);
            }
            records[row as usize].range = range;
            for other in self.octree.containing(position) {
                let neighbour = &mut records[other as usize];
                let most = range + self.slope * neighbour.position.distance(position);
                if most < neighbour.range {
                    neighbour.range = most;
                    if !std::mem::replace(&mut is_open[other as usize], true) {
                        open.push_back(other);
                    }
                }
            }
        }
        Ok(())
    }
}
