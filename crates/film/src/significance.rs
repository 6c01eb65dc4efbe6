//! Whether two means differ by more than their noise.

use std::f64::consts::FRAC_PI_2;

/// Compares two sums of estimates whose variances are estimates themselves: Welch's t-test.
///
/// `t = D / √V`, with `D` the sum of all differences and `V = Σ v_i` that of all variances, has about Student's
/// distribution with `ν = V² / Σ (v_i² / ν_i)` degrees of freedom.
///
/// Source: Welch, "The generalization of 'Student's' problem", Biometrika 34, 1947; Satterthwaite, Biometrics Bulletin 2, 1946.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Welch {
    difference: f64,
    variance: f64,
    spread: f64,
}

impl Welch {
    /// Adds a difference of two independent estimates.
    ///
    /// - `variances`: of both, with their degrees of freedom above 0; infinite ones for a variance that is known.
    pub fn add(&mut self, difference: f64, variances: [(f64, f64); 2]) {
        self.difference += difference;
        for (variance, freedom) in variances {
            self.variance += variance;
            self.spread += variance * variance / freedom;
        }
    }

    /// Returns the same in other units, such as of a mean for a sum.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let square = factor * factor;
        Self {
            difference: factor * self.difference,
            variance: square * self.variance,
            spread: square * square * self.spread,
        }
    }

    /// Returns the sum of all differences.
    #[must_use]
    pub fn difference(&self) -> f64 {
        self.difference
    }

    /// Returns the standard error of that sum.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Returns the degrees of freedom of the standard error; infinite where nothing is estimated.
    #[must_use]
    pub fn freedom(&self) -> f64 {
        if self.spread > 0.0 {
            self.variance * self.variance / self.spread
        } else {
            f64::INFINITY
        }
    }

    /// Returns the difference in standard errors, less what is tolerated; 0 where it is tolerated.
    ///
    /// - `tolerance`: magnitude of a difference that counts as none, in units of the difference, from 0.
    #[must_use]
    pub fn t(&self, tolerance: f64) -> f64 {
        let beyond = (self.difference.abs() - tolerance).max(0.0);
        if beyond > 0.0 {
            (beyond / self.standard_error()).copysign(self.difference)
        } else {
            0.0
        }
    }

    /// Returns the chance that noise alone puts a true difference of no more than `tolerance` this far off, or farther.
    #[must_use]
    pub fn p_value(&self, tolerance: f64) -> f64 {
        p_value(self.t(tolerance), self.freedom())
    }
}

/// A normal distribution in place of more degrees of freedom would be off by less than the integration.
const MOST_FREEDOM: f64 = 1e5;

/// Returns the chance that Student's t is at least as far from 0, to the left or the right.
///
/// `P(|T| ≥ t) = ∫ cos^(ν−1) φ dφ` over `[φ_t, π/2]`, divided by that over `[0, π/2]`, with `t = √ν tan φ_t`.
///
/// - `freedom`: ν, at least 1; infinite for a normal distribution.
///
/// Cost: some ten thousand powers; good to three digits down to 10⁻¹⁰⁰.
#[must_use]
pub fn p_value(t: f64, freedom: f64) -> f64 {
    if t == 0.0 {
        return 1.0;
    }
    if t.is_infinite() {
        return 0.0;
    }
    let freedom = freedom.clamp(1.0, MOST_FREEDOM);
    let power = |angle: f64| libm::pow(libm::cos(angle).max(0.0), freedom - 1.0);
    // Where cos^(ν−1) is spread over a few 1/√ν, steps have to be small there.
    let width = (8.0 / freedom.sqrt()).min(FRAC_PI_2);
    let integral = |from: f64| {
        let middle = (from + width).min(FRAC_PI_2);
        simpson(from, middle, power) + simpson(middle, FRAC_PI_2, power)
    };
    (integral(libm::atan(t.abs() / freedom.sqrt())) / integral(0.0)).min(1.0)
}

/// Integrates a smooth function.
fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PARTS: u32 = 2048;
    let step = (to - from) / f64::from(PARTS);
    let inside: f64 = (1..PARTS)
        .map(|i| f64::from(2 + 2 * (i % 2)) * f(from + f64::from(i) * step))
        .sum();
    (f(from) + inside + f(to)) * step / 3.0
}

/// Returns the t that has the chance `p`, between 0 and 1, in both tails together.
#[must_use]
pub fn t_quantile(p: f64, freedom: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if p_value(middle, freedom) > p {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Corrects the chances of many tests for their number, so that the chance of any false alarm is no more than the level
/// that the results are held against, however the tests depend on each other.
///
/// - returns `max over p_j ≤ p_i of min(1, (m − rank_j) p_j)`, in the order given.
///
/// Source: Holm, "A Simple Sequentially Rejective Multiple Test Procedure", Scandinavian Journal of Statistics 6, 1979.
#[must_use]
pub fn holm(chances: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..chances.len()).collect();
    order.sort_by(|&a, &b| chances[a].total_cmp(&chances[b]));
    let mut corrected = vec![0.0; chances.len()];
    let mut most = 0.0_f64;
    for (rank, &test) in order.iter().enumerate() {
        most = most.max(chances[test] * (chances.len() - rank) as f64).min(1.0);
        corrected[test] = most;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_are_those_of_student() {
        // Quantiles from tables.
        for (freedom, t, p) in [
            (1.0, 12.706, 0.05),
            (2.0, 31.599, 0.001),
            (7.0, 0.711, 0.5),
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
            assert!((t_quantile(p, freedom) - t).abs() < 0.005 * t, "{freedom}, {p}");
        }
        assert_eq!((p_value(0.0, 7.0), p_value(f64::INFINITY, 7.0)), (1.0, 0.0));
    }

    #[test]
    fn what_is_tolerated_is_no_difference() {
        let mut sum = Welch::default();
        sum.add(-3.0, [(0.5, 7.0), (0.5, 7.0)]);
        assert_eq!((sum.t(0.0), sum.t(1.0), sum.t(3.0)), (-3.0, -2.0, 0.0));
        assert_eq!((sum.freedom(), sum.p_value(4.0)), (14.0, 1.0));
        let mut exact = Welch::default();
        exact.add(1.0, [(0.0, 7.0); 2]);
        assert_eq!((exact.p_value(0.5), exact.p_value(1.0)), (0.0, 1.0));
    }

    #[test]
    fn the_correction_is_that_of_holm() {
        let corrected = holm(&[0.01, 0.04, 0.03, 0.005]);
        let expected = [0.03, 0.06, 0.06, 0.02];
        assert!(
            corrected.iter().zip(expected).all(|(c, e)| (c - e).abs() < 1e-12),
            "{corrected:?}"
        );
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
    }
}
