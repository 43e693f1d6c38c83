//! Frames -> neighbours: every camera of a vehicle renders its own frames and locates in them; who is there is followed by all of them together, and nothing
//! else is known.
//!
//! ```text
//! world -> snapshot of one camera -> frame     eye, photinus-sim
//! frame -> located                             eye, photinus
//! located by all cameras -> tracks             photinus, one lookout
//! tracks -> neighbours in the body frame       eye
//! ```

mod eye;

use nalgebra::Rotation3;
use photinus::camera::{Mounted, Mounting, Rig, RigError};
use photinus::locator::{self, LocatorError};
use photinus::lookout::{Fleet, FleetError, Lookout, LookoutError};
use photinus::tracking::{self, Turned};
use photinus_control::Seen;

use super::{Looking, Moment};
use crate::scenario::{self, Scenario};
use eye::{Eye, Shown};

/// A name is taken for right from this probability on.
const SURE_NAME: f64 = 0.9;
/// By how much neighbours tilt more than their autopilots ask for: overshoot, and the error of the own tilt.
const TILT_MARGIN_RAD: f64 = 0.15;
/// Gyros are never trusted beyond this, rad/s.
const LEAST_TURN_RAD_S: f64 = 1e-3;

/// Why a vehicle cannot see by frames.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EyesError {
    /// The cameras are too many.
    #[error("{0}")]
    Rig(#[from] RigError),
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
    lookout: Lookout,
    shown: Vec<Shown>,
    /// How far what the gyro tells of a turn from frame to frame may be off, per axis, rad.
    turn_sigma_rad: f64,
}

impl Rendered {
    pub(super) fn new(scenario: &Scenario, index: usize) -> Result<Self, EyesError> {
        let kind = &scenario.vehicles[index].kind;
        let settings = settings(scenario);
        let mounted = |own: &scenario::Mounted| Mounted {
            mounting: Mounting {
                body_from_camera: own.body_from_camera.rotation.to_rotation_matrix(),
                position_m: own.body_from_camera.translation.vector,
                ..Mounting::default()
            },
            ..Mounted::from(own.camera.clone())
        };
        let rig = Rig::new(kind.cameras.iter().map(mounted).collect())?;
        let fleet = fleet(scenario)?;
        let tracking = tracking::Settings::default();
        let eye = |camera| Eye::new(scenario, index, camera, &settings);
        Ok(Self {
            eyes: (0..kind.cameras.len()).map(eye).collect::<Result<_, _>>()?,
            lookout: Lookout::new(rig, &kind.expects, &settings, tracking, fleet.as_ref())?,
            shown: Vec::new(),
            turn_sigma_rad: scenario.period_s()
                * (scenario.accuracy.gyro_bias_rad_s + scenario.accuracy.gyro_noise_rad_s)
                    .max(LEAST_TURN_RAD_S),
        })
    }

    pub(super) fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        let works = &moment.vehicles[looking.vehicle].cameras_work;
        let turned = (moment.number > 0).then(|| Turned {
            now_from_before: looking.turned.inverse().to_rotation_matrix(),
            sigma_rad: self.turn_sigma_rad,
        });
        let mut since_any = turned;
        let Self { eyes, lookout, shown, .. } = self;
        for (_, eye) in eyes.iter_mut().enumerate().filter(|(camera, _)| works[*camera]) {
            eye.look(looking, moment, [turned, since_any], lookout, shown);
            // all cameras of a vehicle look at one time
            since_any = Some(Turned { now_from_before: Rotation3::identity(), sigma_rad: 0.0 });
        }
        if !works.contains(&true) {
            return;
        }
        let tracked = lookout.tracked();
        shown.retain(|shown| tracked.tracks.iter().any(|track| track.id == shown.track));
        for track in &tracked.tracks {
            let name = lookout.name(track.id).filter(|name| name.probability > SURE_NAME);
            let last = shown.iter().find(|shown| shown.track == track.id);
            let identity = name.map(|name| name.id);
            seen.push(eyes[tracked.camera].seen(track, last, identity, moment.time_s));
        }
    }
}

fn settings(scenario: &Scenario) -> locator::Settings {
    let tilts = scenario.vehicles.iter().map(|vehicle| vehicle.kind.build.tilt_rad);
    let max_tilt_rad = tilts.fold(0.0, f64::max) + TILT_MARGIN_RAD;
    let mut settings = locator::Settings::default();
    settings.max_tilt_rad = max_tilt_rad;
    // half of the largest tilt is as likely as not to be passed in a turn
    settings.pose.tilt_sigma_rad = settings.pose.tilt_sigma_rad.max(0.3 * max_tilt_rad);
    settings
}

fn fleet(scenario: &Scenario) -> Result<Option<Fleet>, FleetError> {
    let Some(codes) = &scenario.codes else { return Ok(None) };
    let word = |other: &scenario::Vehicle| photinus::lookout::Vehicle {
        id: other.id,
        words: vec![other.id as usize],
    };
    let others = scenario.vehicles.iter().map(|other| (word(other), codes.rate_hz));
    Fleet::new(codes.book.clone(), others).map(Some)
}
