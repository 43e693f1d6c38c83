//! The lowest curve with every area under it.
//!
//! For a given shift C the curve is a line over g = 1 / (l + C)^2, and of all lines above a set of points the one with the
//! least mean height is the edge of their upper hull above the mean of g: no search is needed. The shift is searched for.

use photinus::ranging::Envelope;

use super::Sample;
use super::median::MOST_SHIFT;

const SHIFTS: usize = 24;
/// Where a point falls in its pixel changes an area by about this much: height below it hardly matters to a range.
const GRAIN_PX: f64 = 2.0;

/// The least that the curve must reach for a spot: a curve is rounded before it is compared.
pub(super) fn least_px(spot: &Sample) -> f64 {
    f64::from(spot.area_px) - 0.5
}

/// The curve of least mean height, as a share of the `median` curve; each distance counts the same, however many spots it has.
/// `None` when areas do not fall with distance.
pub(super) fn fit(spots: &[Sample], median: &Envelope) -> Option<Envelope> {
    let mut sorted = spots.to_vec();
    sorted.sort_by(|a, b| b.distance_m.total_cmp(&a.distance_m));
    let weights = weights(&sorted, median);
    let most_m = MOST_SHIFT * sorted.last()?.distance_m;
    let curve = |shift_m: f64| line_above(&sorted, &weights, shift_m);
    let steps = SHIFTS as f64;
    let tried = (0..=SHIFTS).filter_map(|step| curve(most_m * (2.0 * step as f64 / steps - 1.0)));
    let best = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (mut low_m, mut high_m) =
        (best.0.shift_m - 2.0 * most_m / steps, best.0.shift_m + 2.0 * most_m / steps);
    let height = |found: &Option<(Envelope, f64)>| found.map_or(f64::INFINITY, |(_, height)| height);
    // Golden section: the mean height has one valley near its best step.
    let share = (5f64.sqrt() - 1.0) / 2.0;
    while high_m - low_m > 1e-6 {
        let (left_m, right_m) = (high_m - share * (high_m - low_m), low_m + share * (high_m - low_m));
        if height(&curve(left_m)) < height(&curve(right_m)) { high_m = right_m } else { low_m = left_m }
    }
    let last = curve((0.5 * (low_m + high_m)).clamp(-most_m, most_m));
    Some(last.filter(|last| last.1 < best.1).unwrap_or(best).0)
}

/// One over the median curve and the grain, over the spots within a tenth of the distance (the list is sorted).
fn weights(sorted: &[Sample], median: &Envelope) -> Vec<f64> {
    let (mut first, mut last) = (0, 0);
    sorted
        .iter()
        .map(|spot| {
            while sorted[first].distance_m > 1.1 * spot.distance_m {
                first += 1;
            }
            while last < sorted.len() && sorted[last].distance_m > spot.distance_m / 1.1 {
                last += 1;
            }
            1.0 / ((median.area_px(spot.distance_m) + GRAIN_PX) * (last - first).max(1) as f64)
        })
        .collect()
}

/// The line above all spots, farthest spot first, with the least weighted mean height, and that height.
fn line_above(sorted: &[Sample], weights: &[f64], shift_m: f64) -> Option<(Envelope, f64)> {
    let place = |spot: &Sample| {
        let shifted_m = spot.distance_m + shift_m;
        (1.0 / (shifted_m * shifted_m), least_px(spot))
    };
    let total: f64 = weights.iter().sum();
    let mean = sorted.iter().zip(weights).map(|(spot, weight)| weight * place(spot).0).sum::<f64>() / total;
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for point in sorted.iter().map(place) {
        while let [.., a, b] = hull[..]
            && (b.1 - a.1) * (point.0 - a.0) <= (point.1 - a.1) * (b.0 - a.0)
        {
            hull.pop();
        }
        hull.push(point);
    }
    let edge = hull.windows(2).find(|edge| edge[0].0 <= mean && mean <= edge[1].0)?;
    let slope = (edge[1].1 - edge[0].1) / (edge[1].0 - edge[0].0);
    let offset_px = edge[0].1 - slope * edge[0].0;
    let through_zero = || hull.iter().map(|point| point.1 / point.0).fold(0.0, f64::max);
    let (offset_px, scale_px_m2) = if offset_px >= 0.0 { (offset_px, slope) } else { (0.0, through_zero()) };
    let is_falling = scale_px_m2.is_finite() && scale_px_m2 > 1e-9;
    let height = offset_px + scale_px_m2 * mean;
    is_falling.then_some((Envelope { offset_px, scale_px_m2, shift_m }, height))
}
