//! Areas of one LED's spots at known distances -> how large a spot can be: the curve that bounds ranges.
//!
//! ```text
//! median     the curve through the middle of the areas (least absolute deviations) -> what is no spot of this LED
//! envelope   the lowest curve with every area under it
//! margin     how far that curve must rise to hold for areas it was not fitted to, and for brighter LEDs
//! scatter    sigma of the parameters, by resampling
//! ```
//!
//! All curves have the form of the paper's (13), area = offset + scale / (distance + shift)^2. A curve is one of an
//! exposure and a rule of brightness: areas of others are another calibration.

mod envelope;
mod error;
mod median;
mod spread;
#[cfg(test)]
mod tests;

use photinus::ranging::{Envelope, SpotCurve};

use crate::scatter;
pub use error::SpotSizeError;
pub use spread::Bin;

/// A spot of the LED at a known distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// From the camera's centre to the LED, m.
    pub distance_m: f64,
    /// Pixels at or above the threshold; 0 where no spot was found.
    pub area_px: u32,
}

/// A fitted curve and how sure its parameters are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The curve.
    pub envelope: Envelope,
    /// Standard deviations of offset (px), scale (px m^2) and shift (m), by resampling.
    pub sigma: [f64; 3],
}

/// What a calibration of spot sizes gives.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotSize {
    /// The curve for ranging: `envelope` raised by `margin` and [`UNSEEN_PX`], its scale also by what brighter LEDs need.
    pub curve: SpotCurve,
    /// The lowest curve with every area under it that is no outlier.
    pub envelope: Fit,
    /// The curve through the middle of the areas.
    pub median: Fit,
    /// By what share the envelope was raised so that it holds for areas that it was not fitted to: the farthest that an
    /// area left out of a fit lay above it, over five fits.
    pub margin: f64,
    /// Areas over distance.
    pub bins: Vec<Bin>,
    /// Indices of the samples that are no spot of this LED: far above the median curve.
    pub outliers: Vec<usize>,
    /// Share of the spots that lies above the curve for ranging: the outliers that do.
    pub share_above: f64,
    /// The nearest distance with a spot of one pixel, m.
    pub first_one_px_m: Option<f64>,
    /// The farthest distance with a spot of more than one pixel, m.
    pub last_two_px_m: Option<f64>,
    /// The nearest distance measured, m: the curve is not known nearer than that.
    pub nearest_m: f64,
    /// The farthest distance with a spot, m.
    pub farthest_seen_m: f64,
}

/// Fewest spots that make a curve.
pub const FEWEST_SPOTS: usize = 30;
/// The distances must span at least this ratio: over less, offset and scale cannot be told apart.
pub const LEAST_SPAN: f64 = 2.0;
/// What the bound is raised by for places within a pixel that a recording has not seen at every distance: a point on the corner
/// of four pixels makes one pixel more of a faint spot than the rest let expect. In simulation, curves from 200 frames have 0.09 %
/// of the spots of other recordings above them without it, 0.003 % with it.
pub const UNSEEN_PX: f64 = 1.0;
const RESAMPLES: usize = 100;
const FOLDS: usize = 5;

/// Calibrates the curve of one exposure, from samples in the order in which they were taken.
///
/// `brighter` is the share by which other LEDs of the fleet may outshine this one, such as 0.2. A brighter LED looks as this
/// one does from nearer: its curve has the scale and the squared shift times 1 + `brighter`; a shift is small, so only the
/// scale is raised.
///
/// # Errors
/// [`SpotSizeError`] for distances that cannot be, for too few spots or too small a span of distances, and for areas that do
/// not fall with distance.
pub fn calibrate(samples: &[Sample], brighter: f64) -> Result<SpotSize, SpotSizeError> {
    error::check(samples, brighter)?;
    let seen: Vec<usize> = (0..samples.len()).filter(|&index| samples[index].area_px > 0).collect();
    let spots: Vec<Sample> = seen.iter().map(|&index| samples[index]).collect();
    let rough = median::fit(&spots).ok_or(SpotSizeError::NotFalling)?;
    let is_outlier = median::outliers(&spots, &rough);
    let outliers: Vec<usize> =
        seen.iter().zip(&is_outlier).filter(|(_, out)| **out).map(|(&i, _)| i).collect();
    let kept: Vec<Sample> =
        spots.iter().zip(&is_outlier).filter(|(_, out)| !**out).map(|(&s, _)| s).collect();
    error::check_spots(&kept)?;

    let middle = median::fit(&kept).ok_or(SpotSizeError::NotFalling)?;
    let upper = envelope::fit(&kept, &middle).ok_or(SpotSizeError::NotFalling)?;
    let margin = margin(&kept, &middle);
    let curve = raised(&upper, margin, brighter).ok_or(SpotSizeError::NotFalling)?;
    let above = spots.iter().filter(|spot| spot.area_px > curve.max_area_px(spot.distance_m)).count();
    let several = |spot: &&Sample| spot.area_px > 1;
    let distances =
        |of: fn(&Sample) -> bool| kept.iter().filter(move |spot| of(spot)).map(|spot| spot.distance_m);
    Ok(SpotSize {
        curve,
        envelope: Fit {
            envelope: upper,
            sigma: scatter::sigma(&kept, RESAMPLES, |kept| envelope::fit(kept, &middle).map(parameters)),
        },
        median: Fit {
            envelope: middle,
            sigma: scatter::sigma(&kept, RESAMPLES, |kept| median::refit(kept, &middle).map(parameters)),
        },
        margin,
        bins: spread::bins(samples, &outliers),
        outliers,
        share_above: above as f64 / spots.len() as f64,
        first_one_px_m: distances(|spot| spot.area_px == 1).reduce(f64::min),
        last_two_px_m: kept.iter().filter(several).map(|spot| spot.distance_m).reduce(f64::max),
        nearest_m: distances(|_| true).fold(f64::INFINITY, f64::min),
        farthest_seen_m: distances(|_| true).fold(0.0, f64::max),
    })
}

fn parameters(envelope: Envelope) -> [f64; 3] {
    [envelope.offset_px, envelope.scale_px_m2, envelope.shift_m]
}

/// How far an area that was left out of a fit lies above the fitted curve, as a share of it; the farthest.
fn margin(spots: &[Sample], median: &Envelope) -> f64 {
    let mut farthest = 0.0;
    for fold in 0..FOLDS {
        let is_held_out = |index: &usize| index % FOLDS == fold;
        let rest: Vec<Sample> = (0..spots.len()).filter(|i| !is_held_out(i)).map(|i| spots[i]).collect();
        let Some(fitted) = envelope::fit(&rest, median) else { continue };
        for spot in (0..spots.len()).filter(is_held_out).map(|i| &spots[i]) {
            let share = envelope::least_px(spot) / fitted.area_px(spot.distance_m) - 1.0;
            farthest = f64::max(farthest, share);
        }
    }
    farthest
}

/// The curve for ranging.
fn raised(envelope: &Envelope, margin: f64, brighter: f64) -> Option<SpotCurve> {
    let offset_px = envelope.offset_px * (1.0 + margin) + UNSEEN_PX;
    let scale_px_m2 = envelope.scale_px_m2 * (1.0 + margin) * (1.0 + brighter);
    SpotCurve::new(Envelope { offset_px, scale_px_m2, shift_m: envelope.shift_m }, None, None).ok()
}
