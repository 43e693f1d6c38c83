//! Why photos give no layout.

use nalgebra::{DMatrix, Vector3};

use super::adjust::Adjustment;
use super::{FEWEST_LEDS, KnownDistance, LedSighting};

/// Why photos give no layout. LEDs are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// A nominal position that is not finite.
    #[error("the nominal position of LED {led} is not finite")]
    Nominal {
        /// Which LED.
        led: usize,
    },
    /// An LED that the nominal layout does not have.
    #[error("there is an LED {led}, the nominal layout has {leds}")]
    Led {
        /// Which LED.
        led: usize,
        /// How many the nominal layout has.
        leds: usize,
    },
    /// A known distance that means nothing.
    #[error("a distance of {distance_m} m, known to {sigma_m} m, between LEDs {} and {}: two LEDs that photos show, and numbers above 0", leds[0], leds[1])]
    Distance {
        /// Between which LEDs.
        leds: [usize; 2],
        /// How far apart, m.
        distance_m: f64,
        /// Sigma of that, m.
        sigma_m: f64,
    },
    /// Photos that show too little.
    #[error(
        "{photos} photos show {FEWEST_LEDS} or more LEDs that other photos show too: {measured} coordinates for {unknown} unknowns"
    )]
    TooFew {
        /// Photos that count.
        photos: usize,
        /// Coordinates in them.
        measured: usize,
        /// What they must tell.
        unknown: usize,
    },
    /// Sightings that contradict each other.
    #[error("{outliers} of {sightings} sightings do not fit the others")]
    DoNotFit {
        /// How many deviate too far.
        outliers: usize,
        /// How many there are.
        sightings: usize,
    },
    /// An LED whose place the photos do not tell.
    #[error("LED {led} is placed to {sigma_m:.2} m only")]
    Undetermined {
        /// The worst one.
        led: usize,
        /// Sigma of its place along the worst axis, m.
        sigma_m: f64,
    },
}

/// A place known to no better than this share of the airframe's size is not known.
const MOST_SIGMA: f64 = 0.1;

/// Refuses numbers that mean nothing.
pub(super) fn check(
    nominal_m: &[Vector3<f64>],
    sightings: &[LedSighting],
    distances: &[KnownDistance],
) -> Result<(), LayoutError> {
    let is_finite = |position_m: &Vector3<f64>| position_m.iter().all(|number| number.abs() < 1e6);
    if let Some(led) = nominal_m.iter().position(|position_m| !is_finite(position_m)) {
        return Err(LayoutError::Nominal { led });
    }
    if let Some(unknown) = sightings.iter().find(|sighting| sighting.led >= nominal_m.len()) {
        return Err(LayoutError::Led { led: unknown.led, leds: nominal_m.len() });
    }
    for &KnownDistance { leds, distance_m, sigma_m } in distances {
        let is_positive = |number: f64| number.is_finite() && number > 0.0;
        let is_shown = |led: usize| sightings.iter().any(|sighting| sighting.led == led);
        let are_two = leds[0] != leds[1] && leds.into_iter().all(is_shown);
        if !(are_two && is_positive(distance_m) && is_positive(sigma_m)) {
            return Err(LayoutError::Distance { leds, distance_m, sigma_m });
        }
    }
    Ok(())
}

/// Refuses a layout in which an LED is hardly placed.
pub(super) fn check_placed(
    adjustment: &Adjustment,
    placed: &[usize],
    covariance_m2: &DMatrix<f64>,
) -> Result<(), LayoutError> {
    let positions_m = || placed.iter().map(|&led| adjustment.leds_m[led]);
    let mean_m = positions_m().sum::<Vector3<f64>>() / placed.len() as f64;
    let size_m = positions_m().map(|position_m| (position_m - mean_m).norm()).fold(0.0, f64::max);
    let sigma_m = |place: usize| {
        let block = covariance_m2.fixed_view::<3, 3>(3 * place, 3 * place).into_owned();
        block.symmetric_eigenvalues().max().sqrt()
    };
    let worst =
        (0..placed.len()).map(|place| (placed[place], sigma_m(place))).max_by(|a, b| a.1.total_cmp(&b.1));
    match worst {
        Some((led, sigma_m)) if sigma_m.is_nan() || sigma_m > MOST_SIGMA * size_m => {
            Err(LayoutError::Undetermined { led, sigma_m })
        }
        _ => Ok(()),
    }
}
