//! Scenes of flying robots with ultraviolet markers -> frames with truth.
//!
//! The physics is a chain, a module per stage, in the order in which light takes it:
//!
//! ```text
//! scene (motion) -> source -> (inverse square) -> occlusion -> optics -> background -> sensor -> render: frame, truth
//! ```
//!
//! The same seed gives the same bytes, whatever the number of threads: every random number is a function of seed, frame
//! and place.

pub mod background;
pub mod cameras;
pub mod dataset;
pub mod motion;
pub mod occlusion;
pub mod optics;
pub mod preset;
pub mod receding;
pub mod render;
pub mod scene;
pub mod sensor;
pub mod source;

pub use render::{Rendered, Simulator};
pub use scene::Scene;
