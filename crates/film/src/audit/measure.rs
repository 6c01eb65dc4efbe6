//! What two films say of the same pixels.

use super::AuditOptions;
use crate::accumulate::Film;
use crate::batch::{BATCHES, Estimate};
use crate::significance::Welch;

/// Least number of even estimates that a mean has to be worth, `(Σ x)² / Σ x²`, to be judged.
///
/// Student's t takes means for normal. One of a few bright samples is not: it is mostly too low, and its variance too.
const LEAST_EFFECTIVE: f64 = 32.0;

/// Share of the spread that one estimate out of hundreds may make.
const MOST_DOMINANT: f64 = 0.25;

/// Largest chance of light that all samples have missed with which a difference is judged at all.
const MOST_UNSEEN: f64 = 1e-6;

/// One channel of one layer over some pixels, in both films.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) means: [f64; 2],
    pub(super) welch: Welch,
    /// Of the traced film.
    samples: f64,
    /// Least of both films.
    effective: f64,
    /// Largest of both films.
    dominance: f64,
}

impl Measured {
    pub(super) fn of(
        films: [&Film; 2],
        pixels: impl Iterator<Item = usize>,
        layer: Option<usize>,
        channel: usize,
    ) -> Self {
        const FREEDOM: f64 = BATCHES as f64 - 1.0;
        let mut welch = Welch::default();
        let mut sides = [Side::default(); 2];
        let (mut count, mut samples) = (0.0, 0.0);
        for storage in pixels {
            count += 1.0;
            samples += f64::from(films[1].sample_count(storage));
            let found = films.map(|film| film.estimate(storage, layer, channel));
            let variances = found.map(|found| (found.variance, FREEDOM));
            welch.add(found[0].mean - found[1].mean, variances);
            sides.iter_mut().zip(&found).for_each(|(side, found)| side.add(found));
        }
        Self {
            means: sides.map(|side| side.sum / count),
            welch: welch.scaled(1.0 / count),
            samples,
            effective: sides.iter().map(Side::effective).fold(f64::INFINITY, f64::min),
            dominance: sides.iter().map(Side::dominance).fold(0.0, f64::max),
        }
    }

    /// Chance that light which would make up for what ours is too bright by was met by no sample.
    ///
    /// Samples that bring at most `B` each have to come with a chance of at least `D / B` to add up to `D`, so that none of
    /// `n` does with a chance of no more than `exp(−n D / B)`.
    fn unseen(&self, tolerated: f64, brightest: f64) -> f64 {
        /// Weights of lobes and of survival in roulette are about 1 at most; a safe margin.
        const LARGEST_WEIGHT: f64 = 4.0;
        let missing = self.welch.difference() - tolerated;
        if missing > 0.0 {
            libm::exp(-self.samples * missing / (LARGEST_WEIGHT * brightest))
        } else {
            0.0
        }
    }

    /// Chance that noise alone makes the difference; none where that cannot be told.
    pub(super) fn chance(&self, by_chance: bool, tolerated: f64, options: &AuditOptions) -> Option<f64> {
        let noise = self.welch.p_value(tolerated);
        let unseen = match by_chance {
            true => self.unseen(tolerated, options.brightest),
            false => 0.0,
        };
        let is_decided =
            self.is_decided(by_chance, tolerated) && (unseen < MOST_UNSEEN || noise > options.significance);
        is_decided.then(|| (noise + unseen).min(1.0))
    }

    pub(super) fn has_light(&self) -> bool {
        self.means.iter().any(|mean| *mean > 0.0)
    }

    /// True when no few samples decide.
    fn is_decided(&self, by_chance: bool, tolerated: f64) -> bool {
        // A light that is looked for and never seen is not there; and what is off by so little is no defect, whatever makes
        // it so.
        let is_known_black = self.means[1] == 0.0;
        let is_close = self.welch.difference().abs() + 3.0 * self.welch.standard_error() <= tolerated;
        let is_faint = self.means[0].max(self.means[1]) <= tolerated;
        is_faint
            || !by_chance && (is_known_black || is_close)
            || self.effective >= LEAST_EFFECTIVE && self.dominance <= MOST_DOMINANT
    }
}

/// Sums over the batches of some pixels of one film.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    sum: f64,
    squares: f64,
    spread: f64,
    largest: f64,
}

impl Side {
    fn add(&mut self, found: &Estimate) {
        self.sum += found.mean;
        for (part, off) in found.parts.iter().zip(&found.off) {
            self.squares += part * part;
            self.spread += off * off;
            self.largest = self.largest.max(off * off);
        }
    }

    fn effective(&self) -> f64 {
        if self.squares > 0.0 {
            self.sum * self.sum / self.squares
        } else {
            0.0
        }
    }

    fn dominance(&self) -> f64 {
        if self.spread > 0.0 {
            self.largest / self.spread
        } else {
            0.0
        }
    }
}
