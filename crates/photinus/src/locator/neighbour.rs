//! What is told of a frame: its observations, and its neighbours with their evidence.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::Sighting;
use crate::camera::Bearing;
use crate::pose::{LogLight, Misfit, Mode};
use crate::ranging::{Estimate, Interval};
use crate::spots::Rejected;

/// How far away a neighbour is: from the camera's centre to the airframe's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Mean and standard deviation of the posterior; `None` only where no pose explains the spots.
    pub estimate: Option<Estimate>,
    /// Truth never leaves these, see [`crate::ranging::DistanceBounds`]; the far end may be infinite.
    pub bounds: Interval,
    /// The paper's l_A of the widest pair of neighbouring markers, m; only for rings.
    pub perpendicular_m: Option<f64>,
    /// The paper's l_B of the same pair, m.
    pub inline_m: Option<f64>,
}

/// Where a neighbour is, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Mean, m: as long as [`Distance::estimate`].
    pub mean_m: Vector3<f64>,
    /// Covariance, m^2.
    pub covariance_m2: Matrix3<f64>,
}

/// How a neighbour is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Maps the body's coordinates to the camera's. Yaw is one of those that the airframe's symmetry makes equal; where
    /// signals of spots are known, one of those that they do not tell apart.
    pub camera_from_body: Rotation3<f64>,
    /// Covariance as a small rotation in the body frame (its third axis is yaw), rad^2.
    pub covariance_rad2: Matrix3<f64>,
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    pub position_covariance_m_rad: Matrix3<f64>,
}

/// The likeliest other explanation of a neighbour's observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunnerUp {
    /// How likely it is.
    pub probability: f64,
    /// Distance of the neighbour that it then is, m; `None` where the observations are clutter.
    pub distance_m: Option<f64>,
}

/// Another robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbour {
    /// Which of the kinds that are looked for it most likely is, from 0.
    pub kind: usize,
    /// How likely it is that kind, if it is there: 1 where one kind is looked for.
    pub kind_probability: f64,
    /// Direction of the airframe's origin in the camera frame.
    pub bearing: Bearing,
    /// How far away.
    pub distance: Distance,
    /// Where, over all kinds and modes.
    pub position: Option<Position>,
    /// How turned, over all modes of its kind.
    pub orientation: Option<Orientation>,
    /// How likely it is there at all.
    pub probability: f64,
    /// How well its best mode fits.
    pub misfit: Misfit,
    /// What its observations may be otherwise.
    pub runner_up: RunnerUp,
    /// Its spots: their places in [`Located::sightings`], ascending.
    pub sightings: Vec<usize>,
    /// The ways in which they can be its airframe, the likeliest first.
    pub modes: Vec<Mode>,
}

/// What one frame told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Located {
    /// Spots with their bearings.
    pub sightings: Vec<Sighting>,
    /// Bright regions that are not markers.
    pub rejected: Vec<Rejected>,
    /// The neighbours, in the order of their first sighting.
    pub neighbours: Vec<Neighbour>,
    /// Whether the frame was explained within the budget; if not, neighbours may be missing.
    pub is_complete: bool,
    /// Light at which a marker is found half of the time, in the unit of the sightings' light, and how much that differs from marker to marker; `None` before a
    /// frame.
    pub detection_limit: Option<LogLight>,
    /// How often a marker that must show does not, as the frames before told it; `None` before a frame.
    pub miss_rate: Option<f64>,
    /// Standard deviation of neighbours' tilts, per axis, with the error of the known gravity, rad, as the frames before told it, and no less than
    /// [`crate::pose::Settings::tilt_sigma_rad`]; `None` before a frame.
    pub tilt_sigma_rad: Option<f64>,
    /// How many times as much as [`crate::pose::Settings::unit_sigma`] says the power of LEDs spreads, as the frames before told it, and no less than once; `None`
    /// before a frame. Far more than once where lobes or powers are not as the airframe's file has them.
    pub light_times: Option<f64>,
}
