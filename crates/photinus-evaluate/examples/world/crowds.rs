//! The crowd table: 5 to 50 vehicles of a kind at random places, with gravity and without.

use crate::row::{Eye, Row};

/// The rows, with how many frames each has for `frames` of single vehicles.
pub(crate) fn rows(eye: &Eye, frames: u64) -> Vec<(Row, u64)> {
    let mut rows = Vec::new();
    for arms in [6, 4, 8] {
        for (vehicles, knows_gravity) in
            [(5_usize, true), (10, true), (20, true), (20, false), (50, true), (50, false)]
        {
            let gravity = if knows_gravity { "" } else { ", gravity not known" };
            let mut row = Row::plain(format!("{vehicles} vehicles{gravity}"), eye, arms);
            row.vehicles = vehicles;
            row.knows_gravity = knows_gravity;
            row.ranges_m = [3.0, 15.0];
            rows.push((row, (frames / vehicles as u64).max(1)));
        }
    }
    rows
}
