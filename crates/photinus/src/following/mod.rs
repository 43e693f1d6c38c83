//! Following blinking markers: the sightings of frame after frame -> marker tracks, through the frames in which they are dark.
//!
//! In, per frame: its time and exposure, the sightings of the locator, how the observer turned (where a gyro tells it), what the camera
//! watches. Out: [`MarkerTrack`]s: a number that stays, bearing and rate with covariance, whether it shines, whether it exists, who it is.
//!
//! ```text
//! frame        what enters
//! follower     the stages of a frame, a line each
//! seen         what a sighting is worth to any track
//! turn         how the observer turned, where nothing tells it     <- all tracks together
//! motion       bearing and rate on the plane that touches the sphere, with covariance
//! near         which sightings lie near a track
//! association  whose is which sighting: probabilities over all tracks at once
//! track        one marker: what it should show, what a frame says of it
//! presence     in sight, hidden, or gone
//! hearing      what is told to the decoder of its code
//! told         what a caller is told
//! settings     what is believed beforehand, with reasons
//! ```
//!
//! Nobody needs to know who a marker is to follow it; but once its code is known, a frame in which it is dark is not held against it, and no
//! light of that frame is taken for it.

mod association;
mod follower;
mod frame;
mod hearing;
mod motion;
mod near;
mod presence;
mod seen;
mod settings;
mod told;
mod track;
mod turn;

pub(crate) use association::Association;
pub use follower::Follower;
pub use frame::{Frame, Turn};
pub use settings::{Settings, SettingsError};
pub use told::MarkerTrack;
