//! Tracks: who is followed from frame to frame, and who that is.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use photinus_io::results::{FrameRecord, IdRecord, TrackRecord};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::{matrix, vector};

/// A vehicle that is followed from frame to frame, also while it is hidden or dark, as it is at the time of the frame: relative to the
/// camera, in axes that do not rotate and are the camera's at that time.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Track {
    pub(super) record: Arc<FrameRecord>,
    pub(super) index: usize,
}

impl Track {
    fn told(&self) -> &TrackRecord {
        &self.record.tracks[self.index]
    }
}

#[pymethods]
impl Track {
    /// The same number as long as it is followed.
    #[getter]
    fn track(&self) -> u64 {
        self.told().track
    }

    /// Name of its airframe.
    #[getter]
    fn airframe(&self) -> &str {
        &self.told().airframe
    }

    /// How likely it exists, 0 to 1.
    #[getter]
    fn probability(&self) -> f64 {
        self.told().probability
    }

    /// Who it surely is, where that was decoded.
    #[getter]
    fn id(&self) -> Option<u32> {
        self.told().id
    }

    /// How likely it is who it most likely is; None where nobody blinks.
    #[getter]
    fn id_probability(&self) -> Option<f64> {
        self.told().id_probability
    }

    /// Who it may be, the likeliest first; what is missing to 1 is nobody that is listed.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.told().ids.iter().map(Identity::from))
    }

    /// Whether none of its LEDs was seen in this frame.
    #[getter]
    fn predicted(&self) -> bool {
        self.told().predicted
    }

    /// Indices of the spots that it was seen by, in the record's.
    #[getter]
    fn spots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.told().spots)
    }

    /// Its origin, (3,), m.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().position_m)
    }

    /// Covariance of the position, (3, 3), m^2.
    #[getter]
    fn position_covariance_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.told().position_covariance_m2)
    }

    /// Its origin in the body frame of the vehicle that carries the camera, (3,), m, where the mounting is known.
    #[getter]
    fn position_body_m<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().position_body_m.map(|position_m| vector(py, position_m))
    }

    /// Covariance of that position, (3, 3), m^2, the mounting's own errors among it.
    #[getter]
    fn position_body_covariance_m2<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.told().position_body_covariance_m2.map(|covariance| matrix(py, covariance)).transpose()
    }

    /// How its place changes, (3,), m/s.
    #[getter]
    fn velocity_m_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().velocity_m_s)
    }

    /// Covariance of the velocity, (3, 3), m^2/s^2.
    #[getter]
    fn velocity_covariance_m2_s2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.told().velocity_covariance_m2_s2)
    }

    /// Its attitude, (4,): camera_from_body as x, y, z, w.
    #[getter]
    fn orientation_xyzw<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().orientation_xyzw)
    }

    /// Covariance of the attitude as a small rotation in the body frame, (3, 3), rad^2.
    #[getter]
    fn orientation_covariance_rad2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.told().orientation_covariance_rad2)
    }

    /// Covariance of the position (rows) with that rotation (columns), (3, 3), m rad.
    #[getter]
    fn position_orientation_covariance_m_rad<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let covariance = self.told().position_orientation_covariance_m_rad;
        covariance.map(|covariance| matrix(py, covariance)).transpose()
    }

    fn __repr__(&self) -> String {
        let track = self.told();
        let who = track.id.map_or(String::new(), |id| format!(", id {id}"));
        format!("Track({}, {:?}{who}, position_m={:?})", track.track, track.airframe, track.position_m)
    }
}

/// Who a track may be.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct Identity {
    /// The vehicle.
    id: u32,
    /// How likely it is that one.
    probability: f64,
    /// Whether it would be sure if no other track blinked the same words.
    contested: bool,
}

impl From<&IdRecord> for Identity {
    fn from(&IdRecord { id, probability, contested }: &IdRecord) -> Self {
        Self { id, probability, contested }
    }
}

#[pymethods]
impl Identity {
    fn __repr__(&self) -> String {
        format!("Identity({}, probability={:.3})", self.id, self.probability)
    }
}
