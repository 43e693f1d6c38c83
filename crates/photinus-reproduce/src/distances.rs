//! Figures 13 and 14: l_A and l_B of the widest pair over the true distance, with the margins (7) to (12), and their relative
//! errors; beside them Photinus' estimate.

use photinus::ranging::margins::Margins;
use photinus::ranging::{AdjacentPair, SpotCurve, bearing_bound_rad};

use crate::poses::{AT_OUTDOOR, AT_PAPER};
use crate::statistics::{rms, share};
use crate::view::{Seen, SeenPair};
use crate::{Figure, Kind, Panel, Report, Rig, Role, Row, Tolerance};

/// What the paper's figures show, m.
const SHOWN_M: [f64; 2] = [2.0, 14.0];
/// The end of figure 14's axes.
const AXIS_PERCENT: f64 = 40.0;

/// One of the two distances with its true one.
struct Case {
    distance_m: f64,
    seen: SeenPair,
}

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
        panels: distance_panels(&at_outdoor, &own, &margins),
        rows: distance_rows(&at_paper, &at_outdoor, &margins, from_centroids),
    };
    let figure_14 = Report {
        figure: Figure::RelativeErrors,
        panels: error_panels(&at_outdoor, &own, &margins),
        rows: error_rows(&at_outdoor, &own, &margins),
    };
    [figure_13, figure_14]
}

/// The margins at any true distance, for the eps of (3).
struct MarginsOf {
    pair: AdjacentPair,
    rad_per_px: f64,
    curve: SpotCurve,
}

impl MarginsOf {
    fn eps_rad(&self, distance_m: f64) -> f64 {
        bearing_bound_rad(self.rad_per_px, self.curve.max_area_px(distance_m))
    }

    fn at(&self, distance_m: f64) -> Margins {
        Margins::at(self.pair, distance_m, self.eps_rad(distance_m))
    }

    /// Whether l_A lies between (10) and (9).
    fn holds_perpendicular(&self, case: &Case) -> bool {
        let margins = self.at(case.distance_m);
        margins.min_perpendicular_m().is_none_or(|min_m| min_m <= case.seen.perpendicular_m)
            && margins.max_perpendicular_m().is_none_or(|max_m| case.seen.perpendicular_m <= max_m)
    }

    /// Whether l_B lies between (12) and (11).
    fn holds_inline(&self, case: &Case) -> bool {
        let margins = self.at(case.distance_m);
        margins.min_inline_m().is_none_or(|min_m| min_m <= case.seen.inline_m)
            && margins.max_inline_m().is_none_or(|max_m| case.seen.inline_m <= max_m)
    }

    fn line(&self, value: impl Fn(&Margins) -> Option<f64>) -> Vec<(f64, f64)> {
        let distances = (0..=240).map(|step| SHOWN_M[0] + 0.05 * f64::from(step));
        distances.filter_map(|distance_m| Some((distance_m, value(&self.at(distance_m))?))).collect()
    }

    /// A margin's largest relative error, percent.
    fn percent_line(&self, value: impl Fn(&Margins) -> Option<f64>) -> Vec<(f64, f64)> {
        let line = self.line(value);
        line.into_iter().map(|(l, margin_m)| (l, 100.0 * (margin_m / l - 1.0).abs())).collect()
    }
}

fn distance_panels(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Panel> {
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

fn error_panels(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Panel> {
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

fn distance_rows(
    at_paper: &[Case],
    at_outdoor: &[Case],
    margins: &MarginsOf,
    from_centroids: f64,
) -> Vec<Row> {
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

fn violations(cases: &[Case], margins: &MarginsOf) -> (usize, usize) {
    let outside =
        |holds: fn(&MarginsOf, &Case) -> bool| cases.iter().filter(|case| !holds(margins, case)).count();
    (outside(MarginsOf::holds_perpendicular), outside(MarginsOf::holds_inline))
}

/// What stands behind cases outside the margins: how far the angle is off what any front pair shows.
fn causes(cases: &[Case], margins: &MarginsOf, holds: fn(&MarginsOf, &Case) -> bool) -> String {
    let outside = || cases.iter().filter(|case| !holds(margins, case));
    let off = |case: &Case| -> Option<f64> {
        let widest_rad = margins.pair.perpendicular_angle_rad(case.distance_m)?;
        let narrowest_rad = margins.pair.inline_angle_rad(case.distance_m)?;
        Some((case.seen.alpha_rad - widest_rad).max(narrowest_rad - case.seen.alpha_rad))
    };
    let both =
        |case: &&Case| off(case).is_some_and(|off_rad| off_rad <= 2.0 * margins.eps_rad(case.distance_m));
    let within_two = outside().filter(both).count();
    let rest = outside().count() - within_two;
    format!(
        "{within_two} of them within two eps (two bearings enter), {rest} of pairs that are no front pair"
    )
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

fn error_rows(cases: &[Case], own: &[(f64, f64)], margins: &MarginsOf) -> Vec<Row> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::tests::rig;

    #[test]
    fn a_case_is_inside_its_margins_or_told_with_its_cause() {
        let rig = rig();
        let margins =
            MarginsOf { pair: rig.pair(), rad_per_px: rig.rad_per_px(), curve: SpotCurve::paper_1000_us() };
        let eps_rad = margins.eps_rad(6.0);
        assert!((eps_rad - 1.5 * 3.7673e-3).abs() < 1e-8, "two pixels at 6 m");
        let case = |off_eps: f64| {
            let alpha_rad = margins.pair.inline_angle_rad(6.0).unwrap() - off_eps * eps_rad;
            let perpendicular_m = margins.pair.perpendicular_m(alpha_rad).unwrap();
            let inline_m = margins.pair.inline_m(alpha_rad).unwrap();
            Case {
                distance_m: 6.0,
                seen: SeenPair { alpha_rad, eps_rad: [eps_rad; 2], perpendicular_m, inline_m },
            }
        };
        let cases = [case(0.5), case(1.5), case(3.0)];
        assert_eq!(cases.each_ref().map(|case| margins.holds_perpendicular(case)), [true, false, false]);
        assert_eq!(violations(&cases, &margins), (2, 2));
        let told = causes(&cases, &margins, MarginsOf::holds_inline);
        assert!(told.starts_with("1 of them within two eps") && told.contains("1 of pairs"), "{told}");
    }
}
