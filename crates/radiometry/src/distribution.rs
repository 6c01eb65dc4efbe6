/// A discrete distribution over `0..n`, sampled by inverting its cumulative sum.
///
/// The inversion keeps the stratification of the random number that drives it, which an alias table would destroy.
/// Sums are taken in `f64`, in index order. Cost of a sample: O(log n).
#[derive(Clone, Debug, Default)]
pub struct Distribution {
    /// `cumulative[i]` is the probability of an index ≤ i; the last is 1.
    cumulative: Vec<f32>,
    probabilities: Vec<f32>,
    total: f64,
}

impl Distribution {
    /// Builds the distribution that chooses index i in proportion to `weights[i]`.
    ///
    /// Negative or non-finite weights count as zero. When every weight is zero, the distribution is empty: sampling it
    /// yields `None`.
    #[must_use]
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let clean = |w: f64| if w.is_finite() && w > 0.0 { w } else { 0.0 };
        let weights: Vec<f64> = weights.into_iter().map(clean).collect();
        let total: f64 = weights.iter().sum();
        if total <= 0.0 {
            return Self::default();
        }
        let mut sum = 0.0;
        let mut cumulative: Vec<f32> = weights
            .iter()
            .map(|w| {
                sum += w;
                (sum / total) as f32
            })
            .collect();
        // The last index with weight closes the range, so rounding can never choose an index of weight zero behind it.
        if let Some(last) = weights.iter().rposition(|w| *w > 0.0) {
            cumulative[last..].fill(1.0);
        }
        let probabilities = weights.iter().map(|w| (w / total) as f32).collect();
        Self {
            cumulative,
            probabilities,
            total,
        }
    }

    /// Chooses an index with `u` in [0, 1); also returns its probability and `u` stretched back over [0, 1).
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> Option<(usize, f32, f32)> {
        if self.cumulative.is_empty() {
            return None;
        }
        let i = self
            .cumulative
            .partition_point(|c| *c <= u)
            .min(self.cumulative.len() - 1);
        let low = if i == 0 { 0.0 } else { self.cumulative[i - 1] };
        let width = self.cumulative[i] - low;
        let rest = if width > 0.0 {
            ((u - low) / width).clamp(0.0, ONE_MINUS_EPSILON)
        } else {
            0.0
        };
        Some((i, self.probabilities[i], rest))
    }

    /// Probability of `index`; 0 beyond the end.
    #[inline]
    #[must_use]
    pub fn probability(&self, index: usize) -> f32 {
        self.probabilities.get(index).copied().unwrap_or(0.0)
    }

    /// Sum of the weights.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// True when nothing can be chosen.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cumulative.is_empty()
    }
}

/// The largest number below 1.
const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_come_in_proportion_and_never_those_of_weight_zero() {
        let d = Distribution::new([0.0, 1.0, 0.0, 3.0, 0.0]);
        let n = 4000;
        let mut counts = [0; 5];
        for i in 0..n {
            let (index, p, rest) = d.sample((i as f32 + 0.5) / n as f32).expect("weights");
            counts[index] += 1;
            assert_eq!(p, d.probability(index));
            assert!((0.0..1.0).contains(&rest));
        }
        assert_eq!(counts, [0, 1000, 0, 3000, 0]);
        assert_eq!(d.sample(ONE_MINUS_EPSILON).expect("weights").0, 3);
    }

    #[test]
    fn nothing_to_choose_is_none() {
        assert!(Distribution::new([0.0, f64::NAN, -1.0]).sample(0.5).is_none());
        assert!(Distribution::new([]).is_empty());
    }
}
