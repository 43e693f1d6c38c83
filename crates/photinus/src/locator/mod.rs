//! A frame -> neighbours: the whole flow on one page.
//!
//! ```text
//! frame -> spots     what is bright                         crate::spots
//!       -> sightings where each spot lies, how sure, how far  sighting; how bright, brightness
//!       -> groups    which spots are one neighbour          grouping, by matching
//!       -> poses     where, how turned, between which bounds  posing, by matching, crate::pose and crate::ranging
//! ```
//!
//! Without identities the spots of a neighbour are interchangeable. What the airframe can look like is laid out once, in
//! `views`; `matching` asks how well a handful of spots looks like one of those views, which tells whether they belong
//! together and which markers they may be. From there [`crate::pose`] finds every pose that explains them and how sure each
//! is; the bounds are strict and come from [`crate::ranging::DistanceBounds`] and spot sizes alone.

mod brightness;
mod grouping;
mod matching;
mod pairs;
mod posing;
mod sighting;
mod views;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::airframe::Airframe;
use crate::camera::{Bearing, Camera, Watched};
use crate::frame::{FrameError, FrameView, Mask};
use crate::pose::{self, LogLight, Mode};
use crate::ranging::{DistanceBounds, Estimate, Interval, SpotCurve};
use crate::spots::{self, Detector, Reason, Rejected, Spot};
use grouping::Groups;
use matching::Matcher;
use posing::Poser;

/// What a user may choose about locating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What is a spot.
    pub spots: spots::Settings,
    /// Largest tilt of a neighbour against the vertical that the bounds allow for, rad. Default 15 deg. Only with gravity
    /// does it say anything: without, any attitude is allowed.
    pub max_tilt_rad: f64,
    /// What is believed of a neighbour's pose beforehand.
    pub pose: pose::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            spots: spots::Settings::default(),
            max_tilt_rad: DistanceBounds::DEFAULT_MAX_TILT_RAD,
            pose: pose::Settings::default(),
        }
    }
}

/// Why a locator cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocatorError {
    /// A setting of the detector has no meaning.
    #[error("{0}")]
    Spots(#[from] spots::SettingsError),
    /// A prior or tolerance of the pose has no meaning.
    #[error("{0}")]
    Pose(#[from] pose::SettingsError),
    /// A tilt limit that is no angle from 0 to 180 deg.
    #[error("a tilt limit of {0} rad: it must be an angle from 0 to pi")]
    Tilt(f64),
    /// A mask of another size than the camera's image.
    #[error("{0}")]
    Mask(FrameError),
}

/// Why a frame cannot be located.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocateError {
    /// A frame of another size than the camera was calibrated for.
    #[error("the frame is {width}x{height}, the camera {camera_width}x{camera_height}")]
    Size {
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
        /// Columns of the camera's image.
        camera_width: usize,
        /// Rows of the camera's image.
        camera_height: usize,
    },
}

/// A stage of the flow, named when it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

/// A spot and where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// The spot.
    pub spot: Spot,
    /// Which of the airframe's signals it was seen to blink, where that is known.
    pub signal: Option<u32>,
    /// Its light, in units that are the same all over the frame, with what a saturated core hides put back; `None` where none
    /// was measured.
    pub log_light: Option<LogLight>,
    /// Its direction in the camera frame.
    pub bearing: Bearing,
    /// Covariance of the direction, rad^2, tangent to the sphere (rank 2): from the spot and, where the camera's file says
    /// how sure it is, from the calibration.
    pub covariance_rad2: Matrix3<f64>,
    /// The part of it that comes from the spot, and differs from spot to spot.
    pub spot_covariance_rad2: Matrix3<f64>,
    /// How far the direction turns per pixel there, where it turns most, rad/px.
    pub rad_per_px: f64,
    /// The marker's true direction is no further from the bearing, rad: its light falls within the box of pixels that its
    /// spot spans. The camera's calibration is taken as exact.
    pub bound_rad: f64,
    /// Distances at which a spot of this size is possible, where the curve of spot sizes is known.
    pub range: Option<Interval>,
}

