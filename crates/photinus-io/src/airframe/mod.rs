//! Airframe files: enters a TOML of Photinus' own or an LED layout text, leaves an airframe.
//!
//! Which of the two it is shows in the content: the first line of a layout that says anything is a row of numbers.

mod layout;
mod own;

use std::path::Path;

use photinus::airframe::{Airframe, AirframeError};

use crate::{Error, Place, Result, whole};
pub use layout::layout_text;
pub use own::toml_text;

/// An airframe as read.
#[derive(Clone, Debug, PartialEq)]
pub struct AirframeFile {
    /// The airframe.
    pub airframe: Airframe,
    /// What was read otherwise than it stands in the file, a sentence each.
    pub notes: Vec<String>,
}

/// Reads an airframe file.
///
/// # Errors
/// As [`parse_airframe`], and when the file cannot be read.
pub fn read_airframe(path: impl AsRef<Path>) -> Result<AirframeFile> {
    let path = path.as_ref();
    parse_airframe(&whole::read_text(path)?, path)
}

/// Reads the text of an airframe file; `path` is for the messages, and its stem names an airframe that has no name.
///
/// # Errors
/// [`Error`] with the line or the key for unknown keys, for numbers that are none, for a zero axis, for the same LED
/// twice, and for LEDs that form fewer than two markers.
pub fn parse_airframe(text: &str, path: impl AsRef<Path>) -> Result<AirframeFile> {
    let path = path.as_ref();
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    match first {
        None => Err(Error::format(path, "it holds no LED").advise("see docs/file-formats.md for an example")),
        Some(line) if line.split_whitespace().next().is_some_and(is_number) => layout::parse(text, path),
        Some(_) => own::parse(text, path),
    }
}

/// The error of LEDs that are no airframe; `place` says where LED number `led` stands in the file.
fn refuse(path: &Path, error: AirframeError, place: impl Fn(usize, Part) -> Place) -> Error {
    use AirframeError as E;
    let (at, advice) = match error {
        E::TooFewMarkers { .. } => (None, "list every LED, in metres from the body's origin"),
        E::TooManyLeds { .. } => (None, "list the LEDs of one airframe"),
        E::NotFinite { led } => (Some((led, Part::Position)), "give finite numbers"),
        E::Axis { led } => (Some((led, Part::Axis)), "give the direction in which the LED shines"),
        E::TooFar { led, .. } => (Some((led, Part::Position)), "give the position in metres"),
        E::Duplicate { second, .. } => (Some((second, Part::Whole)), "LEDs are counted from 0"),
        _ => (None, "see docs/file-formats.md for an example"),
    };
    let refused = Error::new(path, error).advise(advice);
    match at {
        Some((led, part)) => refused.at(place(led, part)),
        None => refused,
    }
}

/// Which part of an LED's entry is wrong.
#[derive(Clone, Copy)]
enum Part {
    Position,
    Axis,
    Whole,
}

#[cfg(test)]
mod tests;
