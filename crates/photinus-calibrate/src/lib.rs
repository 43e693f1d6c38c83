//! Photos and recordings in; cameras, spot-size curves, mountings and LED layouts out, each with its uncertainty.
//!
//! ```text
//! spot_size        areas of one LED over distance -> how large a spot can be
//! mounting         places in the image of what is known in the body frame -> how the camera sits
//! airframe_layout  photos taken around an airframe -> where its LEDs sit
//! ```
//!
//! What they share: `sighted` (something seen, and what an error of it is in pixels), `resection` (a camera's pose from what is
//! known), `robust` (what deviates too far), `scatter` (sigma by resampling).

pub mod airframe_layout;
pub mod mounting;
mod resection;
mod robust;
mod scatter;
pub mod sighted;
pub mod spot_size;
