//! Blink sequences: enters a text with a code word per line, leave the words as bits.
//!
//! ```text
//! # comment
//! 0,0,1,0,1,1      word 0: one bit per camera frame, 1 is on
//! 0,1,0,1,1,1      word 1
//! ```

use std::fmt;
use std::path::Path;

use crate::{Error, Place, Result, whole};

/// Code words of one length; the index of a word is its id. At least one word of at least one bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlinkCodes {
    words: Vec<Vec<bool>>,
}

impl BlinkCodes {
    /// The words, by id.
    pub fn words(&self) -> &[Vec<bool>] {
        &self.words
    }

    /// Bits of a word, one per camera frame.
    pub fn length(&self) -> usize {
        self.words[0].len()
    }

    /// Reads the text of a blink sequence file; `path` is for the messages. Spaces and Windows line ends are
    /// tolerated, and `#` begins a comment.
    ///
    /// # Errors
    /// [`Error`] with the line for what is neither 0 nor 1, for a word of another length than the first, and for a
    /// file without words.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mut words: Vec<Vec<bool>> = Vec::new();
        for (line, number) in text.lines().zip(1..) {
            let code = line.split('#').next().unwrap_or_default().trim();
            if code.is_empty() {
                continue;
            }
            let refuse = |reason: String, advice: &str| {
                Error::format(path, reason).at(Place::Line(number)).advise(advice)
            };
            let word: Vec<bool> = code
                .split(',')
                .map(|value| bit(value.trim()))
                .collect::<std::result::Result<_, _>>()
                .map_err(|reason| refuse(reason, "write 0 or 1, separated by commas, one word per line"))?;
            if let Some(first) = words.first().filter(|first| first.len() != word.len()) {
                let reason =
                    format!("word {} has {} bits, word 0 has {}", words.len(), word.len(), first.len());
                return Err(refuse(reason, "make all words equally long"));
            }
            words.push(word);
        }
        if words.is_empty() {
            return Err(Error::format(path, "it holds no word").advise("write one code word per line"));
        }
        Ok(Self { words })
    }
}

impl fmt::Display for BlinkCodes {
    /// As the text of a file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for word in &self.words {
            let bits: Vec<&str> = word.iter().map(|&on| if on { "1" } else { "0" }).collect();
            writeln!(f, "{}", bits.join(","))?;
        }
        Ok(())
    }
}

fn bit(value: &str) -> std::result::Result<bool, String> {
    match value {
        "0" => Ok(false),
        "1" => Ok(true),
        "" => Err("a bit is missing between commas".to_owned()),
        _ => Err(format!("`{value}` is no bit")),
    }
}

/// Reads a blink sequence file.
///
/// # Errors
/// As [`BlinkCodes::parse`], and when the file cannot be read.
pub fn read_blink_codes(path: impl AsRef<Path>) -> Result<BlinkCodes> {
    let path = path.as_ref();
    BlinkCodes::parse(&whole::read_text(path)?, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::files_in;
    use photinus_testing::real_data;

    fn message(text: &str) -> String {
        BlinkCodes::parse(text, "codes.txt").unwrap_err().to_string()
    }

    #[test]
    fn words_are_read_with_spaces_comments_and_windows_lines() {
        let codes = BlinkCodes::parse("# two words\r\n0, 1 ,1\r\n\r\n1,0,0 # second\r\n", "t").unwrap();
        assert_eq!(codes.words(), [[false, true, true], [true, false, false]]);
        assert_eq!((codes.length(), codes.to_string().as_str()), (3, "0,1,1\n1,0,0\n"));
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
    }

    #[test]
    fn every_real_code_book_is_read() {
        let Some(folder) = real_data("blink-codes") else { return };
        let mut books = 0;
        for path in files_in(&folder) {
            let codes = read_blink_codes(&path).unwrap();
            println!("{}: {} words of {} bits", path.display(), codes.words().len(), codes.length());
            assert!(codes.words().len() >= 3 && (4..=18).contains(&codes.length()), "{path:?}");
            books += 1;
        }
        assert!(books > 0);
    }
}
