//! Why a locator cannot be made, and why a frame cannot be located.

use crate::frame::FrameError;
use crate::{pose, spots};

/// Why a locator cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocatorError {
    /// No kind of vehicle to look for.
    #[error("no kind of vehicle to look for: give at least one airframe")]
    NoKind,
    /// A setting of the detector has no meaning.
    #[error("{0}")]
    Spots(#[from] spots::SettingsError),
    /// A prior or tolerance of the pose has no meaning.
    #[error("{0}")]
    Pose(#[from] pose::SettingsError),
    /// A tilt limit that is no angle from 0 to 180 deg.
    #[error("a tilt limit of {0} rad: it must be an angle from 0 to pi")]
    Tilt(f64),
    /// A least probability that is not from 0 to 1.
    #[error("a least probability of {0}: it must be from 0 to 1")]
    Probability(f64),
    /// A mask of another size than the camera's image.
    #[error("{0}")]
    Mask(FrameError),
}

/// Why a frame cannot be located.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocateError {
    /// A frame of another size than the camera was calibrated for.
    #[error("the frame is {width}x{height}, the camera {camera_width}x{camera_height}")]
    Size {
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
        /// Columns of the camera's image.
        camera_width: usize,
        /// Rows of the camera's image.
        camera_height: usize,
    },
}
