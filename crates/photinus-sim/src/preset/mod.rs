//! Cameras and LEDs as fitted sets of physical parameters.
//!
//! What a data sheet or the paper says is fixed; the rest ([`Fitted`]) is found by the program
//! `cargo run --release -p photinus-sim --example fit_preset`, whose result stands here as constants.

mod bluefox;
mod small_fisheye;

pub use bluefox::{BLUEFOX_FIT, bluefox};
pub use small_fisheye::{SMALL_FISHEYE_FIT, SmallFisheyeFit, small_fisheye};

use crate::optics::Lens;
use crate::sensor::Sensor;
use crate::source::Emitter;

/// A camera with the LEDs it was fitted with.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// The LED.
    pub emitter: Emitter,
    /// The lens and its filter.
    pub lens: Lens,
    /// The sensor.
    pub sensor: Sensor,
}

/// What no data sheet says of the paper's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Sigma of the point spread's core, px.
    pub core_px: f64,
    /// Share of the light in the skirt around it.
    pub skirt_share: f64,
    /// Sigma of the skirt, px.
    pub skirt_px: f64,
    /// Full well, in units of the charge at which the converter saturates.
    pub well: f64,
    /// Share of a pixel's overflow that reaches its neighbours.
    pub spill: f64,
    /// Share of the light that passes lens and filter; it stands for the LED's current too, which is not known.
    pub transmission: f64,
}
