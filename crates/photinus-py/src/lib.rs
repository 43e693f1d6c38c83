//! Photinus for Python: arrays and files in, light objects out, by the names of docs/file-formats.md.
//!
//! ```text
//! image      numpy array -> frame, borrowed, or an ImageError that names what is wrong
//! camera, airframe, options        what the method is told beforehand, with the program's names and defaults
//! detector, locator, following     frame -> record
//! record, table                    records as objects, many of them as an Arrow table
//! recording, simulation            frames from files and scenes
//! calibration, evaluation, codes, planning
//!                                  the program's commands of these names
//! ```
//!
//! Python's lock is released while Photinus works; what is learnt from frame to frame sits behind a lock of its own.

mod airframe;
mod calibration;
mod camera;
mod codes;
mod detector;
mod error;
mod evaluation;
mod following;
mod image;
mod json;
mod locator;
mod options;
mod planning;
mod record;
mod recording;
mod simulation;
mod table;

/// Tells a flying robot where its neighbours are from one ultraviolet camera.
#[pyo3::pymodule(name = "_native")]
mod native {
    /// The version of the wheel.
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // Python's name for it
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use crate::airframe::Airframe;
    #[pymodule_export]
    use crate::calibration::{CalibratedCamera, calibrate_camera};
    #[pymodule_export]
    use crate::camera::Camera;
    #[pymodule_export]
    use crate::codes::{CodeBook, CodeProperties};
    #[pymodule_export]
    use crate::detector::{Detector, detect};
    #[pymodule_export]
    use crate::error::{
        CalibrationError, CodeError, EvaluationError, FaultError, FileError, ImageError, PhotinusError,
        PhotinusWarning, SettingError,
    };
    #[pymodule_export]
    use crate::evaluation::evaluate;
    #[pymodule_export]
    use crate::locator::Locator;
    #[pymodule_export]
    use crate::planning::{example_setup, plan};
    #[pymodule_export]
    use crate::record::{
        Distance, Identity, Misfit, Mode, Neighbour, Record, Rejected, RunnerUp, Spot, Track, Truth,
        TruthLed, TruthNeighbour, read_results, read_truth,
    };
    #[pymodule_export]
    use crate::recording::{Dataset, Frame, Frames, frames, read_image};
    #[pymodule_export]
    use crate::simulation::{Simulation, simulate};
    #[pymodule_export]
    use crate::table::{Table, neighbours_table, spots_table};
}
