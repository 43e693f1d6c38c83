//! Noise of a pixel: in darkness from patches without light, with light from what fits leave over.
//!
//! A pixel that is rounded and clipped says only between which levels it was: with normal noise a patch of one level has a
//! likelihood in closed form, also where rounding hides most of the noise or black is clipped at 0.

use nalgebra::SVector;
use photinus::optics::{Measured, Response};

use super::window::Patch;

/// Variance of rounding, grey levels^2.
pub(super) const ROUNDING: f64 = 1.0 / 12.0;

/// A pixel this many sigmas above 0 is not cut off there.
const SELDOM_CUT: f64 = 4.0;
/// Steps from one grey level to the next show through noise of less, grey levels.
const FINE: f64 = 0.5;
/// Noise below this is rounding's alone, grey levels.
const LEAST_SIGMA: f64 = 0.2;
/// A pixel that is nearly always cut off tells something, and varies, by no less than this.
const LEAST_SLOPE: f64 = 1e-2;
const LEAST_VARIANCE: f64 = 0.1;

/// What a pixel makes of light: variance = darkness + shot * light + (shape * light)^2, and how its response bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    /// Variance without light, that of rounding included.
    pub(super) dark: f64,
    /// Variance that a grey level of light adds.
    pub(super) shot: f64,
    /// Error of the point spread, as a share of the light.
    pub(super) shape: f64,
    /// Bend of the response, per grey level; 0 where levels grow in proportion to light.
    pub(super) bend: f64,
    /// Whether darkness varies by its noise; where it is all 0, how far below the cut it lies is not known, and 0 tells nothing.
    pub(super) is_dark_seen: bool,
}

impl Noise {
    /// Variance of a pixel with this much light, grey levels^2.
    pub(super) fn variance(&self, light: f64) -> f64 {
        let light = light.max(0.0);
        self.dark + self.shot * light + self.shape * self.shape * light * light
    }

    /// What variance has of 1, of light, and of its square.
    pub(super) fn terms(&self) -> SVector<f64, 3> {
        SVector::from([self.dark, self.shot, self.shape * self.shape])
    }

    /// The light that a level above darkness stands for, and how it grows with that.
    pub(super) fn straightened(&self, above_dn: f64) -> (f64, f64) {
        Response { bend_per_dn: Measured { value: self.bend, sigma: 0.0 } }.straightened(above_dn)
    }
}

/// What a pixel reads on average, where that is not its level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) mean: f64,
    /// How the mean grows with the level.
    pub(super) slope: f64,
    pub(super) variance: f64,
}

impl Noise {
    /// What a pixel of this level reads, rounded and cut off at 0; `None` where that is its level on average, or nothing is known of darkness.
    pub(super) fn read(&self, level: f64, variance: f64) -> Option<Reading> {
        let sigma = (variance - ROUNDING).max(LEAST_SIGMA * LEAST_SIGMA).sqrt();
        if !self.is_dark_seen {
            return None;
        }
        if sigma < FINE {
            return Some(step_by_step(level, sigma, variance));
        }
        if level > SELDOM_CUT * sigma + 0.5 {
            return None;
        }
        let level = level.max(-SELDOM_CUT * sigma);
        // A level of -j and less is read by so many: each is counted j times for the mean, j^2 times for the square.
        let (mut mean, mut slope, mut square) = (level, 1.0, level * level + sigma * sigma + ROUNDING);
        let step = (0.5 * sigma).floor().max(1.0);
        let mut below = 0.5 * step;
        loop {
            let t = -(below + level) / sigma;
            if t < -SELDOM_CUT {
                break;
            }
            let share = 0.5 * libm::erfc(-t * std::f64::consts::FRAC_1_SQRT_2);
            mean += step * share;
            slope -= step * libm::exp(-0.5 * t * t) / (sigma * (std::f64::consts::TAU).sqrt());
            square -= 2.0 * step * below * share;
            below += step;
        }
        Some(Reading {
            mean,
            slope: slope.max(LEAST_SLOPE),
            variance: (square - mean * mean).max(LEAST_VARIANCE * variance),
        })
    }
}

/// What is read where steps show through noise: of every step from one grey level to the next, how often a pixel is above.
fn step_by_step(level: f64, sigma: f64, variance: f64) -> Reading {
    let first = (level - SELDOM_CUT * sigma).floor().max(0.0);
    let (mut mean, mut slope, mut square) = (0.0, 0.0, 0.0);
    for above in (0..).map(f64::from) {
        let t = (first + above + 0.5 - level) / sigma;
        if t > SELDOM_CUT {
            break;
        }
        let share = 0.5 * libm::erfc(t * std::f64::consts::FRAC_1_SQRT_2);
        mean += share;
        square += (2.0 * above + 1.0) * share;
        slope += libm::exp(-0.5 * t * t) / (sigma * (std::f64::consts::TAU).sqrt());
    }
    Reading {
        mean: first + mean,
        slope: slope.max(LEAST_SLOPE),
        variance: (square - mean * mean).max(LEAST_VARIANCE * variance),
    }
}

