//! Density control: fewer photons where they are denser than a picture has use for, and the same flux.

use crate::density::{MIN_NORMAL_COSINE, is_on_surface};
use crate::photon_maps::position_error;
use glam::Vec3;
use radiometry::Rgb;
use rayon::prelude::*;
use spatial::{NearestScratch, PhotonTree, PhotonTreeError};
use std::f32::consts::PI;

/// Photons that tell the density around another. It is known to 1/√64, an eighth: where half as many photons lie as are
/// allowed, none is ever taken for too many.
const NEAREST: usize = 64;

/// Photons of a crowd are kept at least at this share, so that a heap of them in one point leaves some that take the flux of
/// the others.
const LEAST_SHARE: f32 = 1.0 / 1024.0;

/// Neighbours in the tree that one task looks at, so that each search begins with the radius of the last.
const TASK_PHOTONS: usize = 1024;

/// Room for the rounding of a sum of two distances.
const ROUNDED_UP: f32 = 1.000_01;

/// Stored photons by row, as far as thinning looks at them; all three of one length.
#[derive(Clone, Copy, Debug)]
pub struct PhotonRows<'a> {
    /// World space, metres.
    pub position: &'a [Vec3],
    /// Unit normal of where each landed, on the side that it came from.
    pub normal: &'a [Vec3],
    /// Flux in W.
    pub flux: &'a [Rgb],
}

/// Thins photons down to a density where they are denser, and gives the flux of those removed to their neighbours.
///
/// A photon is kept with the share `D / d = D π r² / k`, where `D` is the density asked for and `r` the distance of the k-th
/// photon of the same surface, k = 64. Shares are added up along the order of the tree and a photon is kept whenever
/// the sum passes an integer, so that those kept are spread more evenly than by chance. Each removed one gives its flux to
/// the nearest kept on the same side of the same surface, by the tests of the density estimate; where there is none within
/// reach, it stays. So any disc holds the flux that it held before, but for what crosses its rim.
///
/// Source: Suykens and Willems, "Density Control for Photon Maps", Rendering Workshop 2000.
/// Differs: all photons are looked at together instead of each against those stored before it, so that nothing depends on
/// their order, and threads share the work. Flux goes to one neighbour instead of all of an estimate's: nothing is blurred
/// further than to the next photon.
///
/// - `most_density`: photons per m² that are enough at a position; called from several threads. Positive; where it is infinite
///   or NaN, all photons stay.
/// - returns the flux of each photon by row, `None` for those removed. The sum is that of the input, up to one rounding to
///   `f32` a photon.
///
/// # Errors
/// As [`PhotonTree::build`].
///
/// Cost: O(N log N) on the current rayon pool, 60 bytes a photon on the way. Deterministic whatever the number of threads.
pub fn thin_photons(
    photons: PhotonRows<'_>,
    most_density: impl Fn(Vec3) -> f32 + Sync,
) -> Result<Vec<Option<Rgb>>, PhotonTreeError> {
    let tree = PhotonTree::from_fn(photons.position.len(), |row| photons.position[row])?;
    let rows = tree.rows();
    let mut normals = Vec::new();
    tree.in_query_order(photons.normal, &mut normals);
    let reach: Vec<f32> = rows
        .par_iter()
        .with_min_len(TASK_PHOTONS)
        .map(|row| crowd_radius(most_density(photons.position[*row as usize])))
        .collect();
    let sites = Sites {
        tree: &tree,
        normals: &normals,
        reach: &reach,
    };
    let is_kept = choose(&sites.shares());
    let receivers = sites.receivers(&is_kept)?;

    let mut flux: Vec<Option<[f64; 3]>> = vec![None; rows.len()];
    let slots = || rows.iter().zip(&receivers).enumerate();
    for (slot, (row, receiver)) in slots() {
        if *receiver == slot as u32 {
            flux[slot] = Some(widened(photons.flux[*row as usize]));
        }
    }
    for (slot, (row, receiver)) in slots() {
        if *receiver != slot as u32
            && let Some(sum) = &mut flux[*receiver as usize]
        {
            let given = widened(photons.flux[*row as usize]);
            *sum = std::array::from_fn(|channel| sum[channel] + given[channel]);
        }
    }
    let mut by_row = vec![None; rows.len()];
    for (row, flux) in rows.iter().zip(flux) {
        by_row[*row as usize] = flux.map(|[r, g, b]| Rgb::new(r as f32, g as f32, b as f32));
    }
    Ok(by_row)
}

fn widened(flux: Rgb) -> [f64; 3] {
    [flux.r, flux.g, flux.b].map(f64::from)
}

