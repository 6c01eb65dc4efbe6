use super::clamp::Neighbours;
use super::{ErrorMetric, IrradianceRecord};
use spatial::{Bounds, RecordOctree, RecordOctreeError};

/// How records are kept and read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CacheSettings {
    /// A record is made where none has more weight than this, ≥ 1.
    pub min_weight: f32,
    /// Records of a leaf of the octree before it is cut.
    pub cell_records: usize,
    /// Whether records are extrapolated by their gradients and weighed smoothly; else as by Ward, Rubinstein and Clear.
    pub gradients: bool,
    /// How ranges are found.
    pub metric: ErrorMetric,
    /// Whether records are asked if they hold behind walls and around corners, too; else they are taken to.
    pub validity: bool,
}

/// Extrapolated records are read so many times further than where no other is made beside them. Their weights fall smoothly, so
/// what counts is about as near as ever, but there are more of them: their noise is averaged.
const READ_WIDER: f32 = 1.8;

impl CacheSettings {
    /// 1/a of reading: records with less weight tell nothing.
    #[inline]
    #[must_use]
    pub fn read_weight(&self) -> f32 {
        let wider = if self.gradients { READ_WIDER } else { 1.0 };
        (self.min_weight / wider).max(1.0)
    }

    /// Distance within which a record is read, metres: by the range that was found. The least range counts no further than where no
    /// other record is made, or it would blur what is near a contact.
    #[inline]
    #[must_use]
    pub fn read_radius(&self, record: &IrradianceRecord) -> f32 {
        (record.range / self.read_weight()).max(record.least_range / self.min_weight)
    }
}

/// Records of irradiance and the octree over them.
///
/// A function of the records and the order in which they came.
#[derive(Clone, Debug)]
pub struct IrradianceCache {
    pub(super) settings: CacheSettings,
    pub(super) records: Vec<IrradianceRecord>,
    /// Over the spheres within which records are read.
    pub(super) octree: RecordOctree,
    neighbours: Neighbours,
}

impl IrradianceCache {
    /// A cache without records.
    ///
    /// - `bounds`: of the scene.
    #[must_use]
    pub fn new(settings: CacheSettings, bounds: &Bounds) -> Self {
        Self {
            settings,
            records: Vec::new(),
            octree: RecordOctree::new(bounds, settings.cell_records),
            neighbours: Neighbours::new(bounds, settings.metric.ranges_per_distance()),
        }
    }

    /// A cache of records that another has kept, by number. Their ranges are what neighbours have left, and stay so until others
    /// are inserted.
    ///
    /// - `bounds`: of the scene.
    ///
    /// # Errors
    /// The first record that [`IrradianceCache::accepts`] refuses.
    pub fn restore(
        settings: CacheSettings,
        bounds: &Bounds,
        records: Vec<IrradianceRecord>,
    ) -> Result<Self, RecordOctreeError> {
        let mut cache = Self::new(settings, bounds);
        for record in &records {
            cache.accepts(record)?;
        }
        cache.records = records;
        cache.neighbours.add(&cache.records)?;
        cache.rebuild(bounds)?;
        Ok(cache)
    }

    /// Whether a record can be kept: its place is in the scene and its numbers are finite.
    ///
    /// # Errors
    /// As [`RecordOctree::insert`].
    pub fn accepts(&self, record: &IrradianceRecord) -> Result<(), RecordOctreeError> {
        self.octree
            .accepts(record.position, self.settings.read_radius(record))?;
        self.octree.accepts(record.position, record.range)
    }

    /// Adds records behind those that there are, and lowers the ranges of these and of their neighbours until none exceeds that of
    /// another, in whose range it lies, by more than the distance between the two, times what the metric lets it.
    ///
    /// Source: Křivánek et al., "Making Radiance and Irradiance Caching Practical", EGSR 2006, section 3.3.
    ///
    /// # Errors
    /// The first that [`IrradianceCache::accepts`] refuses; those before it are kept then.
    pub fn insert(&mut self, new: &[IrradianceRecord]) -> Result<(), RecordOctreeError> {
        let first = self.records.len();
        let mut result = Ok(());
        for record in new {
            result = self.accepts(record);
            if result.is_err() {
                break;
            }
            self.records.push(*record);
        }
        self.neighbours.lower_ranges(&mut self.records, first)?;
        for row in first..self.records.len() {
            let radius = self.settings.read_radius(&self.records[row]);
            self.octree.insert(self.records[row].position, radius)?;
        }
        result
    }

    /// Builds the octree anew with the ranges as they are by now.
    pub fn rebuild(&mut self, bounds: &Bounds) -> Result<(), RecordOctreeError> {
        self.octree = RecordOctree::new(bounds, self.settings.cell_records);
        for record in &self.records {
            self.octree.insert(record.position, self.settings.read_radius(record))?;
        }
        Ok(())
    }

    /// All records, by number.
    #[must_use]
    pub fn records(&self) -> &[IrradianceRecord] {
        &self.records
    }

    /// Memory in bytes, about.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.records.capacity() * size_of::<IrradianceRecord>()
            + self.octree.memory_bytes()
            + self.neighbours.memory_bytes()
    }
}
