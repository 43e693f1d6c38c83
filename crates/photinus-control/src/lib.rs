//! What a vehicle sees of its neighbours enters; how it shall fly leaves.
//!
//! ```text
//! own state + neighbours seen -> controller -> set-point -> safety layer -> set-point that is flown
//!                 \-> a few bytes to each other -> mutual localization -> positions and headings of the group
//! ```
//!
//! No simulator, files, threads, clocks or printing: the same on a flight computer as in a simulation, bit for bit. Every vector
//! is in the *level frame* of the vehicle that acts, see [`OwnState`].

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
