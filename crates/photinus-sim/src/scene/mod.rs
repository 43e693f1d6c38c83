//! Scenes: what a TOML file says, checked and with its files read.
//!
//! Paths in a scene are relative to the scene's folder. Unknown keys are refused; every refusal names file, key and
//! reason. The keys are described in docs/scenes.md.

mod blink;
mod camera_table;
mod check;
mod files;
mod instruments;
mod light_table;
#[cfg(test)]
mod light_tests;
mod movers;
mod read;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use camera_table::parse_sampled;
pub use check::Check;
pub use files::files_of;
use nalgebra::{Isometry3, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::identity::CodeBook;
use photinus_io::sky::SkyInfo;
pub use read::mounting;

use crate::background::{Daylight, Water};
use crate::clock::Clock;
use crate::instruments::Instruments;
use crate::motion::Motion;
use crate::occlusion::{Mirror, OwnAirframe, Solid};
use crate::preset::Preset;
use crate::recording::Recording;
use crate::source::{LedFaults, Lobe};

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What it is called.
    pub name: String,
    /// Where random numbers start.
    pub seed: u64,
    /// Frames per second.
    pub rate_hz: f64,
    /// Number of frames.
    pub frames: u64,
    /// Exposure of a frame, us.
    pub exposure_us: f64,
    /// Lens, sensor and LEDs.
    pub preset: Preset,
    /// Light that does not come from markers.
    pub daylight: Option<Daylight>,
    /// Where on Earth and when it is, where there is daylight.
    pub sky: Option<SkyInfo>,
    /// A water surface below.
    pub water: Option<Water>,
    /// Lamps that are no markers.
    pub lamps: Vec<SceneLamp>,
    /// What of the robot with the cameras they see.
    pub own_airframe: OwnAirframe,
    /// How the robot with the cameras moves.
    pub observer: Motion,
    /// Its cameras, at least one.
    pub cameras: Vec<MountedCamera>,
    /// Those that are looked at.
    pub targets: Vec<Target>,
    /// What the observer measures of itself.
    pub instruments: Instruments,
    /// What goes wrong with the recording.
    pub recording: Recording,
}

/// A camera and how it sits on the observer.
#[derive(Clone, Debug)]
pub struct MountedCamera {
    /// What it is called.
    pub name: String,
    /// Its projection.
    pub camera: Camera,
    /// The pose body_from_camera.
    pub body_from_camera: Isometry3<f64>,
    /// The clock that times its frames.
    pub clock: Clock,
    /// What that clock reads when the first exposure begins, s.
    pub phase_s: f64,
    /// Its own exposure, us, where it is not that of the scene.
    pub exposure_us: Option<f64>,
}

/// A robot with markers.
#[derive(Clone, Debug)]
pub struct Target {
    /// Its id in the truth.
    pub id: u32,
    /// Its LEDs.
    pub airframe: Airframe,
    /// What of it hides LEDs.
    pub solids: Vec<Solid>,
    /// How its LEDs really shine, in place of the airframe's lobes.
    pub lobe: Option<Lobe>,
    /// What is wrong with its LEDs.
    pub faults: LedFaults,
    /// What of it mirrors.
    pub mirrors: Vec<Mirror>,
    /// How it moves.
    pub motion: Motion,
    /// How its LEDs blink; without, they shine.
    pub blink: Option<BlinkPlan>,
}

/// A lamp that shines all the time, the same in every direction.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLamp {
    /// Where it is, in the world or in the body frame of what it is beside, m.
    pub position_m: Vector3<f64>,
    /// Intensity against that of a marker's LED on its axis.
    pub power: f64,
    /// Its radius, m.
    pub radius_m: f64,
    /// Index of the target that it moves with.
    pub beside: Option<usize>,
}

/// Which code words a target sends, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct BlinkPlan {
    /// The book of words.
    pub codes: CodeBook,
    /// The word of each signal of the airframe; an LED without a signal sends that of signal 0.
    pub words: Vec<usize>,
    /// Bits per second on the target's clock.
    pub rate_hz: f64,
    /// The target's clock: its words begin when it reads 0.
    pub clock: Clock,
    /// How far edges stray, sigma, s.
    pub jitter_s: f64,
}
