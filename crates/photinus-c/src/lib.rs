//! Photinus for C: enters a camera, an airframe and borrowed frames, leave neighbours in structures of the caller's.
//!
//! ```text
//! camera, airframe, options -> locator     handles: numbers that stay refused once they are closed
//! image, gravity, time      -> locate      the method, under the locator's lock
//! neighbours, spots, tracks <- results     copied into arrays of the caller's; nothing is allocated once warm
//! ```
//!
//! Every function runs inside `border::cross`: an error leaves a message for its thread, a panic becomes one. What C must promise
//! of its pointers stands in the header once; `pointers` is the only module that follows them.

#![allow(unsafe_code, reason = "the border to C: exported names, and pointers that only C can vouch for")]
#![allow(
    clippy::missing_safety_doc,
    reason = "the opening of the header says what pointers must be, once for all"
)]

mod airframe;
mod border;
mod camera;
mod handles;
mod locator;
mod options;
mod pointers;
mod records;
mod results;

pub use airframe::{
    photinus_airframe_note, photinus_close_airframe, photinus_parse_airframe, photinus_read_airframe,
};
pub use border::{Status, photinus_error, photinus_status_name, photinus_version};
pub use camera::{
    photinus_camera_bearing, photinus_camera_note, photinus_camera_pixel, photinus_camera_size,
    photinus_close_camera, photinus_parse_camera, photinus_read_camera,
};
pub use handles::{Airframe, Camera, Locator};
pub use locator::{
    photinus_close_locator, photinus_forget, photinus_locate, photinus_open_locator, photinus_set_mask,
};
pub use options::{Options, photinus_default_options};
pub use pointers::Image;
pub use records::{Frame, Mode, Neighbour, Reason, Rejected, Spot, Track};
pub use results::{
    photinus_members, photinus_modes, photinus_neighbours, photinus_rejected, photinus_spots,
    photinus_track_members, photinus_tracks,
};
