//! Neighbours: how far, where, how turned, how sure.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use photinus_io::results::{self, FrameRecord, NeighbourRecord};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::{matrix, vector};

/// A neighbour. Vectors are in the camera frame: x right, y down, z forward.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Neighbour {
    pub(super) record: Arc<FrameRecord>,
    pub(super) index: usize,
}

impl Neighbour {
    fn told(&self) -> &NeighbourRecord {
        &self.record.neighbours[self.index]
    }
}

#[pymethods]
impl Neighbour {
    /// The track that it belongs to, where frames are followed.
    #[getter]
    fn track(&self) -> Option<u64> {
        self.told().track
    }

    /// Who it is, where that was decoded.
    #[getter]
    fn id(&self) -> Option<u32> {
        self.told().id
    }

    /// How likely its track is who it most likely is, where frames are followed and vehicles blink.
    #[getter]
    fn id_probability(&self) -> Option<f64> {
        self.told().id_probability
    }

    /// The velocity of its track, (3,), m/s, where frames are followed: relative to the camera, in axes that do not rotate.
    #[getter]
    fn velocity_m_s<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().velocity_m_s.map(|velocity_m_s| vector(py, velocity_m_s))
    }

    /// Covariance of the velocity, (3, 3), m^2/s^2.
    #[getter]
    fn velocity_covariance_m2_s2<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.told().velocity_covariance_m2_s2.map(|covariance| matrix(py, covariance)).transpose()
    }

    /// Name of its airframe.
    #[getter]
    fn airframe(&self) -> &str {
        &self.told().airframe
    }

    /// How likely it is built so, where several kinds of neighbours are looked for.
    #[getter]
    fn airframe_probability(&self) -> Option<f64> {
        self.told().airframe_probability
    }

    /// Indices of its spots in the record's.
    #[getter]
    fn spots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.told().spots)
    }

    /// Unit vector towards it, (3,).
    #[getter]
    fn bearing<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.told().bearing)
    }

    /// How far it is.
    #[getter]
    fn distance_m(&self) -> Distance {
        self.told().distance_m.into()
    }

    /// Its origin, (3,), m, where the distance has an estimate.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().position_m.map(|position_m| vector(py, position_m))
    }

    /// Covariance of the position, (3, 3), m^2.
    #[getter]
    fn position_covariance_m2<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.told().position_covariance_m2.map(|covariance| matrix(py, covariance)).transpose()
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

    /// Its mean attitude, (4,): camera_from_body as x, y, z, w; one of those that the airframe's symmetry makes equal.
    #[getter]
    fn orientation_xyzw<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().orientation_xyzw.map(|xyzw| vector(py, xyzw))
    }

    /// Covariance of the attitude as a small rotation in the body frame, (3, 3), the third axis yaw, rad^2.
    #[getter]
    fn orientation_covariance_rad2<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.told().orientation_covariance_rad2.map(|covariance| matrix(py, covariance)).transpose()
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

    /// How likely it is there at all, 0 to 1.
    #[getter]
    fn probability(&self) -> Option<f64> {
        self.told().probability
    }

    /// How well its best pose fits.
    #[getter]
    fn misfit(&self) -> Option<Misfit> {
        self.told().misfit.map(Misfit::from)
    }

    /// The likeliest other explanation of its spots.
    #[getter]
    fn runner_up(&self) -> Option<RunnerUp> {
        self.told().runner_up.map(RunnerUp::from)
    }

    /// Every pose that the spots allow, the likeliest first.
    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.told().modes.iter().copied().map(Mode))
    }

    fn __repr__(&self) -> String {
        format!("Neighbour({:?}, {})", self.told().airframe, self.distance_m().__repr__())
    }
}

/// From the camera's centre to a neighbour's origin, m.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct Distance {
    /// The likeliest; None where only bounds are known.
    estimate: Option<f64>,
    /// Its standard deviation.
    sigma: Option<f64>,
    /// It is never less, under the stated assumptions.
    min: f64,
    /// It is never more; None where nothing bounds it.
    max: Option<f64>,
    /// The paper's l_A: two markers side by side.
    perpendicular: Option<f64>,
    /// The paper's l_B: two markers one behind the other.
    inline: Option<f64>,
}

impl From<results::Distance> for Distance {
    fn from(distance: results::Distance) -> Self {
        let results::Distance { estimate, sigma, min, max, perpendicular, inline } = distance;
        Self { estimate, sigma, min, max, perpendicular, inline }
    }
}

#[pymethods]
impl Distance {
    fn __repr__(&self) -> String {
        let told = |value: Option<f64>| value.map_or("None".to_owned(), |value| format!("{value:.3}"));
        let Self { estimate, sigma, min, max, .. } = *self;
        format!(
            "Distance(estimate={}, sigma={}, min={min:.3}, max={})",
            told(estimate),
            told(sigma),
            told(max)
        )
    }
}

/// How well a pose fits.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct Misfit {
    /// Sum of the squared residuals, each over its variance.
    chi2: f64,
    /// How many residuals are left when the pose is fitted.
    dof: u32,
    /// How often a right answer fits no better, 0 to 1.
    p: f64,
}

impl From<results::Misfit> for Misfit {
    fn from(results::Misfit { chi2, dof, p }: results::Misfit) -> Self {
        Self { chi2, dof, p }
    }
}

/// What spots may be otherwise.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct RunnerUp {
    /// How likely it is, 0 to 1.
    probability: f64,
    /// How far the neighbour is that they are then, m; None for clutter.
    distance_m: Option<f64>,
}

impl From<results::RunnerUp> for RunnerUp {
    fn from(results::RunnerUp { probability, distance_m }: results::RunnerUp) -> Self {
        Self { probability, distance_m }
    }
}

/// A pose that the spots allow.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Mode(results::Mode);

#[pymethods]
impl Mode {
    /// Its share of the probability, 0 to 1.
    #[getter]
    fn weight(&self) -> f64 {
        self.0.weight
    }

    /// Origin in the camera frame, (3,), m.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.position_m)
    }

    /// Covariance of the position, (3, 3), m^2.
    #[getter]
    fn position_covariance_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.0.position_covariance_m2)
    }

    /// Attitude, (4,): camera_from_body as x, y, z, w.
    #[getter]
    fn orientation_xyzw<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.orientation_xyzw.map(|xyzw| vector(py, xyzw))
    }

    /// Covariance of the attitude as a small rotation in the body frame, (3, 3), rad^2.
    #[getter]
    fn orientation_covariance_rad2<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.0.orientation_covariance_rad2.map(|covariance| matrix(py, covariance)).transpose()
    }

    /// Covariance of the position (rows) with that rotation (columns), (3, 3), m rad.
    #[getter]
    fn position_orientation_covariance_m_rad<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.0.position_orientation_covariance_m_rad.map(|covariance| matrix(py, covariance)).transpose()
    }
}
