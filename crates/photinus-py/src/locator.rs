//! Frames -> neighbours.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Unit, Vector3};
use photinus::frame::FrameView;
use photinus::locator::{self, Kind, Settings};
use photinus_io::calibration::{MountingFile, read_mounting};
use photinus_io::results::FrameRecord;
use pyo3::prelude::*;

use crate::airframe::Airframe;
use crate::camera::Camera;
use crate::error::{self, ImageError, detached};
use crate::following::{Beside, State};
use crate::image::Image;
use crate::options::{MaskOption, direction, spot_curve, spot_settings};
use crate::record::{Record, empty};
use crate::recording::Dataset;

/// Locates neighbours in frame after frame of one camera, as `photinus locate` does: optics, the power of LEDs and clutter are learnt from
/// the frames that came before, and neighbours are followed through frames that have times. `airframe` is that of the neighbours, or a list:
/// one for each kind of them. With `recording` it is that recording's locator: what is not given (mask, mounting, spot curve) is the
/// recording's, and who blinks what, how the camera turned and where the sun stood, too. Making one takes up to a second. May be shared by threads, which then
/// wait for each other.
///
/// Options: `contrast`, `threshold`, `reflection_ratio` and `mask` as for Detector; `mounting`, a TOML file that says how the camera sits on
/// its vehicle: neighbours are told in the body frame, too; `spot_curve`, a TOML file, or "paper";
/// `max_tilt`, deg, that the bounds allow for where gravity is known; `min_probability`, neighbours less likely are left out; `budget`,
/// most looks at a handful of spots per frame; `tilt_sigma`, deg, how far neighbours tilt at least; `marker_sigma`, m, how far LEDs are from
/// where the airframe says (what its file says, else 0.003); `power_spread`, a share, of the power of LEDs (what the file says, else
/// 0.2); `scale_sigma`, a share, of the size of the airframe; `miss_rate`, how often a marker does not show, before frames tell it; `no_brightness`, leave
/// brightness out of the pose; `no_time`, every frame by itself: no tracks, no velocities, no ids. Raises SettingError, FileError, ImageError.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Locator {
    state: Mutex<State>,
    camera: Py<Camera>,
    airframes: Vec<Py<Airframe>>,
    names: Vec<String>,
    mounting: Option<MountingFile>,
}

/// The airframe of all neighbours, or that of each kind.
#[derive(FromPyObject)]
pub(crate) enum Airframes {
    One(Py<Airframe>),
    Several(Vec<Py<Airframe>>),
}

