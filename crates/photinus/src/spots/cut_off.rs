//! What a noisy pixel reads where darkness is cut off at 0.
//!
//! In: how far the light of a pixel stands above 0, in sigmas of its noise. Out: what it reads on average, how that grows with the light, and
//! its variance. Where noise is as large as the level of darkness, half of it is not to be seen: what is read there is too high on average and
//! spreads too little, as long as the two are not told apart.

use alloc::vec::Vec;

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{LANES, Lanes};
use crate::normal;

/// Sigmas from the first entry of the table to the last, on both sides of 0, and entries per sigma.
const FARTHEST: f64 = 4.0;
const PER_SIGMA: usize = 16;
const ENTRIES: usize = 2 * FARTHEST as usize * PER_SIGMA + 1;
/// A pixel varies by no less than this share of its noise, so that a single one that is seldom above 0 does not outweigh all others.
const LEAST_VARIANCE: f32 = 0.2;
/// Darkness is no further below 0 than this, and cut off where it is no further above, sigmas.
const LOWEST: f64 = -1.0;
const HIGHEST: f64 = 2.5;

/// Moments of a normal variable of sigma 1 that is cut off at 0, by its mean.
#[derive(Debug)]
pub(super) struct CutOff {
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    mean: f32,
    /// How the mean grows: the share that is not cut off.
    slope: f32,
    square: f32,
}

/// What four pixels read.
pub(super) struct Read {
    pub(super) mean: Lanes,
    pub(super) slope: Lanes,
    /// Over the variance of a pixel that nothing cuts off.
    pub(super) variance: Lanes,
}

impl Default for CutOff {
    fn default() -> Self {
        let entry = |number: usize| {
            let t = number as f64 / PER_SIGMA as f64 - FARTHEST;
            let above = normal::below(t);
            let mean = t * above + normal::density(t, 1.0);
            Entry { mean: mean as f32, slope: above as f32, square: (above + t * mean) as f32 }
        };
        Self { entries: (0..ENTRIES).map(entry).collect() }
    }
}

impl CutOff {
    /// What pixels of this sigma read on average whose light stands `above` 0, both in grey levels.
    #[inline(always)]
    pub(super) fn read(&self, above: Lanes, sigma: Lanes) -> Read {
        let t = (above / sigma).to_array();
        let (mut mean, mut slope, mut variance) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let Entry { mean: own, slope: above, square } = self.at(t[lane]);
            (mean[lane], slope[lane]) = (own, above);
            variance[lane] = (square - own * own).max(LEAST_VARIANCE);
        }
        Read { mean: sigma * Lanes::new(mean), slope: Lanes::new(slope), variance: Lanes::new(variance) }
    }

    /// How much more than their level dark pixels read on average, grey levels.
    pub(super) fn excess(&self, level: f32, variance: f32) -> f64 {
        let sigma = variance.sqrt().max(f32::MIN_POSITIVE);
        f64::from(sigma * self.at(level / sigma).mean - level)
    }

    fn at(&self, t: f32) -> Entry {
        let farthest = FARTHEST as f32;
        if t >= farthest {
            return Entry { mean: t, slope: 1.0, square: t * t + 1.0 };
        }
        let place = (t.max(-farthest) + farthest) * PER_SIGMA as f32;
        let first = (place as usize).min(ENTRIES - 2);
        let share = place - first as f32;
        let [a, b] = [self.entries[first], self.entries[first + 1]];
        let between = |a: f32, b: f32| a + share * (b - a);
        Entry {
            mean: between(a.mean, b.mean),
            slope: between(a.slope, b.slope),
            square: between(a.square, b.square),
        }
    }

    /// Level and variance of darkness of which pixels read this mean and this mean square: those of the normal variable that has the same two
    /// moments once it is cut off; `None` where nothing is cut off, or all is 0.
    pub(super) fn darkness(&self, mean: f64, square: f64) -> Option<(f32, f32)> {
        if mean.is_nan() || mean <= 0.0 {
            return None;
        }
        let ratio = |entry: &Entry| f64::from(entry.mean) * f64::from(entry.mean) / f64::from(entry.square);
        let told = mean * mean / square;
        let lowest = ((LOWEST + FARTHEST) * PER_SIGMA as f64) as usize;
        let after = lowest + self.entries[lowest..].partition_point(|entry| ratio(entry) < told);
        if after >= ENTRIES {
            return None;
        }
        let t = if after == lowest {
            after as f64
        } else {
            let [before, here] = [ratio(&self.entries[after - 1]), ratio(&self.entries[after])];
            (after - 1) as f64 + (told - before) / (here - before)
        };
        let t = t / PER_SIGMA as f64 - FARTHEST;
        if t > HIGHEST {
            return None;
        }
        let entry = self.at(t as f32);
        let variance = square / f64::from(entry.square);
        Some(((t * variance.sqrt()) as f32, variance as f32))
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64;

    use super::*;

    #[test]
    fn darkness_is_found_from_what_is_not_cut_off() {
        let cut_off = CutOff::default();
        let mut rng = Pcg64::new(11, 0);
        for (level, sigma) in [(0.0, 8.0), (0.0, 20.0), (6.0, 8.0), (-4.0, 8.0), (10.0, 5.0)] {
            let normal = Normal::<f64>::new(level, sigma).unwrap();
            let values: Vec<f64> =
                (0..40_000).map(|_| normal.sample(&mut rng).round().clamp(0.0, 255.0)).collect();
            let moment =
                |power: i32| values.iter().map(|value| value.powi(power)).sum::<f64>() / values.len() as f64;
            let (found, variance) = cut_off.darkness(moment(1), moment(2)).unwrap();
            assert!((f64::from(found) - level).abs() < 0.04 * sigma, "{found} of {level}, {sigma}");
            assert!(
                (f64::from(variance).sqrt() / sigma - 1.0).abs() < 0.03,
                "{variance} of {level}, {sigma}"
            );
        }
    }

    #[test]
    fn what_is_read_is_what_normal_numbers_read() {
        let cut_off = CutOff::default();
        let mut rng = Pcg64::new(12, 0);
        for light in [-6.0, 0.0, 3.0, 9.0, 40.0] {
            let normal = Normal::<f64>::new(light, 5.0).unwrap();
            let values: Vec<f64> = (0..100_000).map(|_| normal.sample(&mut rng).max(0.0)).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance =
                values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
            let read = cut_off.read(Lanes::splat(light as f32), Lanes::splat(5.0));
            let [own, ..] = read.mean.to_array();
            assert!((f64::from(own) - mean).abs() < 0.07, "{own} {mean}");
            let [own, ..] = read.variance.to_array();
            let share = (variance / 25.0).max(f64::from(LEAST_VARIANCE));
            assert!((f64::from(own) - share).abs() < 0.02, "{own} {share}");
        }
    }
}
