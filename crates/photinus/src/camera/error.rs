//! Why numbers do not make a camera.

use crate::frame::FrameView;

/// Why numbers do not make a camera.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A width or height of zero, or one past what a frame may have.
    #[error("an image of {width_px}x{height_px} pixels: each side must be 1 to {max}", max = FrameView::MAX_SIDE_PX)]
    Size {
        /// Columns given.
        width_px: usize,
        /// Rows given.
        height_px: usize,
    },
    /// A parameter that is NaN or infinite.
    #[error("{what} is {value}: it must be a finite number")]
    NotFinite {
        /// Which parameter.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A focal length of zero or less.
    #[error("a focal length of {value_px} px: it must be positive")]
    FocalLength {
        /// The value given, px.
        value_px: f64,
    },
    /// A polynomial with no coefficient, or with more than any calibration has.
    #[error("a polynomial of {count} coefficients: it needs 1 to {max}", max = super::OCam::MAX_COEFFICIENTS)]
    Coefficients {
        /// How many were given.
        count: usize,
    },
    /// A direct polynomial whose term 0 does not look forward (it is z in the toolbox's axes, where forward is negative).
    #[error(
        "term 0 of the direct polynomial is {value}: it must be negative, as z points backward in OCamCalib"
    )]
    LooksBack {
        /// Term 0, px.
        value: f64,
    },
    /// A matrix that flattens the image.
    #[error("the affine matrix cannot be inverted (its determinant is {determinant})")]
    Singular {
        /// Its determinant.
        determinant: f64,
    },
    /// A field limit that is not an angle off the axis.
    #[error("a field limit of {} deg: it must be above 0 and at most 180", value_rad.to_degrees())]
    FieldLimit {
        /// The value given, rad.
        value_rad: f64,
    },
    /// A covariance that is not of the model's parameters.
    #[error("a covariance of {rows} rows: this model has {needed} parameters that are calibrated")]
    CovarianceSize {
        /// Rows that the model needs.
        needed: usize,
        /// Rows given.
        rows: usize,
    },
    /// A matrix that is no covariance.
    #[error(
        "the matrix is not a covariance: it is not symmetric, or a combination of parameters has a negative variance"
    )]
    NoCovariance,
    /// A model that folds back inside the image: two pixels would see the same direction, or one pixel two.
    #[error(
        "the angle off the axis stops growing at {radius_px:.1} px from the centre ({deg:.1} deg), inside the image: \
         only a field limit below that makes it a camera", deg = angle_rad.to_degrees()
    )]
    NotMonotonic {
        /// Distance from the centre where it turns, px.
        radius_px: f64,
        /// Angle off the axis where it turns, rad.
        angle_rad: f64,
    },
}

/// Refuses a parameter that is not a number.
pub(super) fn finite(what: &'static str, values: &[f64]) -> Result<(), CameraError> {
    values
        .iter()
        .find(|value| !value.is_finite())
        .map_or(Ok(()), |&value| Err(CameraError::NotFinite { what, value }))
}
