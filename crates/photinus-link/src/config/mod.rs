//! The tables of a configuration file that say which links a run has: each opens a [`photinus_run::sink::Sink`].
//!
//! ```text
//! [record]    file, pixels, split_mb, split_s
//! [ros2]      domain, namespace, remaps, base_frame, world_frame, imu, odometry, compat
//! [zenoh]     vehicle, listen, connect, scouting, imu, odometry
//! [mavlink]   peer, local, system, component, radius_m, reach_m, tells_free, most_hz, stale_ms
//! ```

#[cfg(feature = "mavlink")]
mod mavlink;
#[cfg(feature = "recording")]
mod record;
#[cfg(feature = "ros2")]
mod ros2;
#[cfg(feature = "zenoh")]
mod zenoh;

use photinus::camera::Camera as Lens;
use photinus::frame::Mask;
use photinus_io::calibration::MountingFile;

#[cfg(feature = "mavlink")]
pub use mavlink::Mavlink;
#[cfg(feature = "recording")]
pub use record::Record;
#[cfg(feature = "ros2")]
pub use ros2::{Compat, Ros2};
#[cfg(feature = "zenoh")]
pub use zenoh::Zenoh;

use crate::messages::Viewpoint;

/// A camera of the run, as links need to know it.
#[derive(Clone, Debug)]
pub struct Camera {
    /// What its messages are headed with.
    pub view: Viewpoint,
    /// What it looks through.
    pub lens: Lens,
    /// Where it does not look.
    pub mask: Option<Mask>,
    /// How it sits on its vehicle, where that is known.
    pub mounting: Option<MountingFile>,
}

/// The vehicle's body frame, by REP 105.
#[cfg(any(feature = "recording", feature = "ros2", feature = "zenoh"))]
const BASE: &str = "base_link";

#[cfg(any(feature = "recording", feature = "zenoh"))]
fn mountings(base: &str, cameras: &[Camera]) -> crate::ros::TFMessage {
    let transform = |camera: &Camera| {
        crate::messages::mounting_transform(&camera.mounting?, base, &camera.view.header(None))
    };
    crate::ros::TFMessage { transforms: cameras.iter().filter_map(transform).collect() }
}
