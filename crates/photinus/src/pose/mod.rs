//! Markers -> position and attitude of their airframe.
//!
//! Bearings in the camera frame and the places of their markers in the body frame enter; poses
//! `camera_from_body` leave. [`p3p`] gives every pose that three bearings allow, [`pnp`] the best one for four
//! and more.

mod p3p;
mod pnp;

pub use p3p::{P3pSolutions, p3p};
pub use pnp::pnp;
