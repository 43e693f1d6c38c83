//! JSON lines: a record per line, so that a run that stops has written all it knew.

use std::io::{BufRead, BufReader, Read, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::{Cause, ContentError, Error, Place, Result};

/// Longest line: thousands of spots.
const MAX_LINE_BYTES: usize = 16 << 20;

/// The records of a stream. A line that is not a record gives an error, and the next line comes after it; blank lines are
/// skipped.
#[derive(Debug)]
pub(crate) struct JsonLines<R, T> {
    source: BufReader<R>,
    name: PathBuf,
    line: usize,
    ended: bool,
    record: PhantomData<fn() -> T>,
}

impl<R: Read, T> JsonLines<R, T> {
    pub(crate) fn new(source: R, name: impl AsRef<Path>) -> Self {
        let name = name.as_ref().to_owned();
        Self { source: BufReader::new(source), name, line: 0, ended: false, record: PhantomData }
    }

    /// The next line, empty at the end.
    fn line(&mut self) -> Result<Vec<u8>> {
        let mut line = Vec::new();
        self.line += 1;
        let read = (&mut self.source).take(MAX_LINE_BYTES as u64).read_until(b'\n', &mut line);
        let at = Place::Line(self.line);
        read.map_err(|error| Error::io(&self.name, error).at(at.clone()))?;
        if line.len() == MAX_LINE_BYTES {
            return Err(Error::format(&self.name, format!("the line is longer than {MAX_LINE_BYTES} bytes"))
                .at(at)
                .advise("check that this is a JSON lines file"));
        }
        Ok(line)
    }
}

impl<R: Read, T: DeserializeOwned> Iterator for JsonLines<R, T> {
    type Item = Result<T>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            let line = match self.line() {
                Ok(line) => line,
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            };
            self.ended = line.is_empty();
            if !line.trim_ascii().is_empty() {
                let record = serde_json::from_slice(&line);
                return Some(record.map_err(|error| match error.is_eof() && !line.ends_with(b"\n") {
                    true => self.cut(),
                    false => self.refuse::<T>(&line, &error),
                }));
            }
        }
        None
    }
}

impl<R, T> JsonLines<R, T> {
    fn cut(&self) -> Error {
        Error::new(&self.name, Cause::Cut).at(Place::Line(self.line)).advise("remove it, or run again")
    }

    fn refuse<Record: DeserializeOwned>(&self, line: &[u8], error: &serde_json::Error) -> Error {
        let advice = match error.is_eof() {
            true => "the line is cut: remove it, or run again",
            false => "see docs/file-formats.md for an example",
        };
        Error::new(&self.name, ContentError::of_json::<Record>(line, error))
            .at(Place::Column { line: self.line, column: error.column() })
            .advise(advice)
    }
}

/// Writes a record as a line. A number that is not finite becomes null.
pub(crate) fn write_json(sink: &mut impl Write, record: &impl Serialize, name: &Path) -> Result<()> {
    let mut line = serde_json::to_vec(record).map_err(|error| Error::format(name, error.to_string()))?;
    line.push(b'\n');
    sink.write_all(&line).map_err(|error| Error::io(name, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_line_is_named_and_the_next_one_is_read() {
        let read: Vec<Result<[u32; 2]>> =
            JsonLines::new(b"[1,2]\r\n\n[1,\n[3,4]".as_slice(), "t.jsonl").collect();
        assert_eq!(read.len(), 3);
        assert_eq!(*read[2].as_ref().unwrap(), [3, 4]);
        let message = read[1].as_ref().unwrap_err().to_string();
        assert!(message.starts_with("t.jsonl, line 3: column "), "{message}");
        assert!(message.ends_with("; the line is cut: remove it, or run again"), "{message}");
    }

    #[test]
    fn a_line_that_never_ends_is_refused() {
        let read: Vec<Result<f64>> = JsonLines::new(std::io::repeat(b' '), "/dev/zero").collect();
        assert_eq!(read.len(), 1);
        assert!(read[0].as_ref().unwrap_err().to_string().contains("longer than"));
    }

    #[test]
    fn no_number_but_finite_ones_reaches_json() {
        let mut line = Vec::new();
        write_json(&mut line, &[f64::NAN, f64::INFINITY, 0.1], Path::new("t")).unwrap();
        assert_eq!(line, b"[null,null,0.1]\n");
    }
}
