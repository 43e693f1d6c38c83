//! Polynomials in ascending powers: their value and slope, and a proof of where they stay positive.

use alloc::vec;
use alloc::vec::Vec;

/// Value and slope of the polynomial at `x` (Horner).
#[inline]
pub(super) fn value_and_slope(ascending: &[f64], x: f64) -> (f64, f64) {
    ascending.iter().rev().fold((0.0, 0.0), |(value, slope), a| (value * x + a, slope * x + value))
}

/// Coefficients of the derivative.
pub(super) fn derivative(ascending: &[f64]) -> Vec<f64> {
    ascending.iter().enumerate().skip(1).map(|(k, a)| k as f64 * a).collect()
}

/// Coefficients of the product.
pub(super) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            sum[i + j] += x * y;
        }
    }
    sum
}

/// Coefficients of `a - factor * b`.
pub(super) fn minus(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    let at = |c: &[f64], k: usize| c.get(k).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|k| at(a, k) - factor * at(b, k)).collect()
}

/// The first place in [0, `upper`] where the polynomial is not positive, to 1e-9 of `upper`; `None` is a proof that
/// there is none.
///
/// On an interval a polynomial lies within the hull of its Bernstein coefficients; halving the interval
/// tightens the hull. A zero that is only touched counts, and so does a coefficient that is not a number.
pub(super) fn first_not_positive(ascending: &[f64], upper: f64) -> Option<f64> {
    const DEEPEST: u32 = 30;
    let mut pending = vec![(0.0, 1.0, bernstein(ascending, upper), 0)];
    while let Some((from, to, hull, depth)) = pending.pop() {
        if hull.iter().all(|&b| b > 0.0) {
            continue;
        }
        if depth == DEEPEST || !hull.first().is_some_and(|&b| b > 0.0) {
            return Some(from * upper);
        }
        let middle = 0.5 * (from + to);
        let (left, right) = halves(hull);
        pending.push((middle, to, right, depth + 1));
        pending.push((from, middle, left, depth + 1));
    }
    None
}

/// Bernstein coefficients on [0, `upper`].
fn bernstein(ascending: &[f64], upper: f64) -> Vec<f64> {
    let degree = ascending.len().saturating_sub(1);
    (0..ascending.len())
        .map(|i| {
            let (mut ratio, mut power, mut sum) = (1.0, 1.0, 0.0);
            for (k, a) in ascending.iter().enumerate().take(i + 1) {
                sum += ratio * power * a;
                ratio *= (i - k) as f64 / (degree - k).max(1) as f64;
                power *= upper;
            }
            sum
        })
        .collect()
}

/// Bernstein coefficients on the left and right half of the interval (de Casteljau).
fn halves(mut hull: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let mut left = Vec::with_capacity(hull.len());
    for end in (0..hull.len()).rev() {
        left.push(hull[0]);
        for i in 0..end {
            hull[i] = 0.5 * (hull[i] + hull[i + 1]);
        }
    }
    (left, hull)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_and_slope_of_a_cubic() {
        assert_eq!(value_and_slope(&[1.0, -2.0, 0.0, 3.0], 2.0), (21.0, 34.0));
        assert_eq!(derivative(&[1.0, -2.0, 0.0, 3.0]), [-2.0, 0.0, 9.0]);
        assert_eq!(product(&[1.0, 2.0], &[3.0, 0.0, 1.0]), [3.0, 6.0, 1.0, 2.0]);
        assert_eq!(minus(&[1.0], 2.0, &[1.0, 3.0]), [-1.0, -6.0]);
    }

    #[test]
    fn the_first_zero_is_found_even_when_narrow() {
        // (x - 2)^2 + floor, times (5 - x)
        let dip = |floor: f64| product(&[4.0 + floor, -4.0, 1.0], &[5.0, -1.0]);
        assert_eq!(first_not_positive(&dip(1e-6), 4.9), None);
        assert!((first_not_positive(&dip(1e-6), 6.0).unwrap() - 5.0).abs() < 1e-8);
        assert!((first_not_positive(&dip(-1e-8), 6.0).unwrap() - (2.0 - 1e-4)).abs() < 1e-7);
        assert_eq!(first_not_positive(&[-1.0, 3.0], 1.0), Some(0.0));
    }

    #[test]
    fn what_is_no_number_is_not_positive() {
        assert!(first_not_positive(&[1.0, f64::NAN], 1.0).is_some());
        assert!(first_not_positive(&[1.0, -f64::INFINITY], 1.0).is_some());
        assert!(first_not_positive(&[], 1.0).is_none());
    }
}
