//! A word that is in no book: any of the 2^L words of its length may be it, and its bits are learnt round by round.
//!
//! Before anything is seen each of its bits is on or off with equal probability, apart from the others; so they stay, but for exposures
//! that fall on two bits, where the tie between the two is left out. The probability of all 2^L words together is then a product.

use alloc::vec;
use alloc::vec::Vec;

use super::super::evidence::Evidence;
use super::phases::Signal;
use super::window::{PLACES, Window};

/// What is known of a word that is in no book.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stranger {
    /// Probability of each place of the exposure in a bit.
    places: [f32; PLACES],
    /// For each place the probability of each bit to be on.
    on: Vec<f32>,
    length: usize,
    is_new: bool,
}

impl Stranger {
    pub(super) fn new(length: usize) -> Self {
        Self { places: [1.0 / PLACES as f32; PLACES], on: vec![0.5; PLACES * length], length, is_new: true }
    }

    pub(super) fn restart(&mut self) {
        self.places = [1.0 / PLACES as f32; PLACES];
        self.on.fill(0.5);
        self.is_new = true;
    }

    /// So large a share of the probability is new here: nothing was learnt with it.
    pub(super) fn dilute(&mut self, share: f32) {
        let keep = 1.0 - share;
        self.places.iter_mut().for_each(|place| *place = *place * keep + share / PLACES as f32);
        self.on.iter_mut().for_each(|on| *on = 0.5 + (*on - 0.5) * keep);
    }

    /// The likelihood of a frame where nothing was learnt: all that was is forgotten.
    pub(super) fn skip(&mut self, evidence: &Evidence) -> f32 {
        if !self.is_new {
            self.restart();
        }
        0.5 * (evidence.off() + evidence.on())
    }

    /// The likelihood of a frame, which is learnt from; places stray in this many steps, with this probability each way in each.
    pub(super) fn hear(&mut self, windows: &[Window; PLACES], (steps, each_way): (usize, f32)) -> f32 {
        self.is_new = false;
        let stray = (steps as f32 * each_way).min(1.0 / 3.0);
        let was = self.places;
        let mut total = 0.0;
        for (place, window) in windows.iter().enumerate() {
            let neighbours = was[(place + 1) % PLACES] + was[(place + PLACES - 1) % PLACES];
            let prior = was[place] * (1.0 - 2.0 * stray) + neighbours * stray;
            let bits = &mut self.on[place * self.length..][..self.length];
            let (here, next) = (window.bit, (window.bit + 1) % self.length);
            let (p, q) = (bits[here], bits[next]);
            let [[dark, rising], [falling, lit]] = window.table;
            let (if_on, if_off) = ((1.0 - q) * falling + q * lit, (1.0 - q) * dark + q * rising);
            let likelihood = p * if_on + (1.0 - p) * if_off;
            let next_on = p * lit + (1.0 - p) * rising;
            if likelihood > 0.0 {
                bits[here] = p * if_on / likelihood;
                if next != here {
                    bits[next] = q * next_on / likelihood;
                }
            }
            self.places[place] = prior * likelihood;
            total += self.places[place];
        }
        if total > 0.0 {
            self.places.iter_mut().for_each(|place| *place /= total);
        } else {
            self.places = [1.0 / PLACES as f32; PLACES];
        }
        total
    }

    /// The probability that it is the word of this signal, shifted by this many bits.
    pub(super) fn is(&self, signal: &Signal, shift: usize) -> f32 {
        let of = |(place, bits): (&f32, &[f32])| {
            let agrees = |(bit, on): (usize, &f32)| if signal.is_on(bit + shift) { *on } else { 1.0 - on };
            place * bits.iter().enumerate().map(agrees).product::<f32>()
        };
        self.places.iter().zip(self.on.chunks_exact(self.length)).map(of).sum()
    }

    /// The mean of a table over what is known.
    pub(super) fn mean(&self, windows: &[Window; PLACES]) -> f32 {
        let of = |(place, window): (usize, &Window)| {
            let bits = &self.on[place * self.length..][..self.length];
            let (p, q) = (bits[window.bit], bits[(window.bit + 1) % self.length]);
            let [[dark, rising], [falling, lit]] = window.table;
            self.places[place]
                * (p * ((1.0 - q) * falling + q * lit) + (1.0 - p) * ((1.0 - q) * dark + q * rising))
        };
        windows.iter().enumerate().map(of).sum()
    }
}
