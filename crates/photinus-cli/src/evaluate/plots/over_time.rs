//! The distance of one neighbour over time, as figures 15 and 16 of the paper show it: truth, estimate, bounds, l_A, l_B.

use std::collections::BTreeMap;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::Plot;
use photinus_evaluate::{Evaluation, Pair};
use photinus_io::dataset::TruthFrame;

use super::Figure;
use crate::plots::style::{
    BOUNDS, ESTIMATE, INLINE, PERPENDICULAR, TRUTH, axes, band, line, points, thinned,
};

/// The axis ends at so many times the farthest truth: bounds are cut there, and estimates beyond it are not drawn.
const HEADROOM: f64 = 1.4;

/// The figure of neighbour `id`; `None` where it was never found.
pub(super) fn distance(id: u32, evaluation: &Evaluation<'_>, truth: &[TruthFrame]) -> Option<Figure> {
    let found: BTreeMap<u64, &Pair<'_>> =
        evaluation.pairs.iter().filter(|pair| pair.truth.id == id).map(|pair| (pair.frame, pair)).collect();
    let mut there: Vec<(u64, f64, f64)> = truth
        .iter()
        .filter_map(|frame| {
            let neighbour = frame.neighbours.iter().find(|neighbour| neighbour.id == id)?;
            Some((frame.frame, frame.time_s, neighbour.distance_m))
        })
        .collect();
    there.sort_unstable_by_key(|frame| frame.0);
    if found.is_empty() {
        return None;
    }
    let highest_m = HEADROOM * there.iter().fold(0.0, |most: f64, frame| most.max(frame.2));
    let of = |value: fn(&Pair<'_>) -> Option<f64>| -> Vec<(f64, f64)> {
        let values = found.values().filter_map(|pair| Some((pair.time_s, value(pair)?)));
        values.filter(|point| point.1 <= highest_m).collect()
    };

    let mut plots: Vec<Plot> = Vec::new();
    for (number, run) in runs(&there, &found, highest_m).iter().enumerate() {
        let shown = band(run, BOUNDS);
        plots.push(if number == 0 { shown.with_legend("bounds") } else { shown }.into());
    }
    for (data, colour, marker, legend) in [
        (of(|pair| pair.found.distance_m.perpendicular), PERPENDICULAR, MarkerShape::TriangleDown, "l_A"),
        (of(|pair| pair.found.distance_m.inline), INLINE, MarkerShape::Triangle, "l_B"),
        (of(|pair| pair.found.distance_m.estimate), ESTIMATE, MarkerShape::Circle, "estimate"),
    ] {
        if !data.is_empty() {
            plots.push(points(data, colour, marker, legend).into());
        }
    }
    let truth = thinned(there.iter().map(|&(_, time_s, distance_m)| (time_s, distance_m)).collect());
    plots.push(line(truth, TRUTH).with_legend("truth").into());
    let layout = axes(&plots, "time (s)", "distance (m)")
        .with_title(format!("neighbour {id}"))
        .with_width(900.0)
        .with_y_axis_min(0.0)
        .with_y_axis_max(highest_m);
    Some(Figure { name: format!("distance-over-time-{id}"), plots, layout })
}

/// Bounds as (time, min, max), in runs of frames in which it was found: a gap shows as a gap.
fn runs(
    there: &[(u64, f64, f64)],
    found: &BTreeMap<u64, &Pair<'_>>,
    highest_m: f64,
) -> Vec<Vec<(f64, f64, f64)>> {
    let mut runs = vec![Vec::new()];
    for (frame, time_s, _) in there {
        match (found.get(frame), runs.last_mut()) {
            (Some(pair), Some(run)) => {
                let bounds = &pair.found.distance_m;
                let max = bounds.max.unwrap_or(highest_m).min(highest_m);
                run.push((*time_s, bounds.min.min(highest_m), max));
            }
            (None, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
            _ => {}
        }
    }
    // One point has no area.
    runs.retain(|run| run.len() > 1);
    runs
}
