//! What a vehicle sees of a neighbour.

use nalgebra::{Matrix3, UnitVector3, Vector3};
use photinus::locator::Distance;

/// A vector that is known up to a normal error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    /// Mean.
    pub mean: Vector3<f64>,
    /// Covariance, in the mean's unit squared.
    pub covariance: Matrix3<f64>,
}

impl Normal {
    /// A vector without error.
    pub fn exactly(mean: Vector3<f64>) -> Self {
        Self { mean, covariance: Matrix3::zeros() }
    }
}

/// An angle about the vertical that is known up to a normal error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// The angle, rad, counter-clockwise seen from above.
    pub angle_rad: f64,
    /// Its standard deviation, rad.
    pub sigma_rad: f64,
}

/// A neighbour, as one vehicle sees it: all vectors in the level frame of the vehicle that sees, from its own origin.
///
/// Bearing and bounds are what the last frame told that showed the neighbour, `age_s` ago, turned into the axes of now; position and
/// velocity are what is believed of now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The number of the track: the same as long as the neighbour is followed, of no meaning to others.
    pub track: u64,
    /// Who it is, where its code was read: the same for all who see it.
    pub identity: Option<u32>,
    /// Where its origin lies.
    pub bearing: UnitVector3<f64>,
    /// Its true direction is no further from the bearing, rad; pi where nothing is known.
    pub bearing_bound_rad: f64,
    /// How far away: the estimate, strict bounds, and the founding paper's l_A and l_B where its markers form a ring.
    pub distance: Distance,
    /// Where it is, m, where an estimate exists.
    pub position_m: Option<Normal>,
    /// How fast it moves relative to the vehicle that sees it, in axes that do not rotate, m/s.
    pub velocity_m_s: Option<Normal>,
    /// How far its level frame is turned from that of the vehicle that sees it, where its markers or messages tell.
    pub heading: Option<Heading>,
    /// How likely it exists, 0 to 1.
    pub probability: f64,
    /// Pixels of its largest spot, in the frame that showed it last: the founding paper's S.
    pub spot_px: Option<f64>,
    /// Time since it was last seen, s.
    pub age_s: f64,
}
