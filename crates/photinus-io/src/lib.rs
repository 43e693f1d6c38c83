//! Every file format and stream that Photinus reads and writes.
//!
//! A reader returns a checked value of the `photinus` crate, or an [`Error`] that names the file, the place in it,
//! the reason and what to do. A number from a file is never trusted: it may be NaN, infinite, huge or negative.
//!
//! ```no_run
//! use photinus::locator::{Input, Locator, Settings};
//! use photinus_io::airframe::read_airframe;
//! use photinus_io::dataset::Dataset;
//! use photinus_io::frames::FrameSource;
//! use photinus_io::read_camera;
//!
//! let dataset = Dataset::read("recording")?;
//! let camera = read_camera(dataset.path(&dataset.info().camera))?.camera;
//! let airframe = read_airframe(&dataset.airframes()[0])?.airframe;
//! let mut locator = Locator::new(camera, &airframe, None, Settings::default())?;
//! for frame in FrameSource::dataset(dataset) {
//!     let frame = frame?;
//!     let located = locator.locate(Input::frame(&frame.image.view()).gravity(frame.gravity.as_ref()))?;
//!     println!("{}: {} neighbours", frame.source, located.neighbours.len());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ```text
//! image, video, dataset -> frames -> (photinus) -> results
//! camera, airframe, mask, codes, spot_curve: what the method is told beforehand
//! calibration: tables that calibrations are made from
//! kind: which of these a file is, by its content
//! content: why a well-formed file is not what it should be
//! whole: files that are read and written whole or not at all
//! ```

pub mod airframe;

pub mod calibration;
pub mod camera;
pub mod codes;
mod content;
pub mod corners;
pub mod dataset;
mod error;
pub mod frames;
pub mod image;
pub mod kind;
mod lines;
pub mod mask;
pub mod physics;
pub mod results;
#[cfg(test)]
mod scratch;
pub mod sky;
pub mod spot_curve;
pub mod table;
pub mod video;
pub mod whole;

pub use camera::{CameraFile, CameraFormat, read_camera};
pub use content::{ContentError, Found, Wanted};
pub use error::{Cause, Error, Place, Result};
