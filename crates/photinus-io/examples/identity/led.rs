//! LEDs that blink, by their own clocks, and what a camera measures of them. Nothing here is the decoder's.

use photinus::identity::{Evidence, Word};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64Mcg;

/// Frames per second.
pub(crate) const CAMERA_HZ: f64 = 60.0;
pub(crate) const EXPOSURE_S: f64 = 1e-3;

pub(crate) fn uniform(random: &mut Pcg64Mcg) -> f64 {
    StandardUniform.sample(random)
}

pub(crate) fn below(random: &mut Pcg64Mcg, end: usize) -> usize {
    (uniform(random) * end as f64) as usize
}

/// What a light does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Signal {
    Steady,
    Word(Word),
    /// Any bit is on or off, whatever the others are.
    Random(u64),
}

/// A light whose clock shows `at_first` bits at time 0 and runs at `rate_hz`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Led {
    pub(crate) signal: Signal,
    pub(crate) at_first: f64,
    pub(crate) rate_hz: f64,
}

impl Led {
    /// The share of an exposure in which it shines.
    pub(crate) fn share(&self, time_s: f64) -> f64 {
        let (bit, after) = bit_and_share_after(self.at_first, self.rate_hz, time_s);
        let on = |bit: f64| f64::from(u8::from(self.signal.is_on(bit)));
        (1.0 - after) * on(bit) + after * on(bit + 1.0)
    }
}

/// The bit in which an exposure begins, and the share of the exposure that falls on the next: it is shorter than a bit.
pub(crate) fn bit_and_share_after(at_first: f64, rate_hz: f64, time_s: f64) -> (f64, f64) {
    let begin = at_first + time_s * rate_hz;
    let length = EXPOSURE_S * rate_hz;
    (begin.floor(), ((begin - begin.floor() + length - 1.0) / length).max(0.0))
}

impl Signal {
    fn is_on(&self, bit: f64) -> bool {
        match self {
            Self::Steady => true,
            Self::Word(word) => word.bit(bit.rem_euclid(word.length() as f64) as usize),
            Self::Random(seed) => {
                // one draw of a generator that is seeded by the bit
                let mut random = Pcg64Mcg::new(u128::from(*seed) << 64 | u128::from(bit.to_bits()));
                uniform(&mut random);
                uniform(&mut random) < 0.5
            }
        }
    }
}

/// Light in units of that of an LED that shines all the time, with noise that makes one in so many bits wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise {
    pub(crate) sigma: f64,
}

impl Noise {
    /// Noise with which a threshold at half the light is wrong with this probability.
    pub(crate) fn of_bit_error(error: f64) -> Self {
        // the quantile of the normal distribution by halving
        let (mut low, mut high) = (0.0, 10.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let tail = 0.5 * libm::erfc(middle / std::f64::consts::SQRT_2);
            if tail > error { low = middle } else { high = middle }
        }
        Self { sigma: 0.5 / low }
    }

    pub(crate) fn measure(&self, share: f64, random: &mut Pcg64Mcg) -> f64 {
        let normal: f64 = StandardNormal.sample(random);
        share + self.sigma * normal
    }

    /// Logarithm of the likelihood of a measured light, up to a constant.
    pub(crate) fn log_likelihood(&self, light: f64, share: f64) -> f64 {
        let off = (light - share) / self.sigma;
        -0.5 * off * off
    }

    pub(crate) fn evidence(&self, light: f64) -> Evidence {
        let shares = [0.0, 0.25, 0.5, 0.75, 1.0];
        Evidence::of_log_likelihoods(shares.map(|share| self.log_likelihood(light, share)))
            .expect("light is finite")
    }
}
