//! Truth's LEDs and reported spots of one frame -> which spot is which LED.
//!
//! A spot and an LED go together within the gate: [`crate::Settings::spot_gate_px`], or the spot's own radius where that
//! is more. Pairs are one to one, by the least sum of distances. What is left is told apart: an LED near a spot of another
//! LED is *merged* into it, for no detector can part what the image does not; a spot near an LED that has its spot is a
//! *double*; only what is near nothing is *missed* or *false*.

use std::f64::consts::PI;

use photinus_io::dataset::{TruthFrame, TruthLed};
use photinus_io::results::{FrameRecord, SpotRecord};

use super::assignment::{Candidate, assign};

/// An LED of truth in one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Led<'a> {
    /// Index of its neighbour in the frame's truth.
    pub(crate) neighbour: usize,
    pub(crate) range_m: f64,
    pub(crate) led: &'a TruthLed,
}

/// What became of an LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LedFate {
    /// It is this spot.
    Found(usize),
    /// Its light is in this spot, which is another LED.
    Merged(usize),
    /// This entry of the rejected is near it.
    Rejected(usize),
    /// Nothing is near it.
    Missed,
}

/// What became of a spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpotFate {
    /// It is this LED.
    True(usize),
    /// This LED has another spot.
    Double(usize),
    /// Nothing is near it.
    False,
}

/// LEDs and spots of one frame.
#[derive(Debug)]
pub(crate) struct LedPairing<'a> {
    pub(crate) leds: Vec<Led<'a>>,
    pub(crate) led_fates: Vec<LedFate>,
    pub(crate) spot_fates: Vec<SpotFate>,
}

/// How far an LED may be from a spot that covers this many pixels, px.
fn gate_px(area_px: u32, spot_gate_px: f64) -> f64 {
    spot_gate_px.max((f64::from(area_px) / PI).sqrt())
}

fn distance_px(led: &TruthLed, u_px: f64, v_px: f64) -> f64 {
    libm::hypot(led.u_px - u_px, led.v_px - v_px)
}

impl<'a> LedPairing<'a> {
    /// Pairs a frame; without a record nothing was found.
    pub(crate) fn new(truth: &'a TruthFrame, record: Option<&FrameRecord>, spot_gate_px: f64) -> Self {
        let leds: Vec<Led<'a>> = truth
            .neighbours
            .iter()
            .enumerate()
            .flat_map(|(neighbour, there)| {
                there.leds.iter().map(move |led| Led { neighbour, range_m: there.distance_m, led })
            })
            .collect();
        let spots = record.map_or(&[][..], |record| &record.spots);
        // The distance as a share of the gate, for what is within it.
        let share = |led: &TruthLed, spot: &SpotRecord| {
            let share = distance_px(led, spot.u_px, spot.v_px) / gate_px(spot.area_px, spot_gate_px);
            (share < 1.0).then_some(share)
        };
        let mut candidates = Vec::new();
        for (row, led) in leds.iter().enumerate() {
            let near = spots.iter().enumerate();
            let near = near.filter_map(|(column, spot)| share(led.led, spot).map(|cost| (column, cost)));
            candidates.extend(near.map(|(column, cost)| Candidate { row, column, cost }));
        }
        let nearest = |of: &dyn Fn(&Candidate) -> bool| {
            let all = candidates.iter().filter(|candidate| of(candidate));
            all.min_by(|a, b| a.cost.total_cmp(&b.cost)).copied()
        };
        let mut led_fates = vec![LedFate::Missed; leds.len()];
        let mut spot_fates = vec![SpotFate::False; spots.len()];
        for (led, spot) in assign(&candidates) {
            (led_fates[led], spot_fates[spot]) = (LedFate::Found(spot), SpotFate::True(led));
        }
        for (led, fate) in led_fates.iter_mut().enumerate().filter(|(_, fate)| **fate == LedFate::Missed) {
            *fate = match nearest(&|candidate| candidate.row == led) {
                Some(candidate) => LedFate::Merged(candidate.column),
                None => rejected_near(leds[led].led, record, spot_gate_px)
                    .map_or(LedFate::Missed, LedFate::Rejected),
            };
        }
        for (spot, fate) in spot_fates.iter_mut().enumerate().filter(|(_, fate)| **fate == SpotFate::False) {
            if let Some(candidate) = nearest(&|candidate| candidate.column == spot) {
                *fate = SpotFate::Double(candidate.row);
            }
        }
        Self { leds, led_fates, spot_fates }
    }

    /// The truth neighbour that a spot is of.
    pub(crate) fn neighbour_of_spot(&self, spot: usize) -> Option<usize> {
        match self.spot_fates.get(spot)? {
            SpotFate::True(led) => Some(self.leds[*led].neighbour),
            SpotFate::Double(_) | SpotFate::False => None,
        }
    }
}

fn rejected_near(led: &TruthLed, record: Option<&FrameRecord>, spot_gate_px: f64) -> Option<usize> {
    let near = |rejected: &photinus_io::results::RejectedRecord| {
        distance_px(led, rejected.u_px, rejected.v_px) < gate_px(rejected.area_px, spot_gate_px)
    };
    record?.rejected.iter().position(near)
}
