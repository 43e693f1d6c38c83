//! The accuracy snapshot: a dozen rows, small, the same bit for bit everywhere.

use photinus_sim::faults::{Fault, Lamp};

use crate::cameras;
use crate::row::{Outcome, Row};
use crate::table::Table;

/// Where the committed table is.
pub(crate) const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/accuracy-snapshot.txt");
/// What writes it anew.
pub(crate) const UPDATE: &str =
    "cargo run --release -p photinus-evaluate --example world -- snapshot --update";

/// Frames of a row with a single vehicle.
const FRAMES: u64 = 40;

fn rows() -> Vec<(Row, u64)> {
    let eye = cameras::paper();
    let with = |name: &str, arms: usize, change: &dyn Fn(&mut Row)| {
        let mut row = Row::plain(name, &eye, arms);
        change(&mut row);
        (row, FRAMES)
    };
    let crowd = |vehicles: usize, arms: usize| {
        let mut row = Row::plain(format!("{vehicles} vehicles"), &eye, arms);
        row.vehicles = vehicles;
        row.ranges_m = [3.0, 15.0];
        (row, FRAMES / vehicles as u64)
    };
    let gravity_rad = 5.0 * std::f64::consts::PI / 180.0;
    let faulty = |name: &str, arms: usize, fault: Fault| with(name, arms, &|row| row.faults = vec![fault]);
    vec![
        with("none", 6, &|_| ()),
        with("none", 4, &|_| ()),
        with("none", 8, &|_| ()),
        with("dead LED", 6, &|row| row.build.dead_led = true),
        with("smear of 3 px", 4, &|row| row.smear_px = 3.0),
        faulty("foreign lamp 25 px beside", 4, Fault::Lamp(Lamp::Beside { gap_px: 25.0 })),
        faulty("30 hot pixels", 6, Fault::Hot(30)),
        faulty("noise of 8 levels", 4, Fault::Noise(8.0)),
        faulty("gravity 5 deg wrong", 6, Fault::Gravity(gravity_rad)),
        faulty("airframe told 2 % too large", 6, Fault::Airframe(1.02)),
        with("camera full-240", 4, &|row| row.eye = cameras::named("full-240")),
        with("camera coma", 6, &|row| row.eye = cameras::named("coma")),
        crowd(5, 6),
        crowd(10, 4),
    ]
}

/// The table as it is today.
pub(crate) fn text() -> String {
    let outcomes: Vec<Outcome> = rows().iter().map(|(row, frames)| row.run(*frames)).collect();
    let (neighbours, spots) = (Table::of_neighbours(&outcomes), Table::of_spots(&outcomes));
    format!(
        "Accuracy with default options. A change of it shows here: look whether it is meant, then\n{UPDATE}\n\n{}\n\
         Squared error of centre and light over the claim (spots), 1 is right\n\n{}",
        neighbours.aligned(),
        spots.aligned()
    )
}
