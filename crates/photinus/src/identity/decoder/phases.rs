//! The phases of one known word: how probable each is, moved on and weighed by the evidence of a frame.
//!
//! A phase is a shift by whole bits and a place in the bit: a row of numbers for each place, a number for each shift. The grid moves
//! along with the nominal clock, so that an LED on time stays where it is; one that is fast or slow steps to a neighbour now and then.

use alloc::vec::Vec;

use super::super::Word;
use super::window::{PLACES, Window};
use crate::lanes::{LANES, Lanes, sum};

/// The most numbers in a row.
const WIDEST: usize = Word::MOST_BITS + LANES;

/// Bits of a word as numbers, repeated so that any shift can be read from it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Signal(Vec<f32>);

impl Signal {
    pub(super) fn of(word: &Word) -> Self {
        let on = |k| if word.bit(k) { 1.0 } else { 0.0 };
        Self((0..2 * word.length() + 2 * LANES).map(on).collect())
    }

    /// Whether the word is on in a bit, counted to less than two rounds.
    pub(super) fn is_on(&self, bit: usize) -> bool {
        self.0[bit] > 0.5
    }
}

/// What a frame does to the phases of a word.
pub(super) struct Step<'a> {
    /// Factor for what was there before.
    pub(super) keep: f32,
    /// Added to every phase.
    pub(super) share: f32,
    pub(super) windows: &'a [Window; PLACES],
}

/// Numbers in a row: a shift each, and zeros up to whole lanes.
pub(super) fn row(length: usize) -> usize {
    length.next_multiple_of(LANES)
}

/// Takes the step in `phases`, whose words have `length` bits; returns their sum.
pub(super) fn weigh(phases: &mut [f32], signal: &Signal, length: usize, step: &Step<'_>) -> f32 {
    let width = row(length);
    let (keep, share) = (Lanes::splat(step.keep), Lanes::splat(step.share));
    let last =
        Lanes::new(core::array::from_fn(|lane| if width - LANES + lane < length { step.share } else { 0.0 }));
    let mut total = Lanes::ZERO;
    for (window, row) in step.windows.iter().zip(phases.chunks_exact_mut(width)) {
        let bits = &signal.0[window.bit..];
        let (first, _) = bits[..width].as_chunks::<LANES>();
        let (next, _) = bits[1..=width].as_chunks::<LANES>();
        let likelihood = likelihood(window);
        let (cells, _) = row.as_chunks_mut::<LANES>();
        let count = cells.len();
        for (at, ((cell, first), next)) in cells.iter_mut().zip(first).zip(next).enumerate() {
            let share = if at + 1 == count { last } else { share };
            let now = (Lanes::new(*cell) * keep + share) * likelihood(Lanes::new(*first), next);
            *cell = now.to_array();
            total += now;
        }
    }
    sum(total)
}

/// The likelihood of four phases, by the bits on which the exposure may fall.
fn likelihood(window: &Window) -> impl Fn(Lanes, &[f32; LANES]) -> Lanes + use<> {
    let [[dark, rising], [falling, lit]] = window.table;
    let [none, one, other, both] =
        [dark, falling - dark, rising - dark, lit - falling - rising + dark].map(Lanes::splat);
    // an exposure on one bit does not ask for the next
    let is_on_one = rising.to_bits() == dark.to_bits() && falling.to_bits() == lit.to_bits();
    move |first, next| match is_on_one {
        true => none + first * one,
        false => {
            let next = Lanes::new(*next);
            none + first * (one + next * both) + next * other
        }
    }
}

/// Lets phases step to their neighbours, with this probability each way.
pub(super) fn wander(phases: &mut [f32], length: usize, each_way: f32) {
    let width = row(length);
    // the last place of a bit lies before the first of the next, the first after the last of that before
    let (mut before, mut after) = ([0.0_f32; WIDEST], [0.0_f32; WIDEST]);
    let last = &phases[(PLACES - 1) * width..][..length];
    before[0] = last[length - 1];
    before[1..length].copy_from_slice(&last[..length - 1]);
    after[length - 1] = phases[0];
    after[..length - 1].copy_from_slice(&phases[1..length]);
    let (stay, stray) = (Lanes::splat(1.0 - 2.0 * each_way), Lanes::splat(each_way));
    for place in 0..PLACES {
        let (here, following) = phases[place * width..].split_at_mut(width);
        let above = if place + 1 < PLACES { &following[..width] } else { &after[..width] };
        let (cells, _) = here.as_chunks_mut::<LANES>();
        let (above, _) = above.as_chunks::<LANES>();
        let (below, _) = before[..width].as_chunks_mut::<LANES>();
        for ((cell, above), below) in cells.iter_mut().zip(above).zip(below) {
            let was = Lanes::new(*cell);
            *cell = (was * stay + (Lanes::new(*below) + Lanes::new(*above)) * stray).to_array();
            *below = was.to_array();
        }
    }
}

/// The mean of a table over the phases, times their sum.
pub(super) fn mean(phases: &[f32], signal: &Signal, length: usize, windows: &[Window; PLACES]) -> f32 {
    let width = row(length);
    let mut total = Lanes::ZERO;
    for (window, phases) in windows.iter().zip(phases.chunks_exact(width)) {
        let bits = &signal.0[window.bit..];
        let (first, _) = bits[..width].as_chunks::<LANES>();
        let (next, _) = bits[1..=width].as_chunks::<LANES>();
        let likelihood = likelihood(window);
        let (cells, _) = phases.as_chunks::<LANES>();
        for ((cell, first), next) in cells.iter().zip(first).zip(next) {
            total += Lanes::new(*cell) * likelihood(Lanes::new(*first), next);
        }
    }
    sum(total)
}
