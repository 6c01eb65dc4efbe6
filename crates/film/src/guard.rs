//! The one place that keeps bad numbers out of an image.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::fixed_sum::MAX_MAGNITUDE;

/// Why a sample was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum Rejected {
    /// A value was not a number.
    #[error("the sample has a value that is not a number")]
    Nan,
    /// A radiance or alpha was below zero.
    #[error("the sample has a negative radiance")]
    Negative,
    /// A value was infinite, or 2^40 or more in magnitude.
    #[error("the sample has an infinite value, or one of 2^40 or more")]
    Infinite,
}

/// How many samples were dropped, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct RejectedCounts {
    /// Samples with a value that is not a number.
    pub nan: u64,
    /// Samples with a negative radiance.
    pub negative: u64,
    /// Samples with an infinite or enormous value.
    pub infinite: u64,
}

impl RejectedCounts {
    /// Returns the number of dropped samples.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.nan + self.negative + self.infinite
    }
}

/// Counts that all spans of a film add to; integers, so that the order does not matter.
#[derive(Debug, Default)]
pub(crate) struct RejectedCounter([AtomicU64; 3]);

impl RejectedCounter {
    pub(crate) fn count(&self, reason: Rejected) {
        let index = match reason {
            Rejected::Nan => 0,
            Rejected::Negative => 1,
            Rejected::Infinite => 2,
        };
        self.0[index].fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn add(&self, counts: RejectedCounts) {
        for (counter, count) in self.0.iter().zip([counts.nan, counts.negative, counts.infinite]) {
            counter.fetch_add(count, Ordering::Relaxed);
        }
    }

    pub(crate) fn get(&self) -> RejectedCounts {
        let [nan, negative, infinite] = [0, 1, 2].map(|i: usize| self.0[i].load(Ordering::Relaxed));
        RejectedCounts {
            nan,
            negative,
            infinite,
        }
    }
}

/// Checks every value of a sample; the first bad one decides the reason.
#[inline]
pub(crate) fn check_sample(radiance: &[[f32; 3]], alpha: f32, aux: &[f32]) -> Result<(), Rejected> {
    for &value in radiance.as_flattened() {
        check_radiance(value)?;
    }
    check_radiance(alpha)?;
    for &value in aux {
        check_radiance(value.abs())?;
    }
    Ok(())
}

#[inline]
fn check_radiance(value: f32) -> Result<(), Rejected> {
    // One comparison pair for the good case; NaN fails both.
    if (0.0..MAX_MAGNITUDE).contains(&value) {
        Ok(())
    } else if value.is_nan() {
        Err(Rejected::Nan)
    } else if value.is_infinite() || value >= MAX_MAGNITUDE {
        Err(Rejected::Infinite)
    } else {
        Err(Rejected::Negative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_bad_value_is_named() {
        let good = [[0.0, 1.0, 2.0], [-0.0, 0.5, 1e12]];
        assert_eq!(check_sample(&good, 1.0, &[-1e12, 0.0]), Ok(()));
        let radiance = |value| check_sample(&[[0.0, 0.0, value]], 1.0, &[]);
        assert_eq!(radiance(f32::NAN), Err(Rejected::Nan));
        assert_eq!(radiance(-1e-30), Err(Rejected::Negative));
        assert_eq!(radiance(f32::INFINITY), Err(Rejected::Infinite));
        assert_eq!(radiance(f32::NEG_INFINITY), Err(Rejected::Infinite));
        assert_eq!(radiance(MAX_MAGNITUDE), Err(Rejected::Infinite));
        let aux = |value| check_sample(&[], 1.0, &[value]);
        assert_eq!(aux(-1.0), Ok(()));
        assert_eq!(aux(f32::NAN), Err(Rejected::Nan));
        assert_eq!(aux(-MAX_MAGNITUDE), Err(Rejected::Infinite));
        assert_eq!(check_sample(&[], -0.5, &[]), Err(Rejected::Negative));
    }
}
