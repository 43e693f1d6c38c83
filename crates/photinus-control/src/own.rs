//! What a vehicle knows of itself.

use nalgebra::{Rotation3, Vector3};

use crate::{Heading, Normal};

/// A vehicle's own state, as its own sensors tell it.
///
/// The *level frame* has its origin in the airframe's origin, z up against gravity, x horizontal where the body's forward axis
/// (x) points, y to the left. It turns with the vehicle's heading and does not tilt with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnState {
    /// Tilt: maps the body's coordinates (x forward, y left, z up) to the level frame's.
    pub level_from_body: Rotation3<f64>,
    /// Rates of the gyro in the body frame, rad/s.
    pub rates_rad_s: Vector3<f64>,
    /// Velocity over ground in the level frame's axes, m/s, where anything measures it.
    pub velocity_m_s: Option<Normal>,
    /// How far the level frame is turned from a direction that all vehicles share (north, or a first heading), counter-clockwise seen
    /// from above, where anything tells it.
    pub heading: Option<Heading>,
    /// Height above a level that all vehicles share, m, where anything measures it.
    pub height_m: Option<f64>,
}

impl OwnState {
    /// A level vehicle at rest that has neither compass nor altimeter.
    pub fn resting() -> Self {
        Self {
            level_from_body: Rotation3::identity(),
            rates_rad_s: Vector3::zeros(),
            velocity_m_s: Some(Normal::exactly(Vector3::zeros())),
            heading: None,
            height_m: None,
        }
    }

    /// How fast the level frame turns, rad/s, counter-clockwise seen from above.
    pub fn turn_rad_s(&self) -> f64 {
        (self.level_from_body * self.rates_rad_s).z
    }
}
