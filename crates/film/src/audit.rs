//! Whether a render is biased: its film against one of the same pixels that was rendered by a method without bias.

mod measure;

use std::ops::Range;

use glam::UVec2;

use crate::accumulate::Film;
use crate::batch::{BATCH_RUN, BATCHES};
use crate::significance::holm;
use measure::Measured;

/// A rectangle of pixels that are judged by their mean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelBlock {
    /// First pixel, in coordinates of the full film.
    pub min: UVec2,
    /// The pixel after the last.
    pub max: UVec2,
    /// Its pixels, as storage indices of both films.
    pub storage: Range<usize>,
}

/// How an audit judges.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditOptions {
    /// Chance of a false alarm over the whole audit, in (0, 1).
    pub significance: f64,
    /// Difference that is no defect, relative to the traced value, from 0. Of a block in the dark it is relative to
    /// [`DARK`] of the mean of all blocks.
    pub tolerance: f64,
    /// For each layer, whether a tracer finds some of its light by chance alone: where it found none, there may be some.
    pub by_chance: Vec<bool>,
    /// The most that one sample can bring of such light; infinite where no number of samples finds it.
    pub brightest: f64,
}

/// Blocks darker than this share of the mean count as if they had it.
pub const DARK: f64 = 0.1;

/// What was compared in one channel of one layer, over one block or over all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuditTest {
    /// Row of the block; none for all of them together.
    pub block: Option<usize>,
    /// Row of the layer; none for the beauty.
    pub layer: Option<usize>,
    /// 0 to 2: red, green, blue.
    pub channel: usize,
    /// Mean of the film under test.
    pub ours: f64,
    /// Mean of the traced film.
    pub traced: f64,
    /// Standard error of the difference of both.
    pub standard_error: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// Difference that was tolerated.
    pub tolerated: f64,
    /// What is beyond it, in standard errors; signed.
    pub t: f64,
    /// Chance of that by noise, corrected for the number of all tests; none where nothing can be said: a few samples
    /// decide, or ours is brighter by light that the tracer may not have met yet.
    pub chance: Option<f64>,
}

impl AuditTest {
    /// Returns ours − traced, relative to the traced mean; infinite where that is black.
    #[must_use]
    pub fn relative_difference(&self) -> f64 {
        match self.ours - self.traced {
            0.0 => 0.0,
            difference => difference / self.traced,
        }
    }
}

/// What an audit has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Audit {
    /// Over all blocks together.
    pub overall: Vec<AuditTest>,
    /// Block by block, where ours or the traced film has light.
    pub blocks: Vec<AuditTest>,
    /// Samples of each pixel, at least: of ours, and of the traced film.
    pub samples: [u32; 2],
    significance: f64,
}

/// Fewest samples of a pixel that fill all batches.
pub const LEAST_AUDIT_SAMPLES: u32 = BATCHES * BATCH_RUN;

impl Audit {
    /// Iterates over the tests whose difference is neither noise nor tolerated.
    pub fn findings(&self) -> impl Iterator<Item = &AuditTest> {
        let level = self.significance;
        let is_found = move |test: &&AuditTest| test.chance.is_some_and(|chance| chance < level);
        self.overall.iter().chain(&self.blocks).filter(is_found)
    }

    /// Iterates over the tests that say nothing, because a few samples decide.
    pub fn undecided(&self) -> impl Iterator<Item = &AuditTest> {
        let tests = self.overall.iter().chain(&self.blocks);
        tests.filter(|test| test.chance.is_none())
    }
}

