//! Figure 14: relative errors of l_A and l_B, and of Photinus' estimate.

use photinus::ranging::margins::Margins;

use super::SHOWN_M;
use super::predicted::{Case, MarginsOf};
use crate::statistics::{rms, share};
use crate::view::SeenPair;
use crate::{Figure, Kind, Panel, Report, Role, Row, Tolerance};

/// The end of the paper's axes.
const AXIS_PERCENT: f64 = 40.0;

pub(super) fn report(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Report {
    Report {
        figure: Figure::RelativeErrors,
        panels: panels(cases, own, margins),
        rows: rows(cases, own, margins),
    }
}

fn panels(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Panel> {
    let percent = |value: fn(&SeenPair) -> f64| -> Vec<(f64, f64)> {
        let error = |case: &Case| 100.0 * (value(&case.seen) / case.distance_m - 1.0).abs();
        cases.iter().map(|case| (case.distance_m, error(case))).collect()
    };
    let axes = |title| {
        Panel::new(title, "true distance (m)", "relative error (%)").with_ranges(SHOWN_M, [0.0, AXIS_PERCENT])
    };
    let perpendicular = axes("Error of l_A")
        .with("l_A", Kind::Points, Role::Perpendicular, percent(|seen| seen.perpendicular_m))
        .with(
            "predicted largest (9)",
            Kind::Line,
            Role::Bound,
            margins.percent_line(Margins::max_perpendicular_m),
        );
    let inline = axes("Error of l_B")
        .with("l_B", Kind::Points, Role::Inline, percent(|seen| seen.inline_m))
        .with("predicted largest (12)", Kind::Line, Role::Bound, margins.percent_line(Margins::min_inline_m));
    let own = own.iter().map(|(l, estimate_m)| (*l, 100.0 * (estimate_m / l - 1.0).abs())).collect();
    vec![
        perpendicular,
        inline,
        axes("Error of Photinus' estimate").with("estimate", Kind::Points, Role::Own, own),
    ]
}

fn rows(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Row> {
    let relative = |value: fn(&SeenPair) -> f64| -> Vec<(f64, f64)> {
        cases.iter().map(|case| (case.distance_m, value(&case.seen) / case.distance_m - 1.0)).collect()
    };
    let l_a = relative(|seen| seen.perpendicular_m);
    let l_b = relative(|seen| seen.inline_m);
    let middle = relative(|seen| 0.5 * (seen.perpendicular_m + seen.inline_m));
    let own: Vec<(f64, f64)> = own.iter().map(|(l, estimate_m)| (*l, estimate_m / l - 1.0)).collect();
    let of = |errors: &[(f64, f64)]| rms(errors.iter().map(|error| error.1));
    let within = |errors: &[(f64, f64)]| {
        share(
            errors.iter().filter(|error| error.0 <= 12.0).map(|error| 100.0 * error.1.abs() <= AXIS_PERCENT),
        )
    };
    let growth = |errors: &[(f64, f64)]| {
        let between = |low: f64, high: f64| {
            rms(errors.iter().filter(|error| (low..high).contains(&error.0)).map(|error| error.1 * error.0))
        };
        between(10.0, 14.0) / between(2.0, 6.0)
    };
    let predicted =
        margins.percent_line(Margins::max_perpendicular_m).last().map_or(f64::NAN, |point| point.1);
    vec![
        Row::of_paper(
            "relative errors of l_A within the paper's axis of 40 %, to 12 m, share",
            1.0,
            within(&l_a),
            Tolerance::AtLeast(0.999),
            "the axis holds all of its points",
        ),
        Row::of_paper(
            "relative errors of l_B within the paper's axis of 40 %, to 12 m, share",
            1.0,
            within(&l_b),
            Tolerance::AtLeast(0.999),
            "the axis holds all of its points",
        ),
        Row::own(
            "predicted largest relative error of l_A at 14 m (%)",
            predicted,
            Tolerance::None,
            "(9) with eps of (3) and S_max of (13)",
        ),
        Row::of_paper(
            "growth of the error of l_A, rms at 10 to 14 m over rms at 2 to 6 m",
            12.0 / 4.0,
            growth(&l_a),
            Tolerance::Ratio(0.5),
            "\"roughly linearly with the distance\": 12 m over 4 m; a bearing error that stays the same would give the square",
        ),
        Row::own("relative error of l_A, rms", of(&l_a), Tolerance::None, ""),
        Row::own("relative error of l_B, rms", of(&l_b), Tolerance::None, ""),
        Row::own("relative error of the mean of l_A and l_B, rms", of(&middle), Tolerance::None, ""),
        Row::own(
            "relative error of Photinus' estimate, rms",
            of(&own),
            Tolerance::None,
            "single frames, default settings, gravity known",
        ),
        Row::own(
            "relative error, Photinus over the better of l_A and l_B",
            of(&own) / of(&l_a).min(of(&l_b)),
            Tolerance::AtMost(0.8),
            "Photinus' gain: every marker, its centroid, all views that match",
        ),
        Row::own(
            "relative error, Photinus over the mean of l_A and l_B",
            of(&own) / of(&middle),
            Tolerance::AtMost(1.0),
            "the paper does not take the mean; a fair rival",
        ),
        Row::own(
            "poses with a distance, Photinus over threshold 50",
            own.len() as f64 / cases.len() as f64,
            Tolerance::AtLeast(1.0),
            "2 to 14 m",
        ),
    ]
}
