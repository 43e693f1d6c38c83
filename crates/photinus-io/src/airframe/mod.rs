//! Airframe files: enters a TOML of Photinus' own or an LED layout text, leaves an airframe.
//!
//! Which of the two it is shows in the content: the first line of a layout that says anything is a row of numbers.

mod layout;
mod lobe;
mod own;
mod tolerances;

use std::path::Path;

use photinus::airframe::{Airframe, AirframeError};

use crate::{Error, Place, Result, whole};
pub use layout::layout_text;
pub use own::toml_text;
pub use tolerances::Tolerances;

/// An airframe as read.
#[derive(Clone, Debug, PartialEq)]
pub struct AirframeFile {
    /// The airframe.
    pub airframe: Airframe,
    /// How well it is known.
    pub tolerances: Tolerances,
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
    let Some(first) = first else { return Err(Error::format(path, "it holds no LED").advise(KNOWN)) };
    if let Some(other) = other_kind(first, text) {
        return Err(Error::format(path, format!("this looks like {other}, not an airframe")).advise(KNOWN));
    }
    match first.split_whitespace().next().is_some_and(is_number) {
        true => layout::parse(text, path),
        false => own::parse(text, path),
    }
}

const KNOWN: &str = "an airframe is TOML with a ring or a list of LEDs, or an LED layout with X Y Z Type Pitch Yaw \
                     signal_id per line";

fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

/// What a text is that is no airframe, by its `first` line that says anything.
fn other_kind(first: &str, text: &str) -> Option<&'static str> {
    let words: Vec<&str> = first.split_whitespace().collect();
    if words.iter().all(|word| word.split(',').all(|bit| matches!(bit, "" | "0" | "1")))
        && first.contains(',')
    {
        return Some("a list of blink sequences");
    }
    if words.first().is_some_and(|word| is_number(word)) {
        let count = words[0].parse().is_ok_and(|count: usize| count + 1 == words.len());
        return (count && words.len() != 7).then_some("a camera in OCamCalib text");
    }
    let is_toml = first.starts_with('[') || first.contains('=');
    let is_camera = |line: &str| line.split('=').next().is_some_and(|key| key.trim() == "model");
    match is_toml {
        true => text.lines().any(is_camera).then_some("a camera"),
        false if first.starts_with('{') => Some("JSON"),
        false if first.contains(':') => Some("YAML"),
        false => Some("some other text"),
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
        E::Power { led, .. } => (Some((led, Part::Power)), "give its light against the mean of its kind"),
        E::Lobe { led, .. } => (
            Some((led, Part::Lobe)),
            "give a power of the cosine, or as many angles from the axis as intensities",
        ),
        E::TooFar { led, .. } => (Some((led, Part::Position)), "give the position in metres"),
        E::Duplicate { second, .. } => (Some((second, Part::Whole)), "LEDs are counted from 0"),
        _ => (None, KNOWN),
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
    Lobe,
    Power,
    Whole,
}

#[cfg(test)]
mod tests;
