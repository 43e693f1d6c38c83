//! What the detector promises, on rendered frames of known content.
//!
//! Checked: what is found, what is rejected and for which reason, and where centres lie when something disturbs them. Not
//! checked here: the accuracy of undisturbed centres and their sigma (`centroids.rs`), real photos (`photos.rs` of
//! photinus-io), allocations (`allocations.rs`).

#![allow(clippy::print_stdout, reason = "the measured numbers are worth reading")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod background;
mod crowded;
mod determinism;
#[path = "../hash/mod.rs"]
mod hash;
mod large;
mod mosaic;
mod pairs;
mod properties;
mod scene;
mod smeared;
mod tiny;
mod wide;
