//! Airframes: files or rings of LEDs -> where markers sit.

use std::path::{Path, PathBuf};

use numpy::PyArray2;
use photinus::airframe::{self, Ring};
use photinus_io::airframe::{AirframeFile, Tolerances, read_airframe};
use pyo3::prelude::*;

use crate::error::{self, detached};
use crate::record::rows;

/// Where the LEDs of a kind of robot sit. The body frame has x forward, y left, z up.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Airframe(pub(crate) AirframeFile);

impl Airframe {
    pub(crate) fn new(airframe: airframe::Airframe) -> Self {
        Self(AirframeFile { airframe, tolerances: Tolerances::default(), notes: Vec::new() })
    }

    pub(crate) fn open(py: Python<'_>, path: &Path) -> PyResult<Self> {
        let file = detached(py, || read_airframe(path).map_err(error::file))?;
        error::warn(py, path, &file.notes)?;
        Ok(Self(file))
    }
}

#[pymethods]
impl Airframe {
    /// Reads an airframe: Photinus TOML or a UVDAR layout, told apart by content.
    ///
    /// Raises FileError with the line or key when it is neither; warns with PhotinusWarning of what was read otherwise.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::open(py, &path)
    }

    /// A ring of arms with 1 or 2 LEDs each, the two of an arm `splay_deg` apart. Raises SettingError.
    #[staticmethod]
    #[pyo3(signature = (name, arms, radius_m, *, leds_per_arm = 1, splay_deg = 0.0))]
    fn ring(name: &str, arms: usize, radius_m: f64, leds_per_arm: usize, splay_deg: f64) -> PyResult<Self> {
        let ring = Ring { arms, radius_m, leds_per_arm, splay_rad: splay_deg.to_radians() };
        airframe::Airframe::from_ring(name, ring).map(Self::new).map_err(error::setting)
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        self.0.airframe.name()
    }

    /// Where its LEDs are in the body frame, (N, 3), m.
    #[getter]
    fn positions_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.0.airframe.leds().iter().map(|led| led.position_m.into()))
    }

    /// Where its LEDs shine in the body frame, (N, 3) unit vectors.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.0.airframe.leds().iter().map(|led| led.axis.into_inner().into()))
    }

    /// What was read otherwise than it stands in its file, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes.clone()
    }

    fn __repr__(&self) -> String {
        format!("Airframe({:?}, {} LEDs)", self.0.airframe.name(), self.0.airframe.leds().len())
    }
}
