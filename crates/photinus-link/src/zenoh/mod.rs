//! Keys of Zenoh: what ROS 2 programs get as topics, for vehicles and ground stations without ROS.
//!
//! In: [`Messages`](crate::messages::Messages). Out: the same in CDR on the keys `photinus/VEHICLE/detections`, `neighbours`, `tracks`, `markers`, `tf`,
//! `tf_static` and `diagnostics`, so that `photinus/*/tracks` is whom a whole swarm follows; and images, points and motion that others put.
//! A message that the network does not take at once is dropped by it: the next one is newer.

mod link;
mod sink;
mod source;

pub use link::{Link, Settings, ZenohError};
pub use sink::ZenohSink;
pub use source::KeySource;
