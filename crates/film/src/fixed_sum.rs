//! Sums that do not depend on the order of their terms.

/// Units per 1.0, as a power of two.
const FRACTION_BITS: i32 = 64;

/// Exclusive upper bound on the magnitude of a single term, 2^40.
pub const MAX_MAGNITUDE: f32 = 1_099_511_627_776.0;

/// An exact sum: a 128-bit integer in units of 2⁻⁶⁴.
///
/// Floating-point addition is not associative, so a sum over samples would depend on how they were
/// split over threads, tiles, machines or an interruption. Integer addition is: each term is rounded
/// to the grid once, on its own, and from there on every order and every grouping gives the same
/// bits. That one property is why the film can promise the same image however the work was shared.
///
/// Range: terms below 2^40 in magnitude, and 2^23 of those at the very limit before the sum wraps
/// around; at radiances below 2^20, 2^43 samples. Resolution: 2⁻⁶⁴ ≈ 5·10⁻²⁰ per term; a term of
/// 2⁻⁴⁰ or more keeps all its 24 significant bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct FixedSum(i128);

impl FixedSum {
    /// The empty sum.
    pub const ZERO: Self = Self(0);

    /// Adds one term, rounded to the nearest multiple of 2⁻⁶⁴ (halves away from zero).
    ///
    /// - `term`: finite, below [`MAX_MAGNITUDE`] in magnitude; checked in debug builds only, because
    ///   the film guards its input at one place. Other values give an unspecified sum.
    ///
    /// Cost: a shift and a 128-bit addition.
    #[inline]
    pub fn add(&mut self, term: f32) {
        debug_assert!(term.abs() < MAX_MAGNITUDE, "term {term} is not below 2^40");
        self.0 = self.0.wrapping_add(units_from_f32(term));
    }

    /// Adds another sum: the same bits as adding its terms one by one.
    #[inline]
    pub fn merge(&mut self, other: Self) {
        self.0 = self.0.wrapping_add(other.0);
    }

    /// Returns the sum rounded to the nearest `f64`.
    #[inline]
    #[must_use]
    pub fn to_f64(self) -> f64 {
        // The factor is a power of two, so that only the conversion rounds.
        self.0 as f64 * (1.0 / 18_446_744_073_709_551_616.0)
    }

    /// Returns the little-endian bytes of the integer, for checkpoints.
    #[must_use]
    pub fn to_le_bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }

    /// Restores a sum from [`FixedSum::to_le_bytes`].
    #[must_use]
    pub fn from_le_bytes(bytes: [u8; 16]) -> Self {
        Self(i128::from_le_bytes(bytes))
    }
}

/// Converts to units of 2⁻⁶⁴ from the bits of the number, with integer operations alone.
#[inline]
fn units_from_f32(term: f32) -> i128 {
    const EXPONENT_OF_UNIT_MANTISSA: i32 = 127 + 23;
    let bits = term.to_bits();
    let exponent = ((bits >> 23) & 0xff) as i32;
    if exponent == 0 {
        // Zero, or below 2^-126: far less than half a unit.
        return 0;
    }
    let mantissa = i128::from((bits & 0x007f_ffff) | 0x0080_0000);
    let shift = exponent - EXPONENT_OF_UNIT_MANTISSA + FRACTION_BITS;
    let magnitude = if shift >= 0 {
        // At most 80 for terms in range; the cut-off keeps the shift defined for all others.
        mantissa << shift.min(102)
    } else if shift >= -24 {
        (mantissa + (1 << (-shift - 1))) >> -shift
    } else {
        0
    };
    if term.is_sign_negative() { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum_of(terms: &[f32]) -> FixedSum {
        let mut sum = FixedSum::ZERO;
        terms.iter().for_each(|&term| sum.add(term));
        sum
    }

    fn terms() -> impl Strategy<Value = Vec<f32>> {
        let term = (any::<bool>(), 0.0_f32..1.0, -70_i32..40).prop_map(|(negative, m, e)| {
            let magnitude = m * libm::exp2f(e as f32);
            if negative { -magnitude } else { magnitude }
        });
        prop::collection::vec(term, 0..200)
    }

    proptest! {
        #[test]
        fn order_and_split_do_not_matter(
            (original, shuffled) in terms().prop_flat_map(|t| (Just(t.clone()), Just(t).prop_shuffle())),
            cut in any::<prop::sample::Index>(),
        ) {
            let whole = sum_of(&original);
            let (left, right) = shuffled.split_at(cut.index(shuffled.len() + 1));
            let mut merged = sum_of(right);
            merged.merge(sum_of(left));
            prop_assert_eq!(whole, merged);
        }

        #[test]
        fn sum_is_as_accurate_as_f64(terms in terms()) {
            let exact: f64 = terms.iter().map(|&t| f64::from(t)).sum();
            let scale: f64 = terms.iter().map(|&t| f64::from(t).abs()).sum();
            let tolerance = 1e-13 * scale + terms.len() as f64 * 6e-20;
            prop_assert!((sum_of(&terms).to_f64() - exact).abs() <= tolerance);
        }

        #[test]
        fn one_term_comes_back(m in 0.5_f32..1.0, e in -39_i32..40) {
            let term = m * libm::exp2f(e as f32);
            prop_assert_eq!(sum_of(&[term]).to_f64(), f64::from(term));
            prop_assert_eq!(sum_of(&[-term]).to_f64(), -f64::from(term));
        }
    }

    #[test]
    fn rounds_to_the_nearest_unit() {
        let unit = libm::exp2f(-64.0);
        assert_eq!(sum_of(&[unit]), FixedSum(1));
        assert_eq!(sum_of(&[unit * 0.5]), FixedSum(1));
        assert_eq!(sum_of(&[unit * 0.49]), FixedSum(0));
        assert_eq!(sum_of(&[-unit * 1.5]), FixedSum(-2));
        assert_eq!(sum_of(&[f32::MIN_POSITIVE, 1e-45, 0.0, -0.0]), FixedSum(0));
        assert_eq!(sum_of(&[1.0]), FixedSum(1 << 64));
    }
}
