//! What is known of a neighbour besides its spots: which way is up, how far it can be, which of its markers would be found.

use nalgebra::{Unit, Vector3};

use crate::camera::{Bearing, Watched};
use crate::optics::LogLight;
use crate::ranging::Interval;

/// What is known of a neighbour besides its spots.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Away from the ground, camera frame.
    pub up: Option<Unit<Vector3<f64>>>,
    /// Truth is between these.
    pub bounds: Interval,
    /// What spot size says of distance, where nothing better does.
    pub size: Option<LogDistance>,
    /// Light of an LED of intensity 1 at 1 m, in the units of the observations, where other neighbours tell it.
    pub power: Option<LogLight>,
    /// Standard deviation of a neighbour's tilt, per axis, with the error of the known gravity, rad, where frames tell it; as the settings have it where that is `None`.
    pub tilt_sigma_rad: Option<f64>,
    /// Spread of power between LEDs of one kind, sigma of its natural logarithm, where frames tell it; as the settings have it where that is `None`.
    pub unit_sigma: Option<f64>,
    /// Which markers are found.
    pub visible: Visible<'a>,
}

/// A normal distribution of the logarithm of distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogDistance {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sigma: f64,
}

/// Which markers a detector finds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Visible<'a> {
    /// Light at which a marker is found half of the time, in the units of the observations, and how much that differs from marker to marker; `None` where
    /// unknown.
    pub detection_limit: Option<LogLight>,
    /// How often a marker that must show does not, where frames told it; as the settings have it where that is `None`.
    pub miss_rate: Option<f64>,
    /// Where the camera looks; everywhere where that is `None`.
    pub watched: Option<Watched<'a>>,
    /// Spots that are not this neighbour's, near it: a marker beside one of them may be merged with it.
    pub others: &'a [Bearing],
    /// How likely each marker is lit in this frame, by marker; those beyond its end are.
    pub lit: &'a [f64],
}
