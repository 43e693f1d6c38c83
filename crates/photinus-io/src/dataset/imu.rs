//! imu.csv: how fast what carries the camera turns.

use std::path::Path;

use nalgebra::Vector3;

use super::timed::{self, Column};
use crate::{Result, physics, whole};

const COLUMNS: [Column; 4] = [
    ("time_s", physics::TIME_S),
    ("wx_rad_s", physics::TURN_RAD_S),
    ("wy_rad_s", physics::TURN_RAD_S),
    ("wz_rad_s", physics::TURN_RAD_S),
];

/// A line of imu.csv.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuRow {
    /// When it was measured, s.
    pub time_s: f64,
    /// Rate of turn against the world, rad/s: in the camera's own frame where the dataset has one camera, in the vehicle's body
    /// frame where it has `[[camera]]` with mountings.
    pub turn_rad_s: Vector3<f64>,
}

/// Reads an imu.csv.
///
/// # Errors
/// As [`parse_imu`], and when the file cannot be read.
pub fn read_imu(path: impl AsRef<Path>) -> Result<Vec<ImuRow>> {
    parse_imu(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of an imu.csv; `path` is for the messages.
///
/// # Errors
/// [`crate::Error`] with the line for other columns, what is no number, a rate that nothing turns at, and times that do not grow.
pub fn parse_imu(text: &str, path: impl AsRef<Path>) -> Result<Vec<ImuRow>> {
    let rows = timed::rows(text, path.as_ref(), &COLUMNS)?;
    let row =
        |(_, [time_s, x, y, z]): (usize, [f64; 4])| ImuRow { time_s, turn_rad_s: Vector3::new(x, y, z) };
    Ok(rows.into_iter().map(row).collect())
}

/// The first line of an imu.csv.
pub(super) fn header() -> String {
    timed::header(&COLUMNS)
}

impl ImuRow {
    /// As a line of the file, without its end; it is read back bit for bit.
    pub fn line(&self) -> String {
        let turn = &self.turn_rad_s;
        format!("{},{},{},{}", self.time_s, turn.x, turn.y, turn.z)
    }
}
