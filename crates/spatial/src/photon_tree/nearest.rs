//! The k nearest photons, and all photons within a radius.

use glam::Vec3;

use super::PhotonTree;
use super::node::BUCKET;
use super::scratch::{Nearest, NearestScratch, distance_sq};
use super::search::Visit;

impl PhotonTree {
    /// Finds the `k` photons nearest to a point.
    ///
    /// [`PhotonTree::nearest_where`] with every photon accepted, and faster than it.
    pub fn nearest<'a>(&self, p: Vec3, k: usize, max_radius: f32, scratch: &'a mut NearestScratch) -> Nearest<'a> {
        self.search::<_, false>(p, k, max_radius, |_, _, _| true, scratch)
    }

    /// Finds the `k` photons nearest to a point among those that `accept` takes.
    ///
    /// Source: buckets and near-first descent after Friedman, Bentley, Finkel, "An Algorithm for Finding Best Matches in Logarithmic Expected Time", ACM TOMS 1977.
    /// Differs: candidates gather unsorted, and each time the buffer is full a selection keeps `k` of them and shrinks the radius, instead of a heap; children carry bounding boxes, four to a node.
    ///
    /// - `p`: finite; the unit is the positions'.
    /// - `k`: how many to find; 0 finds none.
    /// - `max_radius`: inclusive, squared in `f32`; infinity sets no limit, a negative number or NaN finds none.
    /// - `accept`: given slot, offset (photon minus `p`) and squared distance. Those it rejects do not count. It must answer alike for the same photon; it sees a few times `k` photons, each once.
    /// - returns the `k` least by (squared distance, input row), hence a set that does not depend on the tree; all accepted photons within the radius if they are fewer.
    ///
    /// Cost: O(k + log N) for photons on surfaces; no allocation once `scratch` has its size. Deterministic for a given tree.
    pub fn nearest_where<'a>(
        &self,
        p: Vec3,
        k: usize,
        max_radius: f32,
        accept: impl FnMut(u32, Vec3, f32) -> bool,
        scratch: &'a mut NearestScratch,
    ) -> Nearest<'a> {
        self.search::<_, true>(p, k, max_radius, accept, scratch)
    }

    /// Calls `f` with slot, offset (photon minus `p`) and squared distance of every photon within a radius, inclusive.
    ///
    /// Cost: O(log N + photons found), no allocation. Deterministic: the order depends on the tree and the query alone.
    pub fn within(&self, p: Vec3, radius: f32, f: impl FnMut(u32, Vec3, f32)) {
        if radius >= 0.0 && p.is_finite() {
            let bound = radius * radius;
            self.traverse(p, &mut All { p, bound, f });
        }
    }

    /// Answers both kinds of query; `FILTER` says whether `accept` is to be asked at all.
    #[inline(always)]
    fn search<'a, F: FnMut(u32, Vec3, f32) -> bool, const FILTER: bool>(
        &self,
        p: Vec3,
        k: usize,
        max_radius: f32,
        accept: F,
        scratch: &'a mut NearestScratch,
    ) -> Nearest<'a> {
        let mut search = Search::<F, FILTER> {
            p,
            k,
            bound: max_radius * max_radius,
            last_row: u32::MAX,
            len: 0,
            full_at: k.min(self.len()) + slack(k.min(self.len())),
            scratch,
            accept,
        };
        let sensible = max_radius >= 0.0 && p.is_finite();
        if k == 0 || !sensible {
            return Nearest { keys: &[], full: false };
        }
        let room = search.full_at + BUCKET;
        if search.scratch.keys.len() < room {
            search.scratch.keys.resize(room, 0);
            search.scratch.spare.clear();
            search.scratch.spare.reserve_exact(room);
        }
        self.traverse(p, &mut search);
        search.finish(self)
    }
}

/// Returns how many candidates above `k` gather before a selection.
///
/// Measured by `cargo bench --bench photon_tree` at k = 500: a quarter of `k` takes 1.15 times as long as half, all of `k` 1.2 times, twice `k` 1.4 times.
fn slack(k: usize) -> usize {
    (k / 2).max(BUCKET)
}

/// The state of a query for the nearest photons.
struct Search<'a, F, const FILTER: bool> {
    p: Vec3,
    k: usize,
    /// Squared distance of the `k`-th nearest so far, or of the maximal radius.
    bound: f32,
    /// Row of the `k`-th nearest so far if photons at its distance had to be left out, else `u32::MAX`.
    last_row: u32,
    /// Candidates in `scratch.keys`.
    len: usize,
    /// Candidates at which the buffer is shrunk before the next bucket.
    full_at: usize,
    scratch: &'a mut NearestScratch,
    accept: F,
}

