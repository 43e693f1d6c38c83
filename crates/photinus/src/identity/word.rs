//! A code word: the bits that an LED repeats without an end.

use core::fmt;

/// 1 to 64 bits in a circle; bit 0 is sent first, 1 is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Word {
    length: u32,
    /// Bit k of the word at bit k of the number; zero above the length.
    bits: u64,
}

impl Word {
    /// The most bits of a word.
    pub const MOST_BITS: usize = 64;

    /// The word of these bits, in the order in which they are sent; `None` for no bit or more than [`Word::MOST_BITS`].
    pub fn new(bits: &[bool]) -> Option<Self> {
        let legal = (1..=Self::MOST_BITS).contains(&bits.len());
        let number = |bits: &[bool]| (0..).zip(bits).fold(0, |word, (k, &on)| word | u64::from(on) << k);
        legal.then(|| Self { length: bits.len() as u32, bits: number(bits) })
    }

    /// The word whose bit k is bit k of `bits`, for a length that is legal; higher bits of the number are left out.
    pub(super) fn of(bits: u64, length: u32) -> Self {
        Self { length, bits: bits & mask(length) }
    }

    /// Number of bits.
    pub fn length(&self) -> usize {
        self.length as usize
    }

    /// Whether bit `k` is on, counted around the circle.
    #[inline]
    pub fn bit(&self, k: usize) -> bool {
        self.bits >> (k % self.length()) & 1 == 1
    }

    /// The bits in the order in which they are sent.
    pub fn bits(&self) -> impl ExactSizeIterator<Item = bool> + Clone + use<> {
        let bits = self.bits;
        (0..self.length).map(move |k| bits >> k & 1 == 1)
    }

    /// The number whose bit k is bit k of the word.
    pub(super) fn number(&self) -> u64 {
        self.bits
    }

    /// How many bits are on.
    pub fn ones(&self) -> u32 {
        self.bits.count_ones()
    }

    /// Share of the time in which it is on.
    pub fn duty(&self) -> f64 {
        f64::from(self.ones()) / f64::from(self.length)
    }

    /// The same circle begun at bit `by`.
    #[must_use]
    pub fn turned(&self, by: usize) -> Self {
        let by = (by % self.length()) as u32;
        let high = if by == 0 { 0 } else { self.bits << (self.length - by) };
        Self::of(self.bits >> by | high, self.length)
    }

    /// The fewest bits in which the two differ, however they are turned; `None` for words of different lengths.
    pub fn cyclic_distance(&self, other: &Self) -> Option<u32> {
        let at = |by| (self.bits ^ other.turned(by).bits).count_ones();
        (self.length == other.length).then(|| (0..self.length()).map(at).min().unwrap_or(0))
    }

    /// The fewest bits in which the word differs from itself turned by less than a round: 0 means that its phase has more than one
    /// answer. It is always even. `None` for a word of one bit, which has no other shift.
    pub fn self_distance(&self) -> Option<u32> {
        (1..self.length()).map(|by| (self.bits ^ self.turned(by).bits).count_ones()).min()
    }

    /// The longest run of bits that are `on`, or not, around the circle.
    pub fn longest_run(&self, on: bool) -> usize {
        let (mut longest, mut run) = (0, 0);
        for bit in self.bits().chain(self.bits()) {
            run = if bit == on { run + 1 } else { 0 };
            longest = longest.max(run);
        }
        longest.min(self.length())
    }

    /// Of all beginnings that which makes the least number: one for each circle.
    #[must_use]
    pub fn least_turned(&self) -> Self {
        (0..self.length()).map(|by| self.turned(by)).min().unwrap_or(*self)
    }
}

impl fmt::Display for Word {
    /// As in a file: bits with commas between them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, on) in self.bits().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(f, "{comma}{}", u8::from(on))?;
        }
        Ok(())
    }
}

fn mask(length: u32) -> u64 {
    u64::MAX >> (64 - length)
}

#[cfg(test)]
pub(super) fn word(text: &str) -> Word {
    Word::new(&text.chars().map(|bit| bit == '1').collect::<Vec<_>>()).expect("1 to 64 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Turned by moving the bits in a list.
    fn turned(bits: &[bool], by: usize) -> Vec<bool> {
        bits[by..].iter().chain(&bits[..by]).copied().collect()
    }

    fn differ(a: &[bool], b: &[bool]) -> u32 {
        a.iter().zip(b).map(|(a, b)| u32::from(a != b)).sum()
    }

    #[test]
    fn what_words_are() {
        assert_eq!(Word::new(&[]), None);
        assert_eq!(Word::new(&[true; 65]), None);
        assert_eq!(Word::new(&[true; 64]).unwrap().ones(), 64);
        let sent = word("001011");
        assert_eq!((sent.to_string().as_str(), sent.ones(), sent.duty()), ("0,0,1,0,1,1", 3, 0.5));
        assert_eq!((sent.longest_run(false), sent.longest_run(true)), (2, 2));
        assert_eq!((word("0110").longest_run(false), word("000").longest_run(true)), (2, 0));
        assert_eq!(word("111").longest_run(true), 3);
        assert_eq!((word("0101").self_distance(), word("1").self_distance()), (Some(0), None));
        assert_eq!(word("01").cyclic_distance(&word("011")), None);
    }

    proptest! {
        #[test]
        fn distances_are_those_of_lists(
            (a, b) in (1..=64_usize).prop_flat_map(|length| {
                let bits = || proptest::collection::vec(any::<bool>(), length);
                (bits(), bits())
            })
        ) {
            let (word, other) = (Word::new(&a).unwrap(), Word::new(&b).unwrap());
            prop_assert_eq!(word.bits().collect::<Vec<_>>(), a.clone());
            for by in 0..a.len() {
                prop_assert_eq!(word.turned(by).bits().collect::<Vec<_>>(), turned(&a, by));
                prop_assert_eq!(word.turned(by).least_turned(), word.least_turned());
                prop_assert_eq!(word.bit(by), a[by]);
            }
            let least = (0..a.len()).map(|by| differ(&a, &turned(&b, by))).min();
            prop_assert_eq!(word.cyclic_distance(&other), least);
            let own = (1..a.len()).map(|by| differ(&a, &turned(&a, by))).min();
            prop_assert_eq!(word.self_distance(), own);
            let run = |on: bool| {
                (1..=a.len()).filter(|n| (0..a.len()).any(|k| (k..k + n).all(|i| a[i % a.len()] == on))).max()
            };
            for on in [false, true] {
                prop_assert_eq!(word.longest_run(on), run(on).unwrap_or(0));
            }
        }
    }
}
