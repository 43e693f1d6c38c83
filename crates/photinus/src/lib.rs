//! Photinus tells a flying robot where its neighbours are from one ultraviolet camera.
//!
//! The data flow is the architecture, and the modules carry its names in its order:
//!
//! ```text
//! frame -> spots -> bearings (camera) -> ranges (airframe, ranging) -> neighbours (locator) -> tracks (tracking)
//!                                                            -> marker tracks (following, identity) -> who is who (lookout)
//! ```
//!
//! No files, threads, clocks or printing happen here. Transcendental functions come from the `libm`
//! crate, because those of the C library give other last bits on other processors.

pub mod airframe;
pub mod camera;
pub mod following;
pub mod frame;
pub mod identity;
mod lanes;
pub mod locator;
pub mod lookout;
pub mod optics;
pub mod pose;
pub mod ranging;
pub mod spots;
pub mod tracking;

/// The README's example is a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
