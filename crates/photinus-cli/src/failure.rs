//! Why the program stops, and with which exit code.

use std::io::ErrorKind;
use std::process::ExitCode;

use photinus_io::{Cause, Error};

use crate::interrupt;

/// Why the program stops early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad usage or input, found before any work: exit 2.
    Input(String),
    /// Something broke while running: exit 1.
    Running(String),
    /// Frames failed and were reported one by one; none came through: exit 2, else exit 1.
    Frames {
        /// Whether there was no good one among them.
        all: bool,
    },
    /// An output failed and was reported; the others are whole: exit 1.
    Output,
    /// The reader of standard output has had enough, as `head` does: no failure.
    Closed,
    /// Somebody asked the run to end: exit 130. Says where it ended.
    Interrupted(String),
}

impl Failure {
    /// A file that is wrong before any work is done.
    pub(crate) fn input(error: Error) -> Self {
        Self::Input(error.to_string())
    }

    /// A file that breaks while running.
    pub(crate) fn running(error: Error) -> Self {
        match &error.cause {
            Cause::Io(cause) if cause.kind() == ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::Running(error.to_string()),
        }
    }

    /// What is still to be said.
    pub(crate) fn message(&self) -> Option<&str> {
        match self {
            Self::Input(message) | Self::Running(message) | Self::Interrupted(message) => Some(message),
            Self::Frames { .. } | Self::Output | Self::Closed => None,
        }
    }

    /// What the caller of the program sees.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Input(_) | Self::Frames { all: true } => ExitCode::from(2),
            Self::Running(_) | Self::Output | Self::Frames { all: false } => ExitCode::from(1),
            Self::Interrupted(_) => interrupt::exit_code(),
            Self::Closed => ExitCode::SUCCESS,
        }
    }
}
