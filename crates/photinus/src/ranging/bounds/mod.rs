//! Strict bounds on distance: the angles between spots -> the distances at which an airframe can show them.
//!
//! Only where the camera is in the body frame matters: in direction u, at distance l. Construction fills a
//! table, over boxes of the elevation of u and of l and every yaw: between what the widest and the narrowest
//! angle that any m visible markers show, times l, must lie. A query then asks of each box whether its angles
//! meet the measured ones; what is left is the interval. The truth never leaves it, over
//!
//! - every yaw, and every tilt of the target up to the limit; any attitude where gravity is not known;
//! - each bearing off by up to its own bound, so that an angle is off by up to the sum of two;
//! - any subset of the visible markers, those with an intensity above 0 towards the camera's very place;
//!
//! as long as the spots are distinct markers of this airframe, gravity is exact (add its error to the tilt
//! limit), and the camera is no nearer than [`DistanceBounds::near_m`]. Inside that a camera would be flying
//! in the other airframe.

mod query;
mod subsets;
mod table;
mod view;

use crate::airframe::Airframe;
use crate::camera::Bearing;
use table::Table;

/// The direction of a spot, and how far the marker's true direction can be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedBearing {
    /// Where the spot is seen.
    pub bearing: Bearing,
    /// Largest angle to the marker's true direction, rad; a number that is no bound (negative or not finite)
    /// counts as pi, nothing known.
    pub bound_rad: f64,
}

/// Strict bounds on the distance of one kind of airframe. Built once: about 0.1 s for a regular ring, 0.3 s
/// for a layout without symmetry, 1 s for the largest. Asked per group of spots: 0.2 to 0.6 us for up to 8
/// spots, without allocation.
#[derive(Clone, Debug)]
pub struct DistanceBounds {
    table: Table,
    markers: usize,
    max_tilt_rad: f64,
}

impl DistanceBounds {
    /// The tilt that a multirotor keeps within in calm flight, rad: 15 deg.
    pub const DEFAULT_MAX_TILT_RAD: f64 = core::f64::consts::PI / 12.0;

    /// Tabulates what `airframe` can show. `max_tilt_rad` is the largest angle of its z axis to the vertical;
    /// a value that is not an angle (negative or not a number) counts as pi, any attitude.
    pub fn new(airframe: &Airframe, max_tilt_rad: f64) -> Self {
        Self {
            table: Table::of(airframe),
            markers: airframe.markers().len(),
            max_tilt_rad: query::known_angle_rad(max_tilt_rad),
        }
    }

    /// The nearest distance at which the bounds hold, m: 1.02 times the airframe's largest radius, and 5 cm.
    pub fn near_m(&self) -> f64 {
        self.table.near_m()
    }
}

#[cfg(test)]
mod tests;
