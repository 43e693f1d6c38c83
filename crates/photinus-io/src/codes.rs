//! Code books: enters a text with a code word per line, leaves the book; and the books that come with Photinus.
//!
//! ```text
//! # comment
//! 0,0,1,0,1,1      word 0: one bit per camera frame, 1 is on
//! 0,1,0,1,1,1      word 1
//! ```

use std::path::Path;

use photinus::identity::{CodeBook, Word};

use crate::{Error, Place, Result, whole};

/// A book that comes with Photinus, designed by `photinus codes design`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// What it is called: bits of a word, distance and longest run.
    pub name: &'static str,
    /// The text of its file, whose first lines say what it has.
    pub text: &'static str,
}

macro_rules! preset {
    ($name:literal) => {
        Preset { name: $name, text: include_str!(concat!("../../../scenes/codes/", $name, ".txt")) }
    };
}

/// The books that come with Photinus; they lie in `scenes/codes`, where scenes find them.
pub const PRESETS: &[Preset] = &[
    preset!("l10-d3-r3"),
    preset!("l12-d3-r3"),
    preset!("l14-d3-r3"),
    preset!("l16-d4-r3"),
    preset!("l18-d3-r2"),
    preset!("l18-d3-r3"),
    preset!("l18-d5-r4"),
];

/// Reads the text of a code book; `path` is for the messages. Spaces and Windows line ends are tolerated, and `#` begins a
/// comment.
///
/// # Errors
/// [`Error`] with the line for what is neither 0 nor 1, for a word of another length than the first or of more than
/// [`Word::MOST_BITS`] bits, and for a file without words.
pub fn parse_codes(text: &str, path: impl AsRef<Path>) -> Result<CodeBook> {
    let path = path.as_ref();
    let mut words: Vec<Word> = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        let code = line.split('#').next().unwrap_or_default().trim();
        if code.is_empty() {
            continue;
        }
        let refuse =
            |reason: String, advice: &str| Error::format(path, reason).at(Place::Line(number)).advise(advice);
        let bits: Vec<bool> = code
            .split(',')
            .map(|value| bit(value.trim()))
            .collect::<std::result::Result<_, _>>()
            .map_err(|reason| refuse(reason, "write 0 or 1, separated by commas, one word per line"))?;
        let Some(word) = Word::new(&bits) else {
            let reason = format!("word {} has {} bits", words.len(), bits.len());
            return Err(refuse(reason, &format!("let words have up to {} bits", Word::MOST_BITS)));
        };
        if let Some(first) = words.first().filter(|first| first.length() != word.length()) {
            let reason =
                format!("word {} has {} bits, word 0 has {}", words.len(), word.length(), first.length());
            return Err(refuse(reason, "make all words equally long"));
        }
        words.push(word);
    }
    CodeBook::new(words)
        .map_err(|error| Error::format(path, error.to_string()).advise("write one code word per line"))
}

/// A book as the text of a file; it is read back as it was.
pub fn codes_text(book: &CodeBook) -> String {
    book.words().iter().map(|word| format!("{word}\n")).collect()
}

fn bit(value: &str) -> std::result::Result<bool, String> {
    match value {
        "0" => Ok(false),
        "1" => Ok(true),
        "" => Err("a bit is missing between commas".to_owned()),
        _ => Err(format!("`{value}` is no bit")),
    }
}

