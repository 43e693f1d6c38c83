//! Cameras: files of any format -> the projection, and how pixels and bearings map.

use std::path::{Path, PathBuf};

use numpy::{AllowTypeChange, PyArray2, PyArrayLike2};
use photinus::camera::{self, Bearing, Pixel};
use photinus_io::camera::write_calibrated_camera_toml;
use photinus_io::read_camera;
use photinus_io::whole::{Existing, write_whole};
use pyo3::prelude::*;

use crate::error::{self, SettingError, detached};
use crate::record::rows;

/// A camera: how pixels and bearings map, and lens and sensor where they were measured.
///
/// The camera frame has x right, y down, z forward. Pixels are u = column and v = row, 0-based, with the centre of a pixel at
/// the integer.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Camera {
    pub(crate) camera: camera::Camera,
    notes: Vec<String>,
}

impl Camera {
    pub(crate) fn new(camera: camera::Camera) -> Self {
        Self { camera, notes: Vec::new() }
    }

    pub(crate) fn open(py: Python<'_>, path: &Path) -> PyResult<Self> {
        let file = detached(py, || read_camera(path).map_err(error::file))?;
        error::warn(py, path, &file.oddities)?;
        Ok(Self { camera: file.camera, notes: file.oddities })
    }
}

#[pymethods]
impl Camera {
    /// Reads a calibration: OCamCalib text, UVDAR, Kalibr or ROS YAML, pyocamcalib JSON or Photinus TOML, told apart by content.
    ///
    /// Raises FileError with the line or key when it is none of them; warns with PhotinusWarning of what is odd about it.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::open(py, &path)
    }

    /// Writes it as Photinus TOML; a file that is there already stays unless `force`. Raises FileError.
    #[pyo3(signature = (path, *, force = false))]
    fn write(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        write_camera(py, &self.camera, None, &path, force)
    }

    /// Columns of its images.
    #[getter]
    fn width_px(&self) -> usize {
        self.camera.width()
    }

    /// Rows of its images.
    #[getter]
    fn height_px(&self) -> usize {
        self.camera.height()
    }

    /// Half the angle of its field: farther off the axis it gives no answer, deg.
    #[getter]
    fn field_limit_deg(&self) -> f64 {
        self.camera.field_limit_rad().to_degrees()
    }

    /// What is odd about its file, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The unit vectors of pixels: (N, 2) of column and row -> (N, 3) in the camera frame, NaN outside of the field.
    fn bearings<'py>(
        &self,
        py: Python<'py>,
        pixels: PyArrayLike2<'py, f64, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pixels = pixels.as_array();
        columns(pixels.ncols(), 2, "pixels")?;
        let bearing = |row: numpy::ndarray::ArrayView1<'_, f64>| {
            let bearing = self.camera.bearing(Pixel::new(row[0], row[1]));
            bearing.map_or([f64::NAN; 3], |bearing| (*bearing.vector()).into())
        };
        rows(py, pixels.rows().into_iter().map(bearing))
    }

    /// Where directions are seen: (N, 3) in the camera frame, of any length but 0 -> (N, 2) of column and row, NaN outside of
    /// the field.
    fn pixels<'py>(
        &self,
        py: Python<'py>,
        bearings: PyArrayLike2<'py, f64, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let bearings = bearings.as_array();
        columns(bearings.ncols(), 3, "bearings")?;
        let pixel = |row: numpy::ndarray::ArrayView1<'_, f64>| {
            let bearing = Bearing::new([row[0], row[1], row[2]].into());
            let pixel = bearing.and_then(|bearing| self.camera.pixel(&bearing));
            pixel.map_or([f64::NAN; 2], |pixel| [pixel.u, pixel.v])
        };
        rows(py, bearings.rows().into_iter().map(pixel))
    }

    fn __repr__(&self) -> String {
        let (width, height) = (self.camera.width(), self.camera.height());
        format!("Camera({width}x{height} px, to {:.1} deg off the axis)", self.field_limit_deg())
    }
}

/// Writes a camera, whole or not at all.
pub(crate) fn write_camera(
    py: Python<'_>,
    camera: &camera::Camera,
    summary: Option<&photinus_io::camera::CalibrationSummary>,
    path: &Path,
    force: bool,
) -> PyResult<()> {
    let existing = if force { Existing::Replace } else { Existing::Keep };
    detached(py, || {
        let mut text = Vec::new();
        write_calibrated_camera_toml(camera, summary, None, &mut text, path)
            .and_then(|()| write_whole(path, &text, existing))
            .map_err(error::file)
    })
}

fn columns(have: usize, want: usize, what: &str) -> PyResult<()> {
    if have == want {
        return Ok(());
    }
    Err(SettingError::new_err(format!("{what} have {have} columns: give an array of shape (N, {want})")))
}
