//! Airframe files: enters a TOML of Photinus' own or an LED layout text, leaves an airframe.
//!
//! Which of the two it is shows in the content: the first line of a layout that says anything is a row of numbers.

mod layout;
mod lobe;
mod own;
mod tolerances;

use std::path::Path;

use photinus::airframe::{Airframe, AirframeError};

use crate::kind::{Kind, Syntax};
use crate::{CameraFormat, Error, Place, Result, whole};
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
    /// Where reading departed from what the file says, a sentence each.
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
/// [`Error`] with the line or the key for unknown keys, for what is not a number, for a zero axis, for the same LED
/// twice, and for a file without an LED.
pub fn parse_airframe(text: &str, path: impl AsRef<Path>) -> Result<AirframeFile> {
    let path = path.as_ref();
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let Some(first) = first else { return Err(Error::format(path, "it holds no LED").advise(KNOWN)) };
    let mut file = match Kind::of_content(text.as_bytes()) {
        Kind::Airframe | Kind::Camera(CameraFormat::OcamText) if is_row_of_layout(first) => {
            layout::parse(text, path)?
        }
        Kind::Airframe | Kind::Keys(Syntax::Toml) => own::parse(text, path)?,
        other => return Err(other.refuse(path, "an airframe", KNOWN)),
    };
    file.remark_size();
    Ok(file)
}

/// No airframe that carries UV LEDs reaches farther, m.
const LARGEST_M: f64 = 3.0;

impl AirframeFile {
    fn remark_size(&mut self) {
        let reach_m = self.airframe.max_radius_m();
        if reach_m > LARGEST_M {
            self.notes.push(format!(
                "its farthest marker is {reach_m:.2} m from the body's origin: positions are taken as metres; if they are \
                 centimetres, divide them by 100"
            ));
        }
    }
}

const KNOWN: &str = "an airframe is TOML with a ring or a list of LEDs, or an LED layout with X Y Z Type Pitch Yaw \
                     signal_id per line";

fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

/// Whether a line is of numbers, and not the first of OCamCalib text, which counts the others; seven may be a row all the same.
fn is_row_of_layout(first: &str) -> bool {
    let words: Vec<&str> = first.split_whitespace().collect();
    let counts_itself = words[0].parse().is_ok_and(|count: usize| count + 1 == words.len());
    is_number(words[0]) && (words.len() == 7 || !counts_itself)
}

/// The error of LEDs that are no airframe; `place` says where LED number `led` stands in the file.
fn refuse(path: &Path, error: AirframeError, place: impl Fn(usize, Part) -> Place) -> Error {
    use AirframeError as E;
    let (at, advice) = match error {
        E::NoLed => (None, "list every LED, in metres from the body's origin"),
        E::TooFewMarkers { .. } => (None, "give a larger radius"),
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
