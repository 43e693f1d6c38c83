//! What enters: a frame of a camera.

use nalgebra::Rotation3;

use crate::camera::Watched;
use crate::locator::Sighting;
use crate::optics::LogLight;
use crate::tracking::Turned;

/// A frame of a camera.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// When its exposure began, s.
    pub time_s: f64,
    /// How long it lasted, s.
    pub exposure_s: f64,
    /// What may be markers.
    pub sightings: &'a [Sighting],
    /// Light at which a marker is found half of the time, in the unit of the sightings' light, and how much that differs from marker to marker; `None` where
    /// any is found.
    pub detection_limit: Option<LogLight>,
    /// How the observer turned since the frame before, where that is known.
    pub turn: Option<Turn>,
    /// Where a marker would be seen.
    pub watched: Watched<'a>,
}

/// How the observer turned between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Takes directions in the camera frame of the frame before to that of this one.
    pub now_from_before: Rotation3<f64>,
    /// Standard deviation of its error about each axis, rad.
    pub sigma_rad: f64,
}

impl From<Turned> for Turn {
    fn from(Turned { now_from_before, sigma_rad }: Turned) -> Self {
        Self { now_from_before, sigma_rad }
    }
}