/// Reads the file of a code book.
///
/// # Errors
/// As [`parse_codes`], and when the file cannot be read.
pub fn read_codes(path: impl AsRef<Path>) -> Result<CodeBook> {
    let path = path.as_ref();
    parse_codes(&whole::read_text(path)?, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::files_in;
    use photinus::identity::Properties;
    use photinus_testing::real_data;

    fn message(text: &str) -> String {
        parse_codes(text, "codes.txt").unwrap_err().to_string()
    }

    #[test]
    fn words_are_read_with_spaces_comments_and_windows_lines() {
        let codes = parse_codes("# two words\r\n0, 1 ,1\r\n\r\n1,0,0 # second\r\n", "t").unwrap();
        let bits = |word: &Word| word.bits().collect::<Vec<_>>();
        assert_eq!(bits(&codes.words()[0]), [false, true, true]);
        assert_eq!(bits(&codes.words()[1]), [true, false, false]);
        assert_eq!((codes.length(), codes_text(&codes).as_str()), (3, "0,1,1\n1,0,0\n"));
    }

    #[test]
    fn what_is_no_word_is_named_by_its_line() {
        assert_eq!(
            message("0,1\n\n0,1,1\n"),
            "codes.txt, line 3: word 1 has 3 bits, word 0 has 2; make all words equally long"
        );
        assert!(message("0,1\n0,2\n").starts_with("codes.txt, line 2: `2` is no bit; write 0 or 1"));
        assert!(message("0,1,\n").starts_with("codes.txt, line 1: a bit is missing"));
        assert!(message("0110\n").starts_with("codes.txt, line 1: `0110` is no bit"));
        assert!(message("# nothing\n").starts_with("codes.txt: it holds no word"));
        let long = vec!["1"; 65].join(",");
        assert_eq!(message(&long), "codes.txt, line 1: word 0 has 65 bits; let words have up to 64 bits");
    }

    /// Each pair of words at each shift, bit by bit.
    #[test]
    fn the_books_that_come_with_photinus_have_what_they_say() {
        let differ = |a: &[bool], b: &[bool], by: usize| {
            (0..a.len()).filter(|&k| a[k] != b[(k + by) % b.len()]).count()
        };
        for (preset, words, [length, distance, run]) in [
            ("l10-d3-r3", 6, [10, 3, 3]),
            ("l12-d3-r3", 11, [12, 3, 3]),
            ("l14-d3-r3", 28, [14, 3, 3]),
            ("l16-d4-r3", 38, [16, 4, 3]),
            ("l18-d3-r2", 41, [18, 3, 2]),
            ("l18-d3-r3", 168, [18, 3, 3]),
            ("l18-d5-r4", 25, [18, 5, 4]),
        ] {
            let text = PRESETS.iter().find(|one| one.name == preset).unwrap().text;
            let claim = format!(
                "# {words} words of {length} bits, {distance} apart at any shift, 2 from their own shifts, runs of up to {run};"
            );
            assert!(text.starts_with(&claim), "{preset}: {text}");
            let book: Vec<Vec<bool>> =
                parse_codes(text, preset).unwrap().words().iter().map(|word| word.bits().collect()).collect();
            assert_eq!(book.len(), words, "{preset}");
            for (id, word) in book.iter().enumerate() {
                assert_eq!(word.len(), length, "{preset}");
                assert!((1..length).all(|by| differ(word, word, by) >= 2), "{preset}: word {id}");
                let runs = |k: usize| (k..=k + run).map(|i| word[i % length]);
                assert!((0..length).all(|k| runs(k).any(|bit| bit != word[k])), "{preset}: word {id}");
                let is_apart = |other: &Vec<bool>| (0..length).all(|by| differ(word, other, by) >= distance);
                assert!(book[..id].iter().all(is_apart), "{preset}: word {id}");
            }
        }
        assert_eq!(PRESETS.len(), 7);
    }

    /// What a reader of their names would believe is not always so.
    #[test]
    fn every_real_code_book_is_read() {
        let Some(folder) = real_data("blink-codes") else { return };
        let known = [
            ("manchesterPropeties.txt", 28, 3, 0),
            ("TBS-L12-P0.500000-HD3-NO3-NZ3-N12.txt", 12, 3, 0),
            ("TBS-L12-P0.500000-HD3-NO5-NZ5-eta0.000000-N20.txt", 20, 1, 0),
            ("TBS-L13-P0.400000-HD3-NO7-NZ7-Na22.txt", 22, 3, 2),
            ("TBS-L14-P0.500000-HD3-NO3-NZ3-N21.txt", 21, 3, 0),
            ("mixed_L18_p0.444_HD2_NO5_NZ2_Na6.txt", 6, 1, 4),
            ("BlinkingSequence-14-4-4-3-12.txt", 14, 3, 0),
        ];
        let (mut books, mut recognised) = (0, 0);
        for path in files_in(&folder) {
            let codes = read_codes(&path).unwrap();
            assert!(codes.words().len() >= 3 && (4..=18).contains(&codes.length()), "{path:?}");
            books += 1;
            let name = path.file_name().unwrap().to_str().unwrap();
            if let Some(&(_, words, distance, own)) = known.iter().find(|(file, ..)| *file == name) {
                let has = Properties::of(&codes);
                let found = (codes.words().len(), has.distance.unwrap().0, has.self_distance.unwrap().0);
                assert_eq!(found, (words, distance, own), "{name}");
                recognised += 1;
            }
        }
        assert!(books > 0 && recognised == known.len());
    }
}
