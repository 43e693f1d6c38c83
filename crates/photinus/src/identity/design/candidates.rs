//! Which circles of bits may be words of a book.

use alloc::vec::Vec;
use core::ops::RangeInclusive;

use super::super::{CodeBook, Properties, Word};

/// What every book must have that is designed.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirements {
    length: usize,
    distance: u32,
    longest_run: usize,
    self_distance: u32,
    duty: RangeInclusive<f64>,
}

/// Why no book can be searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unmet {
    /// A length that has no words, or more than can be listed.
    #[error("words of {0} bits: designed are words of 2 to {most} bits", most = Requirements::LONGEST)]
    Length(usize),
    /// Not even one circle of bits is as required.
    #[error("no word meets the requirements")]
    NoWord,
    /// More circles than can be compared each with each.
    #[error("{0} circles of bits may be words, more than {most} that can be compared", most = Requirements::MOST_CANDIDATES)]
    TooMany(usize),
}

impl Requirements {
    /// The longest words that are designed, bits.
    pub const LONGEST: usize = 24;

    /// The most circles of bits that are compared each with each.
    pub const MOST_CANDIDATES: usize = 16_000;

    /// Words of `length` bits of which two differ in `distance` bits at least, however they are turned. Further requirements follow
    /// by the methods; none of them is set, but that a word differs from its own shifts: else its phase has more than one answer.
    ///
    /// # Errors
    /// [`Unmet::Length`] for a length that is not between 2 and [`Requirements::LONGEST`].
    pub fn new(length: usize, distance: u32) -> Result<Self, Unmet> {
        if !(2..=Self::LONGEST).contains(&length) {
            return Err(Unmet::Length(length));
        }
        Ok(Self { length, distance, longest_run: length, self_distance: 2, duty: 0.0..=1.0 })
    }

    /// With no more than this many equal bits in a row: the LED is seen again soon, and told from steady light soon.
    #[must_use]
    pub fn with_longest_run(self, longest_run: usize) -> Self {
        Self { longest_run, ..self }
    }

    /// With at least this many bits between a word and its own shifts; always an even number, as the distances are.
    #[must_use]
    pub fn with_self_distance(self, self_distance: u32) -> Self {
        Self { self_distance, ..self }
    }

    /// With a share of bits that are on in this range.
    #[must_use]
    pub fn with_duty(self, duty: RangeInclusive<f64>) -> Self {
        Self { duty, ..self }
    }

    /// Bits of a word.
    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// The fewest bits in which two words differ.
    pub(super) fn distance(&self) -> u32 {
        self.distance
    }

    /// Whether the word may stand in a book.
    pub fn allow(&self, word: &Word) -> bool {
        word.length() == self.length
            && word.longest_run(false).max(word.longest_run(true)) <= self.longest_run
            && word.self_distance().is_none_or(|distance| distance >= self.self_distance)
            && self.duty.contains(&word.duty())
    }

    /// Whether the book has all of it.
    pub fn are_met_by(&self, book: &CodeBook) -> bool {
        let distance = Properties::of(book).distance;
        book.words().iter().all(|word| self.allow(word))
            && distance.is_none_or(|(distance, _)| distance >= self.distance)
    }

    /// Every circle of bits that may be a word, begun where it makes the least number, in ascending order.
    pub(super) fn candidates(&self) -> Result<Vec<Word>, Unmet> {
        let circles = (0..1_u64 << self.length).filter(|&number| begins_least(number, self.length as u32));
        let words: Vec<Word> = circles
            .map(|number| Word::of(number, self.length as u32))
            .filter(|word| self.allow(word))
            .collect();
        match words.len() {
            0 => Err(Unmet::NoWord),
            count if count > Self::MOST_CANDIDATES => Err(Unmet::TooMany(count)),
            _ => Ok(words),
        }
    }
}

/// Whether no turn of the number, as a circle of this many bits, is less than it.
fn begins_least(number: u64, length: u32) -> bool {
    let all = (1 << length) - 1;
    (1..length).all(|by| (number >> by | number << (length - by)) & all >= number)
}
