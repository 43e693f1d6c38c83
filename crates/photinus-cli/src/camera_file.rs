//! The camera file that a user named, read; every refusal says what to do.

use std::path::Path;

use photinus_io::{CameraFile, Cause, Error, Result, read_camera};

/// Reads a camera file of any format.
///
/// # Errors
/// As [`read_camera`], with advice where it gives none.
pub(crate) fn read(path: &Path) -> Result<CameraFile> {
    read_camera(path).map_err(|error| match error {
        Error { cause: Cause::Io(cause), file, .. } => Error::io(file, cause),
        error if error.advice.is_empty() => error.advise("correct it there, or export the calibration again"),
        error => error,
    })
}
