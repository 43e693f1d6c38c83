//! A frame -> neighbours: the whole flow on one page.
//!
//! ```text
//! frame -> spots     what is bright                         crate::spots
//!       -> sightings where each spot lies, how sure, how far  sighting; how bright, brightness
//!       -> groups    which spots are one neighbour          grouping, by kinds, each by its matching
//!       -> poses     where, how turned, between which bounds  posing, by matching, crate::pose and crate::ranging
//! ```
//!
//! Without identities the spots of a neighbour are interchangeable. What the airframe can look like is laid out once, in
//! `views`; `matching` asks how well a handful of spots looks like one of those views, which tells whether they belong
//! together and which markers they may be. From there [`crate::pose`] finds every pose that explains them and how sure each
//! is; the bounds are strict and come from [`crate::ranging::DistanceBounds`] and spot sizes alone.

mod alternatives;
mod blinking;
mod brightness;
mod candidates;
mod cells;
mod clutter;
mod companions;
mod context;
mod error;
mod explanation;
mod fixtures;
mod grouping;
mod inference;
mod input;
mod kinds;
mod matching;
mod memory;
mod near;
mod neighbour;
mod number;
mod pairs;
mod places;
mod posing;
mod settings;
mod sighting;
mod sun;
mod telling;
mod views;
mod whereabouts;

use crate::airframe::Airframe;
use crate::camera::{Camera, Watched};
use crate::frame::{FrameView, Mask};
use crate::pose::LogLight;
use crate::ranging::SpotCurve;
use crate::spots::{Detector, Reason, Rejected, Spot};
use cells::ByCell;
pub use error::{LocateError, LocatorError};
use inference::Inference;
pub use input::Input;
use input::Seen;
pub use kinds::Kind;
pub use neighbour::{Distance, Located, Neighbour, Orientation, Position, RunnerUp};
pub(crate) use posing::{LOG_RANGE, of_mean_calibration};
pub use settings::Settings;
pub use sighting::Sighting;
pub use sun::Sun;

/// A stage of the flow, named when it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// Spots were found.
    Spots,
    /// Spots have bearings.
    Bearings,
    /// Spots were sorted by neighbour.
    Grouping,
    /// Neighbours have poses and distances.
    Posing,
}

impl Stage {
    /// One lowercase word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spots => "spots",
            Self::Bearings => "bearings",
            Self::Grouping => "grouping",
            Self::Posing => "posing",
        }
    }
}

/// Locates neighbours of one kind of airframe, or of several, in the frames of one camera. Keeps its room from frame to
/// frame, so that a warm locator allocates nothing.
#[derive(Debug)]
pub struct Locator {
    camera: Camera,
    curve: Option<SpotCurve>,
    mask: Option<Mask>,
    detector: Detector,
    inference: Inference,
    by_cell: ByCell,
    /// Of other detectors' spots.
    any_detection_limit: LogLight,
    unit: brightness::Unit,
    located: Located,
}

impl Locator {
    /// A locator of one kind; lays out what the airframe can look like, which takes a tenth of a second to a second.
    ///
    /// # Errors
    /// [`LocatorError`] when a setting has no meaning.
    pub fn new(
        camera: Camera,
        airframe: &Airframe,
        curve: Option<SpotCurve>,
        settings: Settings,
    ) -> Result<Self, LocatorError> {
        Self::of_kinds(camera, &[Kind::new(airframe.clone(), &settings.pose)], curve, settings)
    }

    /// A locator of several kinds at once, each as likely beforehand. [`Neighbour::kind`] is the place in `kinds`.
    ///
    /// # Errors
    /// [`LocatorError`] when a setting has no meaning, or there is no kind.
    pub fn of_kinds(
        camera: Camera,
        kinds: &[Kind],
        curve: Option<SpotCurve>,
        settings: Settings,
    ) -> Result<Self, LocatorError> {
        if !(0.0..=core::f64::consts::PI).contains(&settings.max_tilt_rad) {
            return Err(LocatorError::Tilt(settings.max_tilt_rad));
        }
        if !(0.0..=1.0).contains(&settings.min_probability) {
            return Err(LocatorError::Probability(settings.min_probability));
        }
        let detector = Detector::with_optics(settings.spots, camera.optics().cloned())?;
        let inference = Inference::new(&camera, kinds, &settings)?;
        Ok(Self {
            camera,
            curve,
            mask: None,
            detector,
            inference,
            by_cell: ByCell::default(),
            any_detection_limit: Detector::any_detection_limit(&settings.spots),
            unit: brightness::Unit::default(),
            located: Located { is_complete: true, ..Located::default() },
        })
    }

