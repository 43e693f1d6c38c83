//! Why a tracker cannot be made, and why a frame is refused.

use super::Tracker;
use crate::pose::SettingsError;

/// Why a tracker cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrackerError {
    /// A prior that has no meaning.
    #[error("{0}")]
    Settings(#[from] SettingsError),
    /// A mask of another size than the camera's image.
    #[error("{0}")]
    Mask(#[from] crate::frame::FrameError),
}

/// Why a frame, or a question, is refused. The tracks are as they were.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrackError {
    /// A time that is not a number.
    #[error("a time of {0} s: it must be a finite number")]
    Time(f64),
    /// A frame too far behind the newest.
    #[error(
        "a frame of {time_s} s, {behind_s} s behind the newest: at most {most} s can be made up for; hand frames on sooner, or leave it out",
        most = Tracker::MOST_LATE_S
    )]
    TooLate {
        /// Its time.
        time_s: f64,
        /// How far behind the newest.
        behind_s: f64,
    },
    /// A second frame of the same camera and time.
    #[error("a second frame of {time_s} s: hand each frame on once")]
    Repeated {
        /// Its time.
        time_s: f64,
    },
    /// A camera that the rig does not have.
    #[error("a frame of camera {number} of a rig of {of}: they are numbered from 0")]
    Camera {
        /// Its number.
        number: usize,
        /// How many there are.
        of: usize,
    },
    /// The camera's turn is known to no sigma.
    #[error("a turn of the camera with a sigma of {0} rad: it must be 0 or more")]
    Turn(f64),
    /// The camera's velocity, or its sigma, is no number.
    #[error(
        "a camera that moves at {0} m/s with a sigma of {1} m/s: both must be finite, and the sigma 0 or more"
    )]
    Moving(f64, f64),
}
