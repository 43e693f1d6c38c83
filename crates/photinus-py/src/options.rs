//! What a user may choose, with the program's names and defaults: options of Python -> settings of the method.

use std::path::PathBuf;

use nalgebra::{Unit, Vector3};
use photinus::camera::Bearing;
use photinus::frame::Mask;
use photinus::ranging::SpotCurve;
use photinus::spots::{self, Brightness};
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::{SpotCurveFile, read_spot_curve};
use pyo3::prelude::*;

use crate::error::{self, SettingError, detached};
use crate::image::Image;

/// The detector's settings, as `--contrast`, `--threshold` and `--reflection-ratio` give them.
pub(crate) fn spot_settings(
    contrast: Option<u8>,
    threshold: Option<u8>,
    reflection_ratio: f64,
) -> PyResult<spots::Settings> {
    let mut settings = spots::Settings::default();
    settings.brightness = match (threshold, contrast) {
        (Some(_), Some(_)) => {
            return Err(SettingError::new_err("contrast and threshold are given: keep one of them"));
        }
        (Some(level), None) => Brightness::Threshold(level),
        (None, Some(step)) => Brightness::Contrast(step),
        (None, None) => Brightness::default(),
    };
    settings.shape.reflection_ratio = reflection_ratio;
    Ok(settings)
}

/// Where not to look: an image file or an array of the frames' size that is 0 there.
#[derive(FromPyObject)]
pub(crate) enum MaskOption<'py> {
    /// An image file.
    File(PathBuf),
    /// An array, or what is none.
    Array(Bound<'py, PyAny>),
}

impl MaskOption<'_> {
    /// The mask itself.
    ///
    /// # Errors
    /// `FileError` or `ImageError` when it is no image.
    pub(crate) fn read(&self, py: Python<'_>) -> PyResult<Mask> {
        match self {
            Self::File(path) => {
                let file = detached(py, || read_mask(path).map_err(error::file))?;
                error::warn(py, path, &file.notes)?;
                Ok(file.mask)
            }
            Self::Array(array) => Ok(Mask::from_frame(&Image::borrow(array)?.view()?)),
        }
    }
}

/// The curve of spot sizes that a file holds; the word `paper` stands for the paper's.
pub(crate) fn spot_curve(py: Python<'_>, path: &PathBuf, brightness: Brightness) -> PyResult<SpotCurve> {
    let file = match path.as_os_str() == "paper" {
        true => SpotCurveFile::paper_1000_us(),
        false => detached(py, || read_spot_curve(path).map_err(error::file))?,
    };
    if let Some(threshold) = file.threshold.filter(|level| brightness != Brightness::Threshold(*level)) {
        let note = format!(
            "the spot curve was measured with a threshold of {threshold}: give threshold={threshold}, or bounds that come \
             from spot sizes are wrong"
        );
        error::warn(py, path, &[note])?;
    }
    Ok(file.curve)
}

/// Down in the camera frame, of any length but 0; what is a unit vector to the last digits stays as it is, as in a dataset.
pub(crate) fn direction(gravity: [f64; 3]) -> PyResult<Unit<Vector3<f64>>> {
    let vector = Vector3::from(gravity);
    if (vector.norm() - 1.0).abs() < 1e-12 {
        return Ok(Unit::new_unchecked(vector));
    }
    let bearing = Bearing::new(vector).ok_or_else(|| {
        SettingError::new_err(format!(
            "gravity {gravity:?} points nowhere: give down in the camera frame, such as (0, 1, 0)"
        ))
    })?;
    Ok(Unit::new_unchecked(*bearing.vector()))
}
