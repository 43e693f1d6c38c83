//! Autopilots: what Photinus tells them, and what it hears from them, by MAVLink 2 over UDP, dialect `common`.
//!
//! ```text
//! axes       FLU and ENU of ROS <-> FRD and NED of autopilots
//! obstacles  neighbours -> OBSTACLE_DISTANCE, the strict minimum by direction
//! target     a followed neighbour and the own global position -> FOLLOW_TARGET
//! heard      ATTITUDE_QUATERNION, HIGHRES_IMU, GLOBAL_POSITION_INT -> gravity, rates, the own place, on the clock of the frames
//! autopilot  the socket: heartbeat, rates, and silence that is told
//! sink       an autopilot as a sink of a run
//! ```

mod autopilot;
mod axes;
mod heard;
mod obstacles;
mod sink;
mod target;

pub use autopilot::{Autopilot, Heard, Settings};
pub use axes::{frd, frd_covariance, ned, ned_from_frd};
pub use heard::{Attitude, Speed, Turn};
pub use obstacles::{Obstacles, Outlook, Ring, SECTORS, UNKNOWN_CM};
pub use sink::AutopilotSink;
pub use target::{Own, follow_target};
