//! What a vehicle sees of its neighbours enters; how it shall fly leaves.
//!
//! ```text
//! own state + neighbours seen -> controller -> set-point -> safety layer -> set-point that is flown
//!                 \-> a few bytes to each other -> mutual localization -> positions and headings of the group
//! ```
//!
//! No simulator, files, threads, clocks or printing: the same on a flight computer as in a simulation, bit for bit. Every vector
//! is in the *level frame* of the vehicle that acts, see [`OwnState`].
//!
//! ```
//! use photinus_control::{Controller, OwnState, Seen, controllers::Boids, safety::{Basis, Limits, Safety, Watch}};
//!
//! let limits = Limits::small_multirotor();
//! let (mut flock, mut safety) = (Boids::new(4.0, 9.0), Safety::new(limits)?);
//! // And for every frame:
//! let (own, seen): (OwnState, Vec<Seen>) = (OwnState::resting(), Vec::new());
//! let watch = Watch::empty_to(15.0); // or what the cameras watched: Watch::look
//! let wanted = flock.command(&own, &seen, limits.period_s);
//! let guarded = safety.guard(&own, &seen, &watch, &[], &wanted, limits.period_s);
//! assert_eq!(guarded.basis, Basis::Proven);
//! # Ok::<(), photinus_control::safety::LimitsError>(())
//! ```

mod controller;
pub mod controllers;
mod from_camera;
pub mod mutual;
mod own;
pub mod safety;
mod seen;
mod setpoint;

pub use controller::Controller;
pub use from_camera::Held;
pub use own::OwnState;
pub use seen::{Heading, Normal, Seen};
pub use setpoint::{Motion, Setpoint};
