//! Truth: where everything was.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray1;
use photinus_io::dataset::{self, TruthFrame};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::vector;
use crate::error::{self, detached};
use crate::json;

/// Where the neighbours were in one frame: a line of truth.jsonl.
#[pyclass(frozen, eq, module = "photinus")]
#[derive(PartialEq)]
pub(crate) struct Truth(pub(crate) Arc<TruthFrame>);

#[pymethods]
impl Truth {
    /// Number of the frame.
    #[getter]
    fn frame(&self) -> u64 {
        self.0.frame
    }

    /// When it was taken, s.
    #[getter]
    fn time_s(&self) -> f64 {
        self.0.time_s
    }

    /// Those that were there, seen or not.
    #[getter]
    fn neighbours<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let neighbour = |index| TruthNeighbour { truth: self.0.clone(), index };
        PyTuple::new(py, (0..self.0.neighbours.len()).map(neighbour))
    }

    /// The line of truth.jsonl.
    fn to_json(&self) -> PyResult<String> {
        json::text(self.0.as_ref())
    }

    fn __repr__(&self) -> String {
        format!("Truth(frame {}: {} neighbours)", self.0.frame, self.0.neighbours.len())
    }
}

/// Where a neighbour was, in the camera frame.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct TruthNeighbour {
    truth: Arc<TruthFrame>,
    index: usize,
}

impl TruthNeighbour {
    fn told(&self) -> &dataset::TruthNeighbour {
        &self.truth.neighbours[self.index]
    }
}

#[pymethods]
impl TruthNeighbour {
    /// Which one.
    #[getter]
    fn id(&self) -> u32 {
        self.told().id
    }

    /// Its origin, (3,), m.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().position_m)
    }

    /// Its attitude, (4,): camera_from_body as x, y, z, w.
    #[getter]
    fn orientation_xyzw<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().orientation_xyzw)
    }

    /// From the camera's centre to its origin, m.
    #[getter]
    fn distance_m(&self) -> f64 {
        self.told().distance_m
    }

    /// How its place changes, (3,), m/s: relative to the camera, in axes that do not rotate and are the camera's at that time; None
    /// where that is not known.
    #[getter]
    fn velocity_m_s<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().velocity_m_s.map(|velocity_m_s| vector(py, velocity_m_s))
    }

    /// Those of its LEDs that shone into the image.
    #[getter]
    fn leds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let led = |led: &dataset::TruthLed| TruthLed { u_px: led.u_px, v_px: led.v_px, led: led.led };
        PyTuple::new(py, self.told().leds.iter().map(led))
    }
}

/// Where an LED was in the image.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct TruthLed {
    /// Column, px.
    u_px: f64,
    /// Row, px.
    v_px: f64,
    /// Which LED of the airframe, where that was noted.
    led: Option<u32>,
}

/// Reads a truth.jsonl. Raises FileError with the line that is none.
#[pyfunction]
pub(crate) fn read_truth(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Truth>> {
    detached(py, || {
        let frames = dataset::read_truth(&path).map_err(error::file)?;
        Ok(frames.into_iter().map(|frame| Truth(Arc::new(frame))).collect())
    })
}
