//! Decoding the markers of a frame: who blinks, of 41 words of 18 bits.

use std::hint::black_box;

use photinus::identity::decoder::{Decoder, Listener, Settings};
use photinus::identity::{CodeBook, Evidence, Word};

use crate::contest::Contest;

const BOOK: &str = include_str!("../../../../scenes/codes/l18-d3-r2.txt");
/// 168 words of 18 bits.
const LARGE_BOOK: &str = include_str!("../../../../scenes/codes/l18-d3-r3.txt");

/// Frames after which markers that are not yet known begin anew.
const UNKNOWN_FOR: usize = 18;

struct Markers {
    decoder: Decoder,
    words: Vec<Word>,
    listeners: Vec<Listener>,
    frame: usize,
}

impl Markers {
    fn new(count: usize) -> Self {
        let words = words();
        let book = CodeBook::new(words.clone()).expect("a book");
        let decoder = Decoder::new(&book, Settings::default()).expect("a decoder");
        let listeners = vec![decoder.listener(); count];
        Self { decoder, words, listeners, frame: 0 }
    }

    fn hear(&mut self) {
        self.frame += 1;
        let time_s = self.frame as f64 / 60.0;
        for (marker, listener) in self.listeners.iter_mut().enumerate() {
            let bit = self.words[marker % self.words.len()].bit(self.frame + marker);
            let heard = self.decoder.hear(listener, time_s, 1e-3, &Evidence::of_bit(bit, 0.01));
            heard.expect("time passes");
            black_box(self.decoder.identity(listener));
        }
    }

    /// One in so many begins anew each time, so that each frame costs the same.
    fn begin_some_anew(&mut self) {
        let due = self.frame % UNKNOWN_FOR;
        for listener in self.listeners.iter_mut().skip(due).step_by(UNKNOWN_FOR) {
            self.decoder.restart(listener);
        }
    }
}

/// The words of the book.
pub(crate) fn words() -> Vec<Word> {
    words_of(BOOK)
}

/// Those of one that has enough for a fleet whose vehicles blink several.
pub(crate) fn many_words() -> Vec<Word> {
    words_of(LARGE_BOOK)
}

fn words_of(book: &str) -> Vec<Word> {
    let word = |line: &str| Word::new(&line.split(',').map(|bit| bit == "1").collect::<Vec<_>>());
    book.lines().filter_map(|line| word(line).filter(|_| !line.starts_with('#'))).collect()
}

pub(crate) fn run() {
    let mut contest = Contest::beside_maximum("Decoding the markers of a frame");
    for count in [20, 120] {
        let mut known = Markers::new(count);
        (0..200).for_each(|_| known.hear());
        contest.add(&format!("{count} markers, known"), move |_| known.hear());
        let mut unknown = Markers::new(count);
        contest.add(&format!("{count} markers, not yet known"), move |_| {
            unknown.begin_some_anew();
            unknown.hear();
        });
    }
    contest.run();
}
