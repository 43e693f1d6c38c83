//! The built program from outside: what it prints, writes and exits with.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on has failed; what it ran is shown then"
)]

mod bad_input;
mod batch;
mod calibrate;
mod calibrate_airframe;
mod calibrate_airframe_light;
mod calibrate_mask;
mod calibrate_mounting;
mod calibrate_report;
mod calibrate_spot_size;
mod codes;
mod commands;
mod demo;
mod doctor;
mod evaluate;
mod evaluate_recordings;
mod exposure;
mod files_survive;
mod inject;
mod kinds;
#[cfg(target_os = "linux")]
mod led;
mod live;
mod mistakes;
mod mutated;
mod narrow_frames;
mod odd_input;
mod overlays;
mod plan;
mod real_photos;
mod recording;
mod reproduce;
mod resume;
mod rig;
mod simulate;
mod soak;
mod stage;
mod stopped;
mod swarm;
mod track;
mod walk;
