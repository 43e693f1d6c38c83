//! Who there may be, and what each blinks.

use alloc::vec::Vec;

use crate::identity::CodeBook;

/// Clocks of LEDs differ by no more than this share: one rate stands for all of them, and what is left is followed as a drift.
const ALIKE: f64 = 0.01;

/// A vehicle that blinks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vehicle {
    /// Who it is.
    pub id: u32,
    /// By signal of its airframe: the word of the book, from 0, that its LEDs blink. LEDs without a signal blink the first.
    pub words: Vec<usize>,
}

/// The vehicles that there may be, and the book that their words are of.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    book: CodeBook,
    bit_rate_hz: f64,
    vehicles: Vec<Vehicle>,
}

/// Why vehicles make no fleet.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FleetError {
    /// There is none.
    #[error("no vehicle blinks")]
    Nobody,
    /// An id stands twice.
    #[error("vehicle {0} stands twice")]
    Twice(u32),
    /// A vehicle has no word.
    #[error("vehicle {0} has no word")]
    Silent(u32),
    /// A word is in no book.
    #[error("vehicle {id} blinks word {word} of {words} words, counted from 0")]
    Word {
        /// The vehicle.
        id: u32,
        /// The word that it blinks.
        word: usize,
        /// How many there are.
        words: usize,
    },
    /// Nothing blinks at such a rate.
    #[error("{0} bits per second are no rate")]
    BitRate(f64),
    /// Vehicles blink at different rates.
    #[error("bit rates from {0} to {1} Hz: they must be within a hundredth of each other")]
    BitRates(f64, f64),
}

impl Fleet {
    /// Whether the LEDs of a vehicle blink different words: a frame then shows parts of it.
    #[must_use]
    pub fn has_several_signals(&self) -> bool {
        let differ = |vehicle: &Vehicle| vehicle.words.iter().any(|word| *word != vehicle.words[0]);
        self.vehicles.iter().any(differ)
    }

    /// A fleet whose vehicles each blink this many bits per second.
    ///
    /// # Errors
    /// [`FleetError`] for no vehicle, an id that stands twice, a vehicle without words, words that the book does not hold, and rates that nothing blinks at, or that differ by
    /// more than a hundredth.
    pub fn new(
        book: CodeBook,
        vehicles: impl IntoIterator<Item = (Vehicle, f64)>,
    ) -> Result<Self, FleetError> {
        let (vehicles, rates): (Vec<Vehicle>, Vec<f64>) = vehicles.into_iter().unzip();
        for (index, Vehicle { id, words }) in vehicles.iter().enumerate() {
            if vehicles[..index].iter().any(|other| other.id == *id) {
                return Err(FleetError::Twice(*id));
            }
            if words.is_empty() {
                return Err(FleetError::Silent(*id));
            }
            if let Some(&word) = words.iter().find(|&&word| word >= book.words().len()) {
                return Err(FleetError::Word { id: *id, word, words: book.words().len() });
            }
        }
        if let Some(&rate) = rates.iter().find(|rate| !(rate.is_finite() && **rate > 0.0)) {
            return Err(FleetError::BitRate(rate));
        }
        let least = rates.iter().copied().reduce(f64::min).ok_or(FleetError::Nobody)?;
        let most = rates.iter().copied().fold(least, f64::max);
        if most > (1.0 + ALIKE) * least {
            return Err(FleetError::BitRates(least, most));
        }
        Ok(Self { book, bit_rate_hz: 0.5 * (least + most), vehicles })
    }

    /// The book.
    pub fn book(&self) -> &CodeBook {
        &self.book
    }

    /// Bits per second, nominally.
    pub fn bit_rate_hz(&self) -> f64 {
        self.bit_rate_hz
    }

    /// The vehicles, at least one.
    pub fn vehicles(&self) -> &[Vehicle] {
        &self.vehicles
    }
}
