//! What the camera sees besides markers: sky, ground, sun, water.
//!
//! Radiance is in the band that lens and filter pass, in W/m^2/sr, as if all of it had the markers' wavelength.

mod daylight;
mod water;

pub use daylight::{Daylight, Sky};
pub use water::Water;
