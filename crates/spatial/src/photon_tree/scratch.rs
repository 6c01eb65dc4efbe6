//! What a query for the nearest photons works in, and what it returns.

/// Memory that queries reuse, so that none of them allocates once it has seen its largest `k`.
///
/// One a thread; about 24 bytes times `k`. A result borrows it until the next query.
#[derive(Clone, Debug, Default)]
pub struct NearestScratch {
    /// Candidates, in the order of discovery: bits of the squared distance, then the slot.
    pub(super) keys: Vec<u64>,
    /// A copy for selection, which permutes.
    pub(super) spare: Vec<u64>,
}

impl NearestScratch {
    /// Creates scratch memory that grows at the first query.
    pub fn new() -> Self {
        Self::default()
    }
}

/// A photon that a query found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Place of the photon in query order; [`PhotonTree::rows`](crate::PhotonTree::rows) at this slot is its input row.
    pub slot: u32,
    /// Squared distance from the query point.
    pub dist_sq: f32,
}

impl Neighbour {
    fn from_key(key: u64) -> Self {
        Self {
            slot: key as u32,
            dist_sq: distance_sq(key),
        }
    }
}

/// The photons nearest to a point, in an order that depends on the tree and the query alone.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<'a> {
    /// As in the scratch memory, the `k`-th nearest last if `full`.
    pub(super) keys: &'a [u64],
    /// Whether `k` were found.
    pub(super) full: bool,
}

impl<'a> Nearest<'a> {
    /// Returns how many photons were found, at most `k`.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Returns whether no photon was found.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Iterates over the photons found, in the order of traversal; the `k`-th nearest comes last if there are `k`.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Neighbour> + use<'a> {
        self.keys.iter().map(|&key| Neighbour::from_key(key))
    }

    /// Returns the `k`-th nearest photon, by distance and then row; `None` if fewer than `k` are within the radius.
    pub fn kth(&self) -> Option<Neighbour> {
        let last = self.keys.last().filter(|_| self.full)?;
        Some(Neighbour::from_key(*last))
    }

    /// Iterates over the photons of a density estimate: the `k − 1` nearer than the `k`-th, or all if fewer than `k` are within the radius.
    pub fn inside(&self) -> impl ExactSizeIterator<Item = Neighbour> + use<'a> {
        let count = self.keys.len() - usize::from(self.full);
        self.keys[..count].iter().map(|&key| Neighbour::from_key(key))
    }
}

/// Returns the squared distance that a key begins with.
pub(super) fn distance_sq(key: u64) -> f32 {
    f32::from_bits((key >> 32) as u32)
}
