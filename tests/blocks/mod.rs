//! How far the blocks of an image are from those of another.

use film::RgbImage;
use std::fmt;

/// How far blocks are off, relative to their own means in the reference, the largest of the channels.
pub(crate) struct Quantiles {
    count: usize,
    median: f64,
    high: f64,
    most: f64,
}

impl Quantiles {
    pub(crate) fn of(blocks: &RgbImage, reference: &RgbImage) -> Self {
        Self::with_floor(blocks, reference, 0.0)
    }

    /// - `floor`: blocks darker than this share of the mean of all count as if they were as bright; where there is next to
    ///   no light, there is nothing to be relative to.
    pub(crate) fn with_floor(blocks: &RgbImage, reference: &RgbImage, floor: f64) -> Self {
        assert_eq!(blocks.pixels.len(), reference.pixels.len());
        let values = reference.pixels.as_flattened();
        let floor = floor * values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
        let relative = |ours: f32, theirs: f32| match f64::from(ours) - f64::from(theirs) {
            0.0 => 0.0,
            difference => difference.abs() / f64::from(theirs).max(floor),
        };
        let error = |(ours, theirs): (&[f32; 3], &[f32; 3])| {
            let channel = |c: usize| relative(ours[c], theirs[c]);
            (0..3).map(channel).fold(0.0, f64::max)
        };
        let mut errors: Vec<f64> = blocks.pixels.iter().zip(&reference.pixels).map(error).collect();
        errors.sort_by(f64::total_cmp);
        let quantile = |share: f64| errors[(share * (errors.len() - 1) as f64).round() as usize];
        Self {
            count: errors.len(),
            median: quantile(0.5),
            high: quantile(0.95),
            most: quantile(1.0),
        }
    }

    /// - `median`, `high`: what every other block, and every twentieth, may be off by.
    pub(crate) fn within(&self, [median, high]: [f64; 2]) -> bool {
        self.median < median && self.high < high
    }
}

impl fmt::Display for Quantiles {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [median, high, most] = [self.median, self.high, self.most].map(|share| 100.0 * share);
        write!(
            f,
            "{} blocks off by {median:.2} % at the median, {high:.2} % at the 95th percentile, {most:.1} % at most",
            self.count
        )
    }
}
