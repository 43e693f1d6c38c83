//! Turns about the body's z axis that leave an airframe as it was: yaw is told modulo these.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};

use crate::airframe::{Airframe, Marker};

/// The turns of an airframe, and which marker takes whose place in each.
#[derive(Clone, Debug)]
pub struct Symmetry {
    /// By turn: the rotation of the body after which its turned markers stand where the unturned ones stood.
    turns: Vec<Rotation3<f64>>,
    /// By turn, then by marker: the marker that stands where this one stood.
    turned: Vec<u16>,
    markers: usize,
    /// By marker: the signals that its LEDs carry, ascending.
    signals: Vec<Vec<u32>>,
    /// How many of the turns leave the signals as they were, too.
    turns_with_signals: usize,
}

impl Symmetry {
    /// The symmetry of an airframe.
    pub fn of(airframe: &Airframe) -> Self {
        let (turns, markers) = (airframe.turns(), airframe.markers());
        let nearest = |place_m: Vector3<f64>| {
            let gap = |marker: &usize| (markers[*marker].position_m - place_m).norm_squared();
            (0..markers.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
        };
        let turned = (0..turns).flat_map(|turn| {
            let rotation = rotation(turns, turn);
            markers.iter().map(move |marker| nearest(rotation * marker.position_m) as u16)
        });
        let signals_of = |marker: &Marker| {
            let carried = marker.leds.iter().filter_map(|&led| airframe.leds()[led].signal);
            let mut signals: Vec<u32> = carried.collect();
            signals.sort_unstable();
            signals
        };
        let mut symmetry = Self {
            turns: (0..turns).map(|turn| rotation(turns, turn).inverse()).collect(),
            turned: turned.collect(),
            markers: markers.len(),
            signals: markers.iter().map(signals_of).collect(),
            turns_with_signals: 1,
        };
        symmetry.turns_with_signals = (0..turns).filter(|&turn| symmetry.keeps_signals(turn)).count();
        symmetry
    }

    fn keeps_signals(&self, turn: usize) -> bool {
        let keeps = |marker: usize| {
            self.signals[marker] == self.signals[usize::from(self.turned(turn, marker as u16))]
        };
        (0..self.markers).all(keeps)
    }

    /// How many turns, at least 1.
    pub fn turns(&self) -> usize {
        self.turns.len()
    }

    /// How many turns leave the airframe as it was with its signals, at least 1.
    pub fn turns_with_signals(&self) -> usize {
        self.turns_with_signals
    }

    /// How many turns signals tell apart: the first this many, at least 1.
    pub(crate) fn told_apart(&self) -> usize {
        self.turns() / self.turns_with_signals
    }

    /// Whether an LED of a marker carries a signal.
    pub(crate) fn carries(&self, marker: u16, signal: u32) -> bool {
        self.signals[usize::from(marker)].contains(&signal)
    }

    /// The marker whose place `marker` takes in a turn.
    pub(crate) fn turned(&self, turn: usize, marker: u16) -> u16 {
        self.turned[turn * self.markers + usize::from(marker)]
    }

    /// The turn after which these markers, in this order, are the first of all their equals.
    pub(crate) fn canonical_turn(&self, markers: &[u16]) -> usize {
        let name = |turn: &usize| {
            let turn = *turn;
            markers.iter().map(move |&marker| self.turned(turn, marker))
        };
        (0..self.turns()).min_by(|a, b| name(a).cmp(name(b))).unwrap_or(0)
    }

    /// The rotation of the body after which its turned markers stand where the unturned ones stood.
    pub(crate) fn turn(&self, turn: usize) -> &Rotation3<f64> {
        &self.turns[turn]
    }
}

/// The rotation of the markers of a body that is turned by one of so many turns.
fn rotation(turns: usize, turn: usize) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * turn as f64 / turns as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::Ring;

    #[test]
    fn turned_markers_stand_where_the_others_stood() {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        let airframe = Airframe::from_ring("ring", ring).unwrap();
        let symmetry = Symmetry::of(&airframe);
        assert_eq!(symmetry.turns(), 6);
        let attitude = Rotation3::new(Vector3::new(0.3, -0.2, 0.9));
        for turn in 0..6 {
            for marker in 0..6u16 {
                let stood = attitude * airframe.markers()[usize::from(marker)].position_m;
                let other = usize::from(symmetry.turned(turn, marker));
                let stands = attitude * symmetry.turn(turn) * airframe.markers()[other].position_m;
                assert!((stood - stands).norm() < 1e-12);
            }
        }
        assert_eq!(symmetry.turned(symmetry.canonical_turn(&[4, 5, 1]), 4), 0);
    }
}
