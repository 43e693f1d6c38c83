//! Errors and warnings of Photinus as exceptions of Python.

use std::any::Any;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyUserWarning};
use pyo3::prelude::*;

create_exception!(photinus, PhotinusError, PyException, "What Photinus refuses: the base of its errors.");
create_exception!(
    photinus,
    FileError,
    PhotinusError,
    "A file that cannot be read or written, or does not follow its format; the message names the place in it and what to do."
);
create_exception!(
    photinus,
    ImageError,
    PhotinusError,
    "An array that is no frame: another type of pixels, another shape or size, strides that would need a copy."
);
create_exception!(photinus, SettingError, PhotinusError, "An option whose value has no meaning.");
create_exception!(photinus, CalibrationError, PhotinusError, "Photos that tell no camera.");
create_exception!(photinus, EvaluationError, PhotinusError, "Truth and results that cannot be compared.");
create_exception!(photinus, CodeError, PhotinusError, "Requirements that no code book can be searched for.");
create_exception!(photinus, FaultError, PhotinusError, "A fault of Photinus itself; please report it.");
create_exception!(
    photinus,
    PhotinusWarning,
    PyUserWarning,
    "What is odd about a file, or taken otherwise than it stands in it."
);

/// A file that was refused.
pub(crate) fn file(error: photinus_io::Error) -> PyErr {
    FileError::new_err(error.to_string())
}

/// A setting that was refused.
pub(crate) fn setting(error: impl ToString) -> PyErr {
    SettingError::new_err(error.to_string())
}

/// Does `work` while other threads of Python run; a panic in it is a [`FaultError`], not the end of the interpreter.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
    // What work leaves behind in a detector or locator is made anew by the next frame.
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).unwrap_or_else(|payload| Err(fault(payload.as_ref())))
}

fn fault(payload: &(dyn Any + Send)) -> PyErr {
    let reason = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("it does not say why");
    FaultError::new_err(format!("a fault in Photinus: {reason}; please report it, with the file if you may"))
}

/// Tells what is odd about a file, a warning each.
pub(crate) fn warn(py: Python<'_>, path: &std::path::Path, notes: &[String]) -> PyResult<()> {
    let category = py.get_type::<PhotinusWarning>();
    for note in notes {
        let text = format!("{}: {note}", path.display()).replace('\0', "");
        PyErr::warn(py, &category, &CString::new(text)?, 1)?;
    }
    Ok(())
}
