//! Figures 13 and 14: l_A and l_B of the widest pair over the true distance, with the margins (7) to (12), and their relative
//! errors; beside them Photinus' estimate.

mod predicted;
mod relative_errors;

use photinus::ranging::SpotCurve;
use photinus::ranging::margins::Margins;

use crate::poses::{AT_OUTDOOR, AT_PAPER};
use crate::statistics::share;
use crate::view::{Seen, SeenPair};
use crate::{Figure, Kind, Panel, Report, Rig, Role, Row, Tolerance};
use predicted::{Case, MarginsOf, causes, violations};

/// What the paper's figures show, m.
const SHOWN_M: [f64; 2] = [2.0, 14.0];

/// Figure 13 and figure 14.
pub(crate) fn reports(rig: &Rig, seen: &[Seen]) -> [Report; 2] {
    let shown = || seen.iter().filter(|seen| (SHOWN_M[0]..=SHOWN_M[1]).contains(&seen.distance_m()));
    let cases = |view: usize| -> Vec<Case> {
        let case = |seen: &Seen| Some(Case { distance_m: seen.distance_m(), seen: seen.paper[view].pair? });
        shown().filter_map(case).collect()
    };
    let (at_paper, at_outdoor) = (cases(AT_PAPER), cases(AT_OUTDOOR));
    let estimate = |seen: &Seen| Some((seen.distance_m(), seen.own.neighbour?.estimate_m?));
    let own: Vec<(f64, f64)> = shown().filter_map(estimate).collect();
    let from_centroids = share(shown().filter_map(Seen::is_between_centroids));
    let margins =
        MarginsOf { pair: rig.pair(), rad_per_px: rig.rad_per_px(), curve: SpotCurve::paper_1000_us() };
    let figure_13 = Report {
        figure: Figure::Distances,
        panels: panels(&at_outdoor, &own, &margins),
        rows: rows(&at_paper, &at_outdoor, &margins, from_centroids),
    };
    [figure_13, relative_errors::report(&at_outdoor, &own, &margins)]
}

fn panels(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Panel> {
    let x_label = "true distance (m)";
    let points = |value: fn(&SeenPair) -> f64| -> Vec<(f64, f64)> {
        cases.iter().map(|case| (case.distance_m, value(&case.seen))).collect()
    };
    let axes = |title, y_label| Panel::new(title, x_label, y_label).with_ranges(SHOWN_M, [0.0, 20.0]);
    let truth = || SHOWN_M.map(|l| (l, l)).to_vec();
    let perpendicular = axes("Perpendicular, (5)", "l_A (m)")
        .with("l_A", Kind::Points, Role::Perpendicular, points(|seen| seen.perpendicular_m))
        .with("truth", Kind::Line, Role::Truth, truth())
        .with("wrong case (7)", Kind::Dashed, Role::Printed, margins.line(Margins::wrong_perpendicular_m))
        .with(
            "largest (9), smallest (10)",
            Kind::Line,
            Role::Bound,
            margins.line(Margins::max_perpendicular_m),
        )
        .with("", Kind::Line, Role::Bound, margins.line(Margins::min_perpendicular_m));
    let inline = axes("Inline, (6)", "l_B (m)")
        .with("l_B", Kind::Points, Role::Inline, points(|seen| seen.inline_m))
        .with("truth", Kind::Line, Role::Truth, truth())
        .with("wrong case (8)", Kind::Dashed, Role::Printed, margins.line(Margins::wrong_inline_m))
        .with("largest (11), smallest (12)", Kind::Line, Role::Bound, margins.line(Margins::max_inline_m))
        .with("", Kind::Line, Role::Bound, margins.line(Margins::min_inline_m));
    let estimate = axes("Photinus", "estimate (m)")
        .with("estimate", Kind::Points, Role::Own, own.to_vec())
        .with("truth", Kind::Line, Role::Truth, truth());
    vec![perpendicular, inline, estimate]
}

fn rows(at_paper: &[Case], at_outdoor: &[Case], margins: &MarginsOf, from_centroids: f64) -> Vec<Row> {
    let mut rows = Vec::new();
    for (cases, threshold) in [(at_paper, 200), (at_outdoor, 50)] {
        let (above, below) = violations(cases, margins);
        let note = format!(
            "the paper has all inside; {above} of {} outside, {}",
            cases.len(),
            causes(cases, margins, MarginsOf::holds_perpendicular)
        );
        rows.push(Row::of_paper(
            format!("l_A within (9) and (10), threshold {threshold}, share"),
            1.0,
            share(cases.iter().map(|case| margins.holds_perpendicular(case))),
            Tolerance::AtLeast(1.0),
            note,
        ));
        let note = format!(
            "the paper has all inside; {below} of {} outside, {}",
            cases.len(),
            causes(cases, margins, MarginsOf::holds_inline)
        );
        rows.push(Row::of_paper(
            format!("l_B within (11) and (12), threshold {threshold}, share"),
            1.0,
            share(cases.iter().map(|case| margins.holds_inline(case))),
            Tolerance::AtLeast(1.0),
            note,
        ));
    }
    let truth_between =
        |case: &Case| case.seen.inline_m <= case.distance_m && case.distance_m <= case.seen.perpendicular_m;
    rows.push(Row::own(
        "l_B <= truth <= l_A, threshold 50, share",
        share(at_outdoor.iter().map(truth_between)),
        Tolerance::None,
        "alpha from middle pixels, not widened: it holds for exact bearings only",
    ));
    rows.push(Row::own(
        "l_B <= truth <= l_A, from centroids, share",
        from_centroids,
        Tolerance::AtLeast(0.9),
        "Photinus' bearings in (5) and (6): a tenth of the error; what remains is noise where truth is at an end",
    ));
    rows.extend(printed_rows(margins));
    rows
}

/// What the paper's slips change, in numbers, at 10 m.
fn printed_rows(margins: &MarginsOf) -> Vec<Row> {
    let distance_m = 10.0;
    let (at, eps_rad) = (margins.at(distance_m), margins.eps_rad(distance_m));
    let alpha_rad = margins.pair.perpendicular_angle_rad(distance_m);
    let widened =
        |eps: f64| alpha_rad.and_then(|alpha_rad| margins.pair.perpendicular_m(alpha_rad + eps * eps_rad));
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let narrowed = |eps: f64| {
        let alpha_rad = margins.pair.inline_angle_rad(distance_m);
        number(alpha_rad.and_then(|alpha_rad| margins.pair.perpendicular_m(alpha_rad - eps * eps_rad)))
    };
    vec![
        Row::own(
            "smallest l_A at 10 m by (10) as printed (m)",
            number(at.min_perpendicular_m()),
            Tolerance::None,
            "eps is added to the half angle: the same as two eps on the angle",
        ),
        Row::own(
            "smallest l_A at 10 m, one eps on the angle (m)",
            number(widened(1.0)),
            Tolerance::None,
            "what (10) would be in the manner of (9), (11) and (12)",
        ),
        Row::own("largest l_A at 10 m by (9), one eps (m)", narrowed(1.0), Tolerance::None, "as printed"),
        Row::own(
            "largest l_A at 10 m, two eps (m)",
            narrowed(2.0),
            Tolerance::None,
            "two bearings enter alpha, each with its own eps: a strict margin takes both",
        ),
    ]
}
