//! What is known of a marker -> answers: who it is, where in its word, whether it will shine.

use super::super::evidence::Evidence;
use super::Decoder;
use super::listener::{Listener, Others, TimeStands};
use super::phases;
use super::window::{PLACES, Window};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// What is less probable than this does not tell whether a marker shines.
const NEGLIGIBLE: f64 = 1e-4;

/// Who a marker is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// The word of the book with this index.
    Word(usize),
    /// It blinks what is in no book.
    Unknown,
    /// It shines all the time.
    Steady,
    /// Nothing shines there.
    Dark,
}

/// The most probable answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identity {
    /// Who it is.
    pub who: Who,
    /// With what probability.
    pub probability: f64,
}

/// Where in its word a marker was when the last exposure began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Bits since the beginning of the word, from 0 to its length.
    pub bits: f64,
    /// Standard deviation, bits, of the phases within half a round of the most probable one.
    pub sigma_bits: f64,
}

impl Decoder {
    /// The mean share of an exposure that the marker will shine, or did, beginning at `time_s` after the last frame: for a word whose
    /// phase is known nearly 0 or 1, for the others what is likely.
    ///
    /// # Errors
    /// As [`Decoder::hear`].
    pub fn light_at(&self, listener: &Listener, time_s: f64, exposure_s: f64) -> Result<f64, TimeStands> {
        let (_, base) = self.passed(listener, time_s)?;
        let windows =
            Window::all(base, exposure_s * self.settings.bit_rate_hz, self.length, &Evidence::SHARE);
        let block = self.block();
        let lit = listener.awake.iter().map(|&word| {
            let phases = &listener.phases[word * block..][..block];
            phases::mean(phases, &self.signals[word], self.length, &windows)
        });
        let Others { random, patterned, steady, .. } = listener.others;
        // what is as good as excluded is not worth a look at all its bits
        let is_likely = patterned > NEGLIGIBLE * listener.total;
        let by_pattern = if is_likely { f64::from(listener.stranger.mean(&windows)) } else { 0.5 };
        let others = 0.5 * random + patterned * by_pattern + steady;
        Ok((f64::from(lit.sum::<f32>()) + others) / listener.total)
    }

    /// The most probable answer.
    pub fn identity(&self, listener: &Listener) -> Identity {
        let others = listener.others;
        let mut best = (Who::Unknown, others.random + others.patterned);
        for (who, weight) in [(Who::Steady, others.steady), (Who::Dark, others.dark)] {
            if weight > best.1 {
                best = (who, weight);
            }
        }
        if let Some(word) = self.heaviest(listener).filter(|&word| listener.words[word] > best.1) {
            best = (Who::Word(word), listener.words[word]);
        }
        let (who, weight) = best;
        Identity { who, probability: weight / listener.total }
    }

    /// The most probable word of the book, unless all are as good as excluded.
    pub(super) fn heaviest(&self, listener: &Listener) -> Option<usize> {
        let weight = |word: usize| listener.words[word];
        let heavier = |best: usize, word: usize| if weight(word) > weight(best) { word } else { best };
        listener.awake.iter().copied().reduce(heavier)
    }

    /// The probability of an answer.
    pub fn probability(&self, listener: &Listener, who: Who) -> f64 {
        let Others { random, patterned, steady, dark } = listener.others;
        let weight = match who {
            Who::Word(word) => listener.words.get(word).copied().unwrap_or(0.0),
            Who::Unknown => random + patterned,
            Who::Steady => steady,
            Who::Dark => dark,
        };
        weight / listener.total
    }

    /// Where in a word of the book the marker is, if that is the word; `None` where it is as good as excluded.
    pub fn phase(&self, listener: &Listener, word: usize) -> Option<Phase> {
        if !listener.awake.contains(&word) {
            return None;
        }
        let count = PLACES * self.length;
        let at = |cell: usize| f64::from(self.at(listener, word, cell));
        let most = self.likeliest(listener, word);
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        for step in 0..count {
            let off = step as f64 - (count / 2) as f64;
            let weight = at((most + count + step - count / 2) % count);
            sum += weight;
            first += weight * off;
            second += weight * off * off;
        }
        let mean = first / sum;
        // what lies within a place is spread evenly
        let variance = (second / sum - mean * mean).max(0.0) + 1.0 / 12.0;
        let places = most as f64 + mean + 0.5;
        let bits = listener.base + places / PLACES as f64;
        let length = self.length as f64;
        Some(Phase {
            bits: bits - length * (bits / length).floor(),
            sigma_bits: libm::sqrt(variance) / PLACES as f64,
        })
    }

    /// The most probable phase of a word, in places from the nominal clock on.
    pub(super) fn likeliest(&self, listener: &Listener, word: usize) -> usize {
        let at = |cell: usize| self.at(listener, word, cell);
        (0..PLACES * self.length).fold(0, |best, cell| if at(cell) > at(best) { cell } else { best })
    }

    fn at(&self, listener: &Listener, word: usize, cell: usize) -> f32 {
        listener.phases[word * self.block() + cell % PLACES * phases::row(self.length) + cell / PLACES]
    }
}
