//! What one frame says of one LED: how likely the light that was measured is for each share of the exposure that the LED shone.
//!
//! The exposure may hold an edge of the signal, so that the LED shone for a part of it; a spot that is not there says something, too.

use super::Level;
use crate::normal;

/// Shares of the exposure at which likelihoods are kept: 0, 1/4, 1/2, 3/4, 1; between them they are drawn straight.
pub(crate) const SHARES: usize = 5;

/// Those shares.
const AT: [f64; SHARES] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// This many standard deviations are not worth a function: what it gives is lost beside a surprise.
const NEVER: f64 = 7.0;

/// A light that fits nothing still has this likelihood against the best fit, so that no frame rules out anything for ever.
const LEAST: f64 = 1e-6;

/// How likely what a frame showed is, by the share of the exposure that the LED shone; up to a factor that is the same for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    likelihood: [f32; SHARES],
}

impl Evidence {
    /// Nothing is known: the place was out of sight, masked or covered.
    pub const NONE: Self = Self { likelihood: [1.0; SHARES] };

    /// Of natural logarithms of likelihoods at shares of 0, 1/4, 1/2, 3/4 and 1 of the exposure, up to a constant; minus infinity is
    /// allowed. `None` when one is NaN or plus infinity, or none is finite.
    pub fn of_log_likelihoods(logs: [f64; SHARES]) -> Option<Self> {
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let legal = most.is_finite() && logs.iter().all(|log| !log.is_nan());
        legal.then(|| Self::of_likelihoods(logs.map(|log| libm::exp(log - most))))
    }

    /// Of a bit that is wrong with this probability, from 0 to 1/2; an LED that shone for a part gives either.
    pub fn of_bit(is_on: bool, error: f64) -> Self {
        let error = error.clamp(0.0, 0.5);
        let on = |share: f64| error + (1.0 - 2.0 * error) * share;
        let of = |share: f64| if is_on { on(share) } else { 1.0 - on(share) };
        Self::of_likelihoods(AT.map(of))
    }

    /// Of a spot whose light is `light` with standard deviation `sigma`, where the LED would show `level` if it shone all the time.
    pub fn of_light(light: f64, sigma: f64, level: &Level) -> Self {
        Self::of_likelihoods(density_of_light(light, sigma, level))
    }

    /// Of no spot: what was there showed less light than `limit`, which noise of standard deviation `sigma` makes unsharp.
    pub fn of_absence(limit: f64, sigma: f64, level: &Level) -> Self {
        Self::of_likelihoods(probability_of_absence(limit, sigma, level))
    }

    /// Of likelihoods that are not negative; what is no number says nothing.
    pub(crate) fn of_likelihoods(likelihood: [f64; SHARES]) -> Self {
        let most = likelihood.iter().copied().fold(0.0, f64::max);
        if !(most > 0.0 && most.is_finite()) {
            return Self::NONE;
        }
        Self { likelihood: likelihood.map(|one| (one / most).max(LEAST) as f32) }
    }

    /// In place of likelihoods the share itself, so that a mean over what may be is the mean share.
    pub(super) const SHARE: Self = Self { likelihood: [0.0, 0.25, 0.5, 0.75, 1.0] };

    /// The likelihood of no light.
    pub(super) fn off(&self) -> f32 {
        self.likelihood[0]
    }

    /// The likelihood of light all the time.
    pub(super) fn on(&self) -> f32 {
        self.likelihood[SHARES - 1]
    }

    /// The integral of the likelihood over shares from 0 to `share`.
    pub(super) fn up_to(&self, share: f32) -> f32 {
        let at = share.clamp(0.0, 1.0) * (SHARES - 1) as f32;
        let whole = (at as usize).min(SHARES - 2);
        let mut sum = 0.0;
        for i in 0..whole {
            sum += 0.5 * (self.likelihood[i] + self.likelihood[i + 1]);
        }
        let (low, high, part) = (self.likelihood[whole], self.likelihood[whole + 1], at - whole as f32);
        (sum + part * (low + 0.5 * part * (high - low))) / (SHARES - 1) as f32
    }

    /// The same for an LED that is dark where this one shines.
    pub(super) fn inverted(&self) -> Self {
        let mut likelihood = self.likelihood;
        likelihood.reverse();
        Self { likelihood }
    }
}

/// By share of the exposure the density, per unit of light, of a spot of this light.
pub(crate) fn density_of_light(light: f64, sigma: f64, level: &Level) -> [f64; SHARES] {
    AT.map(|share| {
        let (off, deviation) = level.standing(light, sigma, share);
        let stray = level.surprise / (2.0 * level.full);
        if off.abs() > NEVER {
            return stray;
        }
        normal::density(off, deviation) + stray
    })
}

/// By share of the exposure the probability of less light than `limit`.
pub(crate) fn probability_of_absence(limit: f64, sigma: f64, level: &Level) -> [f64; SHARES] {
    AT.map(|share| {
        let (off, _) = level.standing(limit, sigma, share);
        if off.abs() > NEVER {
            return if off > 0.0 { 1.0 + level.surprise } else { level.surprise };
        }
        normal::below(off) + level.surprise
    })
}
