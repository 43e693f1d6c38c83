//! What this crate tells, tried on programs that nobody here wrote, on files cut anywhere and on bytes that mean nothing.

#[cfg(feature = "mavlink")]
mod autopilot;
#[cfg(feature = "recording")]
mod bag_images;
#[cfg(all(feature = "ros2", feature = "recording"))]
mod dds;
#[cfg(feature = "recording")]
mod killed;
mod malformed;
#[cfg(feature = "recording")]
mod motion;
#[cfg(feature = "ros2")]
mod overlay;
#[cfg(feature = "recording")]
mod poses;
#[cfg(feature = "recording")]
mod read_by_others;
#[cfg(feature = "recording")]
mod recording;
mod sample;
#[cfg(feature = "recording")]
mod sinks;
#[cfg(all(feature = "zenoh", feature = "recording"))]
mod zenoh;
