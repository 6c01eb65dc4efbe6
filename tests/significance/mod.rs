//! Whether an image differs from a reference by more than the noise of both.
//!
//! Each value of the image is tested against that of the reference with Welch's t-test: the variance of a pixel's mean comes
//! from eight batches here and from [`RUNS`] independent runs there, far too few to take it as known.

use film::{ExrImage, RgbImage, Welch};
use std::fmt;

/// Independent runs of the other renderer behind a reference with variance.
pub(crate) const RUNS: f64 = 64.0;

/// Chance that equal images have a single value that fails, whatever their size (Šidák's correction).
const SIGNIFICANCE: f64 = 0.01;

/// Share of all values that has to pass; permits rare values whose few batches all missed a rare bright path.
const PASSING: f64 = 0.9975;

/// Standard deviation, relative to the value, that the reference's sums in single precision may add.
const ROUNDING: f64 = 1e-5;

/// Sides of the square blocks that are tested: single pixels find what is sharp, larger blocks what is faint.
pub(crate) const SIDES: [usize; 3] = [1, 2, 8];

/// Means of pixels, with the variance of these means.
pub(crate) struct Measured {
    mean: RgbImage,
    variance: RgbImage,
    /// Degrees of freedom of the variance of one pixel.
    freedom: f64,
}

impl Measured {
    /// - `estimates`: how many independent estimates of each pixel are behind its variance.
    pub(crate) fn new(image: &ExrImage, estimates: f64) -> Self {
        Self {
            mean: image.rgb("").expect("R, G, B"),
            variance: image.rgb("variance").expect("a variance layer"),
            freedom: estimates - 1.0,
        }
    }

    /// The relMSE that noise alone is expected to make.
    pub(crate) fn own_rel_mse(&self) -> f64 {
        let values = self.mean.pixels.as_flattened();
        let floor = 0.1 * values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
        let relative = |(&mean, &variance): (&f32, &f32)| {
            let mean = f64::from(mean);
            f64::from(variance) / (mean * mean + floor * floor)
        };
        let pairs = values.iter().zip(self.variance.pixels.as_flattened());
        pairs.map(relative).sum::<f64>() / values.len() as f64
    }
}

/// What the tests of all blocks of one size, in three channels each, have found.
#[derive(Debug)]
pub(crate) struct Verdict {
    /// Side of the blocks, in pixels.
    pub(crate) side: usize,
    /// Root of the mean square of the statistic: about 1 for equal images.
    pub(crate) rms: f64,
    /// Values tested.
    pub(crate) tested: usize,
    /// Values that differ significantly.
    pub(crate) failed: usize,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            side,
            rms,
            tested,
            failed,
        } = self;
        write!(
            f,
            "blocks of {side}: {failed} of {tested} differ, root mean square {rms:.3}"
        )
    }
}

impl Verdict {
    pub(crate) fn passes(&self) -> bool {
        self.failed as f64 <= (1.0 - PASSING) * self.tested as f64
    }
}

/// Compares two images over blocks of pixels.
///
/// - `side`: of a block, a divisor of the width and the height.
pub(crate) fn test_blocks(image: &Measured, reference: &Measured, side: usize) -> Verdict {
    let (width, height) = (image.mean.width as usize, image.mean.height as usize);
    assert!(
        (image.mean.width, image.mean.height) == (reference.mean.width, reference.mean.height),
        "the sizes differ"
    );
    assert!(
        width.is_multiple_of(side) && height.is_multiple_of(side),
        "blocks fill the image"
    );
    let corners = |end: usize| (0..end).step_by(side);
    let blocks = corners(height).flat_map(|y| corners(width).map(move |x| (x, y)));
    let values = blocks.flat_map(|block| (0..3).map(move |channel| (block, channel)));
    let statistics: Vec<Welch> = values
        .map(|((x, y), channel)| {
            let rows = (y..y + side).map(|row| row * width);
            let pixels = rows.flat_map(|row| row + x..row + x + side);
            statistic(image, reference, pixels, channel)
        })
        .collect();
    let tested = statistics.len();
    let level = 1.0 - radiometry::math::powf_f64(1.0 - SIGNIFICANCE, 1.0 / tested as f64);
    Verdict {
        side,
        rms: (statistics.iter().map(|found| found.t(0.0).powi(2)).sum::<f64>() / tested as f64).sqrt(),
        tested,
        failed: statistics.iter().filter(|found| found.p_value(0.0) < level).count(),
    }
}

/// Compares a sum of pixels.
fn statistic(image: &Measured, reference: &Measured, pixels: impl Iterator<Item = usize>, channel: usize) -> Welch {
    let mut sum = Welch::default();
    for pixel in pixels {
        let theirs = f64::from(reference.mean.pixels[pixel][channel]);
        let difference = f64::from(image.mean.pixels[pixel][channel]) - theirs;
        let variances = [image, reference].map(|side| {
            let own = f64::from(side.variance.pixels[pixel][channel]);
            (own, side.freedom)
        });
        sum.add(difference, variances);
        sum.add(
            0.0,
            [((ROUNDING * theirs).powi(2), f64::INFINITY), (0.0, f64::INFINITY)],
        );
    }
    sum
}
