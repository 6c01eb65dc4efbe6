//! Traversal: the photons within a bound, the bound shrinking as photons are found.

use glam::Vec3;

use super::PhotonTree;
use super::node::{BUCKET, WIDTH};

/// Room for the subtrees that are put off: at most three on each of [`MAX_LEVELS`], and one more.
const STACK: usize = 64;

/// Levels of inner nodes above 2³² photons.
const MAX_LEVELS: u32 = 14;

/// Bits of a [`Pending`] code below the level.
const INDEX_BITS: u32 = 28;

const _: () = assert!(3 * (MAX_LEVELS as usize) < STACK);
const _: () = assert!(MAX_LEVELS < 1 << (u32::BITS - INDEX_BITS));
const _: () = assert!(1_u64 << (2 * MAX_LEVELS) >= (1 << u32::BITS) / BUCKET as u64);
const _: () = assert!(1_u64 << INDEX_BITS > (1 << u32::BITS) / BUCKET as u64);

/// A subtree that is still to be visited: the bits of its squared distance, then a code of level and index.
///
/// As bits of floats that are not negative order like the floats, so do these integers.
#[derive(Clone, Copy)]
struct Pending(u64);

impl Pending {
    fn new(distance_sq: f32, level: u32, index: u32) -> Self {
        let code = level << INDEX_BITS | index;
        Self(u64::from(distance_sq.to_bits()) << 32 | u64::from(code))
    }

    fn distance_sq(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    fn level(self) -> u32 {
        self.0 as u32 >> INDEX_BITS
    }

    fn index(self) -> usize {
        (self.0 as u32 & ((1 << INDEX_BITS) - 1)) as usize
    }
}

/// What a traversal does with the buckets it reaches.
pub(super) trait Visit {
    /// Returns the squared distance, inclusive, beyond which nothing is of interest any more.
    fn bound(&self) -> f32;

    /// Returns the largest row that still matters at exactly the bound; `u32::MAX` if all do.
    fn last_row(&self) -> u32 {
        u32::MAX
    }

    /// Looks at a bucket that the bound does not exclude.
    fn bucket(&mut self, tree: &PhotonTree, index: usize);
}

/// Puts four numbers in ascending order.
#[inline(always)]
fn sort4(mut v: [u64; WIDTH]) -> [u64; WIDTH] {
    for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        (v[a], v[b]) = (v[a].min(v[b]), v[a].max(v[b]));
    }
    v
}

impl PhotonTree {
    /// Visits the buckets within the visitor's bound, near ones first.
    ///
    /// The order depends on the tree, the point and the bounds only.
    #[inline(always)]
    pub(super) fn traverse(&self, p: Vec3, visit: &mut impl Visit) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [0_u64; STACK];
        let mut height = 1;
        stack[0] = Pending::new(0.0, self.levels.len() as u32, 0).0;
        while height > 0 {
            height -= 1;
            let mut here = Pending(stack[height % STACK]);
            while here.level() > 0 && here.distance_sq() <= visit.bound() {
                let below = here.level() - 1;
                let node = &self.nodes[self.levels[below as usize] + here.index()];
                let first = (here.index() * WIDTH) as u32;
                let mut distances = node.distances_sq(p);
                if visit.last_row() != u32::MAX {
                    // Without this, thousands of photons at one point would all be visited.
                    for (distance, &row) in distances.iter_mut().zip(&node.first_row) {
                        if *distance == visit.bound() && row > visit.last_row() {
                            *distance = f32::NAN;
                        }
                    }
                }
                let children = sort4(std::array::from_fn(|lane| {
                    Pending::new(distances[lane], below, first + lane as u32).0
                }));
                for &child in children[1..].iter().rev() {
                    // Written always, kept if near enough: a branch here is hard to predict.
                    stack[height % STACK] = child;
                    height += usize::from(Pending(child).distance_sq() <= visit.bound());
                }
                here = Pending(children[0]);
            }
            if here.level() == 0 && here.distance_sq() <= visit.bound() {
                visit.bucket(self, here.index());
            }
        }
    }
}
