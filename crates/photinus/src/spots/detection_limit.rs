//! How much light a point needs to be found: the step that makes a pixel bright over the share of its light that the brightest pixel gets.
//!
//! In: the point spread, the step and the noise of a pixel. Out: the light at which half of the points are found, and how much that differs from
//! point to point, as a logarithm: by where in a pixel they fall, by noise, and by how well the point spread is known.

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::{LogLight, PointSpread};

/// Places within a pixel that are looked at, along a side.
const PLACES: usize = 6;
/// Light over the step before any lens, px, and what that leaves open, as a logarithm: what a lens as sharp as a pixel makes of points. Lenses differ by more, but all
/// markers before one alike, and each is expected by itself: were it half a unit, lone reflections would be boards of 35 LEDs.
const ANY_PX: f64 = 2.85;
pub(crate) const ANY_SIGMA: f64 = 0.33;

/// How far above the mean of dark pixels a pixel is bright, and their noise, grey levels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) step_dn: f64,
    pub(super) noise_dn: f64,
}

impl Step {
    fn noise(self) -> f64 {
        self.noise_dn / self.step_dn
    }
}

/// The limit before a lens of which nothing is known.
pub(super) fn of_any_lens(step: Step) -> LogLight {
    LogLight { value: libm::log(ANY_PX * step.step_dn), sigma: libm::hypot(ANY_SIGMA, step.noise()) }
}

/// The limit for points that spread so, where windows see `seen` of their light. How high the spread is at its summit is known to `summit_sigma`, as a logarithm.
pub(super) fn of_spread(spread: &PointSpread, seen: f64, summit_sigma: f64, step: Step) -> LogLight {
    let at = |index: usize| (index as f64 + 0.5) / PLACES as f64 - 0.5;
    let (mut sum, mut squares) = (0.0, 0.0);
    for place in 0..PLACES * PLACES {
        let log_share = libm::log(spread.share(at(place % PLACES), at(place / PLACES)).max(1e-6));
        sum += log_share;
        squares += log_share * log_share;
    }
    let places = (PLACES * PLACES) as f64;
    let mean = sum / places;
    let variance = (squares / places - mean * mean).max(0.0);
    let unknown = summit_sigma.min(ANY_SIGMA);
    LogLight {
        value: libm::log(step.step_dn * seen) - mean,
        sigma: (variance + step.noise() * step.noise() + unknown * unknown).sqrt(),
    }
}
