//! Crowds are told: who is there, and no one else.

use crate::cameras;
use crate::row::Row;

const VEHICLES: usize = 20;
const FRAMES: u64 = 50;

/// Nearer than in the tables, so that other frames come of it.
const RANGES_M: [f64; 2] = [2.5, 12.0];

fn crowd_is_told(arms: usize, recall: f64) {
    let mut row = Row::plain("crowd", &cameras::paper(), arms);
    (row.vehicles, row.ranges_m) = (VEHICLES, RANGES_M);
    let scores = row.run(FRAMES).scores;
    let neighbours = &scores.neighbours.by_range.overall;
    let (apart, precision) = (neighbours.apart_recall.unwrap(), neighbours.precision.unwrap());
    let nees = scores.position.overall.consistency.nees.unwrap() / 3.0;
    assert!(apart > recall && precision > 0.99, "{apart} of those apart, precision {precision}");
    assert!((0.7..2.5).contains(&nees), "{nees}");
}

#[test]
fn hexarotors() {
    crowd_is_told(6, 0.97);
}

#[test]
fn quadrotors() {
    crowd_is_told(4, 0.99);
}

#[test]
fn octorotors() {
    crowd_is_told(8, 0.98);
}
