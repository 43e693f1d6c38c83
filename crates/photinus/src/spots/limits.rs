//! What full pixels say of the light of a spot: that it is no less, not how much it is.
//!
//! In: a fit of a spot with full pixels. It takes those that hold the light up for pixels that tell it to their noise. Out: the same fit with
//! the light as the other pixels have it, cut off below what the full ones allow; lights are as many as light^-5/2. Points that stood still before a
//! known point spread only: fits of streaks, of pairs, and with the spread free keep the light that they end with.

use super::fit::{self, Fitted, LIGHT, PixelNoise, Shape};
use super::window::Window;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::normal;

/// Nodes of the sum over light.
const NODES: usize = 32;
/// How far it reaches, standard deviations, and logarithm of light.
const SIGMAS: f64 = 4.0;
const FARTHEST: f64 = 4.0;
/// No light less than this share of that of the fit is looked at.
const LEAST_SHARE: f64 = 0.05;
/// Lights spread evenly in space are as many per logarithm of light as light^-3/2.
const FALLS: f64 = 1.5;
/// Full pixels that tell less of the light than this share do not hold it up.
const HOLDS: f64 = 1e-3;

/// A fit with its light told anew where full pixels hold it up.
pub(super) fn held<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    fitted: Fitted<N>,
    noise: PixelNoise,
) -> Fitted<N> {
    if window.full_px == 0 {
        return fitted;
    }
    let (matrix, right) = fit::of_full_pixels(window, shape, &fitted, noise);
    let others = fitted.covariance.try_inverse().and_then(|all| (all - matrix).cholesky());
    let Some(others) = others else { return fitted };
    let free = Normal {
        mean: fitted.light() - others.solve(&right)[LIGHT],
        variance: others.inverse()[(LIGHT, LIGHT)],
    };
    let all = Normal { mean: fitted.light(), variance: fitted.light_variance() };
    match above_limit(free, all) {
        Some(light) => fitted.with_light(light.mean, light.variance),
        None => fitted,
    }
}

#[derive(Clone, Copy, Debug)]
struct Normal {
    mean: f64,
    variance: f64,
}

/// Light that is `free` but for a limit, which was taken for a measurement in `all`; `None` where that makes no difference.
fn above_limit(free: Normal, all: Normal) -> Option<Normal> {
    let information = 1.0 / all.variance - 1.0 / free.variance;
    if information * all.variance < HOLDS {
        return None;
    }
    let limit = (all.mean / all.variance - free.mean / free.variance) / information;
    let [limit_sigma, free_sigma] = [1.0 / information, free.variance].map(f64::sqrt);
    let least = (limit - SIGMAS * limit_sigma).max(LEAST_SHARE * all.mean);
    let most = limit.max(free.mean) + SIGMAS * free_sigma.max(limit_sigma);
    let low = libm::log(least);
    let step = (libm::log(most) - low).min(FARTHEST) / NODES as f64;
    let [mut sum, mut first, mut second] = [0.0; 3];
    for node in 0..NODES {
        let above = step * (node as f64 + 0.5);
        let light = libm::exp(low + above);
        let off = (light - free.mean) / free_sigma;
        let density =
            libm::exp(-0.5 * off * off - FALLS * above) * normal::below((light - limit) / limit_sigma);
        sum += density;
        first += density * above;
        second += density * above * above;
    }
    if sum <= 0.0 || sum.is_nan() {
        return None;
    }
    let above = first / sum;
    let variance = (second / sum - above * above).max(0.0) + step * step / 12.0;
    let mean = libm::exp(low + above);
    Some(Normal { mean, variance: variance * mean * mean })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Mean and variance of the logarithm of light, by a sum over light itself, a thousand times as fine.
    fn summed(free: Normal, limit: Normal) -> [f64; 2] {
        let most = 60.0 * (limit.mean + free.mean.abs() + free.variance.sqrt());
        let steps = 400_000;
        let [mut sum, mut first, mut second] = [0.0; 3];
        for step in 0..steps {
            let light = most * (f64::from(step) + 0.5) / f64::from(steps);
            let off = (light - free.mean) / free.variance.sqrt();
            let above = normal::below((light - limit.mean) / limit.variance.sqrt());
            let density = libm::exp(-0.5 * off * off) * above * libm::pow(light, -2.5);
            let log = libm::log(light);
            sum += density;
            first += density * log;
            second += density * log * log;
        }
        let mean = first / sum;
        [mean, second / sum - mean * mean]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn light_is_what_is_free_above_the_limit(
            free in 300.0..1500.0_f64,
            free_share in 0.05..0.6_f64,
            limit_share in 0.005..0.03_f64,
        ) {
            // pixels that contradict each other are a misfit, not a limit
            prop_assume!(free > 1000.0 - 4.0 * free_share * free);
            let squared = |sigma: f64| sigma * sigma;
            let free = Normal { mean: free, variance: squared(free_share * free) };
            let limit = Normal { mean: 1000.0, variance: squared(limit_share * 1000.0) };
            // what a fit makes of both, if the limit is taken for a measurement
            let variance = 1.0 / (1.0 / free.variance + 1.0 / limit.variance);
            let all =
                Normal { mean: variance * (free.mean / free.variance + limit.mean / limit.variance), variance };
            let found = above_limit(free, all).expect("the limit matters");
            let [mean, variance] = summed(free, limit);
            prop_assert!((libm::log(found.mean) - mean).abs() < 0.02 + 0.1 * variance.sqrt(), "{found:?} {mean}");
            let sigma = found.variance.sqrt() / found.mean;
            prop_assert!((sigma / variance.sqrt() - 1.0).abs() < 0.15, "{sigma} {}", variance.sqrt());
        }
    }

    #[test]
    fn a_limit_far_below_changes_nothing() {
        let free = Normal { mean: 4000.0, variance: 1e4 };
        assert!(above_limit(free, free).is_none());
    }
}
