//! A run that goes on where one was stopped: enters the file of results that it left, leaves what is done.
//!
//! Whole lines count, a cut one does not. The last whole line is made once more: if it comes out otherwise, the files, the
//! options or the version are not those of the stopped run, and its results are left alone.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use photinus_io::results::{FrameRecord, ResultsReader, ResultsWriter};
use photinus_io::{Error, Place, Result};

use crate::failure::Failure;

/// Results of a stopped run.
pub(crate) struct Done {
    path: PathBuf,
    /// Bytes of the whole lines but the last.
    bytes_before_last: u64,
    /// The frame of the last whole line, and the camera, where there are several.
    frame: u64,
    camera: Option<String>,
    last_line: Vec<u8>,
}

impl Done {
    /// What is in the file; `None` when there is no file, or no whole line in it.
    ///
    /// # Errors
    /// [`Failure`] when it cannot be read, or is no file of results.
    pub(crate) fn read(path: &Path) -> std::result::Result<Option<Self>, Failure> {
        let is_standard = path.as_os_str() == "-";
        if !path.exists() && !is_standard {
            return Ok(None);
        }
        if !path.is_file() {
            let reason = format!("{}: only a file of results can be gone on with", path.display());
            return Err(Failure::Input(reason));
        }
        let refuse = |error| Failure::input(Error::io(path, error));
        let mut source = BufReader::new(File::open(path).map_err(refuse)?);
        let (mut bytes, mut bytes_before_last, mut last_line) = (0, 0, Vec::new());
        let mut line = Vec::new();
        while source.read_until(b'\n', &mut line).map_err(refuse)? > 0 && line.ends_with(b"\n") {
            bytes_before_last = bytes;
            bytes += line.len() as u64;
            std::mem::swap(&mut last_line, &mut line);
            line.clear();
        }
        if bytes == 0 {
            return Ok(None);
        }
        let record = ResultsReader::new(last_line.as_slice(), path).next();
        let (frame, camera) = match record {
            Some(Ok(FrameRecord { frame: Some(frame), camera, .. })) => (frame, camera),
            _ => {
                let refused = Error::format(path, "its last whole line is no result");
                return Err(Failure::input(refused.advise("remove that line, or write elsewhere")));
            }
        };
        Ok(Some(Self { path: path.to_owned(), bytes_before_last, frame, camera, last_line }))
    }

    /// The frame of the last whole line, which is made once more.
    pub(crate) fn frame(&self) -> u64 {
        self.frame
    }

    /// Whether a frame is that of the last whole line.
    pub(crate) fn is_last(&self, record: &FrameRecord) -> bool {
        record.frame == Some(self.frame) && record.camera == self.camera
    }

    /// Refuses to go on after results that this run would not have given.
    ///
    /// # Errors
    /// [`Failure`] when `record`, the last one made once more, is not the one in the file.
    pub(crate) fn check(&self, record: &FrameRecord) -> std::result::Result<(), Failure> {
        let mut line = Vec::new();
        ResultsWriter::new(&mut line, &self.path).write(record).map_err(Failure::running)?;
        match line == self.last_line {
            true => Ok(()),
            false => Err(Failure::input(
                Error::format(&self.path, "this run finds something else in it")
                    .at(Place::Frame(self.frame))
                    .advise(
                        "go on with the files, options and version of the stopped run, or write elsewhere",
                    ),
            )),
        }
    }

    /// The file, cut off before its last whole line, which is written once more.
    ///
    /// # Errors
    /// [`Error`] when it cannot be written.
    pub(crate) fn reopen(&self) -> Result<File> {
        let open = || {
            let mut file = File::options().write(true).open(&self.path)?;
            file.set_len(self.bytes_before_last)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        open().map_err(|error| Error::io(&self.path, error))
    }

    /// The records of the whole lines but the last.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read any more.
    pub(crate) fn records(&self) -> Result<impl Iterator<Item = Result<FrameRecord>> + use<>> {
        let file = File::open(&self.path).map_err(|error| Error::io(&self.path, error))?;
        Ok(ResultsReader::new(file.take(self.bytes_before_last), &self.path))
    }

    /// The input ended before the frame that the stopped run had come to.
    pub(crate) fn never_reached(&self) -> Failure {
        Failure::input(
            Error::format(&self.path, "the input has no such frame")
                .at(Place::Frame(self.frame))
                .advise("go on with the input of the stopped run, or write elsewhere"),
        )
    }
}
