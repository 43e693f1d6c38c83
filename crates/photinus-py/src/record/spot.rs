//! Spots, and what is bright and none.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use photinus_io::results::{FrameRecord, RejectedRecord, SpotRecord};
use pyo3::prelude::*;

use super::{matrix, vector};

/// Something bright that may be a marker. Pixels are u = column and v = row, with the centre of a pixel at the integer.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Spot {
    pub(super) record: Arc<FrameRecord>,
    pub(super) index: usize,
}

impl Spot {
    fn told(&self) -> &SpotRecord {
        &self.record.spots[self.index]
    }
}

#[pymethods]
impl Spot {
    /// Column of the centre, px.
    #[getter]
    fn u_px(&self) -> f64 {
        self.told().u_px
    }

    /// Row of the centre, px.
    #[getter]
    fn v_px(&self) -> f64 {
        self.told().v_px
    }

    /// Pixels that it covers.
    #[getter]
    fn area_px(&self) -> u32 {
        self.told().area_px
    }

    /// Its brightest pixel, grey level.
    #[getter]
    fn peak(&self) -> u8 {
        self.told().peak
    }

    /// Pixels of 255.
    #[getter]
    fn saturated_px(&self) -> u32 {
        self.told().saturated_px
    }

    /// Sum of its pixels above the background, grey levels; 0 where it is not known.
    #[getter]
    fn flux(&self) -> f64 {
        self.told().flux
    }

    /// All of its light and the sigma of that, grey levels, with what full pixels hide; None where no point spread told it.
    #[getter]
    fn light(&self) -> Option<(f64, f64)> {
        self.told().light.map(|[value, sigma]| (value, sigma))
    }

    /// Root of the mean variance of the centre over the two axes, px.
    #[getter]
    fn sigma_px(&self) -> f64 {
        self.told().sigma_px
    }

    /// Covariance of the centre, (2, 2), u then v, px^2.
    #[getter]
    fn covariance_px2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.told().covariance_px2)
    }

    /// The paper's middle pixel: column and row.
    #[getter]
    fn middle_px(&self) -> (u32, u32) {
        self.told().middle_px.into()
    }

    /// The box of pixels that it spans: first column, first row, last column, last row.
    #[getter]
    fn extent_px(&self) -> Option<(u32, u32, u32, u32)> {
        self.told().extent_px.map(Into::into)
    }

    /// Grey value around it.
    #[getter]
    fn background(&self) -> f64 {
        self.told().background
    }

    /// How likely it is the light of markers and not clutter, from how it looks in its frame alone, 0 to 1.
    #[getter]
    fn probability(&self) -> f64 {
        self.told().probability
    }

    /// Natural logarithm of the odds of that.
    #[getter]
    fn marker_log_odds(&self) -> f64 {
        self.told().marker_log_odds
    }

    /// Unit vector towards it in the camera frame, (3,), where the camera is known.
    #[getter]
    fn bearing<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.told().bearing.map(|bearing| vector(py, bearing))
    }

    /// Truth is never farther from the bearing, rad.
    #[getter]
    fn bound_rad(&self) -> Option<f64> {
        self.told().bound_rad
    }

    /// Truth is never outside, m; the far end is None where nothing bounds it.
    #[getter]
    fn range_m(&self) -> Option<(f64, Option<f64>)> {
        self.told().range_m
    }

    /// Which of the airframe's signals it was seen to blink, where that is known.
    #[getter]
    fn signal(&self) -> Option<u32> {
        self.told().signal
    }

    fn __repr__(&self) -> String {
        let spot = self.told();
        format!("Spot(u_px={:.2}, v_px={:.2}, sigma_px={:.3})", spot.u_px, spot.v_px, spot.sigma_px)
    }
}

/// Something bright that is not taken for a marker.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct Rejected {
    /// Column, px.
    u_px: f64,
    /// Row, px.
    v_px: f64,
    /// Pixels that it covers.
    area_px: u32,
    /// Why: "sun", "reflection", "mask", "outside", ...
    reason: String,
}

impl From<&RejectedRecord> for Rejected {
    fn from(RejectedRecord { u_px, v_px, area_px, reason }: &RejectedRecord) -> Self {
        Self { u_px: *u_px, v_px: *v_px, area_px: *area_px, reason: reason.clone() }
    }
}

#[pymethods]
impl Rejected {
    fn __repr__(&self) -> String {
        format!("Rejected(u_px={:.2}, v_px={:.2}, reason={:?})", self.u_px, self.v_px, self.reason)
    }
}
