//! Why samples give no curve.

use super::{FEWEST_SPOTS, LEAST_SPAN, Sample};

/// Why samples give no curve. Samples are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpotSizeError {
    /// A distance that is not above 0, or not finite.
    #[error("sample {sample} has a distance of {distance_m} m: it must be above 0 and finite")]
    Distance {
        /// Which sample.
        sample: usize,
        /// Its distance, m.
        distance_m: f64,
    },
    /// A share that is negative, or not finite.
    #[error("LEDs that are brighter by a share of {0}: it must be 0 to 10")]
    Brighter(f64),
    /// Too few spots.
    #[error("{spots} spots with a known distance: a curve needs {FEWEST_SPOTS}")]
    TooFew {
        /// Samples with an area above 0 that are no outliers.
        spots: usize,
    },
    /// All from about one distance.
    #[error(
        "the distances go from {nearest_m:.2} m to {farthest_m:.2} m: the farthest must be {LEAST_SPAN} times the nearest"
    )]
    Span {
        /// Nearest, m.
        nearest_m: f64,
        /// Farthest, m.
        farthest_m: f64,
    },
    /// Spots that do not shrink as the LED recedes.
    #[error("the areas do not fall with distance")]
    NotFalling,
}

/// Refuses numbers that mean nothing.
pub(super) fn check(samples: &[Sample], brighter: f64) -> Result<(), SpotSizeError> {
    if !(0.0..=10.0).contains(&brighter) {
        return Err(SpotSizeError::Brighter(brighter));
    }
    let is_distance = |distance_m: f64| distance_m.is_finite() && distance_m > 0.0;
    if let Some(sample) = samples.iter().position(|sample| !is_distance(sample.distance_m)) {
        return Err(SpotSizeError::Distance { sample, distance_m: samples[sample].distance_m });
    }
    let spots: Vec<Sample> = samples.iter().filter(|sample| sample.area_px > 0).copied().collect();
    check_spots(&spots)
}

/// Refuses spots that no curve can be fitted to.
pub(super) fn check_spots(spots: &[Sample]) -> Result<(), SpotSizeError> {
    if spots.len() < FEWEST_SPOTS {
        return Err(SpotSizeError::TooFew { spots: spots.len() });
    }
    let distances_m = || spots.iter().map(|spot| spot.distance_m);
    let (nearest_m, farthest_m) =
        (distances_m().fold(f64::INFINITY, f64::min), distances_m().fold(0.0, f64::max));
    match farthest_m >= LEAST_SPAN * nearest_m {
        true => Ok(()),
        false => Err(SpotSizeError::Span { nearest_m, farthest_m }),
    }
}
