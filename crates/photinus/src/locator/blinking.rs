//! Markers that blink are dark now and then, and no single frame tells when.

use alloc::vec::Vec;

use crate::airframe::Airframe;

/// Of the bits of a word this many are lit, about.
const LIT_BITS: f64 = 0.5;

/// How likely each marker of an airframe is lit in a frame, where nobody follows its signal.
pub(super) fn lit(airframe: &Airframe) -> Vec<f64> {
    let blinks = |&led: &usize| airframe.leds()[led].signal.is_some();
    let markers = airframe.markers().iter();
    markers.map(|marker| if marker.leds.iter().all(blinks) { LIT_BITS } else { 1.0 }).collect()
}
