//! Results as JSON lines, written and read.

use std::fs::File;
use std::io::{LineWriter, Read, Write};
use std::path::{Path, PathBuf};

use super::FrameRecord;
use crate::{Error, Result, lines};

/// Writes a line of JSON per frame, handed on at its end: a run that stops has written all it knew.
///
/// A number that is not finite is written as `null`.
#[derive(Debug)]
pub struct ResultsWriter<W: Write> {
    sink: LineWriter<W>,
    name: PathBuf,
}

impl<W: Write> ResultsWriter<W> {
    /// Results to `sink`; `name` is for the messages.
    pub fn new(sink: W, name: impl AsRef<Path>) -> Self {
        Self { sink: LineWriter::new(sink), name: name.as_ref().to_owned() }
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn write(&mut self, record: &FrameRecord) -> Result<()> {
        lines::write_json(&mut self.sink, record, &self.name)
    }

    /// The results are whole: hands back the sink.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn finish(self) -> Result<W> {
        self.sink.into_inner().map_err(|error| Error::io(&self.name, error.into_error()))
    }
}

/// Reads results, or the spots of another program in place of frames. A line that is no frame is an error, and the
/// next one follows. Blank lines are skipped.
#[derive(Debug)]
pub struct ResultsReader<R> {
    lines: lines::JsonLines<R, FrameRecord>,
    next: u64,
}

impl<R: Read> ResultsReader<R> {
    /// Records of `source`; `name` is for the messages.
    pub fn new(source: R, name: impl AsRef<Path>) -> Self {
        Self { lines: lines::JsonLines::new(source, name), next: 0 }
    }
}

impl<R: Read> Iterator for ResultsReader<R> {
    type Item = Result<FrameRecord>;

    fn next(&mut self) -> Option<Self::Item> {
        let record = self.lines.next()?;
        let number = self.next;
        self.next += 1;
        Some(record.map(|record| FrameRecord { frame: record.frame.or(Some(number)), ..record }))
    }
}

/// Reads a results file.
///
/// # Errors
/// [`Error`] when the file cannot be opened; later ones come from the reader.
pub fn read_results(path: impl AsRef<Path>) -> Result<ResultsReader<File>> {
    let path = path.as_ref();
    Ok(ResultsReader::new(File::open(path).map_err(|error| Error::io(path, error))?, path))
}
