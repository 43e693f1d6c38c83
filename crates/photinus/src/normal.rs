//! The normal distribution of one number: how dense it is, and how much of it lies below.

/// The square root of 2 pi.
pub(crate) const ROOT_OF_TAU: f64 = 2.506_628_274_631_000_2;

/// The density so many standard deviations from the mean, per unit of that deviation.
#[inline]
pub(crate) fn density(off_sigmas: f64, sigma: f64) -> f64 {
    libm::exp(-0.5 * off_sigmas * off_sigmas) / (sigma * ROOT_OF_TAU)
}

/// The probability of a number below so many standard deviations over the mean.
#[inline]
pub(crate) fn below(off_sigmas: f64) -> f64 {
    0.5 * libm::erfc(-off_sigmas / core::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Simpson's rule over a far tail.
        #[test]
        fn what_lies_below_is_the_sum_of_the_density(off in -6.0..6.0_f64, sigma in 0.01..100.0_f64) {
            let (steps, begin) = (2000_u32, -9.0);
            let step = (off - begin) / f64::from(steps);
            let at = |number: u32| density(begin + step * f64::from(number), sigma) * sigma;
            let inner: f64 = (1..steps).map(|number| at(number) * if number % 2 == 1 { 4.0 } else { 2.0 }).sum();
            let sum = (at(0) + inner + at(steps)) * step / 3.0;
            prop_assert!((below(off) - sum).abs() < 1e-9);
        }
    }
}
