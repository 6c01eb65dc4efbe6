//! Sums of independent batches of samples, whose spread tells the variance of their mean.

/// Batches that the samples of a pixel are dealt to: each an independently scrambled sequence of its own.
pub const BATCHES: u32 = 8;

/// Samples that go to one batch before the next has its turn; few samples then still are a stratified set.
pub const BATCH_RUN: u32 = 4;

/// Sums of the beauty channels of each batch of a pixel.
pub(crate) type PixelBatches = [[BatchSum; 3]; BATCHES as usize];

/// The batch of a sample, by its number in the pixel.
#[inline]
pub(crate) fn batch_of(number: u32) -> usize {
    (number / BATCH_RUN % BATCHES) as usize
}

/// Samples of a batch among the first `count` of the pixel.
fn samples_of(batch: u32, count: u32) -> u32 {
    let round = BATCHES * BATCH_RUN;
    let rest = (count % round).saturating_sub(batch * BATCH_RUN).min(BATCH_RUN);
    count / round * BATCH_RUN + rest
}

/// An exact sum as [`FixedSum`](crate::FixedSum), of half the size: units of 2⁻²⁸.
///
/// Terms above 2²⁴ count as that, so that one of them cannot wrap the sum; the variance is then too low.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct BatchSum(i64);

const UNITS: f64 = (1_u64 << 28) as f64;
const MOST: f32 = (1_u32 << 24) as f32;

impl BatchSum {
    #[inline]
    pub(crate) fn add(&mut self, term: f32) {
        let units = (f64::from(term.min(MOST)) * UNITS) as i64;
        self.0 = self.0.wrapping_add(units);
    }

    pub(crate) fn merge(&mut self, other: Self) {
        self.0 = self.0.wrapping_add(other.0);
    }

    fn to_f64(self) -> f64 {
        self.0 as f64 / UNITS
    }

    pub(crate) fn to_le_bytes(self) -> [u8; 8] {
        self.0.to_le_bytes()
    }

    pub(crate) fn from_le_bytes(bytes: [u8; 8]) -> Self {
        Self(i64::from_le_bytes(bytes))
    }
}

/// What the batches of a pixel say of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Mean of all samples.
    pub mean: f64,
    /// Of the mean; 0 with fewer than two batches.
    pub variance: f64,
    /// Of each batch, its part of the mean: the batches add up to it.
    pub parts: [f64; BATCHES as usize],
    /// Of each batch, how far that is from its share of the mean.
    pub off: [f64; BATCHES as usize],
}

/// Mean of all samples and its variance: `Σ w_b² (m_b − m)² / (1 − Σ w_b²)` over batches of means `m_b` and shares `w_b`.
///
/// Unbiased for independent batches whose variances are as the inverse of their lengths; for equal ones it is
/// `Σ (m_b − m)² / (B (B − 1))`.
///
/// - `count`: samples of the pixel.
pub(crate) fn estimate(batches: &PixelBatches, component: usize, count: u32) -> Estimate {
    let all = f64::from(count);
    let sum: f64 = batches.iter().map(|batch| batch[component].to_f64()).sum();
    if count == 0 {
        return Estimate::default();
    }
    let mean = sum / all;
    let mut found = Estimate {
        mean,
        ..Estimate::default()
    };
    let (mut spread, mut shares) = (0.0, 0.0);
    for (batch, sums) in batches.iter().enumerate() {
        let share = f64::from(samples_of(batch as u32, count)) / all;
        found.parts[batch] = sums[component].to_f64() / all;
        // w_b (m_b − m), without dividing by the length of an empty batch.
        found.off[batch] = found.parts[batch] - share * mean;
        spread += found.off[batch] * found.off[batch];
        shares += share * share;
    }
    found.variance = if shares < 1.0 { spread / (1.0 - shares) } else { 0.0 };
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_in_one_batch() {
        for count in [0, 1, 4, 5, 31, 32, 33, 63, 64, 1000] {
            let mut seen = [0; BATCHES as usize];
            (0..count).for_each(|number| seen[batch_of(number)] += 1);
            for (batch, seen) in (0..).zip(seen) {
                assert_eq!(samples_of(batch, count), seen, "{count}");
            }
        }
    }

    #[test]
    fn the_variance_is_that_of_means_of_batches() {
        let mut batches = PixelBatches::default();
        for number in 0..64 {
            // Batch b has the mean b.
            batches[batch_of(number)][0].add(batch_of(number) as f32 + if number % 2 == 0 { 0.25 } else { -0.25 });
        }
        let found = estimate(&batches, 0, 64);
        assert_eq!(found.mean, 3.5);
        // Of 0 to 7 the squared deviations add up to 42.
        assert!((found.variance - 42.0 / 56.0).abs() < 1e-12);
        assert_eq!(estimate(&batches, 1, 64).variance, 0.0);
        assert_eq!(estimate(&PixelBatches::default(), 0, 0).mean, 0.0);
    }
}
