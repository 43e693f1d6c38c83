//! Scenes of flying robots with ultraviolet markers -> frames with truth.
//!
//! The physics is a chain, a module per stage, in the order in which light takes it:
//!
//! ```text
//! scene (motion) -> simulator -> snapshot
//!                                   |
//!     source -> (inverse square) -> occlusion -> optics -> background -> sensor -> render: frame, truth
//! ```
//!
//! A [`Snapshot`] is the world during one exposure; [`Renderer`] knows nothing else. [`Simulator`] drives it by a scene; whatever
//! integrates its own vehicles drives it step by step.
//!
//! The same seed gives the same bytes, whatever the number of threads: every random number is a function of seed, frame
//! and place.

pub mod background;
pub mod cameras;
pub mod clock;
pub mod dataset;
mod draw;
pub mod faults;
pub mod instruments;
pub mod measured;
pub mod motion;
pub mod occlusion;
pub mod optics;
pub mod preset;
pub mod receding;
pub mod recording;
pub mod render;
pub mod scene;
pub mod sensor;
pub mod simulator;
pub mod snapshot;
pub mod source;
pub mod stacking;

pub use render::{CameraView, Rendered, Renderer};
pub use scene::Scene;
pub use simulator::Simulator;
pub use snapshot::Snapshot;
