//! One neighbour over time: its distance, as figures 15 and 16 of the paper show it, and the error of the estimate.

use std::collections::BTreeMap;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::Plot;
use photinus_evaluate::{Evaluation, Pair};
use photinus_io::dataset::TruthFrame;
use photinus_io::results::Distance;

use super::Figure;
use crate::plots::style::{
    BOUNDS, ESTIMATE, FAINT, INLINE, PERPENDICULAR, axes, band, level, line, plain, points, thinned,
};

/// A bound farther than this many times the farthest truth is cut there.
const MOST_TIMES: f64 = 8.0;
/// The axis begins at this share of the nearest bound or truth.
const BELOW: f64 = 0.8;

/// Who blinks is dark no longer than this, s.
const LONGEST_DARK_S: f64 = 0.1;

/// What was found of a neighbour, by frame.
type Found<'a> = BTreeMap<u64, &'a Pair<'a>>;

/// The figures of neighbour `id`, called `whose` in their titles; none where it was never found.
pub(super) fn figures(
    id: u32,
    whose: &str,
    evaluation: &Evaluation<'_>,
    truth: &[TruthFrame],
) -> Vec<Figure> {
    let found: Found<'_> =
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
        return Vec::new();
    }
    [Some(distance(id, whose, &there, &found)), error(id, whose, &found)].into_iter().flatten().collect()
}

/// Distances on a logarithmic axis, so that far bounds are shown and near ones are not flat. Truth lies beneath, wide and pale.
fn distance(id: u32, whose: &str, there: &[(u64, f64, f64)], found: &Found<'_>) -> Figure {
    let (nearest_m, farthest_m) =
        there.iter().fold((f64::INFINITY, 0.0_f64), |(near, far), at| (near.min(at.2), far.max(at.2)));
    let bounds = || found.values().map(|pair| (pair.time_s, &pair.found.distance_m));
    let lowest_m =
        BELOW * bounds().map(|(_, bounds)| bounds.min).filter(|&m| m > 0.0).fold(nearest_m, f64::min);
    let highest_m = bounds()
        .filter_map(|(_, bounds)| bounds.max)
        .fold(1.2 * farthest_m, f64::max)
        .min(MOST_TIMES * farthest_m);
    // An axis from tick to tick has two of them at least.
    let (lowest_m, highest_m) = (tick_below(lowest_m), tick_above(highest_m));
    let of = |value: fn(&Pair<'_>) -> Option<f64>| -> Vec<(f64, f64)> {
        let values = found.values().filter_map(|pair| Some((pair.time_s, value(pair)?)));
        values.filter(|point| (lowest_m..=highest_m).contains(&point.1)).collect()
    };
    let mut plots: Vec<Plot> = Vec::new();
    for (number, run) in runs(bounds(), [lowest_m, highest_m]).iter().enumerate() {
        let shown = band(run, BOUNDS);
        plots.push(if number == 0 { shown.with_legend("bounds") } else { shown }.into());
    }
    let truth = thinned(there.iter().map(|&(_, time_s, distance_m)| (time_s, distance_m)).collect());
    plots.push(line(truth, PALE).with_stroke_width(7.0).with_legend("truth").into());
    for (data, colour, marker, legend, size) in [
        (
            of(|pair| pair.found.distance_m.perpendicular),
            PERPENDICULAR,
            MarkerShape::TriangleDown,
            "l_A",
            1.8,
        ),
        (of(|pair| pair.found.distance_m.inline), INLINE, MarkerShape::Triangle, "l_B", 1.8),
        (of(|pair| pair.found.distance_m.estimate), ESTIMATE, MarkerShape::Circle, "estimate", 1.3),
    ] {
        if !data.is_empty() {
            plots.push(points(data, colour, marker, legend).with_size(size).into());
        }
    }
    let layout = axes(&plots, "time (s)", "distance (m)")
        .with_width(900.0)
        .with_log_y()
        .with_y_tick_format(plain())
        .with_y_axis_min(lowest_m)
        .with_y_axis_max(highest_m);
    Figure {
        name: format!("distance-over-time-{id}"),
        title: format!("Distance{whose} over time"),
        caption: "The strict bounds, which truth never leaves, as a band; truth as the wide line beneath; on it the estimate of each \
                  frame by itself, and the two estimates of the founding paper, l_A and l_B.",
        plots,
        layout,
    }
}

