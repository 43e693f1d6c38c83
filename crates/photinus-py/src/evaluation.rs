//! Truth and results -> scores, as `photinus evaluate --json` tells them.

use std::path::{Path, PathBuf};

use photinus_evaluate::{RangeBins, Settings};
use photinus_io::dataset::{Dataset, TruthFrame, read_truth};
use photinus_io::kind::Kind;
use photinus_io::results::{FrameRecord, read_results};
use pyo3::prelude::*;

use crate::error::{self, EvaluationError, SettingError, detached};
use crate::json;
use crate::record::{Record, Truth};

/// Truth: a dataset folder, a truth.jsonl, or what such a file holds.
#[derive(FromPyObject)]
pub(crate) enum TruthOption<'py> {
    File(PathBuf),
    Frames(Vec<Bound<'py, Truth>>),
}

/// Results: a file of them, or what it holds.
#[derive(FromPyObject)]
pub(crate) enum ResultsOption<'py> {
    File(PathBuf),
    Records(Vec<Bound<'py, Record>>),
}

/// Compares results with ground truth: recall, errors, bounds, covariances, as dicts by the names of "Scores" in docs/file-formats.md.
///
/// `truth` is a dataset folder, a truth.jsonl or a list of Truth; `results` a file or a list of Record, whose `frame` says which. `bins` are
/// edges between bins of distance, m; `spot_gate`, px, and `bearing_gate`, deg, how far from truth is still right; `only` names one of
/// several cameras. Raises FileError, SettingError, and EvaluationError when the two cannot be compared.
#[pyfunction]
#[pyo3(signature = (truth, results, *, bins = None, spot_gate = 3.0, bearing_gate = 3.0, only = None))]
#[allow(clippy::too_many_arguments)] // the options of the program, by name
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    truth: TruthOption<'py>,
    results: ResultsOption<'py>,
    bins: Option<Vec<f64>>,
    spot_gate: f64,
    bearing_gate: f64,
    only: Option<String>,
) -> PyResult<Bound<'py, PyAny>> {
    let bins = bins.map_or(Ok(RangeBins::default()), |edges| {
        RangeBins::new(edges)
            .ok_or_else(|| SettingError::new_err("bins are edges in m that grow, such as [2, 5, 10]"))
    })?;
    for (name, value) in [("spot_gate", spot_gate), ("bearing_gate", bearing_gate)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(SettingError::new_err(format!("{name} is {value}, it must be above 0")));
        }
    }
    let (mut truth, time_tolerance_s) = truth.read(py)?;
    let mut results = results.read(py)?;
    truth.retain(|frame| frame.camera == only);
    results.retain(|record| record.camera == only);
    let mut settings = Settings::default();
    settings.spot_gate_px = spot_gate;
    settings.bearing_gate_rad = bearing_gate.to_radians();
    settings.time_tolerance_s = time_tolerance_s;
    settings.bins = bins;
    let scores = detached(py, || {
        let evaluation = photinus_evaluate::evaluate(&truth, &results, &settings);
        Ok(evaluation.map_err(|error| EvaluationError::new_err(error.to_string()))?.scores)
    })?;
    json::object(py, &scores)
}

impl TruthOption<'_> {
    /// The frames, and how far times of the same frame may differ, s: half the time between frames.
    fn read(&self, py: Python<'_>) -> PyResult<(Vec<TruthFrame>, f64)> {
        let frames: Vec<TruthFrame> = match self {
            Self::Frames(frames) => frames.iter().map(|frame| frame.get().0.as_ref().clone()).collect(),
            Self::File(path) => return detached(py, || read(path)),
        };
        let tolerance_s = tolerance_s(&frames);
        Ok((frames, tolerance_s))
    }
}

fn read(path: &Path) -> PyResult<(Vec<TruthFrame>, f64)> {
    if path.is_file() && Kind::of(path).map_err(error::file)? == Kind::Truth {
        let frames = read_truth(path).map_err(error::file)?;
        let tolerance_s = tolerance_s(&frames);
        return Ok((frames, tolerance_s));
    }
    let dataset = Dataset::read(path).map_err(error::file)?;
    let truth = dataset.truth().map_err(error::file)?;
    let truth = truth.ok_or_else(|| {
        EvaluationError::new_err(format!("{}: the folder holds no truth.jsonl", path.display()))
    })?;
    Ok((truth, 0.5 / dataset.info().rate_hz))
}

/// Half the usual time between frames, s; a single frame has nothing to be mistaken for.
fn tolerance_s(frames: &[TruthFrame]) -> f64 {
    let mut times_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    times_s.sort_by(f64::total_cmp);
    let mut steps_s: Vec<f64> =
        times_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|&step_s| step_s > 0.0).collect();
    steps_s.sort_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).map_or(0.5, |step_s| 0.5 * step_s)
}

impl ResultsOption<'_> {
    fn read(&self, py: Python<'_>) -> PyResult<Vec<FrameRecord>> {
        match self {
            Self::Records(records) => {
                Ok(records.iter().map(|record| record.get().0.as_ref().clone()).collect())
            }
            Self::File(path) => {
                detached(py, || read_results(path).and_then(Iterator::collect).map_err(error::file))
            }
        }
    }
}
