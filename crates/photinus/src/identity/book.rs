//! A code book: the words that a fleet blinks.

use alloc::vec::Vec;

use super::Word;

/// Words of one length; the index of a word is its id. At least one word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodeBook {
    words: Vec<Word>,
}

/// Why words make no book.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BookError {
    /// There is none.
    #[error("it holds no word")]
    NoWord,
    /// Words are not equally long.
    #[error("word {word} has {bits} bits, word 0 has {first}")]
    Unequal {
        /// Which word, from 0.
        word: usize,
        /// How many bits it has.
        bits: usize,
        /// How many word 0 has.
        first: usize,
    },
}

impl CodeBook {
    /// A book of these words. They may be alike: [`Properties`](super::Properties) tells.
    ///
    /// # Errors
    /// [`BookError`] for no word, and for words of different lengths.
    pub fn new(words: Vec<Word>) -> Result<Self, BookError> {
        let first = words.first().ok_or(BookError::NoWord)?.length();
        match words.iter().enumerate().find(|(_, word)| word.length() != first) {
            Some((word, unequal)) => Err(BookError::Unequal { word, bits: unequal.length(), first }),
            None => Ok(Self { words }),
        }
    }

    /// The words, by id.
    pub fn words(&self) -> &[Word] {
        &self.words
    }

    /// Bits of a word.
    pub fn length(&self) -> usize {
        self.words[0].length()
    }
}