#[pymethods]
impl Locator {
    #[new]
    #[pyo3(signature = (
        camera, airframe, recording = None, *, contrast = None, threshold = None, reflection_ratio = 0.22, mask = None, mounting = None,
        spot_curve = None, max_tilt = 15.0, min_probability = 0.5, budget = 12000, tilt_sigma = 5.0, marker_sigma = None,
        power_spread = None, scale_sigma = 0.01, miss_rate = 0.02, no_brightness = false, no_time = false
    ))]
    #[allow(clippy::too_many_arguments)] // the options of the program, by name
    fn new(
        py: Python<'_>,
        camera: Py<Camera>,
        airframe: Airframes,
        recording: Option<Py<Dataset>>,
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
        no_time: bool,
    ) -> PyResult<Self> {
        let mut settings = Settings::default();
        settings.spots = spot_settings(contrast, threshold, reflection_ratio)?;
        settings.max_tilt_rad = max_tilt.to_radians();
        settings.pose.tilt_sigma_rad = tilt_sigma.to_radians();
        settings.pose.marker_sigma_m = marker_sigma.unwrap_or(settings.pose.marker_sigma_m);
        settings.pose.unit_sigma = power_spread.unwrap_or(settings.pose.unit_sigma);
        settings.pose.scale_sigma = scale_sigma;
        settings.pose.missed = miss_rate;
        settings.pose.use_brightness = !no_brightness;
        settings.min_probability = min_probability;
        settings.budget = budget;
        let airframes = match airframe {
            Airframes::One(airframe) => vec![airframe],
            Airframes::Several(airframes) => airframes,
        };
        let kinds = airframes.iter().map(|airframe| {
            let kind = Kind::new(airframe.get().0.airframe.clone(), &settings.pose);
            let tolerances = &airframe.get().0.tolerances;
            Kind {
                marker_sigma_m: marker_sigma.or(tolerances.position_sigma_m).unwrap_or(kind.marker_sigma_m),
                unit_sigma: power_spread.or(tolerances.power_sigma).unwrap_or(kind.unit_sigma),
                ..kind
            }
        });
        let kinds: Vec<Kind> = kinds.collect();
        let names: Vec<String> = kinds.iter().map(|kind| kind.airframe.name().to_owned()).collect();
        if let Some(name) =
            names.iter().enumerate().find_map(|(n, name)| names[..n].contains(name).then_some(name))
        {
            return Err(error::setting(format!(
                "two airframes are called {name:?}: records tell them by their names"
            )));
        }
        let recording = recording.as_ref().map(Py::get);
        let curve = spot_curve.or_else(|| recording?.spot_curve());
        let curve = curve.map(|path| self::spot_curve(py, &path, settings.spots.brightness)).transpose()?;
        let mounting =
            mounting.map(|path| detached(py, || read_mounting(&path).map_err(error::file))).transpose()?;
        let mounting = mounting.or_else(|| recording?.of_camera().mounting);
        let mask = mask.or_else(|| recording?.mask().map(MaskOption::File));
        let mask = mask.map(|mask| mask.read(py)).transpose()?;
        let seen_by = &camera.get().camera;
        let (state, remarks) = detached(py, || {
            let mut locator = locator::Locator::of_kinds(seen_by.clone(), &kinds, curve, settings)
                .map_err(error::setting)?;
            locator.set_mask(mask.clone()).map_err(|error| ImageError::new_err(error.to_string()))?;
            let mut remarks = Vec::new();
            let watch = match no_time {
                true => None,
                false => {
                    let beside = Beside::of(recording, &kinds, mounting.as_ref(), &mut remarks)?;
                    Some(beside.watch(seen_by, &kinds, &settings, mask.as_ref())?)
                }
            };
            Ok((Mutex::new(State::new(locator, watch, recording)), remarks))
        })?;
        let folder = recording.map_or("frames".into(), |recording| recording.dataset.path(""));
        error::warn(py, &folder, &remarks)?;
        Ok(Self { state, camera, airframes, names, mounting })
    }

    /// The neighbours in an image: uint8, (rows, columns) of the camera's size, rows may be padded; it is borrowed, not copied, and
    /// must not be written to meanwhile. `gravity` is down in the camera frame, of any length, where it is known. `time`, s, and
    /// `frame`, its number, stand in the record as given; frames that have times are followed, in the order in which they come.
    ///
    /// Raises ImageError when the array is no frame of this camera, SettingError when gravity points nowhere; warns with PhotinusWarning of times
    /// that tell nothing of tracks, once of each kind.
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
        self.look(py, record, gravity, Some(&view))
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
        self.look(py, record, gravity, None)
    }

    /// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before. Tracks begin anew by
    /// themselves where times jump.
    fn forget(&self, py: Python<'_>) {
        py.detach(|| self.state.lock().unwrap_or_else(PoisonError::into_inner).locator.forget());
    }

    /// The camera that it looks through.
    #[getter]
    fn camera(&self, py: Python<'_>) -> Py<Camera> {
        self.camera.clone_ref(py)
    }

    /// The airframe that it looks for; of several, the first.
    #[getter]
    fn airframe(&self, py: Python<'_>) -> Py<Airframe> {
        self.airframes[0].clone_ref(py)
    }

    /// The airframes that it looks for, one for each kind of neighbour.
    #[getter]
    fn airframes(&self, py: Python<'_>) -> Vec<Py<Airframe>> {
        self.airframes.iter().map(|airframe| airframe.clone_ref(py)).collect()
    }
}

impl Locator {
    /// The record with what was located in its frame, or behind its spots.
    fn look(
        &self,
        py: Python<'_>,
        record: FrameRecord,
        gravity: Option<Unit<Vector3<f64>>>,
        frame: Option<&FrameView<'_>>,
    ) -> PyResult<Record> {
        let (mut record, remarks) = detached(py, || {
            // Whatever a fault left is made anew by the frame.
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.locate(record, gravity, frame, &self.names)
        })?;
        if let Some(mounting) = &self.mounting {
            record.put_mounting(mounting);
        }
        error::warn(py, "frames".as_ref(), &remarks)?;
        Ok(Record(Arc::new(record)))
    }
}