/// How far away a neighbour is: from the camera's centre to the airframe's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Mean and standard deviation of the posterior; `None` only where no pose explains the spots.
    pub estimate: Option<Estimate>,
    /// Truth never leaves these, see [`DistanceBounds`]; the far end may be infinite.
    pub bounds: Interval,
    /// The paper's l_A of the widest pair of neighbouring markers, m; only for rings.
    pub perpendicular_m: Option<f64>,
    /// The paper's l_B of the same pair, m.
    pub inline_m: Option<f64>,
}

/// Where a neighbour is, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Mean, m.
    pub mean_m: Vector3<f64>,
    /// Covariance, m^2.
    pub covariance_m2: Matrix3<f64>,
}

/// How a neighbour is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Maps the body's coordinates to the camera's. Yaw is one of those that the airframe's symmetry makes equal; where
    /// signals of spots are known, one of those that they do not tell apart.
    pub camera_from_body: Rotation3<f64>,
    /// Covariance as a small rotation in the body frame (its third axis is yaw), rad^2.
    pub covariance_rad2: Matrix3<f64>,
}

/// Another robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbour {
    /// Direction of the airframe's origin in the camera frame.
    pub bearing: Bearing,
    /// How far away.
    pub distance: Distance,
    /// Where, over all modes.
    pub position: Option<Position>,
    /// How turned, over all modes.
    pub orientation: Option<Orientation>,
    first_member: usize,
    members: usize,
    first_mode: usize,
    modes: usize,
}

/// What one frame told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Located {
    /// Spots with their bearings.
    pub sightings: Vec<Sighting>,
    /// What is bright and no marker.
    pub rejected: Vec<Rejected>,
    /// Who is there, in the order of their first sighting.
    pub neighbours: Vec<Neighbour>,
    members: Vec<usize>,
    modes: Vec<Mode>,
}

impl Located {
    /// Which sightings are this neighbour, ascending.
    pub fn members(&self, neighbour: &Neighbour) -> &[usize] {
        self.members
            .get(neighbour.first_member..)
            .and_then(|rest| rest.get(..neighbour.members))
            .unwrap_or(&[])
    }

    /// The ways in which this neighbour's spots can be its airframe, the likeliest first.
    pub fn modes(&self, neighbour: &Neighbour) -> &[Mode] {
        self.modes.get(neighbour.first_mode..).and_then(|rest| rest.get(..neighbour.modes)).unwrap_or(&[])
    }
}

/// Locates neighbours of one kind of airframe in the frames of one camera. Keeps its room from frame to frame, so that a
/// warm locator allocates nothing.
#[derive(Debug)]
pub struct Locator {
    camera: Camera,
    curve: Option<SpotCurve>,
    mask: Option<Mask>,
    detector: Detector,
    matcher: Matcher,
    poser: Poser,
    groups: Groups,
    group: Vec<usize>,
    order: Vec<usize>,
    located: Located,
}

