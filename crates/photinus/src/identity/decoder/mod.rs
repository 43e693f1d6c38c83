//! Soft decoding: evidence of one marker, frame by frame -> who it is, with probability.
//!
//! ```text
//! window     which bits an exposure falls on          -> likelihood of each pair of bits
//! phases     a known word at every phase              -> how well it explains the frame
//! stranger   all words that are in no book, at once   -> the same
//! listener   what is known of one marker, moved on from frame to frame
//! answer     who that is, where in its word, whether it will shine
//! ```
//!
//! A marker is one of the words of the book at some phase, another blinking light, a steady light, or nothing any more. The posterior
//! over all of these is kept, and each frame is one step of it: phases stray (the clock of an LED is not the camera's), once in a long
//! while a track takes on another light, the frame's likelihood weighs what is left. What the steps cost has a bound, and words that are as
//! good as excluded are not looked at until something contradicts what is believed.

mod answer;
mod listener;
mod phases;
mod stranger;
mod window;

use alloc::vec::Vec;

use super::CodeBook;
use phases::Signal;

pub use answer::{Identity, Phase, Who};
pub use listener::{Listener, TimeStands};

/// What is believed of markers before anything is seen of them. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Bits per second of the words, nominally.
    pub bit_rate_hz: f64,
    /// How likely a marker is one of the book's words, each of them equally.
    pub known: f64,
    /// How likely it is a steady light.
    pub steady: f64,
    /// How likely it blinks something else: a word of the same length, or without a pattern.
    pub unknown: f64,
    /// Probability per bit that a track takes on another light, or the light another signal.
    pub change: f64,
    /// Quarters of a bit by which a phase strays in a bit, each way: LEDs that are fast or slow by a few thousandths are followed at no
    /// cost, by percents at a high one.
    pub stray: f64,
}

impl Default for Settings {
    /// For LEDs at 60 bits per second.
    fn default() -> Self {
        Self { bit_rate_hz: 60.0, known: 0.5, steady: 0.15, unknown: 0.3, change: 1e-5, stray: 0.01 }
    }
}

/// Why no decoder can be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecoderError {
    /// The bit rate is not positive and finite.
    #[error("the bit rate is not positive")]
    BitRate,
    /// A probability is not between 0 and 1, or the three of what a marker may be are together more than 1.
    #[error("`{0}` is no probability that goes with the others")]
    Probability(&'static str),
}

/// What all markers of a camera share: the book, and what is believed beforehand. What is known of one of them is a [`Listener`].
#[derive(Clone, Debug, PartialEq)]
pub struct Decoder {
    signals: Vec<Signal>,
    length: usize,
    settings: Settings,
}

impl Decoder {
    /// For words of `book`.
    ///
    /// # Errors
    /// [`DecoderError`] for settings that have no meaning.
    pub fn new(book: &CodeBook, settings: Settings) -> Result<Self, DecoderError> {
        if !(settings.bit_rate_hz.is_finite() && settings.bit_rate_hz > 0.0) {
            return Err(DecoderError::BitRate);
        }
        let Settings { known, steady, unknown, change, stray, .. } = settings;
        for (name, number, most) in [
            ("known", known, 1.0),
            ("steady", steady, 1.0 - known),
            ("unknown", unknown, 1.0 - known - steady),
            ("change", change, 0.1),
            ("stray", stray, 0.25),
        ] {
            if !(number.is_finite() && 0.0 < number && number <= most + 1e-12) {
                return Err(DecoderError::Probability(name));
            }
        }
        Ok(Self { signals: book.words().iter().map(Signal::of).collect(), length: book.length(), settings })
    }

    /// How many words the book has.
    pub fn words(&self) -> usize {
        self.signals.len()
    }

    /// How likely each word of the book is before anything is heard, if anything shines.
    pub(crate) fn word_beforehand(&self) -> f64 {
        let Settings { known, steady, unknown, .. } = self.settings;
        known / (known + steady + unknown) / self.signals.len() as f64
    }

    /// Seconds of a round of a word.
    pub fn round_s(&self) -> f64 {
        self.length as f64 / self.settings.bit_rate_hz
    }
}

#[cfg(test)]
mod tests;
