//! Places of an airframe's LEDs in photos.

use std::path::Path;

use super::columns;
use crate::{Result, whole};

const COLUMNS: [&str; 5] = ["photo", "led", "u_px", "v_px", "sigma_px"];

/// Where an LED is in a photo.
#[derive(Clone, Debug, PartialEq)]
pub struct LedSighting {
    /// The line of the file, counted from 1.
    pub line: usize,
    /// Which photo: any name without a comma.
    pub photo: String,
    /// Which LED of the airframe, counted from 0.
    pub led: usize,
    /// Column, px.
    pub u_px: f64,
    /// Row, px.
    pub v_px: f64,
    /// Standard deviation of either coordinate, px, where the table says so.
    pub sigma_px: Option<f64>,
}

/// Reads a table of LEDs in photos.
///
/// # Errors
/// As [`parse_led_sightings`], and when the file cannot be read.
pub fn read_led_sightings(path: impl AsRef<Path>) -> Result<Vec<LedSighting>> {
    parse_led_sightings(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of a table with the columns `photo,led,u_px,v_px[,sigma_px]`; `path` is for the messages.
///
/// # Errors
/// [`crate::Error`] with the line for other columns, for what is not a number, for an empty name, and for an LED that a photo
/// shows twice.
pub fn parse_led_sightings(text: &str, path: impl AsRef<Path>) -> Result<Vec<LedSighting>> {
    let rows = columns::rows(text, path.as_ref(), &COLUMNS, &COLUMNS[..4])?;
    let mut first_lines = std::collections::BTreeMap::new();
    rows.iter()
        .map(|row| {
            let (photo, led) = (row.cell("photo").to_owned(), row.whole("led")?);
            if photo.is_empty() {
                return Err(
                    row.refuse("the photo has no name", "name the photo: rows of one photo share its name")
                );
            }
            if let Some(first) = first_lines.insert((photo.clone(), led), row.line) {
                let reason = format!("line {first} has LED {led} of photo {photo} already");
                return Err(row.refuse(reason, "keep one of the two"));
            }
            let (u_px, v_px) = (row.number("u_px")?, row.number("v_px")?);
            Ok(LedSighting { line: row.line, photo, led, u_px, v_px, sigma_px: row.optional("sigma_px")? })
        })
        .collect()
}
