//! Places in the image of what is known in the body frame.

use std::path::Path;

use nalgebra::Vector3;

use super::columns;
use crate::{Result, whole};

const COLUMNS: [&str; 9] = ["u_px", "v_px", "x", "y", "z", "x_m", "y_m", "z_m", "sigma_px"];

/// What is known of something seen, in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The direction to it, of any length but 0: it is far away.
    Direction(Vector3<f64>),
    /// Where it is, m.
    Position(Vector3<f64>),
}

/// A place in the image of something that is known in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownSighting {
    /// The line of the file, counted from 1.
    pub line: usize,
    /// Column, px.
    pub u_px: f64,
    /// Row, px.
    pub v_px: f64,
    /// What is known of it.
    pub known: Known,
    /// Standard deviation of either coordinate, px, where the table says so.
    pub sigma_px: Option<f64>,
}

/// Reads a table of known directions or positions.
///
/// # Errors
/// As [`parse_known_sightings`], and when the file cannot be read.
pub fn read_known_sightings(path: impl AsRef<Path>) -> Result<Vec<KnownSighting>> {
    parse_known_sightings(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of a table with the columns `u_px,v_px,x,y,z[,sigma_px]` for directions, or `u_px,v_px,x_m,y_m,z_m` for
/// positions; with all of them, each row fills in one of the two. `path` is for the messages.
///
/// # Errors
/// [`crate::Error`] with the line for other columns, for what is not a number, for a direction of length 0, and for a row with
/// both or neither.
pub fn parse_known_sightings(text: &str, path: impl AsRef<Path>) -> Result<Vec<KnownSighting>> {
    let rows = columns::rows(text, path.as_ref(), &COLUMNS, &COLUMNS[..2])?;
    rows.iter()
        .map(|row| {
            let is_given = |names: [&str; 3]| names.iter().any(|name| !row.cell(name).is_empty());
            let vector = |[x, y, z]: [&str; 3]| -> Result<Vector3<f64>> {
                Ok(Vector3::new(row.number(x)?, row.number(y)?, row.number(z)?))
            };
            let (direction, position) = (["x", "y", "z"], ["x_m", "y_m", "z_m"]);
            let known = match (is_given(direction), is_given(position)) {
                (true, false) => Known::Direction(vector(direction)?),
                (false, true) => Known::Position(vector(position)?),
                _ => {
                    let advice =
                        "fill in x, y, z (a direction) or x_m, y_m, z_m (a position), both in the body frame";
                    return Err(row.refuse("it says neither or both of direction and position", advice));
                }
            };
            if let Known::Direction(vector) | Known::Position(vector) = known
                && !(vector.norm() > 0.0 && vector.norm().is_finite())
            {
                return Err(row.refuse(
                    format!("[{}, {}, {}] has no direction", vector.x, vector.y, vector.z),
                    "x is forward, y left, z up",
                ));
            }
            let (u_px, v_px) = (row.number("u_px")?, row.number("v_px")?);
            Ok(KnownSighting { line: row.line, u_px, v_px, known, sigma_px: row.optional("sigma_px")? })
        })
        .collect()
}
