//! Every file format and stream that Photinus reads and writes.
//!
//! A reader returns a checked value of the `photinus` crate, or an [`Error`] that names the file, the place in it,
//! the reason and what to do.

pub mod camera;
mod error;

pub use camera::{CameraFile, CameraFormat, read_camera};
pub use error::{Cause, Error, Place, Result};
