//! A gravity that is wrong, by more than vehicles tilt: claims are as wide as errors, since frames tell how far vehicles seem to tilt.

use photinus_sim::faults::Fault;

use crate::cameras;
use crate::row::Row;

const FRAMES: u64 = 200;

/// Nearer than in the tables, so that other frames come of it.
const RANGES_M: [f64; 2] = [2.5, 12.0];

fn claims_hold(arms: usize) {
    let mut row = Row::plain("gravity", &cameras::paper(), arms);
    row.ranges_m = RANGES_M;
    row.faults = vec![Fault::Gravity(0.35)];
    let scores = row.run(FRAMES).scores;
    let recall = scores.neighbours.by_range.overall.recall.unwrap();
    let nees = scores.position.overall.consistency.nees.unwrap() / 3.0;
    assert!(recall > 0.98, "{recall}");
    assert!((0.7..1.5).contains(&nees), "{nees}");
}

#[test]
fn hexarotors() {
    claims_hold(6);
}

#[test]
fn quadrotors() {
    claims_hold(4);
}
