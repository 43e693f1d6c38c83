//! Values as JSON text, and JSON text as objects of Python: what stands in a file and what Python shows are the same.

use pyo3::prelude::*;

use crate::error::FaultError;

/// The text of a value, as files have it.
pub(crate) fn text(value: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| FaultError::new_err(error.to_string()))
}

/// The value as dicts, lists and numbers.
pub(crate) fn object<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text(value)?,))
}
