//! Photos and recordings in; cameras, their optics, spot-size curves, mountings and LED layouts out, each with its uncertainty.
//!
//! A camera, in the order of the flow:
//!
//! ```text
//! photo -> grid -> start -> adjust -> labels -> solve -> camera: which model, how sure, what to warn of, export
//! ```
//!
//! What else Photinus must know beforehand:
//!
//! ```text
//! optics           frames with LEDs -> point spread, saturation, noise
//! spot_size        areas of one LED over distance -> how large a spot can be
//! mounting         places in the image of what is known in the body frame -> how the camera sits
//! airframe_layout  photos taken around an airframe -> where its LEDs sit
//! standing         frames of a camera that moves -> the mask of what stays with it
//! airframe_light   a flight of one neighbour -> lobes, the power of each LED, how well positions are known
//! ```
//!
//! What these share: `sighted` (something seen, and what an error of it is in pixels), `resection` (a camera's pose from what is
//! known), `robust` (what deviates too far), `scatter` (sigma by resampling).

pub mod adjust;
pub mod airframe_layout;
pub mod airframe_light;
pub mod camera;
pub mod grid;
pub mod labels;
pub mod lens;
pub mod mounting;
pub mod optics;
pub mod photo;
mod resection;
mod robust;
mod scatter;
pub mod sighted;
pub mod solve;
pub mod spot_size;
pub mod standing;
mod start;
