//! The curve through the middle of the areas, and what lies too far above it.

use nalgebra::{Matrix3, Vector3};
use photinus::ranging::Envelope;

use super::Sample;

/// What the shift of a curve may be, as a share of the nearest distance: more would bend the curve where nothing was measured.
pub(super) const MOST_SHIFT: f64 = 0.3;
const PASSES: usize = 60;
/// An area this many robust sigmas above the median curve is no spot of this LED, but of two, or of the sun.
const OUTLIER_SIGMAS: f64 = 8.0;
/// The least robust sigma, in roots of pixels: where a point falls in its pixel makes 1 px or 4 of it.
const LEAST_SIGMA: f64 = 0.5;

/// The curve with the least sum of absolute deviations, each over the root of the curve (areas scatter about so); `None`
/// when areas do not fall with distance.
pub(super) fn fit(spots: &[Sample]) -> Option<Envelope> {
    // The middle of area times squared distance is a scale for which offset and shift hardly matter.
    let mut scales: Vec<f64> =
        spots.iter().map(|s| f64::from(s.area_px) * s.distance_m * s.distance_m).collect();
    scales.sort_unstable_by(f64::total_cmp);
    let scale_px_m2 = *scales.get(scales.len() / 4)?;
    refit(spots, &Envelope { offset_px: 0.5, scale_px_m2, shift_m: 0.0 })
}

/// The same from a curve near by.
pub(super) fn refit(spots: &[Sample], start: &Envelope) -> Option<Envelope> {
    let nearest_m = spots.iter().map(|spot| spot.distance_m).reduce(f64::min)?;
    let mut curve = *start;
    for _ in 0..PASSES {
        let next = step(spots, &curve, MOST_SHIFT * nearest_m)?;
        let change =
            (next.scale_px_m2 / curve.scale_px_m2 - 1.0).abs() + (next.offset_px - curve.offset_px).abs();
        curve = next;
        if change < 1e-6 {
            break;
        }
    }
    let falls = curve.scale_px_m2 > 1e-9 && curve.offset_px.is_finite();
    falls.then_some(curve)
}

/// One pass of reweighted least squares.
fn step(spots: &[Sample], curve: &Envelope, most_shift_m: f64) -> Option<Envelope> {
    let (mut information, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    for spot in spots {
        let shifted_m = spot.distance_m + curve.shift_m;
        let area_px = curve.area_px(spot.distance_m);
        let slope = Vector3::new(
            1.0,
            1.0 / (shifted_m * shifted_m),
            -2.0 * curve.scale_px_m2 / (shifted_m * shifted_m * shifted_m),
        );
        let residual_px = f64::from(spot.area_px) - area_px;
        let root = area_px.max(0.5).sqrt();
        // absolute deviations: the weight is one over the residual, bounded where that vanishes
        let weight = 1.0 / (root * residual_px.abs().max(0.05 * root));
        information += slope * slope.transpose() * weight;
        gradient += slope * (residual_px * weight);
    }
    let ridge = 1e-12 * Matrix3::from_diagonal(&information.diagonal());
    let change = (information + ridge).cholesky()?.solve(&gradient);
    Some(Envelope {
        offset_px: (curve.offset_px + change.x).max(0.0),
        scale_px_m2: (curve.scale_px_m2 + change.y).clamp(0.3 * curve.scale_px_m2, 3.0 * curve.scale_px_m2),
        shift_m: (curve.shift_m + change.z).clamp(-most_shift_m, most_shift_m),
    })
}

/// Which spots lie too far above the curve.
pub(super) fn outliers(spots: &[Sample], curve: &Envelope) -> Vec<bool> {
    let deviation = |spot: &Sample| {
        let area_px = curve.area_px(spot.distance_m);
        (f64::from(spot.area_px) - area_px) / area_px.max(1.0).sqrt()
    };
    let mut sizes: Vec<f64> = spots.iter().map(|spot| deviation(spot).abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let sigma = (1.4826 * sizes[sizes.len() / 2]).max(LEAST_SIGMA);
    spots.iter().map(|spot| deviation(spot) > OUTLIER_SIGMAS * sigma).collect()
}
