//! truth.jsonl: where everything was, a line per frame.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{Result, lines, whole};

/// Where the neighbours were in one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TruthFrame {
    /// Number of the frame, as in frames.csv.
    pub frame: u64,
    /// The camera's name, where the dataset has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// When it was taken, s, as frames.csv has it.
    #[serde(deserialize_with = "limits::time")]
    pub time_s: f64,
    /// When it was taken indeed, s, on the clock of imu.csv and odometry.csv, where that is another time.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "limits::maybe_time")]
    pub true_time_s: Option<f64>,
    /// Those that were there, seen or not.
    pub neighbours: Vec<TruthNeighbour>,
}

/// Where a neighbour was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthNeighbour {
    /// Which one.
    pub id: u32,
    /// Its origin in the camera frame, m.
    #[serde(deserialize_with = "limits::place")]
    pub position_m: [f64; 3],
    /// Its attitude: the rotation camera_from_body as x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// From the camera's centre to its origin, m.
    pub distance_m: f64,
    /// How its place changes, m/s: relative to the camera, in axes that do not rotate and are the camera's at that time, where known.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "limits::maybe_velocity")]
    pub velocity_m_s: Option<[f64; 3]>,
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
    /// Whether every number of it is finite: JSON has no others.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = |n: &TruthNeighbour| {
            let leds = n.leds.iter().all(|led| led.u_px.is_finite() && led.v_px.is_finite());
            leds && n
                .position_m
                .iter()
                .chain(&n.orientation_xyzw)
                .chain(n.velocity_m_s.iter().flatten())
                .chain([&n.distance_m])
                .all(|x| x.is_finite())
        };
        self.time_s.is_finite()
            && self.true_time_s.is_none_or(f64::is_finite)
            && self.neighbours.iter().all(numbers)
    }
}

/// Numbers that a flight can have, or an error at their place in the line.
mod limits {
    use std::ops::RangeInclusive;

    use serde::de::{Deserialize, Deserializer, Error};

    use crate::physics;

    fn check<E: Error>(value: f64, range: &RangeInclusive<f64>) -> Result<f64, E> {
        let refuse = || E::custom(format!("{value:?} is out of range; {}", physics::advice(range)));
        range.contains(&value).then_some(value).ok_or_else(refuse)
    }

    pub(super) fn time<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        check(f64::deserialize(deserializer)?, &physics::TIME_S)
    }

    pub(super) fn maybe_time<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
        let time_s = Option::<f64>::deserialize(deserializer)?;
        time_s.map(|time_s| check(time_s, &physics::TIME_S)).transpose()
    }

    pub(super) fn place<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
        let place_m = <[f64; 3]>::deserialize(deserializer)?;
        place_m.iter().try_for_each(|x| check(*x, &physics::PLACE_M).map(|_| ()))?;
        Ok(place_m)
    }

    pub(super) fn maybe_velocity<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<[f64; 3]>, D::Error> {
        let velocity_m_s = Option::<[f64; 3]>::deserialize(deserializer)?;
        velocity_m_s.iter().flatten().try_for_each(|x| check(*x, &physics::SPEED_M_S).map(|_| ()))?;
        Ok(velocity_m_s)
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
