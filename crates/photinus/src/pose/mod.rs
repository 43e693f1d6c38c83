//! Markers -> position and attitude: every way in which the spots of one neighbour can be its airframe, and how sure.
//!
//! In: bearings with their covariances and light, which markers they may be, gravity and bounds where known. Out: the
//! posterior, as a mixture of modes and as one mean with covariance. The flow:
//!
//! ```text
//! hypotheses    which spot may be which marker, with a first guess of the pose
//! problem       one assignment with all that is known (known) and seen (observation)
//! cost          what a pose costs: bearings (merging), light, tilt; with its derivatives; and visibility
//! refine        downhill to the modes of each hypothesis: what must show beside a spot and does not shines into it or is dark
//! along_yaw     slices along the valley where the yaw is uncertain
//! mixture       weights, truncation to the strict bounds, moments, modes
//! ```
//!
//! `measurement` hands on the cost of the spots without priors, to tracks, which have their own. Beside the flow stand [`p3p`](fn@p3p) and [`pnp`](fn@pnp), closed forms for callers who know which bearing is which marker; first guesses
//! of hypotheses come from the locator's views instead.
//!
//! The prior prefers no direction, no yaw and no scale (even over the logarithm of distance): of all priors it is the one
//! under which a mean and covariance are as good at every range. Where gravity is known the body is upright but for a tilt;
//! where it is not, a camera well above or below the body's horizon is the less likely.

mod along_yaw;
mod assignment;
mod cost;
mod estimator;
mod hypotheses;
mod known;
mod light;
mod light_spread;
mod measurement;
mod merging;
mod misfit;
mod mixture;
mod observation;
mod p3p;
mod pnp;
mod problem;
mod refine;
mod settings;
mod signals;
mod symmetry;
#[cfg(test)]
mod tests;
mod tilting;
mod visibility;

pub use crate::optics::LogLight;
pub(crate) use assignment::Assignment;
pub use estimator::{Estimator, Posterior};
pub use hypotheses::Hypotheses;
pub use known::{Known, LogDistance, Visible};
pub(crate) use light::POWER_RANGE;
pub use light_spread::LightSpread;
pub(crate) use measurement::{Measurement, Seen};
pub use misfit::Misfit;
pub(crate) use mixture::turn_of;
pub use mixture::{Mode, Summary};
pub use observation::Observation;
pub(crate) use observation::Whitened;
pub(crate) use p3p::p3p_with_near_misses;
pub use p3p::{P3pSolutions, p3p};
pub use pnp::pnp;
pub(crate) use problem::Normal;
pub use problem::Pose;
pub use settings::{Settings, SettingsError};
pub use symmetry::Symmetry;
pub use tilting::Tilting;
pub use visibility::Missed;
pub(crate) use visibility::{Part, merged_into};
