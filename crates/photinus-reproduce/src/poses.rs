//! A hexarotor at random poses indoors: what figures 12 to 14 are drawn from.

use core::f64::consts::TAU;

use nalgebra::Vector3;
use photinus_sim::Simulator;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use crate::view::{OUTDOOR_DN, Observer, PAPER_DN, Seen};
use crate::{Effort, Report, ReproduceError, Rig, bearings, distances};

/// Nearest and farthest pose, m; the figures are drawn from 2 m.
const RANGE_M: (f64, f64) = (1.5, 14.5);
/// How far to the side and how far up or down of the optical axis, rad.
const ASIDE_RAD: (f64, f64) = (0.9, 0.25);
/// Which of the views is at the paper's threshold, and which at the outdoor one.
pub(crate) const AT_PAPER: usize = 0;
/// See [`AT_PAPER`].
pub(crate) const AT_OUTDOOR: usize = 1;

/// How many frames are rendered.
pub(crate) fn frames(effort: Effort) -> u64 {
    effort.of(4000, 150)
}

/// The three figures.
pub(crate) fn reports(
    rig: &Rig,
    effort: Effort,
    frame_done: &dyn Fn(),
) -> Result<Vec<Report>, ReproduceError> {
    let seen = record(rig, frames(effort), frame_done)?;
    let [distances, relative_errors] = distances::reports(rig, &seen);
    Ok(vec![bearings::report(rig, &seen), distances, relative_errors])
}

/// Level, at any heading.
fn record(rig: &Rig, count: u64, frame_done: &dyn Fn()) -> Result<Vec<Seen>, ReproduceError> {
    let mut random = Pcg64::new(12, 13);
    let mut between = |low: f64, high: f64| -> f64 {
        let share: f64 = StandardUniform.sample(&mut random);
        low + (high - low) * share
    };
    let places: Vec<_> = (0..count)
        .map(|_| {
            let distance_m = between(RANGE_M.0, RANGE_M.1);
            let (sin, cos) = libm::sincos(between(-ASIDE_RAD.0, ASIDE_RAD.0));
            let (sin_up, cos_up) = libm::sincos(between(-ASIDE_RAD.1, ASIDE_RAD.1));
            (Vector3::new(sin * cos_up, -sin_up, cos * cos_up) * distance_m, between(0.0, TAU))
        })
        .collect();
    let scene = rig.posed(&places, true, 12);
    let mut simulator = Simulator::new(&scene, 0).ok_or(ReproduceError::Lacks("camera"))?;
    let mut observer = Observer::new(rig, &[PAPER_DN, OUTDOOR_DN])?;
    let seen = (0..count).filter_map(|number| {
        let seen = observer.look(&simulator.frame(number));
        frame_done();
        seen
    });
    Ok(seen.collect())
}
