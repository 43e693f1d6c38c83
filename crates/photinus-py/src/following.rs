//! What frames change: a locator, where the sun stands, and what follows vehicles from one frame to the next, as in the program.

use nalgebra::{Unit, Vector3};
use photinus::camera::Camera;
use photinus::frame::{FrameView, Mask};
use photinus::locator::{Input, Kind, Locator, Settings};
use photinus::lookout::Fleet;
use photinus::spots::Spot;
use photinus_io::calibration::MountingFile;
use photinus_io::results::FrameRecord;
use photinus_run::course::Course;
use photinus_run::watch::{self, Looking, Watch};
use photinus_run::{Daylight, Entry};
use pyo3::prelude::*;

use crate::error::{self, ImageError};
use crate::recording::Dataset;

/// What a recording tells beside its frames: who blinks what, how its camera turned, how long it exposed.
pub(crate) struct Beside {
    fleets: Vec<Option<Fleet>>,
    course: Course,
    exposure_us: Option<f64>,
}

impl Beside {
    /// Of a recording, or of frames alone.
    ///
    /// # Errors
    /// `FileError` when a table of the recording is not in order.
    pub(crate) fn of(
        recording: Option<&Dataset>,
        kinds: &[Kind],
        mounting: Option<&MountingFile>,
        remarks: &mut Vec<String>,
    ) -> PyResult<Self> {
        let dataset = recording.map(|recording| &recording.dataset);
        let fleets = watch::fleets(dataset, kinds, |text| remarks.push(text)).map_err(error::file)?;
        let course = |recording: &Dataset| {
            Course::of(&recording.dataset, recording.of_camera().name.is_some(), mounting)
                .map_err(error::file)
        };
        Ok(Self {
            fleets,
            course: recording.map_or_else(|| Ok(Course::default()), course)?,
            exposure_us: recording.map(|recording| recording.of_camera().exposure_us),
        })
    }

    /// What follows vehicles of these kinds.
    ///
    /// # Errors
    /// `SettingError` when a setting has no meaning.
    pub(crate) fn watch(
        self,
        camera: &Camera,
        kinds: &[Kind],
        settings: &Settings,
        mask: Option<&Mask>,
    ) -> PyResult<Watch> {
        let Self { fleets, course, exposure_us } = self;
        let (camera, mask) = (camera.clone(), mask.cloned());
        let looking = Looking { camera, mask, mounting: None, course, exposure_us };
        Watch::alone(looking, kinds, settings, &fleets).map_err(error::setting)
    }
}

/// What frames change.
pub(crate) struct State {
    pub(crate) locator: Locator,
    watch: Option<Watch>,
    daylight: Daylight,
}

impl State {
    /// Before the first frame of a recording, or of frames alone.
    pub(crate) fn new(locator: Locator, watch: Option<Watch>, recording: Option<&Dataset>) -> Self {
        let sky = recording.and_then(|recording| recording.dataset.sky());
        Self { locator, watch, daylight: Daylight::under(sky) }
    }

    /// The record with what was located in its frame, or behind its spots where there is none, and what a user should know.
    ///
    /// # Errors
    /// `ImageError` when the frame is not of the camera's size.
    pub(crate) fn locate(
        &mut self,
        record: FrameRecord,
        gravity: Option<Unit<Vector3<f64>>>,
        frame: Option<&FrameView<'_>>,
        airframes: &[String],
    ) -> PyResult<(FrameRecord, Vec<String>)> {
        let spots: Vec<(Spot, Option<u32>)> =
            record.spots.iter().map(|spot| (Spot::from(spot), spot.signal)).collect();
        let input = frame.map_or_else(|| Input::signalled(&spots), Input::frame);
        let sun = self.daylight.sun(record.time_s, gravity.as_ref());
        let located = self.locator.locate(input.gravity(gravity.as_ref()).sun(sun)).map_err(|error| {
            ImageError::new_err(format!("{error}; give the calibration of this camera at this resolution"))
        })?;
        let mut entry = Entry::from_spots(record);
        entry.gravity = gravity;
        entry.record.put_located(located, airframes);
        let Some(watch) = &self.watch else { return Ok((entry.record, Vec::new())) };
        watch.follow(&mut entry, located);
        Ok((entry.record, watch.remarks()))
    }
}
