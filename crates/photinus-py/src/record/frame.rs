//! What was found in one frame.

use std::path::PathBuf;
use std::sync::Arc;

use photinus_io::results::{FrameRecord, ResultsReader, read_results as read};
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};

use super::{Neighbour, Rejected, Spot, Track};
use crate::error::{self, FileError, SettingError, detached};
use crate::json;

/// What was found in one frame: a line of the results, field by field.
#[pyclass(frozen, eq, module = "photinus")]
#[derive(PartialEq)]
pub(crate) struct Record(pub(crate) Arc<FrameRecord>);

/// A record of which only number and time are known.
///
/// # Errors
/// `SettingError` when the time is no finite number.
pub(crate) fn empty(frame: Option<u64>, time_s: Option<f64>) -> PyResult<FrameRecord> {
    if let Some(time_s) = time_s.filter(|time_s| !time_s.is_finite()) {
        return Err(SettingError::new_err(format!("a time of {time_s}: give seconds, or None")));
    }
    Ok(FrameRecord {
        frame,
        camera: None,
        time_s,
        latency_s: None,
        source: String::new(),
        incomplete: false,
        spots: Vec::new(),
        rejected: Vec::new(),
        neighbours: Vec::new(),
        tracks: Vec::new(),
    })
}

#[pymethods]
impl Record {
    /// The record of a line of JSON, as `to_json` and the program write it. Raises FileError.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let mut records = ResultsReader::new(text.as_bytes(), "JSON");
        match (records.next(), records.next()) {
            (Some(record), None) => {
                let record = record.map_err(error::file)?;
                Ok(Self(Arc::new(record)))
            }
            (None, _) => Err(FileError::new_err("JSON: it is empty; give one line of results")),
            (Some(_), Some(_)) => Err(FileError::new_err("JSON: it has several lines; give one of them")),
        }
    }

    /// The line of JSON that the program writes for it.
    fn to_json(&self) -> PyResult<String> {
        json::text(self.0.as_ref())
    }

    /// The same as dicts, lists and numbers.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::object(py, self.0.as_ref())
    }

    /// The number of the frame.
    #[getter]
    fn frame(&self) -> Option<u64> {
        self.0.frame
    }

    /// The camera's name, where there are several.
    #[getter]
    fn camera(&self) -> Option<&str> {
        self.0.camera.as_deref()
    }

    /// When it was taken, s.
    #[getter]
    fn time_s(&self) -> Option<f64> {
        self.0.time_s
    }

    /// From the end of the exposure until the result stood, s, where that was measured.
    #[getter]
    fn latency_s(&self) -> Option<f64> {
        self.0.latency_s
    }

    /// Whether the frame held more than there was work for: the likeliest was weighed, not all.
    #[getter]
    fn incomplete(&self) -> bool {
        self.0.incomplete
    }

    /// The image file or stream; empty where it is not known.
    #[getter]
    fn source(&self) -> &str {
        &self.0.source
    }

    /// What is bright and may be a marker.
    #[getter]
    fn spots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, (0..self.0.spots.len()).map(|index| Spot { record: self.0.clone(), index }))
    }

    /// What is bright and is none.
    #[getter]
    fn rejected<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.rejected.iter().map(Rejected::from))
    }

    /// Who is there.
    #[getter]
    fn neighbours<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let neighbour = |index| Neighbour { record: self.0.clone(), index };
        PyTuple::new(py, (0..self.0.neighbours.len()).map(neighbour))
    }

    /// Who is followed from frame to frame, where frames have times.
    #[getter]
    fn tracks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, (0..self.0.tracks.len()).map(|index| Track { record: self.0.clone(), index }))
    }

    fn __repr__(&self) -> String {
        let Self(record) = self;
        let frame = record.frame.map_or(String::new(), |frame| format!("frame {frame}: "));
        format!(
            "Record({frame}{} spots, {} rejected, {} neighbours)",
            record.spots.len(),
            record.rejected.len(),
            record.neighbours.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((PyType::new::<Self>(py).getattr("from_json")?, (self.to_json()?,)))
    }
}

/// Reads the results of `photinus locate` or `detect`, a record per line. Raises FileError with the line that is none.
#[pyfunction]
pub(crate) fn read_results(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Record>> {
    detached(py, || {
        let records = read(&path).map_err(error::file)?;
        records.map(|record| Ok(Record(Arc::new(record.map_err(error::file)?)))).collect()
    })
}
