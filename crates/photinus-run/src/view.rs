//! What looks through one camera: enters a frame, leaves its record with neighbours, tracks and names, in the body frame where the mounting is known.

use nalgebra::{Unit, Vector3};
use photinus::camera::Camera;
use photinus::frame::Mask;
use photinus::locator::{Input, Kind, Locator, LocatorError, Settings, Stage};
use photinus::ranging::SpotCurve;
use photinus::spots::Spot;
use photinus_io::calibration::MountingFile;
use photinus_io::image::GreyImage;
use photinus_io::sky::Sky;
use photinus_io::{Error, Place, Result};

use crate::contradictions::Contradictions;
use crate::daylight::Daylight;
use crate::watch::Watch;
use crate::{Clock, Entry, Work};

/// What looks through one camera.
pub struct View {
    /// The camera.
    pub camera: Camera,
    mounting: Option<MountingFile>,
    mask: Option<Mask>,
    locator: Locator,
    watch: Option<Watch>,
    /// The names of the neighbours' airframes, by kind.
    airframes: Vec<String>,
    gravity: Option<Unit<Vector3<f64>>>,
    daylight: Daylight,
    contradictions: Contradictions,
}

impl View {
    /// For neighbours of these kinds.
    ///
    /// # Errors
    /// [`LocatorError`] when a setting has no meaning, or the mask is of another size.
    pub fn new(
        camera: Camera,
        kinds: &[Kind],
        curve: Option<SpotCurve>,
        settings: Settings,
        mask: Option<&Mask>,
    ) -> std::result::Result<Self, LocatorError> {
        let contradictions = Contradictions::of(&settings, kinds);
        let mut locator = Locator::of_kinds(camera.clone(), kinds, curve, settings)?;
        locator.set_mask(mask.cloned())?;
        let airframes = kinds.iter().map(|kind| kind.airframe.name().to_owned()).collect();
        let mask = mask.cloned();
        Ok(Self {
            camera,
            mounting: None,
            mask,
            locator,
            watch: None,
            airframes,
            gravity: None,
            daylight: Daylight::default(),
            contradictions,
        })
    }

    /// How it sits on its vehicle, where that is known.
    pub fn mounting(&self) -> Option<&MountingFile> {
        self.mounting.as_ref()
    }

    /// Where it does not look.
    pub fn mask(&self) -> Option<&Mask> {
        self.mask.as_ref()
    }

    /// It sits so on its vehicle, where that is known.
    #[must_use]
    pub fn mounted(self, mounting: Option<MountingFile>) -> Self {
        Self { mounting, ..self }
    }

    /// Frames are followed from one to the next.
    #[must_use]
    pub fn following(self, watch: Watch) -> Self {
        Self { watch: Some(watch), ..self }
    }

    /// Down in the camera frame in every frame, whatever the source says.
    #[must_use]
    pub fn level(self, gravity: Option<Unit<Vector3<f64>>>) -> Self {
        Self { gravity, ..self }
    }

    /// The sky that it looks at, where place and time are known.
    #[must_use]
    pub fn under(self, sky: Option<Sky>) -> Self {
        Self { daylight: Daylight::under(sky), ..self }
    }
}

impl Work for View {
    fn fill(&mut self, entry: &mut Entry, clock: &mut Clock) -> Result<()> {
        let live = || self.watch.as_ref()?.down(entry);
        entry.gravity = self.gravity.or(entry.gravity).or_else(live);
        entry.sun = self.daylight.sun(entry.record.time_s, entry.gravity.as_ref());
        locate(entry, &mut self.locator, &self.airframes, clock)?;
        self.contradictions.see(self.locator.located());
        if let Some(watch) = &self.watch {
            watch.follow(entry, self.locator.located());
            clock.lap("following");
        }
        if let Some(mounting) = &self.mounting {
            entry.record.put_mounting(mounting);
        }
        Ok(())
    }

    fn learns(&self) -> bool {
        // What is remembered of each frame depends on those before it.
        true
    }

    fn learn(&mut self, entry: &mut Entry) {
        // A frame of another size is refused, and teaches nothing.
        let _ = self.fill(entry, &mut Clock::new());
    }

    fn remarks(&mut self) -> Vec<String> {
        let mut remarks = self.watch.as_ref().map_or_else(Vec::new, Watch::remarks);
        remarks.extend(self.contradictions.remarks());
        remarks
    }
}

/// The views of cameras that are mounted together: each entry says which one it is of.
impl Work for Vec<View> {
    fn fill(&mut self, entry: &mut Entry, clock: &mut Clock) -> Result<()> {
        self[entry.camera].fill(entry, clock)
    }

    fn learns(&self) -> bool {
        true
    }

    fn learn(&mut self, entry: &mut Entry) {
        self[entry.camera].learn(entry);
    }

    fn remarks(&mut self) -> Vec<String> {
        self.iter_mut().flat_map(View::remarks).collect()
    }
}

/// Completes the record of a frame by itself.
///
/// # Errors
/// [`Error`] when the frame is not of the camera's size.
pub fn locate(
    entry: &mut Entry,
    locator: &mut Locator,
    airframes: &[impl AsRef<str>],
    clock: &mut Clock,
) -> Result<()> {
    let gravity = entry.gravity.as_ref();
    let finished = &mut |stage: Stage| clock.lap(stage.name());
    let view = entry.image.as_ref().map(GreyImage::view);
    let given = entry.record.spots.iter().map(|record| (Spot::from(record), record.signal));
    let spots: Vec<(Spot, Option<u32>)> = given.collect();
    let input = view.as_ref().map_or_else(|| Input::signalled(&spots), Input::frame);
    let input = input.gravity(gravity).sun(entry.sun).exposure(entry.exposure_s).finished(finished);
    let located = locator.locate(input).map_err(|error| {
        let advice = "give the calibration of this camera at this resolution; frames are not scaled";
        in_frame(Error::format(&entry.record.source, error.to_string()).advise(advice), entry)
    })?;
    entry.record.put_located(located, airframes);
    Ok(())
}

/// Says which frame an error is about, where the file does not say it.
pub fn in_frame(error: Error, entry: &Entry) -> Error {
    match entry.record.frame {
        Some(frame) => error.at(Place::Frame(frame)),
        None => error,
    }
}
