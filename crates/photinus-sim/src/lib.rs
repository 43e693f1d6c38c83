//! Scenes of flying robots with ultraviolet markers -> frames with truth.
//!
//! The physics is a chain, a module per stage, in the order in which light takes it:
//!
//! ```text
//! source -> (inverse square) -> occlusion -> optics -> background -> sensor -> frame
//! ```
//!
//! The same seed gives the same bytes, whatever the number of threads: every random number is a function of seed, frame
//! and place.

pub mod optics;
pub mod preset;
pub mod receding;
pub mod sensor;
pub mod source;