impl Locator {
    /// A locator; lays out what the airframe can look like, which takes a tenth of a second to a second.
    ///
    /// # Errors
    /// [`LocatorError`] when a setting has no meaning.
    pub fn new(
        camera: Camera,
        airframe: &Airframe,
        curve: Option<SpotCurve>,
        settings: Settings,
    ) -> Result<Self, LocatorError> {
        if !(0.0..=std::f64::consts::PI).contains(&settings.max_tilt_rad) {
            return Err(LocatorError::Tilt(settings.max_tilt_rad));
        }
        let detector = Detector::with_optics(settings.spots, camera.optics().cloned())?;
        Ok(Self {
            camera,
            curve,
            mask: None,
            detector,
            matcher: Matcher::new(airframe, settings.max_tilt_rad),
            poser: Poser::new(airframe, settings.pose, &settings.spots)?,
            groups: Groups::default(),
            group: Vec::with_capacity(airframe.markers().len()),
            order: Vec::new(),
            located: Located::default(),
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

    /// Whether frames still tell something of the camera, see [`Detector::learns`].
    pub fn learns(&self) -> bool {
        self.detector.learns()
    }

    /// Learns of the camera from a frame what [`Self::locate`] would have learnt, without locating anybody: for a run that goes on where
    /// another ended.
    ///
    /// # Errors
    /// [`LocateError::Size`] when the frame is not of the camera's size.
    pub fn learn(&mut self, frame: &FrameView<'_>) -> Result<(), LocateError> {
        let size = self.wrong_size(frame);
        self.detector.detect(frame, self.mask.as_ref()).map(|_| ()).map_err(|_| size)
    }

    /// The camera in use.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Locates the neighbours in `frame`. `gravity` is down in the camera frame, where it is known. `finished` is told
    /// each stage as it ends, so that a caller with a clock can time it.
    ///
    /// # Errors
    /// [`LocateError::Size`] when the frame is not of the camera's size.
    pub fn locate(
        &mut self,
        frame: &FrameView<'_>,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> Result<&Located, LocateError> {
        let size = self.wrong_size(frame);
        if (frame.width(), frame.height()) != (self.camera.width(), self.camera.height()) {
            return Err(size);
        }
        let detections = self.detector.detect(frame, self.mask.as_ref()).map_err(|_| size)?;
        self.located.rejected.clone_from(&detections.rejected);
        finished(Stage::Spots);
        let spots = detections.spots.iter().map(|spot| (spot, None));
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
        brightness::tell(&mut self.located.sightings, &mut self.order);
        finished(Stage::Bearings);
        Ok(self.tell_neighbours(gravity, finished))
    }

    /// Locates the neighbours behind spots that another detector found.
    pub fn locate_spots(
        &mut self,
        spots: &[Spot],
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.sight_and_tell(spots.iter().map(|spot| (spot, None)), gravity, finished)
    }

    /// The same with the signal that each spot was seen to blink, `None` where that is not known: with them a symmetric
    /// airframe's yaw is told as far as its signals differ. A signal that no LED of the airframe carries tells nothing, a
    /// wrong one little.
    pub fn locate_signalled(
        &mut self,
        spots: &[(Spot, Option<u32>)],
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.sight_and_tell(spots.iter().map(|(spot, signal)| (spot, *signal)), gravity, finished)
    }

    fn wrong_size(&self, frame: &FrameView<'_>) -> LocateError {
        LocateError::Size {
            width: frame.width(),
            height: frame.height(),
            camera_width: self.camera.width(),
            camera_height: self.camera.height(),
        }
    }

    fn sight_and_tell<'a>(
        &mut self,
        spots: impl Iterator<Item = (&'a Spot, Option<u32>)>,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.located.rejected.clear();
        finished(Stage::Spots);
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
        brightness::tell(&mut self.located.sightings, &mut self.order);
        finished(Stage::Bearings);
        self.tell_neighbours(gravity, finished)
    }

    fn tell_neighbours(
        &mut self,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.groups.sort_out(&self.located.sightings, gravity, &mut self.matcher);
        finished(Stage::Grouping);
        let watched = Watched::new(&self.camera, self.mask.as_ref());
        let Located { sightings, neighbours, members, modes, .. } = &mut self.located;
        neighbours.clear();
        members.clear();
        modes.clear();
        for group in self.groups.iter() {
            self.group.clear();
            self.group.extend_from_slice(group);
            let (neighbour, its_modes) =
                self.poser.tell(sightings, &mut self.group, gravity, watched, &mut self.matcher);
            neighbours.push(Neighbour {
                first_member: members.len(),
                first_mode: modes.len(),
                modes: its_modes.len(),
                ..neighbour
            });
            members.extend_from_slice(&self.group);
            modes.extend_from_slice(its_modes);
        }
        finished(Stage::Posing);
        &self.located
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
