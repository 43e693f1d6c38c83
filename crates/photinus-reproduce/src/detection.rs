//! The range outdoors: a hexarotor ever farther away against sky and ground, and how often its markers are found.

use core::f64::consts::TAU;

use nalgebra::Vector3;
use photinus_sim::Simulator;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use crate::statistics::share;
use crate::view::{OUTDOOR_DN, Observer, PAPER_DN, Seen};
use crate::{Effort, Figure, Kind, Panel, Report, ReproduceError, Rig, Role, Row, Tolerance};

/// Where the target stands, m.
const DISTANCES_M: [f64; 14] =
    [4.0, 6.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 17.0, 20.0, 25.0, 30.0];
/// The paper: found out to here.
const PAPER_M: f64 = 15.0;
/// Printed circles, the paper's comparison: largest range at 42 deg field of view, and at the resolution that compares.
const CIRCLES_M: (f64, f64) = (5.5, 3.2);
/// A range ends where fewer frames than this have a marker.
const FOUND: f64 = 0.95;
/// The lowest threshold that the sky allows: half as much again as its 20 levels at noon.
const ABOVE_SKY_DN: u8 = 30;
const THRESHOLDS_DN: [u8; 4] = [PAPER_DN, 120, OUTDOOR_DN, ABOVE_SKY_DN];

fn frames_each(effort: Effort) -> u64 {
    effort.of(200, 6)
}

/// How many frames are rendered.
pub(crate) fn frames(effort: Effort) -> u64 {
    DISTANCES_M.len() as u64 * frames_each(effort)
}

/// What one pipeline finds over distance: the share of frames with at least one marker, and with at least two.
struct Found {
    label: String,
    role: Role,
    one: Vec<(f64, f64)>,
    two: Vec<(f64, f64)>,
}

impl Found {
    fn of(label: String, role: Role, by_distance: &[Vec<Seen>], markers: impl Fn(&Seen) -> usize) -> Self {
        let over = |least: usize| -> Vec<(f64, f64)> {
            let shares = by_distance.iter().map(|seen| share(seen.iter().map(|seen| markers(seen) >= least)));
            DISTANCES_M.into_iter().zip(shares).collect()
        };
        Self { label, role, one: over(1), two: over(2) }
    }

    /// The last distance before the share of frames falls short, m; 0 where it always does.
    fn range_m(shares: &[(f64, f64)]) -> f64 {
        shares.iter().take_while(|point| point.1 >= FOUND).map(|point| point.0).fold(0.0, f64::max)
    }
}

pub(crate) fn report(rig: &Rig, effort: Effort, frame_done: &dyn Fn()) -> Result<Report, ReproduceError> {
    let by_distance = record(rig, frames_each(effort), frame_done)?;
    let roles = [Role::Perpendicular, Role::Printed, Role::Inline, Role::Member(6)];
    let fixed = THRESHOLDS_DN.into_iter().zip(roles).enumerate().map(|(view, (threshold_dn, role))| {
        Found::of(format!("threshold {threshold_dn}"), role, &by_distance, move |seen| {
            seen.paper[view].markers.len()
        })
    });
    let mut found: Vec<Found> = fixed.collect();
    found.push(Found::of("Photinus, contrast".to_owned(), Role::Own, &by_distance, |seen| {
        seen.own.markers.len()
    }));
    let panel = |title, of: fn(&Found) -> &Vec<(f64, f64)>| {
        let empty =
            Panel::new(title, "distance (m)", "share of frames (%)").with_ranges([0.0, 30.0], [0.0, 115.0]);
        let percent = |found: &Found| of(found).iter().map(|(l, share)| (*l, 100.0 * share)).collect();
        let panel = found.iter().fold(empty, |panel, found| {
            panel.with(found.label.clone(), Kind::Line, found.role, percent(found))
        });
        panel.with_upright("circles, 5.5 m", CIRCLES_M.0, None).with_upright("15 m", PAPER_M, None)
    };
    let panels = vec![
        panel("At least one marker: direction", |found| &found.one),
        panel("At least two: distance", |found| &found.two),
    ];
    Ok(Report { figure: Figure::Range, panels, rows: rows(&found) })
}

