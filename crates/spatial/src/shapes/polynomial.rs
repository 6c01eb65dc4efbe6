//! Real roots of small polynomials on an interval, none missed.

/// Calls `found` with the roots of the polynomial inside [low, high] in ascending order, until it says stop.
///
/// Between two neighbouring roots of its derivative a polynomial is monotonic, so that a sign change there brackets
/// exactly one root; the derivative's roots come the same way, down to a line. A root where the polynomial only touches
/// zero may count as none.
///
/// Source: Yuksel, "High-Performance Polynomial Root Finding for Graphics", HPG 2022.
///
/// - `coefficients`: constant term first, at most 5.
fn roots_of(coefficients: &[f64], low: f64, high: f64, roots: &mut [f64; 4]) -> usize {
    let degree = coefficients.len() - 1;
    if degree == 1 {
        let root = -coefficients[0] / coefficients[1];
        if root > low && root < high {
            roots[0] = root;
            return 1;
        }
        return 0;
    }
    let mut derivative = [0.0; 4];
    for (i, c) in coefficients.iter().enumerate().skip(1) {
        derivative[i - 1] = c * i as f64;
    }
    let mut turning = [0.0; 4];
    let turns = roots_of(&derivative[..degree], low, high, &mut turning);
    let mut count = 0;
    let (mut a, mut value_a) = (low, evaluate(coefficients, low));
    for b in turning[..turns].iter().copied().chain([high]) {
        let value_b = evaluate(coefficients, b);
        if (value_a < 0.0) != (value_b < 0.0) && count < 4 {
            roots[count] = bracketed(coefficients, &derivative[..degree], (a, value_a), b);
            count += 1;
        }
        (a, value_a) = (b, value_b);
    }
    count
}

/// Roots of a quartic inside (low, high), ascending, and how many.
pub(super) fn quartic_roots(coefficients: &[f64; 5], low: f64, high: f64) -> ([f64; 4], usize) {
    let mut roots = [0.0; 4];
    if !(low < high) {
        return (roots, 0);
    }
    let count = roots_of(coefficients, low, high, &mut roots);
    (roots, count)
}

fn evaluate(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The root between `a` and `b`, where the polynomial changes sign once: Newton's steps, halving where they leave the
/// bracket.
fn bracketed(coefficients: &[f64], derivative: &[f64], (a, value_a): (f64, f64), b: f64) -> f64 {
    const STEPS: usize = 60;
    let rising = value_a < 0.0;
    let (mut a, mut b) = (a, b);
    let mut x = 0.5 * (a + b);
    for _ in 0..STEPS {
        let value = evaluate(coefficients, x);
        if (value < 0.0) == rising {
            a = x;
        } else {
            b = x;
        }
        let step = x - value / evaluate(derivative, x);
        let next = if step > a && step < b { step } else { 0.5 * (a + b) };
        if (next - x).abs() <= 1e-15 * x.abs().max(1e-3) {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_simple_root_inside_is_found(mut r in prop::array::uniform4(-2.0_f64..2.0), scale in 0.1_f64..10.0) {
            r.sort_by(f64::total_cmp);
            prop_assume!(r.windows(2).all(|w| w[1] - w[0] > 1e-3));
            let mut c = [scale, 0.0, 0.0, 0.0, 0.0];
            for (degree, root) in r.iter().enumerate() {
                for i in (0..=degree + 1).rev() {
                    c[i] = if i > 0 { c[i - 1] } else { 0.0 } - root * c[i];
                }
            }
            let inside: Vec<f64> = r.iter().copied().filter(|x| x.abs() < 1.5).collect();
            let (found, count) = quartic_roots(&c, -1.5, 1.5);
            prop_assert_eq!(count, inside.len());
            for (a, b) in found.iter().zip(&inside) {
                prop_assert!((a - b).abs() < 1e-6, "{} is not {}", a, b);
            }
        }
    }

    #[test]
    fn lower_degrees_are_quartics_with_zeros_in_front() {
        assert_eq!(quartic_roots(&[-1.0, 0.0, 1.0, 0.0, 0.0], -3.0, 3.0).1, 2);
        assert_eq!(quartic_roots(&[-1.0, 1.0, 0.0, 0.0, 0.0], -3.0, 3.0).1, 1);
        assert_eq!(quartic_roots(&[1.0, 0.0, 0.0, 0.0, 0.0], -3.0, 3.0).1, 0);
    }
}
