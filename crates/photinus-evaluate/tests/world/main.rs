//! What the example `world` shows, in small: accuracy as it was committed, crowds, and what the detector finds before other cameras.

#![allow(dead_code, reason = "the example prints more than the tests look at")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod accuracy;
#[path = "../../examples/world/calibrated.rs"]
mod calibrated;
#[path = "../../examples/world/cameras.rs"]
mod cameras;
mod crowds;
mod detection_limit;
mod gravity;
#[path = "../../examples/world/light.rs"]
mod light;
#[path = "../../examples/world/priors.rs"]
mod priors;
#[path = "../../examples/world/row.rs"]
mod row;
#[path = "../../examples/world/snapshot.rs"]
mod snapshot;
#[path = "../../examples/world/table.rs"]
mod table;
