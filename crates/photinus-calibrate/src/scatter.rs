//! How far an estimate scatters: sigma by resampling what it is made from (the bootstrap of B. Efron, 1979).

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

/// Neighbours in time are alike: they are drawn together, this many at a time.
const BLOCK: usize = 8;

/// Standard deviations of the estimates from `count` resamples, drawn with replacement in blocks; those that give no estimate
/// are left out. The same samples give the same answer.
pub(crate) fn sigma<T: Copy, const N: usize>(
    samples: &[T],
    count: usize,
    estimate: impl Fn(&[T]) -> Option<[f64; N]>,
) -> [f64; N] {
    let mut random = Pcg64::new(samples.len() as u128, 0x5ca7);
    let mut drawn = Vec::with_capacity(samples.len());
    let mut estimates = Vec::with_capacity(count);
    for _ in 0..count {
        drawn.clear();
        while drawn.len() < samples.len() {
            let first = (random.next_u64() % samples.len() as u64) as usize;
            drawn.extend((0..BLOCK).map(|step| samples[(first + step) % samples.len()]));
        }
        estimates.extend(estimate(&drawn));
    }
    let number = estimates.len() as f64;
    std::array::from_fn(|parameter| {
        let values = || estimates.iter().map(|estimate| estimate[parameter]);
        let mean = values().sum::<f64>() / number;
        (values().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (number - 1.0)).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn a_mean_scatters_by_the_root_of_its_count() {
        let mut random = Pcg64::new(1, 2);
        let samples: Vec<f64> = (0..4000).map(|_| StandardNormal.sample(&mut random)).collect();
        let [sigma] = sigma(&samples, 400, |drawn| Some([drawn.iter().sum::<f64>() / drawn.len() as f64]));
        assert!((sigma * 4000f64.sqrt() - 1.0).abs() < 0.15, "{sigma}");
    }
}
