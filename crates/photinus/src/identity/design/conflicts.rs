//! Which candidates are too much alike to stand in one book.

use alloc::vec;
use alloc::vec::Vec;

use super::super::Word;

/// A graph of candidates with an edge between two that conflict, as rows of bits and as lists.
pub(super) struct Conflicts {
    rows: Vec<u64>,
    stride: usize,
    lists: Vec<Vec<u32>>,
}

impl Conflicts {
    /// Compares each with each: those closer than `distance` at some turn conflict.
    pub(super) fn among(words: &[Word], distance: u32) -> Self {
        let mut lists = vec![Vec::new(); words.len()];
        for (a, word) in words.iter().enumerate() {
            let turns: Vec<u64> = (0..word.length()).map(|by| word.turned(by).number()).collect();
            for (b, other) in words.iter().enumerate().skip(a + 1) {
                // turning changes the number of ones of neither
                let is_far = word.ones().abs_diff(other.ones()) >= distance;
                if !is_far && turns.iter().any(|turn| (turn ^ other.number()).count_ones() < distance) {
                    lists[a].push(b as u32);
                    lists[b].push(a as u32);
                }
            }
        }
        Self::of(lists)
    }

    /// Of lists of those that each conflicts with.
    pub(super) fn of(lists: Vec<Vec<u32>>) -> Self {
        let stride = lists.len().div_ceil(64);
        let mut rows = vec![0; stride * lists.len()];
        for (a, list) in lists.iter().enumerate() {
            for &b in list {
                rows[a * stride + b as usize / 64] |= 1 << (b % 64);
            }
        }
        Self { rows, stride, lists }
    }

    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.lists.len()
    }

    /// Those that `a` conflicts with.
    pub(super) fn with(&self, a: usize) -> &[u32] {
        &self.lists[a]
    }

    /// Those that `a` conflicts with, a bit each.
    pub(super) fn row(&self, a: usize) -> &[u64] {
        &self.rows[a * self.stride..(a + 1) * self.stride]
    }
}

/// The least number whose bit is set.
pub(super) fn first(bits: &[u64]) -> Option<usize> {
    let at = bits.iter().position(|&bits| bits != 0)?;
    Some(64 * at + bits[at].trailing_zeros() as usize)
}
