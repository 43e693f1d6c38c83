//! How much light a point needs to be found: the step that makes a pixel bright over the share of its light that the brightest pixel gets.
//!
//! In: the point spread, the step and the noise of a pixel. Out: the light at which half of the points are found, and how much that differs from
//! point to point, as a logarithm: by where in a pixel they fall, by noise, and by how well the point spread is known.

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::PointSpread;
use crate::pose::LogLight;

/// Places within a pixel that are looked at, along a side.
const PLACES: usize = 6;
/// What a point spread that frames have not told yet leaves open, as a logarithm.
const UNKNOWN_SPREAD: f64 = 0.5;

/// The limit for points that spread so, where windows see `seen` of their light. A pixel is bright this far above the mean of dark ones, whose noise is `noise_dn`,
/// grey levels.
pub(super) fn detection_limit(
    (spread, seen): (&PointSpread, f64),
    is_known: bool,
    (step_dn, noise_dn): (f64, f64),
) -> LogLight {
    let at = |index: usize| (index as f64 + 0.5) / PLACES as f64 - 0.5;
    let (mut sum, mut squares) = (0.0, 0.0);
    for place in 0..PLACES * PLACES {
        let log_share = libm::log(spread.share(at(place % PLACES), at(place / PLACES)).max(1e-6));
        sum += log_share;
        squares += log_share * log_share;
    }
    let places = (PLACES * PLACES) as f64;
    let mean = sum / places;
    let unknown = if is_known { 0.0 } else { UNKNOWN_SPREAD };
    let noise = noise_dn / step_dn;
    LogLight {
        value: libm::log(step_dn * seen) - mean,
        sigma: ((squares / places - mean * mean).max(0.0) + noise * noise + unknown * unknown).sqrt(),
    }
}
