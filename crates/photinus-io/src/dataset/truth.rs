//! truth.jsonl: where everything was, a line per frame.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{Result, lines, whole};

/// Where the neighbours were in one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthFrame {
    /// Number of the frame, as in frames.csv.
    pub frame: u64,
    /// When it was taken, s.
    pub time_s: f64,
    /// Those that were there, seen or not.
    pub neighbours: Vec<TruthNeighbour>,
}

/// Where a neighbour was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthNeighbour {
    /// Which one.
    pub id: u32,
    /// Its origin in the camera frame, m.
    pub position_m: [f64; 3],
    /// Its attitude: the rotation camera_from_body as x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// From the camera's centre to its origin, m.
    pub distance_m: f64,
    /// Those of its LEDs that shone into the image.
    pub leds: Vec<TruthLed>,
}

/// Where an LED was in the image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthLed {
    /// Column, px.
    pub u_px: f64,
    /// Row, px.
    pub v_px: f64,
    /// Which LED of the airframe, where that was noted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub led: Option<u32>,
}

impl TruthFrame {
    /// Whether every number of it is one: JSON has no others.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = |n: &TruthNeighbour| {
            let leds = n.leds.iter().all(|led| led.u_px.is_finite() && led.v_px.is_finite());
            leds && n
                .position_m
                .iter()
                .chain(&n.orientation_xyzw)
                .chain([&n.distance_m])
                .all(|x| x.is_finite())
        };
        self.time_s.is_finite() && self.neighbours.iter().all(numbers)
    }
}

/// Reads a truth.jsonl.
///
/// # Errors
/// [`crate::Error`] with the line for what is not a truth record.
pub fn read_truth(path: impl AsRef<Path>) -> Result<Vec<TruthFrame>> {
    let path = path.as_ref();
    parse_truth(&whole::read_text(path)?, path)
}

/// Reads the text of a truth.jsonl; `path` is for the messages.
///
/// # Errors
/// As [`read_truth`].
pub fn parse_truth(text: &str, path: impl AsRef<Path>) -> Result<Vec<TruthFrame>> {
    lines::JsonLines::new(text.as_bytes(), path).collect()
}
