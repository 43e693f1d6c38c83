//! LEDs that a camera cannot tell apart: one marker, one spot.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::Vector3;

use super::Led;

/// LEDs closer than this belong to one marker, m.
pub const MARKER_GAP_M: f64 = 0.03;

/// LEDs so close together that they make one spot.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Mean position of its LEDs, body frame, m.
    pub position_m: Vector3<f64>,
    /// Indices of its LEDs in the airframe, ascending.
    pub leds: Vec<usize>,
    /// Largest distance of one of its LEDs from the mean position, m: the spot's centre is that near to it.
    pub spread_m: f64,
}

/// Groups LEDs closer than [`MARKER_GAP_M`], transitively, in the order of the first LED of each group.
pub(super) fn group(leds: &[Led]) -> Vec<Marker> {
    let mut grouped = vec![false; leds.len()];
    let mut markers = Vec::new();
    for first in 0..leds.len() {
        if grouped[first] {
            continue;
        }
        grouped[first] = true;
        let mut members = vec![first];
        let mut next = 0;
        while let Some(&member) = members.get(next) {
            for other in first + 1..leds.len() {
                let gap_m = (leds[other].position_m - leds[member].position_m).norm();
                if !grouped[other] && gap_m < MARKER_GAP_M {
                    grouped[other] = true;
                    members.push(other);
                }
            }
            next += 1;
        }
        members.sort_unstable();
        markers.push(from_members(leds, members));
    }
    markers
}

fn from_members(leds: &[Led], members: Vec<usize>) -> Marker {
    // Relative to the first LED, so that LEDs in one place have exactly that place as their mean.
    let first_m = leds[members[0]].position_m;
    let sum_m: Vector3<f64> = members.iter().map(|&led| leds[led].position_m - first_m).sum();
    let position_m = first_m + sum_m / members.len() as f64;
    let spread_m = members.iter().map(|&led| (leds[led].position_m - position_m).norm()).fold(0.0, f64::max);
    Marker { position_m, leds: members, spread_m }
}
