//! The records of the tree: buckets of photons and inner nodes with four children.

use glam::Vec3;

/// Photons in a bucket.
///
/// Measured by `cargo bench --bench photon_tree` at 50 and 500 neighbours: 16 takes 1.15 times as long as 32; 64 is as fast and rejects more photons within a small radius.
pub(super) const BUCKET: usize = 32;

/// Independent chains in a minimum over a bucket, which otherwise waits for each comparison.
const CHAINS: usize = 8;

/// Children of an inner node: the width of an SSE2 register.
pub(super) const WIDTH: usize = 4;

/// The least and the greatest coordinates.
pub(super) type Bounds = ([f32; 3], [f32; 3]);

/// Returns the smaller of two numbers, and `b` when either is not a number.
///
/// This form is one `minps` lane; `f32::min` costs three more instructions for its treatment of NaN.
#[inline(always)]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers, and `b` when either is not a number.
#[inline(always)]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The positions of up to [`BUCKET`] photons, axis by axis so that distances are computed in lanes.
///
/// The unused tail of the last bucket is NaN: its distances compare as false with every bound, so that a scan needs no length.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Bucket {
    /// Coordinates by axis, then lane.
    pub(super) axes: [[f32; BUCKET]; 3],
}

const _: () = assert!(size_of::<Bucket>() == 12 * BUCKET);

impl Bucket {
    /// A bucket without photons.
    pub(super) const EMPTY: Self = Self {
        axes: [[f32::NAN; BUCKET]; 3],
    };

    /// Returns the position of the photon in a lane.
    #[inline]
    pub(super) fn position(&self, lane: usize) -> Vec3 {
        Vec3::new(self.axes[0][lane], self.axes[1][lane], self.axes[2][lane])
    }

    /// Computes the squared distances from `p` to all photons of the bucket.
    #[inline(always)]
    pub(super) fn distances_sq(&self, p: Vec3) -> [f32; BUCKET] {
        let [x, y, z] = &self.axes;
        std::array::from_fn(|lane| {
            let (dx, dy, dz) = (x[lane] - p.x, y[lane] - p.y, z[lane] - p.z);
            dx * dx + dy * dy + dz * dz
        })
    }

    /// Returns the bounding box of the photons, `(min, max)`; NaN lanes are passed over.
    pub(super) fn bounds(&self) -> Bounds {
        let reduced = |axis: usize, of: fn(f32, f32) -> f32, none: f32| {
            let mut lanes = [none; CHAINS];
            for values in self.axes[axis].chunks_exact(CHAINS) {
                for (lane, &value) in lanes.iter_mut().zip(values) {
                    *lane = of(value, *lane);
                }
            }
            lanes.into_iter().fold(none, |a, b| of(b, a))
        };
        (
            std::array::from_fn(|axis| reduced(axis, min, f32::INFINITY)),
            std::array::from_fn(|axis| reduced(axis, max, f32::NEG_INFINITY)),
        )
    }
}

/// The bounding boxes of four children, which are nodes of the level below or buckets.
///
/// A missing child has NaN bounds: its distance is NaN and so beyond every bound.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(super) struct Node {
    pub(super) min: [[f32; WIDTH]; 3],
    pub(super) max: [[f32; WIDTH]; 3],
    /// The smallest input row in each child, which settles ties in `traverse`.
    pub(super) first_row: [u32; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 112);

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        min: [[f32::NAN; WIDTH]; 3],
        max: [[f32::NAN; WIDTH]; 3],
        first_row: [u32::MAX; WIDTH],
    };

    /// Computes the squared distances from `p` to the four boxes; NaN for a missing child.
    ///
    /// Never above the computed distance to a photon inside: subtraction, squaring and the sum round monotonically, and the terms are added in the order of [`Bucket::distances_sq`]. Hence pruning loses nothing to rounding.
    #[inline(always)]
    pub(super) fn distances_sq(&self, p: Vec3) -> [f32; WIDTH] {
        let p = p.to_array();
        let gap: [[f32; WIDTH]; 3] = std::array::from_fn(|axis| {
            std::array::from_fn(|lane| {
                let outside = max(self.min[axis][lane] - p[axis], p[axis] - self.max[axis][lane]);
                max(0.0, outside)
            })
        });
        std::array::from_fn(|lane| {
            gap[0][lane] * gap[0][lane] + gap[1][lane] * gap[1][lane] + gap[2][lane] * gap[2][lane]
        })
    }

    /// Sets the box and the smallest row of a child.
    pub(super) fn set(&mut self, lane: usize, bounds: Bounds, first_row: u32) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.0[axis];
            self.max[axis][lane] = bounds.1[axis];
        }
        self.first_row[lane] = first_row;
    }

    /// Returns the union of the children's boxes; NaN lanes are passed over.
    pub(super) fn bounds(&self) -> Bounds {
        let mut bounds = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for axis in 0..3 {
            for lane in 0..WIDTH {
                bounds.0[axis] = min(self.min[axis][lane], bounds.0[axis]);
                bounds.1[axis] = max(self.max[axis][lane], bounds.1[axis]);
            }
        }
        bounds
    }
}
