//! Scenarios: what a TOML file says, checked and with its files read.
//!
//! Unknown keys are refused with their line; every other refusal names file, key and reason. The keys are described in docs/swarm.md. Files that a scenario
//! names lie in its folder; those that the program carries are found by their names alone ([`Library`]).

mod carried;
mod files;
mod kind;
mod place;
mod read;
mod table;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::identity::CodeBook;
use photinus_sim::background::Daylight;
use photinus_sim::occlusion::Solid;
use photinus_sim::preset::Preset;

pub use carried::{CARRIED, Carried, carried};
pub use files::Library;
pub use place::Layout;
pub(crate) use place::Start;

use crate::mind::{Plan as MindPlan, SafetyPlan};
use crate::perception::Grade;
use crate::vehicle::{Accuracy, Build, Wind};
use crate::world::Obstacle;

/// What is flown.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// What it is called.
    pub name: String,
    /// What it shows, a sentence.
    pub about: String,
    /// Where random numbers start.
    pub seed: u64,
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Frames of every camera and decisions of every vehicle per second.
    pub rate_hz: f64,
    /// How long frames are exposed at the start, us.
    pub exposure_us: f64,
    /// Lens, sensor and LEDs.
    pub preset: Preset,
    /// Light that does not come from markers.
    pub daylight: Option<Daylight>,
    /// How the air moves.
    pub wind: Wind,
    /// How good the vehicles' own instruments are.
    pub accuracy: Accuracy,
    /// How vehicles see, unless a run says otherwise.
    pub grade: Grade,
    /// Nobody is seen from farther, m: of perfect eyes, and of those that stand in.
    pub range_m: f64,
    /// What their LEDs blink; without, they shine.
    pub codes: Option<Codes>,
    /// The vehicles, in the order of the file.
    pub vehicles: Vec<Vehicle>,
    /// What stands in the way.
    pub obstacles: Vec<Obstacle>,
    /// What happens on the way, by time.
    pub events: Vec<Event>,
    /// Where vehicles are wanted relative to each other, m: one place for each of the first ones, up to a shift and a turn about the vertical.
    pub formation: Vec<Vector3<f64>>,
    /// Where vehicles begin, group after group.
    pub(crate) layouts: Vec<Layout>,
}

/// The words that vehicles blink: vehicle `id` the word of its number.
#[derive(Clone, Debug, PartialEq)]
pub struct Codes {
    /// The book.
    pub book: CodeBook,
    /// Bits per second.
    pub rate_hz: f64,
}

/// A vehicle.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Its number, from 0: also its word.
    pub id: u32,
    /// How it is built.
    pub kind: Arc<Kind>,
    /// How it decides.
    pub mind: MindPlan,
    /// The height that it keeps by its altimeter whatever is wanted, m; without, it flies up and down as it wants.
    pub height_m: Option<f64>,
    /// What stands in front of that, if anything.
    pub safety: Option<SafetyPlan>,
}

/// How vehicles are built.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// What it is called.
    pub name: String,
    /// Its body.
    pub build: Build,
    /// Its LEDs.
    pub airframe: Arc<Airframe>,
    /// What of it hides LEDs.
    pub solids: Arc<[Solid]>,
    /// Its eyes, one to three.
    pub cameras: Vec<Mounted>,
    /// The airframe that it expects of others: a locator knows one.
    pub expects: Arc<Airframe>,
}

/// A camera on a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounted {
    /// What it is called.
    pub name: String,
    /// Its projection.
    pub camera: Camera,
    /// The pose body_from_camera.
    pub body_from_camera: Isometry3<f64>,
}

/// Something that happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When, s.
    pub at_s: f64,
    /// What.
    pub what: Happening,
}

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// All cameras are exposed otherwise from then on, us.
    Exposure(f64),
    /// An LED of a vehicle fails.
    LedFails {
        /// The vehicle.
        vehicle: usize,
        /// Its LED.
        led: usize,
    },
    /// A camera of a vehicle fails.
    CameraFails {
        /// The vehicle.
        vehicle: usize,
        /// Its camera, by index.
        camera: usize,
    },
    /// A vehicle decides otherwise from then on.
    Mind {
        /// The vehicle.
        vehicle: usize,
        /// How.
        mind: MindPlan,
    },
}

impl Scenario {
    /// Time between frames, s.
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }

    /// How many frames it lasts.
    pub fn frames(&self) -> u64 {
        (self.duration_s * self.rate_hz).round().max(1.0) as u64
    }
}
