//! The margins (7) to (12) at any true distance, and whether what was seen lies within them.

use photinus::ranging::margins::Margins;
use photinus::ranging::{AdjacentPair, SpotCurve, bearing_bound_rad};

use super::SHOWN_M;
use crate::view::SeenPair;

/// What was made of a pair, with its true distance.
pub(super) struct Case {
    pub(super) distance_m: f64,
    pub(super) seen: SeenPair,
}

/// The margins at any true distance, for the eps of (3).
pub(super) struct MarginsOf {
    pub(super) pair: AdjacentPair,
    pub(super) rad_per_px: f64,
    pub(super) curve: SpotCurve,
}

impl MarginsOf {
    pub(super) fn eps_rad(&self, distance_m: f64) -> f64 {
        bearing_bound_rad(self.rad_per_px, self.curve.max_area_px(distance_m))
    }

    pub(super) fn at(&self, distance_m: f64) -> Margins {
        Margins::at(self.pair, distance_m, self.eps_rad(distance_m))
    }

    /// Whether l_A lies between (10) and (9).
    pub(super) fn holds_perpendicular(&self, case: &Case) -> bool {
        let margins = self.at(case.distance_m);
        margins.min_perpendicular_m().is_none_or(|min_m| min_m <= case.seen.perpendicular_m)
            && margins.max_perpendicular_m().is_none_or(|max_m| case.seen.perpendicular_m <= max_m)
    }

    /// Whether l_B lies between (12) and (11).
    pub(super) fn holds_inline(&self, case: &Case) -> bool {
        let margins = self.at(case.distance_m);
        margins.min_inline_m().is_none_or(|min_m| min_m <= case.seen.inline_m)
            && margins.max_inline_m().is_none_or(|max_m| case.seen.inline_m <= max_m)
    }

    pub(super) fn line(&self, value: impl Fn(&Margins) -> Option<f64>) -> Vec<(f64, f64)> {
        let distances = (0..=240).map(|step| SHOWN_M[0] + 0.05 * f64::from(step));
        distances.filter_map(|distance_m| Some((distance_m, value(&self.at(distance_m))?))).collect()
    }

    /// A margin's largest relative error, percent.
    pub(super) fn percent_line(&self, value: impl Fn(&Margins) -> Option<f64>) -> Vec<(f64, f64)> {
        let line = self.line(value);
        line.into_iter().map(|(l, margin_m)| (l, 100.0 * (margin_m / l - 1.0).abs())).collect()
    }
}

/// How many are outside the margins of l_A, and of l_B.
pub(super) fn violations(cases: &[Case], margins: &MarginsOf) -> (usize, usize) {
    let outside =
        |holds: fn(&MarginsOf, &Case) -> bool| cases.iter().filter(|case| !holds(margins, case)).count();
    (outside(MarginsOf::holds_perpendicular), outside(MarginsOf::holds_inline))
}

/// What stands behind cases outside the margins: how far the angle is off what any front pair shows.
pub(super) fn causes(cases: &[Case], margins: &MarginsOf, holds: fn(&MarginsOf, &Case) -> bool) -> String {
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