    /// Sets where not to look.
    ///
    /// # Errors
    /// [`LocatorError::Mask`] when the mask is not of the camera's size.
    pub fn set_mask(&mut self, mask: Option<Mask>) -> Result<(), LocatorError> {
        if let Some(mask) = &mask {
            mask.check_size(self.camera.width(), self.camera.height()).map_err(LocatorError::Mask)?;
        }
        self.mask = mask;
        Ok(())
    }

    /// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before.
    pub fn forget(&mut self) {
        self.inference.forget();
        self.unit = brightness::Unit::default();
    }

    /// What it told of the frame that it was handed last.
    #[must_use]
    pub fn located(&self) -> &Located {
        &self.located
    }

    /// The camera in use.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Locates the neighbours in a frame, or behind the spots of one.
    ///
    /// # Errors
    /// [`LocateError::Size`] when the frame is not of the camera's size; spots have none.
    pub fn locate(&mut self, mut input: Input<'_>) -> Result<&Located, LocateError> {
        match input.seen {
            Seen::Frame(frame) => self.detect(frame, &mut input)?,
            Seen::Spots(spots) => self.sight(spots.iter().map(|spot| (spot, None)), &mut input),
            Seen::Signalled(spots) => {
                self.sight(spots.iter().map(|(spot, signal)| (spot, *signal)), &mut input);
            }
        }
        let size = [self.camera.width(), self.camera.height()];
        let vignetting = self.camera.optics().and_then(|optics| optics.vignetting.as_ref());
        let most = self.inference.most();
        brightness::tell(&mut self.located.sightings, vignetting, most, size, &mut self.by_cell);
        let log_longer = self.unit.log_longer(input.exposure_s);
        brightness::shorten(&mut self.located, log_longer);
        input.tell(Stage::Bearings);
        let watched = Watched::new(&self.camera, self.mask.as_ref());
        self.inference.explain(&mut self.located, watched, &mut input);
        Ok(&self.located)
    }

    /// Sights the spots of a frame.
    fn detect(&mut self, frame: &FrameView<'_>, input: &mut Input<'_>) -> Result<(), LocateError> {
        let size = LocateError::Size {
            width: frame.width(),
            height: frame.height(),
            camera_width: self.camera.width(),
            camera_height: self.camera.height(),
        };
        if (frame.width(), frame.height()) != (self.camera.width(), self.camera.height()) {
            return Err(size);
        }
        let detections = self.detector.detect(frame, self.mask.as_ref()).map_err(|_| size)?;
        self.located.rejected.clone_from(&detections.rejected);
        input.tell(Stage::Spots);
        let spots = detections.spots.iter().map(|spot| (spot, None));
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
        self.located.detection_limit = self.detector.detection_limit();
        Ok(())
    }

    /// Sights the spots of another detector.
    fn sight<'a>(&mut self, spots: impl Iterator<Item = (&'a Spot, Option<u32>)>, input: &mut Input<'_>) {
        self.located.rejected.clear();
        self.located.detection_limit = Some(self.any_detection_limit);
        input.tell(Stage::Spots);
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
    }
}

/// Gives every spot its bearing; those that have none are rejected.
fn sight_all<'a>(
    camera: &Camera,
    curve: Option<&SpotCurve>,
    spots: impl Iterator<Item = (&'a Spot, Option<u32>)>,
    located: &mut Located,
) {
    located.sightings.clear();
    for (spot, signal) in spots {
        match sighting::sight(camera, curve, spot, signal) {
            Some(sighting) => located.sightings.push(sighting),
            None => located.rejected.push(Rejected {
                centre: spot.centre,
                area_px: spot.area_px,
                peak: spot.peak,
                reason: Reason::Outside,
                extent: spot.extent,
            }),
        }
    }
}

#[cfg(test)]
mod tests;
