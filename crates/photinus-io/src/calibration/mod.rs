//! What calibrations are made from and what they give: tables of measurements (CSV) in, a mounting (TOML) in and out.
//!
//! The tables have a line that names the columns, in any order, then a row per measurement; `#` begins a comment. A column
//! that is not known is refused, as is what should be a number and is not.

mod columns;
mod known;
mod led_sightings;
mod mounting;
mod spot_sizes;
#[cfg(test)]
mod tests;

pub use known::{Known, KnownSighting, parse_known_sightings, read_known_sightings};
pub use led_sightings::{LedSighting, parse_led_sightings, read_led_sightings};
pub use mounting::{MountingFile, mounting_text, parse_mounting, read_mounting};
pub use spot_sizes::{SpotSizeRow, parse_spot_sizes, read_spot_sizes};
