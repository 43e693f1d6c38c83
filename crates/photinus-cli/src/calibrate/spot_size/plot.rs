//! Areas over distance with the three curves, as figure 11 of the paper shows it, but with both axes logarithmic: near spots
//! would hide the far ones.

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::Plot;
use photinus::ranging::Envelope;
use photinus_calibrate::spot_size::SpotSize;

use super::recordings::Recording;
use crate::plots::Figure;
use crate::plots::style::{BOUNDS, ESTIMATE, FAINT, WRONG, axes, line, plain, points};

const STEPS: usize = 200;

/// The figure of one exposure.
pub(super) fn figure(recording: &Recording, found: &SpotSize) -> Figure {
    let spot = |index: usize| {
        let sample = recording.samples[index];
        (sample.distance_m, f64::from(sample.area_px))
    };
    let is_spot = |index: &usize| recording.samples[*index].area_px > 0;
    let (outliers, spots): (Vec<usize>, Vec<usize>) = (0..recording.samples.len())
        .filter(is_spot)
        .partition(|index| found.outliers.binary_search(index).is_ok());
    let spots: Vec<(f64, f64)> = spots.into_iter().map(spot).collect();
    let mut plots: Vec<Plot> = vec![points(spots, FAINT, MarkerShape::Circle, "spots").into()];
    if !outliers.is_empty() {
        let outliers = outliers.into_iter().map(spot).collect();
        plots.push(points(outliers, WRONG, MarkerShape::Cross, "not used").with_size(4.0).into());
    }
    let along = |curve: Envelope| {
        let ratio = found.farthest_seen_m / found.nearest_m;
        let distance_m = |step: usize| found.nearest_m * libm::pow(ratio, step as f64 / STEPS as f64);
        (0..=STEPS).map(|step| (distance_m(step), curve.area_px(distance_m(step)))).collect::<Vec<_>>()
    };
    plots.push(line(along(found.median.envelope), BOUNDS).with_dashed().with_legend("median").into());
    plots.push(line(along(found.envelope.envelope), ESTIMATE).with_legend("envelope").into());
    plots.push(line(along(found.curve.upper()), WRONG).with_dotted().with_legend("bound for ranging").into());
    let exposure = recording.exposure_us.map_or(String::new(), |us| format!("-{us}us"));
    let title = recording.exposure_us.map_or("spot size".to_owned(), |us| format!("spot size at {us} us"));
    let layout = axes(&plots, "distance (m)", "area (px)").with_title(title).with_log_x().with_log_y();
    let layout = layout
        .with_x_axis_min(0.8 * found.nearest_m)
        .with_x_axis_max(1.25 * found.farthest_seen_m)
        .with_y_axis_min(0.5)
        .with_x_tick_format(plain())
        .with_y_tick_format(plain());
    Figure { name: format!("spot-size{exposure}"), plots, layout }
}
