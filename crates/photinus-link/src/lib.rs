//! What Photinus finds, in the words that robots speak, and what robots say, as Photinus reads it.
//!
//! ```text
//! photinus-io's FrameRecord -> messages -> ros -> cdr -> recording   MCAP files, feature `recording`
//!                                                     -> dds         ROS 2 topics without ROS, feature `ros2`
//!                                                     -> zenoh       keys of Zenoh, feature `zenoh`
//!                           -> mavlink                               autopilots, feature `mavlink`
//! a code book               -> led                                   LED boards on serial ports, feature `led`
//! ```
//! [`messages`] says what a located frame is in ROS's words, once for all that carry them. Each link is a [`Sink`](photinus_run::sink::Sink)
//! of a run; below the sinks nothing reads a clock. The other way round, [`recording`] reads MCAP, [`mod@bag`] bags of ROS 1, and [`poses`] where
//! vehicles were from either.

#[cfg(any(feature = "ros2", feature = "zenoh"))]
mod arriving;
#[cfg(feature = "recording")]
pub mod bag;
pub mod cdr;
#[cfg(any(feature = "ros2", feature = "zenoh", feature = "mavlink"))]
pub mod clock_offset;
#[cfg(any(feature = "recording", feature = "ros2", feature = "zenoh", feature = "mavlink"))]
pub mod config;
#[cfg(any(feature = "ros2", feature = "zenoh"))]
pub mod heard;
#[cfg(feature = "led")]
pub mod led;
#[cfg(feature = "mavlink")]
pub mod mavlink;
pub mod messages;
#[cfg(feature = "recording")]
pub mod poses;
#[cfg(feature = "recording")]
pub mod recording;
pub mod ros;
#[cfg(feature = "ros2")]
pub mod ros2;
#[cfg(any(feature = "recording", feature = "ros2", feature = "zenoh", feature = "mavlink"))]
mod sink_clock;
pub mod topics;
#[cfg(feature = "zenoh")]
pub mod zenoh;
