//! What a book truly has, whatever its name says.

use alloc::collections::BTreeMap;

use super::{CodeBook, Word};

/// What tells the words of a book apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Properties {
    /// The fewest bits in which two words differ, however they are turned, and which two; `None` for a single word. 0 means that
    /// they are the same but for their beginning. With 2 t + 1 every t wrong bits in a round can be put right.
    pub distance: Option<(u32, [usize; 2])>,
    /// The fewest bits in which a word differs from its own shifts, and which word; `None` for words of one bit. 0 means that the
    /// phase of that word has more than one answer.
    pub self_distance: Option<(u32, usize)>,
    /// The fewest bits in which a word differs from steady light.
    pub steady_distance: u32,
    /// The longest run of bits that are off.
    pub longest_dark: usize,
    /// The longest run of bits that are on.
    pub longest_lit: usize,
    /// The least and the largest share of bits that are on.
    pub duty: [f64; 2],
    /// This many bits without error, begun anywhere, belong to one word only; `None` when no number does.
    pub unique_after: Option<usize>,
    /// This many bits without error, begun anywhere, belong to one word and one place in it only; `None` when no number does.
    pub in_phase_after: Option<usize>,
}

impl Properties {
    /// What `book` has.
    pub fn of(book: &CodeBook) -> Self {
        let words = book.words();
        let pairs = (0..words.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let distance = pairs.filter_map(|[a, b]| Some((words[a].cyclic_distance(&words[b])?, [a, b]))).min();
        let own = (0..).zip(words).filter_map(|(id, word)| Some((word.self_distance()?, id)));
        let longest = |on| words.iter().map(|word| word.longest_run(on)).max().unwrap_or(0);
        let ones = || words.iter().map(Word::ones);
        let length = book.length();
        let share = |ones: Option<u32>| f64::from(ones.unwrap_or(0)) / length as f64;
        Self {
            distance,
            self_distance: own.min(),
            steady_distance: length as u32 - ones().max().unwrap_or(0),
            longest_dark: longest(false),
            longest_lit: longest(true),
            duty: [share(ones().min()), share(ones().max())],
            unique_after: (1..=length).find(|&bits| each_window_has_one(words, bits, |id, _| id)),
            in_phase_after: (1..=length).find(|&bits| each_window_has_one(words, bits, |id, at| (id, at))),
        }
    }
}

/// Whether equal windows of `bits` bits, begun anywhere, always have the same owner. A round tells all: words of one length that
/// agree for a round agree for ever.
fn each_window_has_one<O: PartialEq>(words: &[Word], bits: usize, owner: impl Fn(usize, usize) -> O) -> bool {
    let mut owners: BTreeMap<u64, O> = BTreeMap::new();
    let windows = words.iter().enumerate().flat_map(|(id, word)| {
        (0..word.length()).map(move |at| (word.turned(at).number() & (u64::MAX >> (64 - bits)), id, at))
    });
    for (window, id, at) in windows {
        let owner = owner(id, at);
        match owners.get(&window) {
            Some(other) if *other != owner => return false,
            Some(_) => {}
            None => {
                owners.insert(window, owner);
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::word::word;
    use super::*;

    fn properties(words: &[&str]) -> Properties {
        Properties::of(&CodeBook::new(words.iter().map(|bits| word(bits)).collect()).unwrap())
    }

    #[test]
    fn what_small_books_have() {
        let two = properties(&["0011", "0001"]);
        assert_eq!((two.distance, two.self_distance), (Some((1, [0, 1])), Some((2, 0))));
        assert_eq!((two.longest_dark, two.longest_lit, two.steady_distance), (3, 2, 2));
        assert_eq!((two.duty[0], two.duty[1]), (0.25, 0.5));
        // 0,0 and 1,0 and 0,1 stand in both; of three bits 0,0,1 and 1,0,0 do; four bits are the word
        assert_eq!((two.unique_after, two.in_phase_after), (Some(4), Some(4)));
        let turned = properties(&["0011", "1001"]);
        assert_eq!((turned.distance, turned.unique_after), (Some((0, [0, 1])), None));
        let alone = properties(&["0101"]);
        assert_eq!((alone.distance, alone.self_distance), (None, Some((0, 0))));
        assert_eq!((alone.unique_after, alone.in_phase_after), (Some(1), None));
        assert_eq!(properties(&["001", "011"]).unique_after, Some(3));
    }

    #[test]
    fn unequal_words_make_no_book() {
        use super::super::BookError;
        assert_eq!(CodeBook::new(vec![]), Err(BookError::NoWord));
        let unequal = BookError::Unequal { word: 1, bits: 3, first: 2 };
        assert_eq!(CodeBook::new(vec![word("01"), word("011")]), Err(unequal));
    }
}
