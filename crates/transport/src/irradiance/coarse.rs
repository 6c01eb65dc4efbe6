use super::IrradianceRecord;
use super::interpolate::error_at;
use spatial::{Bounds, RecordOctree, RecordOctreeError};

/// Records of the subset hold so many times as far as others.
const WIDER: f32 = 3.0;

/// Least 1/a of the subset, so that no record reaches around a corner.
const LEAST_WEIGHT: f32 = 3.0;

/// A record is in the subset where none of it is within this share of the error at which it still counts.
const COVERED_SHARE: f32 = 0.7;

/// A subset of the records, sparse and wide, for rays of other records to read where they end.
///
/// A ray's end is one of a thousand that make a record, so blur does no harm there, and few records make it quick. Without it the
/// light of many reflections comes from single paths, which are much noisier than the mean of the records that they would meet.
///
/// Source: Ward's Radiance, whose deeper reflections read the same cache with less accuracy.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    /// 1/a of the subset.
    pub(super) min_weight: f32,
    octree: RecordOctree,
    /// Number of the record in each row of the octree.
    numbers: Vec<u32>,
}

impl Coarse {
    pub(super) fn new(min_weight: f32, bounds: &Bounds, cell_records: usize) -> Self {
        let min_weight = min_weight.max(1.0);
        Self {
            min_weight: (min_weight / WIDER).max(LEAST_WEIGHT).min(min_weight),
            octree: RecordOctree::new(bounds, cell_records),
            numbers: Vec::new(),
        }
    }

    /// Takes up those records from row `first` on whose places the subset says nothing of.
    pub(super) fn insert(&mut self, records: &[IrradianceRecord], first: usize) -> Result<(), RecordOctreeError> {
        for (number, record) in (first as u32..).zip(&records[first..]) {
            let covers = |other: &IrradianceRecord| {
                error_at(other, record.position, record.normal, self.min_weight, true)
                    .is_some_and(|error| error < COVERED_SHARE)
            };
            if self.candidates(record.position, records).any(covers) {
                continue;
            }
            self.octree
                .insert(record.position, record.effective_range() / self.min_weight)?;
            self.numbers.push(number);
        }
        Ok(())
    }

    /// Records of the subset that may hold at a place.
    #[inline]
    pub(super) fn candidates<'a>(
        &'a self,
        position: glam::Vec3,
        records: &'a [IrradianceRecord],
    ) -> impl Iterator<Item = &'a IrradianceRecord> {
        let number = |row: u32| self.numbers[row as usize] as usize;
        self.octree.candidates(position).map(move |row| &records[number(row)])
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.octree.memory_bytes() + self.numbers.capacity() * size_of::<u32>()
    }
}
