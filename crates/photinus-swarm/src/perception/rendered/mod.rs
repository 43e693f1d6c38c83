//! Frames -> neighbours: every camera of a vehicle renders its own frames, locates in them and follows what it finds; nothing else is known.
//!
//! ```text
//! world -> snapshot of one camera -> frame     eye, photinus-sim
//! frame -> located -> tracks                   eye, photinus
//! tracks of all cameras -> neighbours          joint: one number for one who passes from camera to camera
//! ```

mod eye;
mod joint;

use photinus::locator::LocatorError;
use photinus::lookout::{FleetError, LookoutError};
use photinus_control::Seen;

use super::{Looking, Moment};
use crate::scenario::Scenario;
use eye::Eye;
use joint::Joint;

/// Why a vehicle cannot see by frames.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EyesError {
    /// The locator's settings.
    #[error("{0}")]
    Locator(#[from] LocatorError),
    /// The lookout's settings.
    #[error("{0}")]
    Lookout(#[from] LookoutError),
    /// The fleet's words.
    #[error("{0}")]
    Fleet(#[from] FleetError),
}

/// Eyes that see frames.
#[derive(Debug)]
pub struct Rendered {
    eyes: Vec<Eye>,
    joint: Joint,
}

impl Rendered {
    pub(super) fn new(scenario: &Scenario, index: usize) -> Result<Self, EyesError> {
        let count = scenario.vehicles[index].kind.cameras.len();
        let eyes = (0..count).map(|camera| Eye::new(scenario, index, camera)).collect::<Result<_, _>>()?;
        Ok(Self { eyes, joint: Joint::default() })
    }

    pub(super) fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        self.joint.begin(moment.time_s);
        let works = &moment.vehicles[looking.vehicle].cameras_work;
        for (camera, eye) in self.eyes.iter_mut().enumerate().filter(|(camera, _)| works[*camera]) {
            eye.look(looking, moment, |track| self.joint.take(camera, track));
        }
        self.joint.tell(seen);
    }
}
