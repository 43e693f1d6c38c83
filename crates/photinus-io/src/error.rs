//! The one error of this crate: which file, where in it, what is wrong, what to do.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::content::ContentError;

/// Shorthand for a result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// What is wrong with a file, where in it, and what to do.
#[derive(Debug)]
pub struct Error {
    /// The file or stream (`-` is standard input).
    pub file: PathBuf,
    /// Where in it, when that is known.
    pub place: Option<Place>,
    /// What is wrong.
    pub cause: Cause,
    /// What the reader of the message can do about it; empty when there is nothing to say.
    pub advice: String,
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(usize),
    /// A byte of a line, both counted from 1.
    #[expect(missing_docs, reason = "the names say it")]
    Column { line: usize, column: usize },
    /// A key of a structured file, such as `led[3].axis`.
    Key(String),
    /// A frame of a stream, counted from 0.
    Frame(u64),
}

/// What is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The last line of a stream of lines is no whole one: whoever wrote it was stopped.
    #[error("the last line is cut: the run that wrote it was stopped")]
    Cut,
    /// The text or bytes do not follow the format.
    #[error("{0}")]
    Format(String),
    /// The text is of the format, and its keys or values are not those that belong there.
    #[error("{0}")]
    Content(Box<ContentError>),
    /// The pixels do not make a frame.
    #[error("{0}")]
    Frame(#[from] photinus::frame::FrameError),
    /// The LEDs do not make an airframe.
    #[error("{0}")]
    Airframe(#[from] photinus::airframe::AirframeError),
    /// The numbers do not make a camera.
    #[error("{0}")]
    Camera(#[from] photinus::camera::CameraError),
}

impl From<ContentError> for Cause {
    fn from(error: ContentError) -> Self {
        Self::Content(Box::new(error))
    }
}

impl Error {
    /// An error in `file` with `cause`; add the rest with [`Error::at`] and [`Error::advise`].
    pub fn new(file: impl AsRef<Path>, cause: impl Into<Cause>) -> Self {
        Self { file: file.as_ref().to_owned(), place: None, cause: cause.into(), advice: String::new() }
    }

    /// The operating system refused to read or write `file`.
    pub fn io(file: impl AsRef<Path>, cause: std::io::Error) -> Self {
        let advice = match cause.kind() {
            ErrorKind::NotFound => "check the path, which is taken from the current folder",
            ErrorKind::PermissionDenied => "check the permissions of the file and its folder",
            ErrorKind::IsADirectory => "name a file, not a folder",
            ErrorKind::InvalidData => "check that it is a text file in UTF-8",
            ErrorKind::AlreadyExists => "remove it, or write elsewhere",
            ErrorKind::StorageFull => "free some space and run again",
            _ => "",
        };
        Self::new(file, cause).advise(advice)
    }

    /// A file that does not follow its format, for this reason.
    pub fn format(file: impl AsRef<Path>, reason: impl Into<String>) -> Self {
        Self::new(file, Cause::Format(reason.into()))
    }

    /// Says where in the file.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Says what to do.
    #[must_use]
    pub fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = advice.into();
        self
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Column { line, column } => write!(f, "line {line}: column {column}"),
            Place::Key(key) => write!(f, "`{key}`"),
            Place::Frame(frame) => write!(f, "frame {frame}"),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.file.as_os_str() == "-" {
            true => write!(f, "standard input")?,
            false => write!(f, "{}", self.file.display())?,
        }
        if let Some(place) = &self.place {
            write!(f, ", {place}")?;
        }
        write!(f, ": {}", self.cause)?;
        if !self.advice.is_empty() {
            write!(f, "; {}", self.advice)?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}
