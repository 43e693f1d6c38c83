//! Pixel <-> bearing, and how sure a direction is.

mod bearing;

pub use bearing::{Bearing, Pixel};
