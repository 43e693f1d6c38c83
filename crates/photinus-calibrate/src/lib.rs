//! Photos and recordings in; cameras, spot-size curves, mountings and LED layouts out, each with its uncertainty.
//!
//! A camera, in the order of the flow:
//!
//! ```text
//! photo -> grid -> start -> adjust -> labels -> solve -> camera: which model, how sure, what to warn of, export
//! ```

pub mod adjust;
pub mod camera;
pub mod grid;
pub mod labels;
pub mod lens;
pub mod photo;
pub mod solve;
mod start;
