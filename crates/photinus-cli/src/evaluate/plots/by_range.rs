//! Figures over the true distance.

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::Plot;
use photinus_evaluate::{Bin, Evaluation, Pair, Scores};

use super::Figure;
use crate::plots::style::{
    BOUNDS, ESTIMATE, FAINT, INLINE, PERPENDICULAR, TRUTH, WRONG, axes, band, level, line, points,
};

const DISTANCE: &str = "true distance (m)";

/// All figures that have something to show.
pub(super) fn figures(evaluation: &Evaluation<'_>) -> Vec<Figure> {
    let (scores, pairs) = (&evaluation.scores, &evaluation.pairs);
    let figures = [
        recall(scores),
        centre_error(scores),
        bearing_error(scores, pairs),
        distance_error(scores, pairs),
        bounds(pairs),
        position_nees(scores),
        paper(pairs),
    ];
    figures.into_iter().flatten().collect()
}

/// Name, title, and what there is to see in it.
type About = (&'static str, &'static str, &'static str);

const RECALL: About = (
    "recall-precision",
    "Recall and precision",
    "Recall: the share of what is there that was found. Precision: the share of what was found that is there. Marks that lie on \
     one another are drawn smaller and smaller.",
);
const CENTRE: About = (
    "centre-error",
    "Error of the spots' centres",
    "Against where the simulator put the centre of each LED's image.",
);
const BEARING: About =
    ("bearing-error", "Error of bearings", "Angle between the bearing of a neighbour and the true one.");
const DISTANCE_ERROR: About = (
    "distance-error",
    "Error of distances",
    "Estimate minus truth, by the true distance. Bias is what all have in common; rms is all of it.",
);
const BOUNDS_HELD: About = (
    "bounds",
    "Strict bounds",
    "How far the bounds are from truth. Near bounds lie below zero and far bounds above it: a mark on the wrong side is a \
     violation, and a bug.",
);
const NEES: About = (
    "position-nees",
    "Consistency of position covariances",
    "Mean squared error over what the covariance claims. 1 is right; above, covariances are too small.",
);
const PAPER: About = (
    "paper-distances",
    "The two distances of the founding paper",
    "l_A takes the two nearest markers as perpendicular to the line of sight, l_B as along it; truth lies between.",
);

fn figure((name, title, caption): About, plots: Vec<Plot>, y_label: &str) -> Option<Figure> {
    let layout = axes(&plots, DISTANCE, y_label);
    let (name, title) = (name.to_owned(), title.to_owned());
    (!plots.is_empty()).then(|| Figure { name, title, caption, plots, layout })
}

/// A value of each bin at its middle; what lies beyond the last edge stands at that edge.
fn at_middles<S>(bins: &[Bin<S>], value: impl Fn(&S) -> Option<f64>) -> Vec<(f64, f64)> {
    let middle = |bin: &Bin<S>| bin.to_m.map_or(bin.from_m, |to_m| (bin.from_m + to_m) / 2.0);
    bins.iter().filter_map(|bin| Some((middle(bin), value(&bin.score)?))).collect()
}

/// A line through marks, for values of bins; nothing where there is no value.
fn marked(data: Vec<(f64, f64)>, colour: &str, marker: MarkerShape, legend: &str) -> Vec<Plot> {
    if data.is_empty() {
        return Vec::new();
    }
    let marks = points(data.clone(), colour, marker, legend).with_size(4.0).with_marker_opacity(1.0);
    vec![line(data, colour).into(), marks.into()]
}

/// Points, their colour, mark and name.
type Kind<'a> = (Vec<(f64, f64)>, &'a str, MarkerShape, &'a str);

/// Points of several kinds, where there are any.
fn named_points<const N: usize>(kinds: [Kind<'_>; N]) -> Vec<Plot> {
    let kinds = kinds.into_iter().filter(|kind| !kind.0.is_empty());
    kinds.map(|(data, colour, marker, legend)| points(data, colour, marker, legend).into()).collect()
}

/// Points of pairs over the true distance.
fn of_pairs(pairs: &[Pair<'_>], value: impl Fn(&Pair<'_>) -> Option<f64>) -> Vec<(f64, f64)> {
    let points = pairs.iter().filter_map(|pair| Some((pair.truth.distance_m, value(pair)?)));
    points.filter(|point| point.1.is_finite()).collect()
}

fn recall(scores: &Scores) -> Option<Figure> {
    let neighbours = &scores.neighbours.by_range.bins;
    let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
    let mut plots = marked(
        at_middles(neighbours, |score| percent(score.recall)),
        ESTIMATE,
        MarkerShape::Circle,
        "neighbours, recall",
    );
    plots.extend(marked(
        at_middles(neighbours, |score| percent(score.precision)),
        BOUNDS,
        MarkerShape::Square,
        "neighbours, precision",
    ));
    if let Some(spots) = &scores.spots {
        let bins = &spots.by_range.bins;
        let recall = at_middles(bins, |score| percent(score.recall));
        let precision = at_middles(bins, |score| percent(score.precision));
        plots.extend(marked(recall, WRONG, MarkerShape::Triangle, "spots, recall"));
        plots.extend(marked(precision, PERPENDICULAR, MarkerShape::Diamond, "spots, precision"));
    }
    let mut figure = figure(RECALL, plots, "share (%)")?;
    // Curves that lie on one another are all seen: those that are drawn later have smaller marks.
    let marks = figure
        .plots
        .iter_mut()
        .filter_map(|plot| if let Plot::Scatter(marks) = plot { Some(marks) } else { None });
    marks.zip([8.0, 6.2, 4.4, 2.6]).for_each(|(marks, size)| *marks = std::mem::take(marks).with_size(size));
    figure.layout = figure.layout.with_y_axis_min(0.0).with_y_axis_max(105.0);
    Some(figure)
}

fn centre_error(scores: &Scores) -> Option<Figure> {
    let bins = &scores.spots.as_ref()?.by_range.bins;
    let mut plots =
        marked(at_middles(bins, |score| score.centroid_error_px.rms), ESTIMATE, MarkerShape::Circle, "rms");
    plots.extend(marked(
        at_middles(bins, |score| score.centroid_bias_u_px),
        PERPENDICULAR,
        MarkerShape::Square,
        "bias, column",
    ));
    plots.extend(marked(
        at_middles(bins, |score| score.centroid_bias_v_px),
        INLINE,
        MarkerShape::Triangle,
        "bias, row",
    ));
    figure(CENTRE, plots, "error of a spot's centre (px)")
}

fn bearing_error(scores: &Scores, pairs: &[Pair<'_>]) -> Option<Figure> {
    let each = of_pairs(pairs, |pair| pair.bearing_error_rad().map(|rad| 1e3 * rad));
    if each.is_empty() {
        return None;
    }
    let rms = at_middles(&scores.bearing_error_rad.bins, |error| error.rms.map(|rad| 1e3 * rad));
    let mut plots: Vec<Plot> = vec![points(each, BOUNDS, MarkerShape::Circle, "each neighbour").into()];
    plots.extend(marked(rms, ESTIMATE, MarkerShape::Square, "rms"));
    figure(BEARING, plots, "bearing error (mrad)")
}

fn distance_error(scores: &Scores, pairs: &[Pair<'_>]) -> Option<Figure> {
    let each = of_pairs(pairs, |pair| Some(pair.found.distance_m.estimate? - pair.truth.distance_m));
    if each.is_empty() {
        return None;
    }
    let bins = &scores.distance.bins;
    let mut plots: Vec<Plot> = vec![points(each, BOUNDS, MarkerShape::Circle, "each neighbour").into()];
    let bias = at_middles(bins, |score| score.error_m.bias);
    let rms = at_middles(bins, |score| score.error_m.rms);
    plots.extend(marked(bias, ESTIMATE, MarkerShape::Square, "bias"));
    plots.extend(marked(rms, WRONG, MarkerShape::Triangle, "rms"));
    let mut figure = figure(DISTANCE_ERROR, plots, "estimate - truth (m)")?;
    figure.layout = figure.layout.with_reference_line(level(0.0));
    Some(figure)
}

fn bounds(pairs: &[Pair<'_>]) -> Option<Figure> {
    let near = of_pairs(pairs, |pair| Some(pair.found.distance_m.min - pair.truth.distance_m));
    let far = of_pairs(pairs, |pair| Some(pair.found.distance_m.max? - pair.truth.distance_m));
    if near.is_empty() {
        return None;
    }
    let (too_far, near): (Vec<_>, Vec<_>) = near.into_iter().partition(|point| point.1 > 0.0);
    let (too_near, far): (Vec<_>, Vec<_>) = far.into_iter().partition(|point| point.1 < 0.0);
    let violations = [too_far, too_near].concat();
    let mut plots = named_points([
        (far, PERPENDICULAR, MarkerShape::TriangleDown, "max - truth"),
        (near, INLINE, MarkerShape::Triangle, "min - truth"),
    ]);
    if !violations.is_empty() {
        let crosses = points(violations, WRONG, MarkerShape::Cross, "violated");
        plots.push(crosses.with_size(5.0).with_marker_opacity(1.0).into());
    }
    let mut figure = figure(BOUNDS_HELD, plots, "bound - truth (m)")?;
    figure.layout = figure.layout.with_reference_line(level(0.0));
    Some(figure)
}

fn position_nees(scores: &Scores) -> Option<Figure> {
    let bins = &scores.position.bins;
    let nees = at_middles(bins, |score| score.consistency.nees.map(|nees| nees / 3.0));
    if nees.is_empty() {
        return None;
    }
    // Where the mean of right covariances falls in 95 of 100 experiments.
    let error =
        at_middles(bins, |score| score.consistency.nees_standard_error.map(|error| 1.96 * error / 3.0));
    let expected: Vec<_> = error.iter().map(|&(x, error)| (x, (1.0 - error).max(0.0), 1.0 + error)).collect();
    let mut plots: Vec<Plot> = Vec::new();
    if expected.len() > 1 {
        plots.push(band(&expected, FAINT).with_legend("95 % of means, if covariances are right").into());
    }
    plots.extend(marked(nees, ESTIMATE, MarkerShape::Circle, "mean NEES / 3"));
    let mut figure = figure(NEES, plots, "NEES of the position / 3")?;
    figure.layout = figure.layout.with_reference_line(level(1.0)).with_y_axis_min(0.0);
    Some(figure)
}

fn paper(pairs: &[Pair<'_>]) -> Option<Figure> {
    let perpendicular = of_pairs(pairs, |pair| pair.found.distance_m.perpendicular);
    let inline = of_pairs(pairs, |pair| pair.found.distance_m.inline);
    if perpendicular.is_empty() && inline.is_empty() {
        return None;
    }
    let both = perpendicular.iter().chain(&inline).map(|point| point.0);
    let (nearest, farthest) = both.fold((f64::INFINITY, 0.0f64), |(near, far), x| (near.min(x), far.max(x)));
    let mut plots = named_points([
        (perpendicular, PERPENDICULAR, MarkerShape::TriangleDown, "l_A (perpendicular)"),
        (inline, INLINE, MarkerShape::Triangle, "l_B (inline)"),
    ]);
    plots.push(line(vec![(nearest, nearest), (farthest, farthest)], TRUTH).with_legend("truth").into());
    figure(PAPER, plots, "distance (m)")
}
