//! A global random search, then random steps that shrink.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

const SAMPLES: usize = 1500;
const SURVIVORS: usize = 6;
const STEPS: usize = 300;

/// The point of the unit cube of N dimensions with the least cost that was found, and that cost.
pub(crate) fn least<const N: usize>(cost: impl Fn(&[f64; N]) -> f64) -> (f64, [f64; N]) {
    let mut random = Pcg64::new(13, 314_662);
    let mut sample = || {
        let x: [f64; N] = std::array::from_fn(|_| StandardUniform.sample(&mut random));
        (cost(&x), x)
    };
    let mut pool: Vec<(f64, [f64; N])> = (0..SAMPLES).map(|_| sample()).collect();
    pool.sort_by(|a, b| a.0.total_cmp(&b.0));
    pool.truncate(SURVIVORS);
    let mut random = Pcg64::new(13, 2);
    for (best, at) in &mut pool {
        let mut step = 0.15;
        for _ in 0..STEPS {
            let x = at.map(|x| {
                let normal: f64 = StandardNormal.sample(&mut random);
                (x + step * normal).clamp(0.0, 1.0)
            });
            let cost = cost(&x);
            if cost < *best {
                (*best, *at) = (cost, x);
            } else {
                step *= 0.98;
            }
        }
    }
    pool.sort_by(|a, b| a.0.total_cmp(&b.0));
    pool[0]
}

/// A parameter from a number of 0 to 1, by equal ratios.
pub(crate) fn between(x: f64, low: f64, high: f64) -> f64 {
    low * libm::pow(high / low, x)
}