/// What patches without light tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Darkness {
    /// Noise without that of rounding, grey levels; `None` where every pixel reads the same.
    pub(super) noise_dn: Option<Measured>,
    /// Level of most patches, and how far patches scatter; `None` where darkness is clipped.
    pub(super) level_dn: Option<Measured>,
}

const LEAST_PATCHES: usize = 20;
const PARTS: usize = 10;

/// Level and noise of darkness.
pub(super) fn darkness(patches: &[Patch]) -> Darkness {
    let counted: Vec<Counts> = patches.iter().map(Counts::of).collect();
    if counted.len() < LEAST_PATCHES {
        return Darkness { noise_dn: None, level_dn: None };
    }
    let mut levels: Vec<f64> = counted.iter().map(Counts::mean).collect();
    levels.sort_by(f64::total_cmp);
    let quantile = |share: f64| levels[((levels.len() - 1) as f64 * share) as usize];
    // a level below one is the mean of what was not clipped
    let spread = (0.5 * (quantile(0.84) - quantile(0.16))).max(0.02);
    let level_dn = (quantile(0.5) >= 1.0).then(|| Measured { value: quantile(0.5), sigma: spread });
    Darkness { noise_dn: dark_noise(&counted), level_dn }
}

/// The noise that makes patches as likely as can be; none where it cannot be told from no noise.
fn dark_noise(patches: &[Counts]) -> Option<Measured> {
    let varied = patches.iter().filter(|patch| patch.several()).count();
    if varied < LEAST_PATCHES {
        return None;
    }
    // patches that something else lights are wider than most
    let mut widths: Vec<f64> = patches.iter().map(Counts::variance).collect();
    widths.sort_by(f64::total_cmp);
    let widest = 4.0 * widths[widths.len() / 2].max(0.1);
    let calm: Vec<&Counts> = patches.iter().filter(|patch| patch.variance() <= widest).collect();
    let whole = most_likely(&calm, |_| true);
    let without = |part: usize| most_likely(&calm, |index| index % PARTS != part);
    let square: f64 = (0..PARTS).map(|part| (without(part) - whole) * (without(part) - whole)).sum();
    let sigma = (square * (PARTS - 1) as f64 / PARTS as f64).sqrt();
    (sigma < 0.5 * whole).then_some(Measured { value: whole, sigma })
}

fn most_likely(patches: &[&Counts], is_used: impl Fn(usize) -> bool) -> f64 {
    let step = (patches.len() / 300).max(1);
    let used: Vec<&&Counts> = patches
        .iter()
        .enumerate()
        .step_by(step)
        .enumerate()
        .filter_map(|(number, (_, patch))| is_used(number).then_some(patch))
        .collect();
    let cost = |log_sigma: f64| -> f64 {
        let sigma = libm::exp(log_sigma);
        used.iter().map(|patch| patch.cost(sigma)).sum()
    };
    let sigma = libm::exp(least(cost, libm::log(0.05), libm::log(20.0), 24));
    // the level of each patch was found from the same pixels
    let count = Patch::COUNT as f64;
    sigma * (count / (count - 1.0)).sqrt()
}

impl Patch {
    const COUNT: usize = super::window::PATCH_SIDE * super::window::PATCH_SIDE;
}

/// How often a patch has each grey level.
struct Counts {
    values: Vec<(f64, f64)>,
}

impl Counts {
    fn of(patch: &Patch) -> Self {
        let mut sorted = patch.pixels;
        sorted.sort_unstable();
        let values = sorted.chunk_by(|a, b| a == b);
        Self { values: values.map(|same| (f64::from(same[0]), same.len() as f64)).collect() }
    }

    fn several(&self) -> bool {
        self.values.len() > 1
    }

    fn mean(&self) -> f64 {
        self.values.iter().map(|(value, count)| value * count).sum::<f64>() / Patch::COUNT as f64
    }

    fn variance(&self) -> f64 {
        let mean = self.mean();
        let square = |&(value, count): &(f64, f64)| count * (value - mean) * (value - mean);
        self.values.iter().map(square).sum::<f64>() / Patch::COUNT as f64
    }

    /// Minus the logarithm of the likelihood at the best level.
    fn cost(&self, sigma: f64) -> f64 {
        let mean = self.mean();
        let cost = |level: f64| -> f64 {
            self.values.iter().map(|&(value, count)| -count * log_share(value, level, sigma)).sum()
        };
        // darkness may lie below the clip
        let reach = 0.6 + if self.values[0].0 < 0.5 { 3.0 * sigma } else { 0.0 };
        cost(least(cost, mean - reach, mean + 0.6, 10))
    }
}

