//! Figure 12: how far off the bearing of a marker is, with the bound (3), eps = k (S_max(l) - 1/2).

use photinus::ranging::{SpotCurve, bearing_bound_rad};

use crate::poses::{AT_OUTDOOR, AT_PAPER};
use crate::statistics::{rms, share};
use crate::view::{Seen, SeenMarker};
use crate::{Figure, Kind, Panel, Report, Rig, Role, Row, Tolerance};

/// The paper: under this past [`PAST_M`].
const UNDER_RAD: f64 = 0.02;
const PAST_M: f64 = 3.0;

pub(crate) fn report(rig: &Rig, seen: &[Seen]) -> Report {
    let paper = |view: usize| -> Vec<SeenMarker> {
        seen.iter().flat_map(|seen| seen.paper[view].markers.iter().copied()).collect()
    };
    let (at_paper, at_outdoor) = (paper(AT_PAPER), paper(AT_OUTDOOR));
    let own: Vec<SeenMarker> = seen.iter().flat_map(|seen| seen.own.markers.iter().copied()).collect();
    let curve = SpotCurve::paper_1000_us();
    let eps_rad = |distance_m: f64| bearing_bound_rad(rig.rad_per_px(), curve.max_area_px(distance_m));
    Report {
        figure: Figure::Bearings,
        panels: panels(&at_paper, &at_outdoor, &own, &eps_rad),
        rows: rows(&at_paper, &at_outdoor, &own, &eps_rad),
    }
}

fn mrad(markers: &[SeenMarker]) -> Vec<(f64, f64)> {
    markers.iter().map(|marker| (marker.distance_m, 1e3 * marker.error_rad)).collect()
}

fn panels(
    at_paper: &[SeenMarker],
    at_outdoor: &[SeenMarker],
    own: &[SeenMarker],
    eps_rad: &dyn Fn(f64) -> f64,
) -> Vec<Panel> {
    let bound: Vec<_> =
        (0..=1400).map(|step| 1.0 + 0.01 * f64::from(step)).map(|l| (l, 1e3 * eps_rad(l))).collect();
    let labels = ("distance of the marker (m)", "bearing error (mrad)");
    let all = Panel::new("Bearing error, middle pixel and centroid", labels.0, labels.1)
        .with_ranges([0.0, 15.0], [0.0, 80.0])
        .with("middle pixel, threshold 50", Kind::Points, Role::Inline, mrad(at_outdoor))
        .with("middle pixel, threshold 200", Kind::Points, Role::Perpendicular, mrad(at_paper))
        .with("Photinus, centroid", Kind::Points, Role::Own, mrad(own))
        .with("bound (3)", Kind::Line, Role::Bound, bound.clone());
    let near = Panel { title: "The same, enlarged", y_range: Some([0.0, 8.0]), ..all.clone() };
    vec![all, near]
}

fn rows(
    at_paper: &[SeenMarker],
    at_outdoor: &[SeenMarker],
    own: &[SeenMarker],
    eps_rad: &dyn Fn(f64) -> f64,
) -> Vec<Row> {
    let under_bound = |markers: &[SeenMarker]| {
        share(markers.iter().map(|marker| marker.error_rad <= eps_rad(marker.distance_m)))
    };
    let past = |markers: &[SeenMarker]| -> f64 {
        let far = markers.iter().filter(|marker| marker.distance_m > PAST_M);
        far.map(|marker| marker.error_rad).fold(0.0, f64::max)
    };
    let all = "the paper has all of its errors below its line";
    let error = |markers: &[SeenMarker]| rms(markers.iter().map(|marker| marker.error_rad));
    // the same markers and distances: those near enough for the threshold of 200
    let near_own: Vec<SeenMarker> = own.iter().filter(|marker| marker.distance_m < 6.0).copied().collect();
    let near_paper: Vec<SeenMarker> =
        at_paper.iter().filter(|marker| marker.distance_m < 6.0).copied().collect();
    vec![
        Row::of_paper(
            "bearing errors under (3), threshold 200, share",
            1.0,
            under_bound(at_paper),
            Tolerance::AtLeast(1.0),
            all,
        ),
        Row::of_paper(
            "bearing errors under (3), threshold 50, share",
            1.0,
            under_bound(at_outdoor),
            Tolerance::AtLeast(1.0),
            all,
        ),
        Row::of_paper(
            "largest bearing error past 3 m, threshold 200 (rad)",
            UNDER_RAD,
            past(at_paper),
            Tolerance::AtMost(UNDER_RAD),
            "under 0.02 rad past 3 m",
        ),
        Row::of_paper(
            "largest bearing error past 3 m, threshold 50 (rad)",
            UNDER_RAD,
            past(at_outdoor),
            Tolerance::AtMost(UNDER_RAD),
            "under 0.02 rad past 3 m",
        ),
        Row::own(
            "bearing error rms, middle pixel, threshold 200 (mrad)",
            1e3 * error(at_paper),
            Tolerance::None,
            "a pixel is 3.77 mrad; even over a pixel, the corners included, 1.54 mrad rms",
        ),
        Row::own("bearing error rms, Photinus (mrad)", 1e3 * error(own), Tolerance::None, "out to 14.5 m"),
        Row::own(
            "bearing error rms, Photinus over middle pixel, markers nearer than 6 m",
            error(&near_own) / error(&near_paper),
            Tolerance::AtMost(0.5),
            "Photinus' gain: centroids of the light, not the middle of a list of pixels",
        ),
        Row::own(
            "largest bearing error, Photinus (mrad)",
            1e3 * own.iter().map(|marker| marker.error_rad).fold(0.0, f64::max),
            Tolerance::None,
            "out to 14.5 m",
        ),
    ]
}