impl<F: FnMut(u32, Vec3, f32) -> bool, const FILTER: bool> Visit for Search<'_, F, FILTER> {
    #[inline(always)]
    fn bound(&self) -> f32 {
        self.bound
    }

    #[inline(always)]
    fn last_row(&self) -> u32 {
        self.last_row
    }

    #[inline(always)]
    fn bucket(&mut self, tree: &PhotonTree, index: usize) {
        if self.len > self.full_at {
            self.shrink(tree);
        }
        let bucket = &tree.buckets[index];
        let first_slot = (index * BUCKET) as u32;
        let distances = bucket.distances_sq(self.p);
        let found = &mut self.scratch.keys[self.len..self.len + BUCKET];
        let mut count = 0;
        // Written without a branch: whether a photon is near is as good as random.
        for (lane, &distance) in distances.iter().enumerate() {
            let slot = u64::from(first_slot + lane as u32);
            found[count % BUCKET] = u64::from(distance.to_bits()) << 32 | slot;
            count += usize::from(distance <= self.bound);
        }
        if FILTER {
            let mut kept = 0;
            for i in 0..count {
                let key = found[i];
                let slot = key as u32;
                let offset = bucket.position(slot as usize % BUCKET) - self.p;
                found[kept] = key;
                kept += usize::from((self.accept)(slot, offset, distance_sq(key)));
            }
            count = kept;
        }
        self.len += count;
    }
}

impl<'a, F, const FILTER: bool> Search<'a, F, FILTER> {
    /// Keeps the `k` nearest candidates and lowers the bound to the last of them.
    ///
    /// Those kept stay in the order of discovery: selection permutes a copy, since its order is the library's affair.
    #[inline(never)]
    fn shrink(&mut self, tree: &PhotonTree) {
        let NearestScratch { keys, spare } = &mut *self.scratch;
        let candidates = &mut keys[..self.len];
        spare.clear();
        spare.extend_from_slice(candidates);
        let (_, &mut kth, rest) = spare.select_nth_unstable(self.k - 1);
        self.bound = distance_sq(kth);
        self.last_row = u32::MAX;
        self.len = self.k;
        if rest.iter().all(|&key| key >> 32 != kth >> 32) {
            keep(candidates, |key| key <= kth);
            return;
        }
        // Photons at one distance straddle the k-th place: rows decide, not slots.
        let by_row = |key: u64| (key >> 32, tree.rows[key as u32 as usize]);
        spare.select_nth_unstable_by_key(self.k - 1, |&key| by_row(key));
        let kth = by_row(spare[self.k - 1]);
        self.last_row = kth.1;
        keep(candidates, |key| by_row(key) <= kth);
    }

    /// Reduces the candidates to the answer.
    fn finish(mut self, tree: &PhotonTree) -> Nearest<'a> {
        let full = self.len >= self.k;
        if full {
            self.shrink(tree);
            let keys = &mut self.scratch.keys[..self.k];
            let farthest = u64::from(self.bound.to_bits());
            let kth = (0..self.k)
                .filter(|&i| keys[i] >> 32 == farthest)
                .max_by_key(|&i| tree.rows[keys[i] as u32 as usize]);
            if let Some(kth) = kth {
                keys[kth..].rotate_left(1);
            }
        }
        let keys = &self.scratch.keys[..self.len];
        Nearest { keys, full }
    }
}

/// Moves the keys that pass to the front, in their order.
#[inline(always)]
fn keep(keys: &mut [u64], passes: impl Fn(u64) -> bool) {
    let mut kept = 0;
    for i in 0..keys.len() {
        let key = keys[i];
        keys[kept] = key;
        kept += usize::from(passes(key));
    }
}

/// The state of a query for all photons within a radius.
struct All<F> {
    p: Vec3,
    bound: f32,
    f: F,
}

impl<F: FnMut(u32, Vec3, f32)> Visit for All<F> {
    #[inline(always)]
    fn bound(&self) -> f32 {
        self.bound
    }

    #[inline(always)]
    fn bucket(&mut self, tree: &PhotonTree, index: usize) {
        let bucket = &tree.buckets[index];
        for (lane, &distance) in bucket.distances_sq(self.p).iter().enumerate() {
            if distance <= self.bound {
                let slot = (index * BUCKET + lane) as u32;
                (self.f)(slot, bucket.position(lane) - self.p, distance);
            }
        }
    }
}