/// Level at any heading, in daylight, somewhat to the side and above or below.
fn record(rig: &Rig, count: u64, frame_done: &dyn Fn()) -> Result<Vec<Vec<Seen>>, ReproduceError> {
    let mut random = Pcg64::new(15, 5);
    let mut between = |low: f64, high: f64| -> f64 {
        let share: f64 = StandardUniform.sample(&mut random);
        low + (high - low) * share
    };
    let mut observer = Observer::new(rig, &THRESHOLDS_DN)?;
    let mut at_distance = |distance_m: f64| -> Result<Vec<Seen>, ReproduceError> {
        let places: Vec<_> = (0..count)
            .map(|_| {
                let (sin, cos) = libm::sincos(between(-0.6, 0.6));
                let (sin_up, cos_up) = libm::sincos(between(-0.05, 0.1));
                (Vector3::new(sin * cos_up, -sin_up, cos * cos_up) * distance_m, between(0.0, TAU))
            })
            .collect();
        let scene = rig.posed(&places, false, distance_m as u64);
        let mut simulator = Simulator::new(&scene, 0).ok_or(ReproduceError::Lacks("camera"))?;
        let seen = (0..count).filter_map(|number| {
            let seen = observer.look(&simulator.frame(number));
            frame_done();
            seen
        });
        Ok(seen.collect())
    };
    DISTANCES_M.into_iter().map(&mut at_distance).collect()
}

fn rows(found: &[Found]) -> Vec<Row> {
    let [at_200, _, outdoor, above_sky, own] = found else { return Vec::new() };
    let at = |shares: &[(f64, f64)]| {
        shares.iter().find(|point| point.0 >= PAPER_M).map_or(f64::NAN, |point| point.1)
    };
    let beyond = outdoor.one.last().map_or(f64::NAN, |point| point.1);
    let (outdoor_m, own_m) = (Found::range_m(&outdoor.one), Found::range_m(&own.one));
    vec![
        Row::of_paper(
            "frames with a marker at 15 m, threshold 50, share",
            1.0,
            at(&outdoor.one),
            Tolerance::AtLeast(FOUND),
            "\"could still be detected at 15 m\"; a marker on the border of pixels divides its light, see docs/sensor-preset.md",
        ),
        Row::own(
            "frames with a marker at 15 m, threshold 200, share",
            at(&at_200.one),
            Tolerance::None,
            "impossible beside 6.62 m: a border halves a point, so past 9.4 m even the middle of a pixel is below 200",
        ),
        Row::of_paper(
            "frames with a marker at 15 m, threshold 30, share",
            1.0,
            at(&above_sky.one),
            Tolerance::AtLeast(FOUND),
            "the lowest threshold that a sky of 20 levels allows",
        ),
        Row::own(
            "frames with a marker at 15 m, Photinus, share",
            at(&own.one),
            Tolerance::AtLeast(FOUND),
            "contrast of 20 levels",
        ),
        Row::own(
            "frames with two markers at 15 m, Photinus, share",
            at(&own.two),
            Tolerance::None,
            "what a distance needs",
        ),
        Row::own(
            "frames with a marker at 30 m, threshold 50, share",
            beyond,
            Tolerance::AtMost(0.5),
            "\"after that there were drop-offs\"",
        ),
        Row::of_paper(
            "range at 95 % of frames, threshold 50 (m)",
            PAPER_M,
            outdoor_m,
            Tolerance::Ratio(0.15),
            "steps of a metre",
        ),
        Row::of_paper(
            "range over printed circles' 5.5 m, threshold 50",
            PAPER_M / CIRCLES_M.0,
            outdoor_m / CIRCLES_M.0,
            Tolerance::Ratio(0.15),
            "42 deg field of view there, 180 deg here",
        ),
        Row::of_paper(
            "range over printed circles' 3.2 m, threshold 50",
            PAPER_M / CIRCLES_M.1,
            outdoor_m / CIRCLES_M.1,
            Tolerance::Ratio(0.15),
            "at the resolution that compares",
        ),
        Row::own(
            "range at 95 % of frames, Photinus (m)",
            own_m,
            Tolerance::AtLeast(PAPER_M),
            "contrast, default settings",
        ),
        Row::own(
            "range, Photinus over threshold 50",
            own_m / outdoor_m,
            Tolerance::AtLeast(1.0),
            "Photinus' gain",
        ),
        Row::own("range over printed circles' 5.5 m, Photinus", own_m / CIRCLES_M.0, Tolerance::None, ""),
    ]
}