/// Radius in metres of the disc that holds [`NEAREST`] photons at a density.
fn crowd_radius(density: f32) -> f32 {
    (NEAREST as f32 / (PI * density)).sqrt()
}

/// Which photons are kept: those at which the sum of the shares passes an integer, and all with a share of 1.
fn choose(shares: &[f32]) -> Vec<bool> {
    let mut sum = 0.5_f64;
    let mut is_chosen = |share: &f32| {
        if *share >= 1.0 {
            return true;
        }
        sum += f64::from(*share);
        let is_passed = sum >= 1.0;
        if is_passed {
            sum -= 1.0;
        }
        is_passed
    };
    shares.iter().map(&mut is_chosen).collect()
}

/// Photons in the order of a tree over them.
struct Sites<'a> {
    tree: &'a PhotonTree,
    normals: &'a [Vec3],
    /// Radius within which [`NEAREST`] photons would be as dense as asked for, metres.
    reach: &'a [f32],
}

impl Sites<'_> {
    /// Calls `f` for the slots of each task, in parallel; the results in order.
    fn map_slots<T: Send, I: Iterator<Item = T>>(
        &self,
        f: impl Fn(std::ops::Range<usize>) -> I + Sync + Send,
    ) -> Vec<T> {
        let count = self.tree.len();
        (0..count.div_ceil(TASK_PHOTONS))
            .into_par_iter()
            .flat_map_iter(|task| f(task * TASK_PHOTONS..((task + 1) * TASK_PHOTONS).min(count)))
            .collect()
    }

    /// True when a photon belongs to the surface of another, as the density estimate sees it.
    #[inline]
    fn is_beside(&self, at: usize, normal: Vec3, error_sq: f32, offset: Vec3, dist_sq: f32) -> bool {
        normal.dot(self.normals[at]) >= MIN_NORMAL_COSINE && is_on_surface(offset, self.normals[at], dist_sq, error_sq)
    }

    /// The share of photons to keep at each slot, in (0, 1].
    fn shares(&self) -> Vec<f32> {
        self.map_slots(|slots| {
            let mut scratch = NearestScratch::new();
            let mut last: Option<(Vec3, f32)> = None;
            slots.map(move |at| {
                let position = self.tree.position(at as u32);
                let error = position_error(position);
                let accept = |slot: u32, offset: Vec3, dist_sq: f32| {
                    slot != at as u32 && self.is_beside(at, self.normals[slot as usize], error * error, offset, dist_sq)
                };
                let reach = self.reach[at];
                // As in the density estimate: the triangle inequality bounds the radius, which changes the cost alone.
                let bound = last.map_or(f32::INFINITY, |(place, radius): (Vec3, f32)| {
                    (radius + place.distance(position)) * ROUNDED_UP
                });
                let mut find = |bound| {
                    self.tree
                        .nearest_where(position, NEAREST, bound, accept, &mut scratch)
                        .kth()
                };
                let kth = find(bound.min(reach)).or_else(|| (bound < reach).then(|| find(reach)).flatten());
                last = kth.map(|kth| (position, kth.dist_sq.sqrt()));
                kth.map_or(1.0, |kth| (kth.dist_sq / (reach * reach)).clamp(LEAST_SHARE, 1.0))
            })
        })
    }

    /// The slot that the flux of each goes to: its own where it is kept.
    fn receivers(&self, is_kept: &[bool]) -> Result<Vec<u32>, PhotonTreeError> {
        let kept: Vec<u32> = (0..is_kept.len() as u32)
            .filter(|slot| is_kept[*slot as usize])
            .collect();
        let thinned = PhotonTree::from_fn(kept.len(), |row| self.tree.position(kept[row]))?;
        let slot_of = |found: u32| kept[thinned.rows()[found as usize] as usize];
        let (thinned, slot_of) = (&thinned, &slot_of);
        Ok(self.map_slots(|slots| {
            let mut scratch = NearestScratch::new();
            slots.map(move |at| {
                if is_kept[at] {
                    return at as u32;
                }
                let position = self.tree.position(at as u32);
                let error = position_error(position);
                let accept = |found: u32, offset: Vec3, dist_sq: f32| {
                    self.is_beside(
                        at,
                        self.normals[slot_of(found) as usize],
                        error * error,
                        offset,
                        dist_sq,
                    )
                };
                let nearest = thinned.nearest_where(position, 1, self.reach[at], accept, &mut scratch);
                nearest.kth().map_or(at as u32, |nearest| slot_of(nearest.slot))
            })
        }))
    }
}

#[cfg(test)]
mod tests;
