//! Construction: medians found in place, in parallel at fixed splits.

use glam::Vec3;
use rayon::prelude::*;

use super::node::{BUCKET, Bucket, Node, WIDTH, max, min};
use super::{PhotonTree, PhotonTreeError};

/// Below this many photons a subtree is built by one thread.
///
/// Part of the schedule only: the tree is the same at every value.
const JOIN_ABOVE: usize = 8192;

/// A photon on its way into the tree.
#[derive(Clone, Copy)]
struct Record {
    position: [f32; 3],
    row: u32,
}

const _: () = assert!(size_of::<Record>() == 16);

impl Record {
    /// Returns the box of this photon alone.
    #[inline(always)]
    fn extent(&self) -> Extent {
        let [x, y, z] = self.position;
        let lanes = [x, y, z, f32::from_bits(self.row)];
        (lanes, lanes)
    }

    /// Returns the place of the photon along an axis as one integer: the coordinate, then the row.
    ///
    /// The bits of a float, with the magnitude flipped if it is negative, order like the float itself.
    #[inline(always)]
    fn key<const AXIS: usize>(&self) -> i64 {
        let bits = self.position[AXIS].to_bits() as i32;
        let ordered = bits ^ (((bits >> 31) as u32) >> 1) as i32;
        (i64::from(ordered) << 32) | i64::from(self.row)
    }
}

/// Builds the tree of `len` photons whose positions `position` returns by row.
pub(super) fn build(len: usize, position: impl Fn(usize) -> Vec3 + Sync) -> Result<PhotonTree, PhotonTreeError> {
    if len >= u32::MAX as usize {
        return Err(PhotonTreeError::TooMany { len });
    }
    let mut records: Vec<Record> = (0..len)
        .into_par_iter()
        .with_min_len(JOIN_ABOVE)
        .map(|row| Record {
            position: position(row).to_array(),
            row: row as u32,
        })
        .collect();
    let not_finite = |record: &&Record| !Vec3::from(record.position).is_finite();
    if let Some(record) = records.par_iter().with_min_len(JOIN_ABOVE).find_first(not_finite) {
        return Err(PhotonTreeError::NotFinite { row: record.row });
    }

    let mut buckets = vec![Bucket::EMPTY; len.div_ceil(BUCKET)];
    let mut rows = vec![0; len];
    let capacity = buckets.len().next_power_of_two();
    partition(&mut records, &mut buckets, &mut rows, capacity);
    drop(records);
    let (nodes, levels) = bound(&buckets, &rows);
    Ok(PhotonTree {
        buckets,
        rows,
        nodes,
        levels,
    })
}

/// Distributes photons over the buckets of a subtree that has room for `capacity` of them, a power of two.
///
/// The left half is filled before the right one, so that all buckets but the last of the tree are full and the shape follows from the number of photons alone.
fn partition(records: &mut [Record], buckets: &mut [Bucket], rows: &mut [u32], capacity: usize) {
    if buckets.len() <= 1 {
        if let Some(bucket) = buckets.first_mut() {
            fill(records, bucket, rows);
        }
        return;
    }
    let half = capacity / 2;
    if buckets.len() <= half {
        return partition(records, buckets, rows, half);
    }
    let middle = half * BUCKET;
    match widest_axis(records) {
        0 => select::<0>(records, middle),
        1 => select::<1>(records, middle),
        _ => select::<2>(records, middle),
    }
    let join = records.len() > JOIN_ABOVE;
    let (near, far) = records.split_at_mut(middle);
    let (near_buckets, far_buckets) = buckets.split_at_mut(half);
    let (near_rows, far_rows) = rows.split_at_mut(middle);
    let mut left = || partition(near, near_buckets, near_rows, half);
    let mut right = || partition(far, far_buckets, far_rows, half);
    if join {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

/// Moves the `middle` photons that come first along an axis to the front.
fn select<const AXIS: usize>(records: &mut [Record], middle: usize) {
    records.select_nth_unstable_by_key(middle, Record::key::<AXIS>);
}

/// Returns the axis along which the photons spread widest, the first of them if several do.
fn widest_axis(records: &[Record]) -> usize {
    let (low, high) = records.par_chunks(2 * JOIN_ABOVE).map(extent).reduce(|| NOTHING, unite);
    let width: [f32; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
    let wider = |a: usize, b: usize| if width[b] > width[a] { b } else { a };
    wider(wider(0, 1), 2)
}

/// The least and the greatest of each axis; the fourth lane is idle and fills the register.
type Extent = ([f32; 4], [f32; 4]);

/// The extent of no photons.
const NOTHING: Extent = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);

/// Returns the extent of both.
#[inline(always)]
fn unite(a: Extent, b: Extent) -> Extent {
    (
        std::array::from_fn(|lane| min(a.0[lane], b.0[lane])),
        std::array::from_fn(|lane| max(a.1[lane], b.1[lane])),
    )
}

/// Returns the bounding box of photons, in four chains that do not wait for one another.
fn extent(records: &[Record]) -> Extent {
    let mut chains = [NOTHING; 4];
    let mut quads = records.chunks_exact(chains.len());
    for quad in &mut quads {
        for (chain, record) in chains.iter_mut().zip(quad) {
            *chain = unite(record.extent(), *chain);
        }
    }
    for record in quads.remainder() {
        chains[0] = unite(record.extent(), chains[0]);
    }
    let [a, b, c, d] = chains;
    unite(unite(a, b), unite(c, d))
}

/// Writes up to [`BUCKET`] photons into their bucket, by ascending row.
///
/// Selection leaves the order within a part unspecified; sorting makes the tree a function of the positions alone.
fn fill(records: &mut [Record], bucket: &mut Bucket, rows: &mut [u32]) {
    records.sort_unstable_by_key(|record| record.row);
    for (lane, record) in records.iter().enumerate() {
        for axis in 0..3 {
            bucket.axes[axis][lane] = record.position[axis];
        }
        rows[lane] = record.row;
    }
}

/// Computes the inner nodes, level by level from the buckets up, and where each level starts.
fn bound(buckets: &[Bucket], rows: &[u32]) -> (Vec<Node>, Vec<usize>) {
    let mut nodes: Vec<Node> = buckets
        .par_chunks(WIDTH)
        .zip(rows.par_chunks(WIDTH * BUCKET))
        .with_min_len(JOIN_ABOVE / BUCKET)
        .map(|(children, rows)| {
            let mut node = Node::EMPTY;
            for (lane, (bucket, rows)) in children.iter().zip(rows.chunks(BUCKET)).enumerate() {
                node.set(lane, bucket.bounds(), rows[0]);
            }
            node
        })
        .collect();
    // Sums to a third with levels that are rounded up; more would be wasted for the tree's life.
    nodes.reserve_exact(nodes.len() / 3 + 16);
    let mut levels = vec![0];
    let mut start = 0;
    while nodes.len() - start > 1 {
        let end = nodes.len();
        for first in (start..end).step_by(WIDTH) {
            let mut node = Node::EMPTY;
            for (lane, child) in (first..end.min(first + WIDTH)).enumerate() {
                let first_row = nodes[child].first_row.into_iter().fold(u32::MAX, u32::min);
                node.set(lane, nodes[child].bounds(), first_row);
            }
            nodes.push(node);
        }
        levels.push(end);
        start = end;
    }
    (nodes, levels)
}
