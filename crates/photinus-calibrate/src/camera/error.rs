//! Why photos do not make a calibration.

use photinus::camera::CameraError;

/// Why photos do not make a calibration; each message says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Not enough photos with the grid.
    #[error(
        "{usable} photos show the grid: at least {needed} are needed, and 15 or more with the grid near, far, tilted and at \
         every edge make a good calibration", needed = super::LEAST_PHOTOS
    )]
    TooFewPhotos {
        /// Photos with the grid.
        usable: usize,
    },
    /// All photos show the grid in the same pose.
    #[error(
        "all photos show the grid in one pose (within {spread_deg:.1} deg and {spread_share:.0} % of the distance): one view of a flat \
         board cannot tell the lens from the pose; move and tilt the grid between photos"
    )]
    OnePose {
        /// Largest turn between two photos, deg.
        spread_deg: f64,
        /// Largest shift between two photos, % of the distance.
        spread_share: f64,
    },
    /// No lens explains the photos.
    #[error(
        "no lens explains the photos, not even roughly: check that all are of one camera at one zoom and size, and that --grid \
         counts the LEDs right"
    )]
    NoStart,
    /// The best lens is far off.
    #[error(
        "the best lens misses the LEDs by {mean_px:.1} px in the mean: check that all photos are of one camera, none \
         mirrored, and that --grid counts the LEDs right"
    )]
    NothingFits {
        /// Mean distance, px.
        mean_px: f64,
    },
    /// The places of the LEDs were asked for and cannot be told.
    #[error(
        "the photos do not tell where the LEDs are on the board: {reason}; use --board flat, or take more and sharper photos"
    )]
    BoardUnsupported {
        /// Why.
        reason: String,
    },
    /// The adjustment did not work with any model.
    #[error("no model could be adjusted to these photos; give more of them, or --model kannala-brandt:2")]
    NoModel,
    /// The lens found does not make a camera.
    #[error(
        "the lens that fits best is not a camera: {0}; take more photos with the grid near the edges, or give a simpler --model"
    )]
    Camera(#[from] CameraError),
}
