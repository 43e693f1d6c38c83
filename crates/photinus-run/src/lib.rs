//! The one loop of Photinus: what `photinus locate` does with files and `photinus run` with cameras. No middleware is linked here.
//!
//! ```text
//! source   frames of a camera, one after the other                     source/, a thread each
//!   slot   the newest one wins, older ones are counted as dropped      live/
//! entry    a frame on its way to a record of results                   entry
//! run      the loop: fill, hand on                                     run, work
//! view     locate, follow, into the body frame                         view, watch, course, motion, daylight
//! fan      every sink its thread and its bounded queue                 sink/
//! health   what was counted and measured on the way                    health/
//! config   the file that says all this                                 config/
//! ```

mod clock;
pub mod config;
mod contradictions;
pub mod course;
mod daylight;
mod disputes;
mod entry;
pub mod exposure;
pub mod fault;
pub mod health;
mod host_clock;
pub mod live;
pub mod motion;
mod odd_frame;
mod quantiles;
mod run;
pub mod sink;
pub mod source;
mod view;
pub mod watch;
mod work;

pub use clock::{Clock, Stage};
pub use daylight::Daylight;
pub use entry::Entry;
pub use host_clock::HostClock;
pub use odd_frame::Oddity;
pub use quantiles::Quantiles;
pub use run::{Outlet, guarded, run, source_name};
pub use view::{View, in_frame, locate};
pub use work::Work;
