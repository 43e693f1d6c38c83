//! What is told of a marker that is followed.

use nalgebra::{Matrix3, Matrix3x2, Matrix4, Vector3};

use super::hearing::Listeners;
use super::track::Track;
use crate::camera::Bearing;
use crate::identity::Level;
use crate::identity::decoder::Identity;

/// A marker that is followed, as of the last frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerTrack {
    /// Its own as long as it is followed; never used again.
    pub number: u64,
    /// Its direction in the camera frame.
    pub bearing: Bearing,
    /// How fast that moves, rad/s, in axes that do not rotate and coincide with the camera's at the frame: tangent to the sphere.
    /// Where no gyro tells how the observer turns, less what all tracks have in common; the covariance says so.
    pub rate_rad_s: Vector3<f64>,
    /// Two axes tangent to the sphere at the bearing, as columns.
    pub axes: Matrix3x2<f64>,
    /// Covariance of bearing and rate on these axes: bearing (rad) first, then rate (rad/s).
    pub covariance: Matrix4<f64>,
    /// The light that it shows when it shines all the time; `None` where no sighting had a light.
    pub level: Option<Level>,
    /// Another marker nearer than this is one spot with it, rad.
    pub resolution_rad: f64,
    /// Which sighting of the frame it is, by index; `None` where it is most probably none, dark or hidden.
    pub sighting: Option<usize>,
    /// The probability of the most probable sighting.
    pub sighting_probability: f64,
    /// The probability that it shone during the whole exposure.
    pub lit: f64,
    /// The share of the exposures in which it shines that hold an edge of its signal.
    pub partly: f64,
    /// The probability that it exists.
    pub existence: f64,
    /// Who it is; `None` where there is no code book.
    pub identity: Option<Identity>,
}

impl MarkerTrack {
    /// `None` while it is not confirmed.
    pub(super) fn of(track: &Track, listeners: &Listeners, common_rad2_s2: &Matrix3<f64>) -> Option<Self> {
        let number = track.number?;
        let motion = &track.motion;
        let own = motion.covariance();
        let of_common = motion.by_turn().transpose() * common_rad2_s2 * motion.by_turn();
        let mut covariance = Matrix4::zeros();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&own.bearing);
        covariance.fixed_view_mut::<2, 2>(0, 2).copy_from(&own.cross);
        covariance.fixed_view_mut::<2, 2>(2, 0).copy_from(&own.cross.transpose());
        covariance.fixed_view_mut::<2, 2>(2, 2).copy_from(&(own.rate + of_common));
        let (sighting, sighting_probability) = track.told.sighting.unzip();
        let sighting_probability = sighting_probability.unwrap_or(0.0);
        let identity = listeners.decoder().zip(track.hearing.listener());
        Some(Self {
            number,
            bearing: Bearing::new(motion.ahead())?,
            rate_rad_s: motion.rate_rad_s(),
            axes: motion.axes(),
            covariance,
            level: track.level,
            resolution_rad: track.resolution_rad,
            sighting: sighting.filter(|_| sighting_probability > 0.5),
            sighting_probability,
            lit: track.told.lit,
            partly: track.partly,
            existence: track.presence.exists(),
            identity: identity.map(|(decoder, listener)| decoder.identity(listener)),
        })
    }

    /// Covariance of the direction, rad^2, tangent to the sphere (rank 2).
    pub fn bearing_covariance_rad2(&self) -> Matrix3<f64> {
        self.axes * self.covariance.fixed_view::<2, 2>(0, 0) * self.axes.transpose()
    }
}
