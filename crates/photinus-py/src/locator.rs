//! Frames -> neighbours.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use photinus::locator::{self, Input, LocateError, Located, Settings};
use photinus::pose;
use photinus::spots::Spot;
use photinus_io::airframe::Tolerances;
use photinus_io::calibration::{MountingFile, read_mounting};
use photinus_io::results::FrameRecord;
use pyo3::prelude::*;

use crate::airframe::Airframe;
use crate::camera::Camera;
use crate::error::{self, ImageError, detached};
use crate::image::Image;
use crate::options::{MaskOption, direction, spot_curve, spot_settings};
use crate::record::{Record, empty};

/// Locates neighbours of one kind of airframe in frame after frame of one camera, as `photinus locate` does: optics, the power of LEDs
/// and clutter are learnt from the frames that came before. Making one takes up to a second. May be shared by threads, which then
/// wait for each other.
///
/// Options: `contrast`, `threshold`, `reflection_ratio` and `mask` as for Detector; `mounting`, a TOML file that says how the camera sits on
/// its vehicle: neighbours are told in the body frame, too; `spot_curve`, a TOML file, or "paper";
/// `max_tilt`, deg, that the bounds allow for where gravity is known; `min_probability`, neighbours less likely are left out; `budget`,
/// most looks at a handful of spots per frame; `tilt_sigma`, deg, how far neighbours tilt; `marker_sigma`, m, how far LEDs are from
/// where the airframe says (what its file says, else 0.003); `power_spread`, a share, of the power of LEDs (what the file says, else
/// 0.2); `scale_sigma`, a share, of the size of the airframe; `miss_rate`, how often a marker does not show; `no_brightness`, leave
/// brightness out of the pose. Raises SettingError, FileError, ImageError.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Locator {
    locator: Mutex<locator::Locator>,
    camera: Py<Camera>,
    airframe: Py<Airframe>,
    mounting: Option<MountingFile>,
}

#[pymethods]
impl Locator {
    #[new]
    #[pyo3(signature = (
        camera, airframe, *, contrast = None, threshold = None, reflection_ratio = 0.22, mask = None, mounting = None, spot_curve = None,
        max_tilt = 15.0, min_probability = 0.5, budget = 12000, tilt_sigma = 5.0, marker_sigma = None, power_spread = None,
        scale_sigma = 0.01, miss_rate = 0.02, no_brightness = false
    ))]
    #[allow(clippy::too_many_arguments)] // the options of the program, by name
    fn new(
        py: Python<'_>,
        camera: Py<Camera>,
        airframe: Py<Airframe>,
        contrast: Option<u8>,
        threshold: Option<u8>,
        reflection_ratio: f64,
        mask: Option<MaskOption<'_>>,
        mounting: Option<PathBuf>,
        spot_curve: Option<PathBuf>,
        max_tilt: f64,
        min_probability: f64,
        budget: u32,
        tilt_sigma: f64,
        marker_sigma: Option<f64>,
        power_spread: Option<f64>,
        scale_sigma: f64,
        miss_rate: f64,
        no_brightness: bool,
    ) -> PyResult<Self> {
        let Tolerances { position_sigma_m, power_sigma, .. } = airframe.get().0.tolerances;
        let default = pose::Settings::default();
        let settings = Settings {
            spots: spot_settings(contrast, threshold, reflection_ratio)?,
            max_tilt_rad: max_tilt.to_radians(),
            pose: pose::Settings {
                tilt_sigma_rad: tilt_sigma.to_radians(),
                marker_sigma_m: marker_sigma.or(position_sigma_m).unwrap_or(default.marker_sigma_m),
                unit_sigma: power_spread.or(power_sigma).unwrap_or(default.unit_sigma),
                scale_sigma,
                missed: miss_rate,
                use_brightness: !no_brightness,
                ..default
            },
            min_probability,
            budget,
        };
        let curve =
            spot_curve.map(|path| self::spot_curve(py, &path, settings.spots.brightness)).transpose()?;
        let mounting =
            mounting.map(|path| detached(py, || read_mounting(&path).map_err(error::file))).transpose()?;
        let mask = mask.map(|mask| mask.read(py)).transpose()?;
        let (seen_by, seen) = (&camera.get().camera, &airframe.get().0.airframe);
        let locator = detached(py, || {
            let mut locator =
                locator::Locator::new(seen_by.clone(), seen, curve, settings).map_err(error::setting)?;
            locator.set_mask(mask).map_err(|error| ImageError::new_err(error.to_string()))?;
            Ok(Mutex::new(locator))
        })?;
        Ok(Self { locator, camera, airframe, mounting })
    }

    /// The neighbours in an image: uint8, (rows, columns) of the camera's size, rows may be padded; it is borrowed, not copied, and
    /// must not be written to meanwhile. `gravity` is down in the camera frame, of any length, where it is known. `time`, s, and
    /// `frame`, its number, stand in the record as given.
    ///
    /// Raises ImageError when the array is no frame of this camera, SettingError when gravity points nowhere.
    #[pyo3(signature = (image, *, gravity = None, time = None, frame = None))]
    fn locate(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        gravity: Option<[f64; 3]>,
        time: Option<f64>,
        frame: Option<u64>,
    ) -> PyResult<Record> {
        let image = Image::borrow(image)?;
        let (view, gravity) = (image.view()?, gravity.map(direction).transpose()?);
        let record = empty(frame, time)?;
        detached(py, || {
            // Whatever a fault left is made anew by the frame.
            let mut locator = self.locator.lock().unwrap_or_else(PoisonError::into_inner);
            let located =
                locator.locate(Input::frame(&view).gravity(gravity.as_ref())).map_err(wrong_size)?;
            Ok(self.told(record, located))
        })
    }

    /// The neighbours behind the spots of a record, such as those of another detector: see `read_results` and `Record.from_json`.
    #[pyo3(signature = (record, *, gravity = None))]
    fn locate_spots(
        &self,
        py: Python<'_>,
        record: &Bound<'_, Record>,
        gravity: Option<[f64; 3]>,
    ) -> PyResult<Record> {
        let gravity = gravity.map(direction).transpose()?;
        let record = record.get().0.as_ref().clone();
        detached(py, || {
            let spots: Vec<(Spot, Option<u32>)> =
                record.spots.iter().map(|spot| (Spot::from(spot), spot.signal)).collect();
            let mut locator = self.locator.lock().unwrap_or_else(PoisonError::into_inner);
            let input = Input::signalled(&spots).gravity(gravity.as_ref());
            Ok(self.told(record, locator.locate(input).map_err(wrong_size)?))
        })
    }

    /// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before.
    fn forget(&self, py: Python<'_>) {
        py.detach(|| self.locator.lock().unwrap_or_else(PoisonError::into_inner).forget());
    }

    /// The camera that it looks through.
    #[getter]
    fn camera(&self, py: Python<'_>) -> Py<Camera> {
        self.camera.clone_ref(py)
    }

    /// The airframe that it looks for.
    #[getter]
    fn airframe(&self, py: Python<'_>) -> Py<Airframe> {
        self.airframe.clone_ref(py)
    }
}

impl Locator {
    /// The record with what was located in its frame.
    fn told(&self, mut record: FrameRecord, located: &Located) -> Record {
        record.put_located(located, &[self.airframe.get().0.airframe.name()]);
        if let Some(mounting) = &self.mounting {
            record.put_mounting(mounting);
        }
        Record(Arc::new(record))
    }
}

fn wrong_size(error: LocateError) -> PyErr {
    ImageError::new_err(format!("{error}; give the calibration of this camera at this resolution"))
}
