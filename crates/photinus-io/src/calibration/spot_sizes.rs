//! Areas of spots at known distances.

use std::path::Path;

use super::columns;
use crate::{Result, whole};

const COLUMNS: [&str; 3] = ["distance_m", "area_px", "exposure_us"];

/// One spot of an LED at a known distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotSizeRow {
    /// From the camera to the LED, m; above 0.
    pub distance_m: f64,
    /// Pixels of the spot; 0 where none was found.
    pub area_px: u32,
    /// Exposure of the frame, us, where the table says so.
    pub exposure_us: Option<f64>,
}

/// Reads a table of spot sizes.
///
/// # Errors
/// As [`parse_spot_sizes`], and when the file cannot be read.
pub fn read_spot_sizes(path: impl AsRef<Path>) -> Result<Vec<SpotSizeRow>> {
    parse_spot_sizes(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of a table with the columns `distance_m,area_px[,exposure_us]`; `path` is for the messages.
///
/// # Errors
/// [`crate::Error`] with the line for other columns, and for what is not a number.
pub fn parse_spot_sizes(text: &str, path: impl AsRef<Path>) -> Result<Vec<SpotSizeRow>> {
    let rows = columns::rows(text, path.as_ref(), &COLUMNS, &COLUMNS[..2])?;
    rows.iter()
        .map(|row| {
            Ok(SpotSizeRow {
                distance_m: row.positive("distance_m")?,
                area_px: row.whole("area_px")?,
                exposure_us: row.optional("exposure_us")?,
            })
        })
        .collect()
}
