//! Designing books: what words must have -> as many of them as can be found, and how many there can be.
//!
//! ```text
//! candidates    every circle of bits that may be a word
//! conflicts     which two of them are too much alike
//! local_search  a large set without conflicts
//! bound         groups of words of which a book has one at most -> how many there can be
//! exact         all sets, where they are few enough -> the most, proved
//! ```

mod bound;
mod candidates;
mod conflicts;
mod exact;
mod local_search;

use alloc::vec::Vec;

use super::{CodeBook, Word};
use conflicts::Conflicts;

pub use candidates::{Requirements, Unmet};

/// How long to search; the same numbers give the same book everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effort {
    /// Where the search begins.
    pub seed: u64,
    /// Conflicts that the local search follows.
    pub work: u64,
    /// Branches that the exact search looks at before it gives up.
    pub branches: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 1, work: 300_000_000, branches: 100_000 }
    }
}

/// A book, and how far it may be from the best.
#[derive(Clone, Debug, PartialEq)]
pub struct Designed {
    /// As many words as were found.
    pub book: CodeBook,
    /// No book that meets the requirements has more words.
    pub at_most: usize,
    /// How many circles of bits meet the requirements on a single word.
    pub candidates: usize,
}

impl Designed {
    /// Whether it is proved that no book has more words.
    pub fn is_the_most(&self) -> bool {
        self.book.words().len() == self.at_most
    }
}

/// Searches for a book that meets `requirements`. A set without conflicts is grown by local search; groups of words that are all
/// alike bound how many there can be; if the two do not meet, all sets are searched as far as `effort` allows.
///
/// # Errors
/// [`Unmet`] when no word meets the requirements, or too many do to compare them all.
pub fn design(requirements: &Requirements, effort: Effort) -> Result<Designed, Unmet> {
    let candidates = requirements.candidates()?;
    let conflicts = Conflicts::among(&candidates, requirements.distance());
    let mut chosen = local_search::grow(&conflicts, effort);
    let mut at_most = bound::at_most(&conflicts, requirements, &candidates);
    if chosen.len() < at_most {
        match exact::search(&conflicts, &chosen, effort.branches) {
            exact::Outcome::Most(most) => {
                at_most = most.len();
                chosen = most;
            }
            exact::Outcome::GaveUp(best) => chosen = best,
        }
    }
    chosen.sort_unstable();
    let words: Vec<Word> = chosen.iter().map(|&index| candidates[index]).collect();
    let book = CodeBook::new(words).map_err(|_| Unmet::NoWord)?;
    Ok(Designed { book, at_most, candidates: candidates.len() })
}

#[cfg(test)]
mod tests;