/// Logarithm of the probability that a level with this noise reads as `value`: rounded, and nothing below 0.
fn log_share(value: f64, level: f64, sigma: f64) -> f64 {
    let below = |edge: f64| 0.5 * libm::erfc((level - edge) / (sigma * std::f64::consts::SQRT_2));
    let lower = if value < 0.5 { 0.0 } else { below(value - 0.5) };
    libm::log((below(value + 0.5) - lower).max(1e-30))
}

/// The place of the least cost between two, by golden section.
pub(super) fn least(cost: impl Fn(f64) -> f64, mut low: f64, mut high: f64, steps: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut at_a, mut at_b) = (cost(a), cost(b));
    for _ in 0..steps {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - GOLDEN * (high - low);
            at_a = cost(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + GOLDEN * (high - low);
            at_b = cost(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    fn patches(level: f64, sigma: f64, seed: u128) -> Vec<Patch> {
        let mut random = Pcg64::new(seed, 7);
        let mut pixel = |base: f64| {
            let normal: f64 = StandardNormal.sample(&mut random);
            (base + sigma * normal).round().clamp(0.0, 255.0) as u8
        };
        (0..300)
            .map(|index| Patch { pixels: std::array::from_fn(|_| pixel(level + f64::from(index) * 1e-3)) })
            .collect()
    }

    #[test]
    fn noise_comes_back_through_rounding_and_clipping() {
        for (level, sigma) in [(6.0, 0.6), (6.2, 0.25), (20.3, 2.0), (0.2, 1.0), (8.0, 5.0)] {
            let found = darkness(&patches(level, sigma, 1)).noise_dn.unwrap();
            assert!((found.value / sigma - 1.0).abs() < 0.03, "{found:?} not {sigma} at {level}");
            assert!(found.sigma < 0.05 * sigma, "{found:?}");
        }
    }

    /// Against pixels drawn, rounded and cut off one by one.
    #[test]
    fn what_is_read_is_what_pixels_read_on_average() {
        let mut random = Pcg64::new(3, 7);
        let near_0 =
            |sigma: f64| [-1.5 * sigma, -0.3, 0.0, 0.4, 1.0, 2.5 * sigma].map(|level| (sigma, level));
        let between = |sigma: f64| [6.0, 6.2, 6.5, 6.7].map(|level| (sigma, level));
        let near_0 = [0.2, 0.5, 1.0, 3.0].into_iter().flat_map(near_0);
        for (sigma, level) in near_0.chain([0.2, 0.3, 0.45].into_iter().flat_map(between)) {
            let noise = Noise {
                dark: sigma * sigma + ROUNDING,
                shot: 0.0,
                shape: 0.0,
                bend: 0.0,
                is_dark_seen: true,
            };
            let mut mean_near = |level: f64| {
                let draws = 200_000;
                let (mut sum, mut squares) = (0.0, 0.0);
                for _ in 0..draws {
                    let normal: f64 = StandardNormal.sample(&mut random);
                    let read = (level + sigma * normal).round().max(0.0);
                    (sum, squares) = (sum + read, squares + read * read);
                }
                let mean = sum / f64::from(draws);
                (mean, squares / f64::from(draws) - mean * mean)
            };
            let read = noise.read(level, noise.dark).unwrap();
            let (mean, variance) = mean_near(level);
            assert!((read.mean - mean).abs() < 0.015 * sigma, "{read:?} not {mean}, {level} +- {sigma}");
            let least = variance.max(LEAST_VARIANCE * noise.dark);
            assert!(
                (read.variance / least - 1.0).abs() < 0.08,
                "{read:?} not {variance}, {level} +- {sigma}"
            );
            let step = 0.25 * sigma;
            let slope = (mean_near(level + step).0 - mean_near(level - step).0) / (2.0 * step);
            assert!((read.slope - slope).abs() < 0.06, "{read:?} not {slope}, {level} +- {sigma}");
        }
        let noise = Noise { dark: 1.0, shot: 0.0, shape: 0.0, bend: 0.0, is_dark_seen: true };
        assert!(noise.read(6.0, 1.0).is_none(), "nothing is cut off there");
        assert!(noise.read(-1e9, 1.0).unwrap().mean < 1e-3, "and all of it here");
    }

    #[test]
    fn black_that_is_clipped_tells_nothing() {
        let found = darkness(&patches(-5.0, 0.6, 1));
        assert_eq!(found, Darkness { noise_dn: None, level_dn: None });
    }
}
