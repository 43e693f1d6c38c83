//! Recordings: MCAP files of the profile `ros2`, which every ROS 2 tool opens.
//!
//! ```text
//! sink      what a run finds comes in
//! write     frames, results and attitudes come in, files come out (part); what was written a second ago survives any death of the program
//! recover   a file that was cut off comes in, a whole one comes out
//! read      a file comes in, whoever wrote it; its index and its messages come out
//! motion    its IMU and odometry come out as attitudes and rates of the vehicle
//! frames    its images come out as frames, bit for bit those that went in
//! ```

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use photinus_io::{Error, Result};

mod frames;
mod motion;
mod part;
mod pixels;
mod read;
mod recover;
mod sink;
mod write;

pub(crate) use frames::{COMPRESSED, RAW, chosen, topics_of_images};
pub use frames::{Frames, ImageTopic, image_topics};
pub use motion::Motions;
pub use pixels::Pixels;
pub(crate) use read::MOST_BYTES;
pub use read::{Recording, Topic};
pub use recover::{Recovered, recover};
pub use sink::RecordSink;
pub use write::{Located, Recorder, Settings, Split};

/// The reader of MCAP is other people's code, and bytes come from anybody: a panic of it is treated as a damaged file.
fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T>) -> Result<T> {
    let refuse = |_| Err(Error::format(path, "its index contradicts itself").advise(MEND));
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(refuse)
}

/// What to do about a damaged file.
const MEND: &str = "`photinus recover` mends a recording that was cut off";

/// ROS writes `package/msg/Name` where definitions say `package/Name`.
fn long_name(name: &str) -> String {
    name.replacen('/', "/msg/", 1)
}

/// `package/Name`, of either form.
fn short_name(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// How definitions are written.
const SCHEMA_ENCODING: &str = "ros2msg";
/// How messages are written.
const MESSAGE_ENCODING: &str = "cdr";
