//! The experiments: what runs together because it shares its frames.

use photinus::locator::LocatorError;
use photinus::spots::SettingsError;

use crate::{Report, Rig, detection, flight, layouts, poses, spectrum, spot_size};

/// How much is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Enough for the numbers of the summary.
    Full,
    /// A fraction of it, to see that every number comes out.
    Quick,
}

impl Effort {
    /// How many of a full run's `count`, in a quick one `quick` of them.
    pub(crate) fn of(self, count: u64, quick: u64) -> u64 {
        match self {
            Self::Full => count,
            Self::Quick => quick,
        }
    }
}

/// Why an experiment cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// A scene without a camera or a target.
    #[error("the scene has no {0}")]
    Lacks(&'static str),
    /// A target whose markers form no ring, for which the paper's equations do not hold.
    #[error("the scene's target is no ring of markers: the paper's equations are for rings")]
    NoRing,
    /// A camera that does not answer along its axis.
    #[error("the scene's camera does not see along its axis")]
    Axis,
    /// A locator that cannot be made.
    #[error("{0}")]
    Locator(#[from] LocatorError),
    /// A detector that cannot be made.
    #[error("{0}")]
    Detector(#[from] SettingsError),
}

/// An experiment, from which one or several figures are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Experiment {
    /// Light of sun, sky and LED: figure 4.
    Sunlight,
    /// Intensities of airframes: figures 7 and 8.
    Lobes,
    /// One LED that recedes: figures 10 and 11.
    RecedingLed,
    /// A hexarotor at random poses indoors: figures 12 to 14.
    RandomPoses,
    /// The outdoor flight: figures 15 to 17, and heading from bearing.
    Flight,
    /// A hexarotor ever farther away outdoors: the range.
    Range,
}

impl Experiment {
    /// All of them, the longest first.
    pub const ALL: [Self; 6] =
        [Self::Flight, Self::Range, Self::RandomPoses, Self::RecedingLed, Self::Sunlight, Self::Lobes];

    /// How many frames it renders.
    pub fn frames(self, rig: &Rig, effort: Effort) -> u64 {
        match self {
            Self::Sunlight | Self::Lobes => 0,
            Self::RecedingLed => spot_size::frames(effort),
            Self::RandomPoses => poses::frames(effort),
            Self::Flight => flight::frames(rig, effort),
            Self::Range => detection::frames(effort),
        }
    }

    /// Runs it; `frame_done` is told of every frame.
    ///
    /// # Errors
    /// [`ReproduceError`] for a rig with which it cannot be run.
    pub fn run(
        self,
        rig: &Rig,
        effort: Effort,
        frame_done: &dyn Fn(),
    ) -> Result<Vec<Report>, ReproduceError> {
        match self {
            Self::Sunlight => Ok(vec![spectrum::report(rig)]),
            Self::Lobes => layouts::reports(),
            Self::RecedingLed => spot_size::reports(rig, effort, frame_done),
            Self::RandomPoses => poses::reports(rig, effort, frame_done),
            Self::Flight => flight::reports(rig, effort, frame_done),
            Self::Range => Ok(vec![detection::report(rig, effort, frame_done)?]),
        }
    }
}
