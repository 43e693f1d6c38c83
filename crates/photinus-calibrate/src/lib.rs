//! Photos and recordings in; cameras, spot-size curves, mountings and LED layouts out, each with its uncertainty.

pub mod airframe_layout;
pub mod mounting;
mod scatter;
pub mod sighted;
pub mod spot_size;
