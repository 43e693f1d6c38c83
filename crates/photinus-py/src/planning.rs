//! A set-up that nobody has built yet -> how far and how exactly it will see, as `photinus plan --json` tells it.

use std::path::PathBuf;

use photinus_plan::{EXAMPLE, Plan, Setup};
use pyo3::prelude::*;

use crate::error::{self, detached};
use crate::json;

/// How far and how exactly LEDs, lens, sensor and airframe will see, as the dict of `photinus plan --json`: docs/planning.md says what is in it
/// and how far it holds. `setup` is a TOML file as `example_setup` has it. Takes some seconds. Raises FileError with the key that has no meaning.
#[pyfunction]
pub(crate) fn plan(py: Python<'_>, setup: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let plan = detached(py, || Ok(Plan::new(&Setup::read(&setup).map_err(error::file)?)))?;
    json::object(py, &plan)
}

/// The text of a set-up with every key explained: the founding paper's.
#[pyfunction]
pub(crate) fn example_setup() -> &'static str {
    EXAMPLE
}
