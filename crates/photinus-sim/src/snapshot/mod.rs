//! The world during one exposure of one camera: enters from whatever moves it, leaves to the renderer.
//!
//! A [`Snapshot`] owns what it says and knows no time but that of its exposure: a scene fills it from motions in closed form
//! ([`crate::Simulator`]), a swarm from states that it integrates. It is made to be filled again: what has the right length already
//! costs no allocation.

mod exposure;
mod lit;
mod moving;

use std::sync::Arc;

use photinus::airframe::Airframe;

pub use exposure::Exposure;
pub use lit::Lit;
pub use moving::{Kinematics, Moving};

use crate::background::{Daylight, Water};
use crate::occlusion::{Mirror, Solid};
use crate::source::{Emitter, Lobe};

/// The world during one exposure of one camera.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// When the rows of the frame are exposed.
    pub exposure: Exposure,
    /// The pose world_from_camera.
    pub camera: Moving,
    /// Those with markers.
    pub vehicles: Vec<Vehicle>,
    /// The LED that all markers are made of.
    pub emitter: Emitter,
    /// Light that does not come from markers.
    pub daylight: Option<Daylight>,
    /// A water surface below.
    pub water: Option<Water>,
    /// Lamps that are no markers.
    pub lamps: Vec<Lamp>,
}

/// A vehicle with markers, during an exposure.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Its id in the truth.
    pub id: u32,
    /// Where its LEDs sit.
    pub airframe: Arc<Airframe>,
    /// What of it hides LEDs.
    pub solids: Arc<[Solid]>,
    /// What else there is to see of it.
    pub looks: Arc<Looks>,
    /// The pose world_from_body.
    pub motion: Moving,
    /// What its LEDs do, in the order of the airframe; one that is missing is dark.
    pub leds: Vec<LedLight>,
}

/// What there is to see of a vehicle besides its markers where they sit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// How its LEDs shine, in place of the airframe's lobes.
    pub lobe: Option<Lobe>,
    /// What of it mirrors its LEDs and the sun.
    pub mirrors: Vec<Mirror>,
}

/// A lamp that is not a marker: it shines all the time, the same in every direction.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Where it is: the origin of this pose.
    pub motion: Moving,
    /// Intensity against that of the mean part on its axis.
    pub power: f64,
    /// Its radius, m.
    pub radius_m: f64,
}

/// What an LED does during an exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct LedLight {
    /// Its intensity against that of the mean part.
    pub power: f64,
    /// When it shines.
    pub lit: Lit,
}

impl LedLight {
    /// A mean part that shines all the time.
    pub fn steady() -> Self {
        Self { power: 1.0, lit: Lit::always() }
    }
}
