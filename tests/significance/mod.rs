//! Whether an image differs from a reference by more than the noise of both.
//!
//! Each value of the image is tested against that of the reference with Welch's t-test: the variance of a pixel's mean comes
//! from eight batches here and from [`RUNS`] independent runs there, far too few to take it as known.

#![expect(
    clippy::disallowed_methods,
    reason = "judges pictures, and no bit of one depends on it"
)]

use film::{ExrImage, RgbImage};
use std::f64::consts::FRAC_PI_2;
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
    let statistics: Vec<(f64, f64)> = values
        .map(|((x, y), channel)| {
            let rows = (y..y + side).map(|row| row * width);
            let pixels = rows.flat_map(|row| row + x..row + x + side);
            statistic(image, reference, pixels, channel)
        })
        .collect();
    let tested = statistics.len();
    let level = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tested as f64);
    Verdict {
        side,
        rms: (statistics.iter().map(|(t, _)| t * t).sum::<f64>() / tested as f64).sqrt(),
        tested,
        failed: statistics
            .iter()
            .filter(|(t, freedom)| p_value(*t, *freedom) < level)
            .count(),
    }
}

/// Welch's t of a sum of pixels, and its degrees of freedom after Satterthwaite.
fn statistic(
    image: &Measured,
    reference: &Measured,
    pixels: impl Iterator<Item = usize>,
    channel: usize,
) -> (f64, f64) {
    let (mut difference, mut variance, mut spread) = (0.0, 0.0, 0.0);
    for pixel in pixels {
        let theirs = f64::from(reference.mean.pixels[pixel][channel]);
        difference += f64::from(image.mean.pixels[pixel][channel]) - theirs;
        variance += (ROUNDING * theirs).powi(2);
        for side in [image, reference] {
            let own = f64::from(side.variance.pixels[pixel][channel]);
            variance += own;
            spread += own * own / side.freedom;
        }
    }
    match difference {
        0.0 => (0.0, f64::INFINITY),
        _ => (difference / variance.sqrt(), variance * variance / spread),
    }
}

/// Chance that Student's t is at least as far from 0, to the left or the right.
///
/// `P(|T| ≥ t) = ∫ cos^(ν−1) φ dφ` over `[φ_t, π/2]`, divided by that over `[0, π/2]`, with `t = √ν tan φ_t`.
fn p_value(t: f64, freedom: f64) -> f64 {
    /// A normal distribution in place of more degrees of freedom would be off by less than the integration.
    const MOST_FREEDOM: f64 = 1e5;
    /// Values nearer to 0 pass whatever their freedom, so the exact chance does not matter; it saves the time.
    const CLEARLY_EQUAL: f64 = 2.5;
    if t.abs() < CLEARLY_EQUAL {
        return 1.0;
    }
    let freedom = freedom.min(MOST_FREEDOM);
    let integral = |from: f64| simpson(from, FRAC_PI_2, |angle: f64| angle.cos().max(0.0).powf(freedom - 1.0));
    integral((t.abs() / freedom.sqrt()).atan()) / integral(0.0)
}

/// Integrates a smooth function.
fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PARTS: u32 = 4096;
    let step = (to - from) / f64::from(PARTS);
    let inside: f64 = (1..PARTS)
        .map(|i| f64::from(2 + 2 * (i % 2)) * f(from + f64::from(i) * step))
        .sum();
    (f(from) + inside + f(to)) * step / 3.0
}

#[test]
fn p_values_are_those_of_student() {
    // Quantiles from tables.
    for (freedom, t, p) in [
        (1.0, 12.706, 0.05),
        (2.0, 31.599, 0.001),
        (7.0, 3.499, 0.01),
        (7.0, 5.408, 0.001),
        (30.0, 2.750, 0.01),
        (120.0, 3.373, 0.001),
        (1e9, 3.2905, 0.001),
        (1e9, 4.8916, 1e-6),
    ] {
        let found = p_value(t, freedom);
        assert!((found - p).abs() < 0.005 * p, "{freedom}, {t}: {found} for {p}");
        assert_eq!(found, p_value(-t, freedom));
    }
}
