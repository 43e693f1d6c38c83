//! What a vehicle sees of the others, in four grades, by one interface.
//!
//! ```text
//! the world at a moment -> in_view: who could be seen at all                      sight
//!                       -> exactly what is in view                                perfect
//!                       -> what a table of errors makes of it                     stand_in
//!                       -> what UVDAR's own simulator makes of it                 uvdar
//!                       -> frames -> photinus -> tracks of all cameras together   rendered
//! body frame -> level frame, as the vehicle believes it to be                     axes
//! ```
//!
//! Eyes are handed the truth, because they make pictures of it; what leaves them is all that a controller gets.

mod axes;
#[cfg(test)]
mod hand_made;
mod perfect;
mod rendered;
mod sight;
mod stand_in;
mod uvdar;

use std::sync::Arc;

use nalgebra::UnitQuaternion;
use photinus_control::Seen;
use photinus_sim::snapshot::Kinematics;
use photinus_sim::source::Blink;

pub use axes::{levelled, nees};
pub use rendered::EyesError;
pub use sight::{InView, in_view};
pub use stand_in::Sampling;
pub use stand_in::table::{Eyesight, StandInTable};

use crate::scenario::{Kind, Scenario};
use crate::vehicle::Own;
use crate::world::Obstacle;

/// How vehicles see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Frames are rendered, and Photinus locates in them.
    Rendered,
    /// Errors are drawn from a table that was fitted to rendered frames.
    StandIn,
    /// What is in view is known exactly.
    Perfect,
    /// What is in view is told with the noise of UVDAR's own simulator, ten times a second.
    Uvdar,
}

impl Grade {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Rendered, Self::StandIn, Self::Perfect, Self::Uvdar];

    /// The grade of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|grade| grade.name() == name)
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rendered => "rendered",
            Self::StandIn => "stand_in",
            Self::Perfect => "perfect",
            Self::Uvdar => "uvdar",
        }
    }
}

/// A vehicle as the world holds it.
#[derive(Clone, Debug)]
pub struct Present {
    /// How it moves.
    pub kinematics: Kinematics,
    /// How it is built.
    pub kind: Arc<Kind>,
    /// How bright each of its LEDs is, 1 being the mean part; 0 for one that failed.
    pub powers: Vec<f64>,
    /// What its LEDs blink; without, they shine.
    pub blink: Option<Blink>,
    /// Which of its cameras work.
    pub cameras_work: Vec<bool>,
}

/// The world while a frame is exposed.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Number of the frame.
    pub number: u64,
    /// When its exposure begins, s.
    pub time_s: f64,
    /// How long it is exposed, us.
    pub exposure_us: f64,
    /// Everybody.
    pub vehicles: &'a [Present],
    /// What stands in the way.
    pub obstacles: &'a [Obstacle],
    /// Nobody is seen from farther by perfect eyes and those that stand in, m.
    pub range_m: f64,
}

/// What a vehicle knows of itself when it looks.
#[derive(Clone, Copy, Debug)]
pub struct Looking<'a> {
    /// Which vehicle it is.
    pub vehicle: usize,
    /// Its instruments' readings.
    pub own: &'a Own,
    /// How its body turned since the frame before, by its gyro: before_from_now.
    pub turned: UnitQuaternion<f64>,
}

/// The eyes of a vehicle.
#[derive(Debug)]
pub enum Eyes {
    /// See what is in view, exactly.
    Perfect(perfect::Perfect),
    /// See what a table makes of it.
    StandIn(Box<stand_in::StandIn>),
    /// See frames.
    Rendered(Box<rendered::Rendered>),
    /// See with UVDAR's own noise.
    Uvdar(Box<uvdar::Uvdar>),
}

impl Eyes {
    /// The eyes of vehicle `index` of a scenario.
    ///
    /// # Errors
    /// [`EyesError`] where the locator refuses the airframe or a setting.
    pub fn new(
        grade: Grade,
        scenario: &Scenario,
        index: usize,
        table: &Arc<StandInTable>,
    ) -> Result<Self, EyesError> {
        Ok(match grade {
            Grade::Perfect => Self::Perfect(perfect::Perfect::default()),
            Grade::StandIn => Self::StandIn(Box::new(stand_in::StandIn::new(scenario, index, table))),
            Grade::Rendered => Self::Rendered(Box::new(rendered::Rendered::new(scenario, index)?)),
            Grade::Uvdar => Self::Uvdar(Box::new(uvdar::Uvdar::new(scenario, index))),
        })
    }

    /// Looks, and tells whom it sees in the vehicle's body frame, from the body's origin.
    pub fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        seen.clear();
        match self {
            Self::Perfect(eyes) => eyes.look(looking, moment, seen),
            Self::StandIn(eyes) => eyes.look(looking, moment, seen),
            Self::Rendered(eyes) => eyes.look(looking, moment, seen),
            Self::Uvdar(eyes) => eyes.look(looking, moment, seen),
        }
    }
}