/// Estimate minus truth, with what the estimates claim.
fn error(id: u32, whose: &str, found: &Found<'_>) -> Option<Figure> {
    let of = |value: fn(&Pair<'_>) -> Option<f64>| -> Vec<(f64, f64)> {
        found.values().filter_map(|pair| Some((pair.time_s, value(pair)?))).collect()
    };
    let errors = of(|pair| Some(pair.found.distance_m.estimate? - pair.truth.distance_m));
    if errors.is_empty() {
        return None;
    }
    let claimed: Vec<(f64, f64, f64)> = thinned(of(|pair| pair.found.distance_m.sigma))
        .into_iter()
        .map(|(time_s, m)| (time_s, -2.0 * m, 2.0 * m))
        .collect();
    let mut plots: Vec<Plot> = Vec::new();
    if claimed.len() > 1 {
        plots.push(band(&claimed, FAINT).with_legend("two sigmas as claimed").into());
    }
    plots.push(points(errors, ESTIMATE, MarkerShape::Circle, "estimate - truth").with_size(1.6).into());
    let layout = axes(&plots, "time (s)", "error of the distance (m)")
        .with_width(900.0)
        .with_reference_line(level(0.0));
    Some(Figure {
        name: format!("distance-error-over-time-{id}"),
        title: format!("Error of the distance{whose} over time"),
        caption: "Where sigmas are right, 95 in 100 points lie within the band.",
        plots,
        layout,
    })
}

/// Ticks of a logarithmic axis: 1, 2 and 5 times the powers of ten.
fn ticks_around(value: f64) -> [f64; 4] {
    let decade = libm::exp10(libm::floor(libm::log10(value)));
    [1.0, 2.0, 5.0, 10.0].map(|tick| tick * decade)
}

fn tick_below(value: f64) -> f64 {
    let ticks = ticks_around(value);
    ticks.into_iter().rfind(|tick| *tick <= value).unwrap_or(ticks[0])
}

fn tick_above(value: f64) -> f64 {
    let ticks = ticks_around(value);
    ticks.into_iter().find(|tick| *tick >= value).unwrap_or(ticks[3])
}

/// Truth, drawn wide, beneath what is to be seen on it.
const PALE: &str = "#B8BDC2";

/// Bounds as (time, min, max), in runs of frames in which it was found: a gap that is longer than words are dark shows as a gap.
fn runs<'a>(
    found: impl Iterator<Item = (f64, &'a Distance)>,
    [lowest_m, highest_m]: [f64; 2],
) -> Vec<Vec<(f64, f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64, f64)>> = Vec::new();
    for (time_s, bounds) in found {
        let max = bounds.max.unwrap_or(highest_m).min(highest_m);
        let own = (time_s, bounds.min.clamp(lowest_m, highest_m), max);
        match runs.last_mut() {
            Some(run) if run.last().is_some_and(|last| time_s - last.0 <= LONGEST_DARK_S) => run.push(own),
            _ => runs.push(vec![own]),
        }
    }
    // One point has no area.
    runs.retain(|run| run.len() > 1);
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_go_on_while_a_word_is_dark_and_end_where_nobody_is_found() {
        let told =
            Distance { estimate: None, sigma: None, min: 2.0, max: None, perpendicular: None, inline: None };
        // Lit in every other frame, and gone for a second.
        let lit_s = (0..10).map(|n| f64::from(n) / 30.0).chain((0..10).map(|n| 1.5 + f64::from(n) / 30.0));
        let runs = runs(lit_s.map(|time_s| (time_s, &told)), [1.0, 9.0]);
        assert_eq!(runs.iter().map(Vec::len).collect::<Vec<_>>(), [10, 10]);
        assert!(
            runs.iter().flatten().all(|(_, min, max)| (1.9..2.1).contains(min) && (8.9..9.1).contains(max))
        );
    }

    #[test]
    fn an_axis_ends_at_the_ticks_around_its_values() {
        for (value, below, above) in
            [(2.1, 2.0, 5.0), (4.9, 2.0, 5.0), (0.07, 0.05, 0.1), (60.0, 50.0, 100.0)]
        {
            let off = (tick_below(value) / below - 1.0).abs().max((tick_above(value) / above - 1.0).abs());
            assert!(off < 1e-12, "{value}: {} to {}", tick_below(value), tick_above(value));
        }
    }
}
