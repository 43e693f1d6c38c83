//! Sightings and located neighbours, frame by frame -> tracks: where each vehicle is, how fast, how turned, and whether it exists.
//!
//! ```text
//! look        what a frame brings, and how the camera turned                look
//! motion      where everybody is expected                                   motion, splitting
//! clutter     lights that were nobody's: another sight of them is no news
//! ways        which spots may be which markers of whom, each with its       ways (branches, update)
//!             Kalman update; the pose room brings the measurement
//! joint       how likely each way is, no spot being two vehicles'           joint
//! state       vehicles as sums of normal distributions, and whether they    reduction, existence
//!             exist; wrong ones begin anew where frames have them           doubting
//!             new ones from located neighbours nobody claims                appearing
//! history     late frames in their place, and all after them again          history
//! tracks      one mean and covariance each                                  track
//! ```
//!
//! A vehicle is a small sum of normal distributions of position, velocity and attitude, so that what one frame leaves open (two spots fit two poses) is
//! settled by the next ones. Every spot updates it, also one marker alone. `step` has the flow of a frame.
//!
//! Cameras that are mounted on one vehicle share the tracks: what is believed stands in the axes of the camera of the last frame, and is turned and moved into
//! those of the next. A camera that does not look where a vehicle is tells nothing of it.

mod appearing;
mod branches;
mod clutter;
mod component;
mod doubting;
mod error;
mod existence;
mod gyro;
mod history;
mod joint;
mod look;
mod motion;
mod power;
mod reduction;
mod settings;
mod silent;
mod splitting;
mod state;
mod step;
#[cfg(test)]
pub(crate) mod tests;
mod track;
mod update;
mod ways;

use crate::airframe::Airframe;
use crate::camera::Rig;
use crate::frame::Mask;
use crate::locator;
use crate::pose::{LogLight, Symmetry};
pub use error::{TrackError, TrackerError};
pub use gyro::turned;
use history::History;
pub(crate) use look::SURELY_HEARD;
pub use look::{Blinking, Called, Calls, Followed, Lit, Look, Moving, Signalled, Turned};
use motion::{Motion, Turn};
pub use settings::{Association, Settings};
use step::{Model, Stepper};
pub use track::{Placed, Track, Tracked};

/// Follows the vehicles that one camera sees, or the cameras of one rig, all with the same airframe. Keeps its room from frame to frame, so that a warm
/// tracker allocates nothing.
#[derive(Debug)]
pub struct Tracker {
    model: Model,
    stepper: Stepper,
    history: History,
    tracked: Tracked,
}

impl Tracker {
    /// Frames so far behind the newest take their place, s.
    pub const MOST_LATE_S: f64 = 0.5;
    /// A time this much before or after the newest is another clock, s.
    pub const JUMP_S: f64 = 5.0;

    /// A tracker of what locators with these settings tell: of one camera, or of a rig.
    ///
    /// # Errors
    /// [`TrackerError`] when a setting has no meaning.
    pub fn new(
        rig: impl Into<Rig>,
        airframe: &Airframe,
        locator: &locator::Settings,
        settings: Settings,
    ) -> Result<Self, TrackerError> {
        locator.pose.check()?;
        settings.check()?;
        let model = Model {
            rig: rig.into(),
            airframe: airframe.clone(),
            symmetry: Symmetry::of(airframe),
            pose: locator.pose,
            settings,
        };
        let stepper = Stepper::new(airframe);
        let history = History::of(&model.rig);
        Ok(Self { model, stepper, history, tracked: Tracked::default() })
    }

    /// The cameras.
    pub fn rig(&self) -> &Rig {
        &self.model.rig
    }

    /// Sets where the locator of a camera does not look.
    ///
    /// # Errors
    /// [`TrackerError::Mask`] when the mask is not of the camera's size.
    ///
    /// # Panics
    /// If there is no camera of this number.
    pub fn set_mask(&mut self, camera: usize, mask: Option<Mask>) -> Result<(), TrackerError> {
        Ok(self.model.rig.set_mask(camera, mask)?)
    }

    /// Forgets all tracks. Their ids are not given again.
    pub fn forget(&mut self) {
        self.history.forget();
    }

    /// The light of an LED of intensity 1 at 1 m in a camera, where several tracks tell it.
    pub(crate) fn power(&mut self, camera: usize) -> Option<LogLight> {
        self.stepper.power(camera, self.history.newest()?)
    }

    /// Takes a frame in, and tells the tracks at its time, in its camera's axes; after a late one, [`Self::at`] tells those of the newest. Frames up to
    /// [`Self::MOST_LATE_S`] behind the newest take their place; one that is more than [`Self::JUMP_S`] off is of another clock: all tracks are forgotten
    /// first, and [`Tracked::placed`] says so. So is the second frame in a row, the one after the other, that lies among frames of its own camera where that has no gap, or
    /// farther behind them than can be made up for: such frames are not late, their clock was set back.
    ///
    /// # Errors
    /// [`TrackError`] for a time or a turn without meaning, a frame that is too late, and a second one of the same time; no track is changed then.
    pub fn track(&mut self, look: &Look<'_>) -> Result<&Tracked, TrackError> {
        look.check(&self.model.rig)?;
        let off_s = self.history.newest().map_or(0.0, |newest| look.time_s - newest.time_s);
        let placed = match off_s {
            _ if self.is_of_another_clock(look.camera, look.time_s) => Placed::Reset,
            _ if off_s < 0.0 => Placed::Late,
            _ => Placed::Newest,
        };
        if placed == Placed::Reset {
            self.history.forget();
        }
        self.history.note(look.camera, look.time_s);
        self.history.take_in(&mut self.stepper, &self.model, look)?;
        if let Some(state) = self.history.at(look.time_s) {
            self.tracked.tell(&self.model, state, None);
        }
        self.tracked.placed = placed;
        Ok(&self.tracked)
    }

    /// Whether a frame's time is of another clock: all tracks are forgotten before it.
    pub(crate) fn is_of_another_clock(&self, camera: usize, time_s: f64) -> bool {
        let off_s = self.history.newest().map_or(0.0, |newest| time_s - newest.time_s);
        off_s.abs() > Self::JUMP_S || self.history.is_of_another_clock(camera, time_s)
    }

    /// Where everybody is at a time: carried on from the last frame before it, in that frame's axes.
    ///
    /// # Errors
    /// [`TrackError`] for a time that is no number, and one before all frames that are kept.
    pub fn at(&mut self, time_s: f64) -> Result<&Tracked, TrackError> {
        if !time_s.is_finite() {
            return Err(TrackError::Time(time_s));
        }
        let Some(state) = self.history.at(time_s) else {
            let newest_s = self.history.newest().map_or(time_s, |newest| newest.time_s);
            return Err(TrackError::TooLate { time_s, behind_s: newest_s - time_s });
        };
        let motion = Motion {
            interval_s: time_s - state.time_s,
            turn: Turn::none(self.model.rig.mounting(state.camera).lever_m()),
            faster: None,
            up: state.up,
            tilt_sigma_rad: self.model.tilt_sigma_rad(state.tilt_sigma_rad),
        };
        self.tracked.tell(&self.model, state, Some(&motion));
        Ok(&self.tracked)
    }
}
