//! Photinus tells a flying robot where its neighbours are from one ultraviolet camera.
//!
//! The data flow is the architecture, and the modules carry its names in its order:
//!
//! ```text
//! frame -> spots -> bearings (camera) -> ranges (airframe, ranging) -> neighbours (locator) -> tracks (tracking)
//!                                                            -> marker tracks (following, identity) -> who is who (lookout)
//! ```
//!
//! ```
//! use photinus::airframe::{Airframe, Ring};
//! use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
//! use photinus::frame::FrameView;
//! use photinus::locator::{Input, Locator, Settings};
//! use photinus::nalgebra::Vector3;
//!
//! let lens = Ideal::new(IdealLaw::Equidistant, [265.4; 2], Pixel::new(375.5, 239.5))?;
//! let camera = Camera::new(Model::Ideal(lens), 752, 480, None)?;
//! let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
//! let mut locator = Locator::new(camera, &Airframe::from_ring("hexarotor", ring)?, None, Settings::default())?;
//!
//! // of every frame: its pixels, and where down is, if anybody knows
//! let pixels = vec![0; 752 * 480];
//! let frame = FrameView::packed(&pixels, 752, 480)?;
//! let located = locator.locate(Input::frame(&frame).gravity(&Vector3::y_axis()))?;
//! for neighbour in &located.neighbours {
//!     let (bounds, spots) = (neighbour.distance.bounds, neighbour.sightings.len());
//!     println!("{bounds:?} away with probability {}, seen by {spots} spots", neighbour.probability);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! No files, threads, clocks or printing happen here. Transcendental functions come from the `libm`
//! crate, because those of the C library give other last bits on other processors. Without the feature `std` (on by
//! default) the crate asks for an allocator and for no operating system, with the same bits.

#![cfg_attr(not(test), no_std)]
#![cfg_attr(
    test,
    allow(unused_imports, reason = "under test the standard library is there and stands in front")
)]

extern crate alloc;

/// The linear algebra of the interface, in the version that it is built with.
pub use nalgebra;

pub mod airframe;
pub mod camera;
#[cfg(not(feature = "std"))]
mod float;
pub mod following;
pub mod frame;
pub mod identity;
mod lanes;
pub mod locator;
pub mod lookout;
mod normal;
pub mod optics;
pub mod pose;
pub mod ranging;
pub mod solve;
pub mod spots;
pub mod tracking;

/// The README's example is a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
