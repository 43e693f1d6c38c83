//! Any text as a code book; what is read is written and read back, and has properties that agree with each other.
#![no_main]

use libfuzzer_sys::fuzz_target;
use photinus::identity::{CodeBook, Properties};
use photinus_io::codes::{codes_text, parse_codes};

/// More words would only be slow: each is compared with each.
const MOST_WORDS: usize = 24;

fuzz_target!(|text: &str| {
    let Ok(book) = parse_codes(text, "fuzz") else { return };
    assert_eq!(parse_codes(&codes_text(&book), "fuzz").expect("what was written is read"), book);
    let words = book.words().iter().take(MOST_WORDS).copied().collect();
    let has = Properties::of(&CodeBook::new(words).expect("words of a book"));
    let [least, most] = has.duty;
    assert!(0.0 <= least && least <= most && most <= 1.0, "{has:?}");
    assert!(has.longest_dark.max(has.longest_lit) <= book.length(), "{has:?}");
    let alike = has.distance.is_some_and(|(distance, _)| distance == 0);
    assert_eq!(alike, has.unique_after.is_none(), "{has:?}");
    assert!(has.in_phase_after.is_none() || has.in_phase_after >= has.unique_after, "{has:?}");
});
