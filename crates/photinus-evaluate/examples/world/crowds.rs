//! The crowd table: 5 to 50 vehicles of a kind at random places.

use crate::row::{Eye, Row};

/// The rows, with how many frames each has for `frames` of single vehicles.
pub(crate) fn rows(eye: &Eye, frames: u64) -> Vec<(Row, u64)> {
    let mut rows = Vec::new();
    for arms in [6, 4, 8] {
        for vehicles in [5_usize, 10, 20, 50] {
            let mut row = Row::plain(format!("{vehicles} vehicles"), eye, arms);
            row.vehicles = vehicles;
            row.ranges_m = [3.0, 15.0];
            rows.push((row, (frames / vehicles as u64).max(1)));
        }
    }
    rows
}