/// Tests a film against one of the same pixels that was traced without bias.
///
/// Every block, layer and channel with light in it is tested with Welch's t over the batches of its pixels, and so are the
/// sums over all blocks. Half of the chance of a false alarm goes to the former, half to the latter, each corrected after
/// Holm. Means that hang on a few samples are set apart: see [`AuditTest::chance`].
///
/// - `ours`, `traced`: with `variance` and `layer_variance`, and the same layers; rendered independently.
/// - `blocks`: that do not overlap.
/// - returns nothing when a film lacks any of that, or a pixel has fewer than [`LEAST_AUDIT_SAMPLES`].
#[must_use]
pub fn audit(ours: &Film, traced: &Film, blocks: &[PixelBlock], options: &AuditOptions) -> Option<Audit> {
    let films = [ours, traced];
    let samples = films.map(|film| (0..film.pixel_count()).map(|i| film.sample_count(i)).min().unwrap_or(0));
    let has_all = |film: &Film| film.layout().variance && film.layout().layer_variance;
    let fits = ours.layout() == traced.layout() && ours.pixel_count() == traced.pixel_count();
    let is_inside = |block: &PixelBlock| !block.storage.is_empty() && block.storage.end <= ours.pixel_count();
    if !(films.into_iter().all(has_all) && fits && blocks.iter().all(is_inside))
        || blocks.is_empty()
        || samples.iter().any(|count| *count < LEAST_AUDIT_SAMPLES)
    {
        return None;
    }
    let layers: Vec<Option<usize>> = std::iter::once(None)
        .chain((0..ours.layout().layers.len()).map(Some))
        .collect();
    let all: Vec<usize> = blocks.iter().flat_map(|block| block.storage.clone()).collect();
    let whole: Vec<[Measured; 3]> = layers
        .iter()
        .map(|layer| [0, 1, 2].map(|channel| Measured::of(films, all.iter().copied(), *layer, channel)))
        .collect();
    let dark = [0, 1, 2].map(|channel| DARK * whole[0][channel].means[1]);
    let mut overall = judge(None, &layers, &whole, [0.0; 3], options);
    let mut tests = Vec::new();
    for (row, block) in blocks.iter().enumerate() {
        let measured = |layer: &Option<usize>| {
            [0, 1, 2].map(|channel| Measured::of(films, block.storage.clone(), *layer, channel))
        };
        let measured: Vec<[Measured; 3]> = layers.iter().map(measured).collect();
        tests.extend(judge(Some(row), &layers, &measured, dark, options));
    }
    correct(&mut overall);
    correct(&mut tests);
    Some(Audit {
        overall,
        blocks: tests,
        samples,
        significance: options.significance,
    })
}

/// Corrects for the number of tests, twice as often as there are: the other half is for the other family.
fn correct(tests: &mut [AuditTest]) {
    let chances: Vec<f64> = tests.iter().filter_map(|test| test.chance).collect();
    let decided = tests.iter_mut().filter_map(|test| test.chance.as_mut());
    for (chance, corrected) in decided.zip(holm(&chances)) {
        *chance = (2.0 * corrected).min(1.0);
    }
}

/// Tests one block, or all together.
///
/// - `measured`: for each of `layers`, of which the first is the beauty.
/// - `dark`: least value, in each channel, that the tolerance is relative to.
fn judge(
    block: Option<usize>,
    layers: &[Option<usize>],
    measured: &[[Measured; 3]],
    dark: [f64; 3],
    options: &AuditOptions,
) -> Vec<AuditTest> {
    let mut tests = Vec::new();
    for channel in 0..3 {
        let beauty = &measured[0][channel];
        let scale = beauty.means[1].max(dark[channel]);
        let tolerated = options.tolerance * scale;
        let is_by_chance = |layer: &Option<usize>| match layer {
            Some(layer) => options.by_chance.get(*layer) == Some(&true),
            None => options.by_chance.contains(&true),
        };
        let chance = |layer, measured: &Measured| measured.chance(is_by_chance(layer), tolerated, options);
        // What is not known of a layer is not known of the sum.
        let unknown = layers.iter().zip(measured).skip(1).any(|(layer, measured)| {
            let measured = &measured[channel];
            measured.means[0].max(measured.means[1]) > tolerated && chance(layer, measured).is_none()
        });
        for (layer, measured) in layers.iter().zip(measured) {
            let measured = &measured[channel];
            if !measured.has_light() {
                continue;
            }
            tests.push(AuditTest {
                block,
                layer: *layer,
                channel,
                ours: measured.means[0],
                traced: measured.means[1],
                standard_error: measured.welch.standard_error(),
                freedom: measured.welch.freedom(),
                tolerated,
                t: measured.welch.t(tolerated),
                chance: chance(layer, measured).filter(|_| !(layer.is_none() && unknown)),
            });
        }
    }
    tests
}

#[cfg(test)]
mod tests;
