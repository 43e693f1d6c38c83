//! How the run is doing, in numbers that were measured: enters what cameras and sinks count, leaves [`Health`] once a second, and a [`Notice`] when
//! something happens that a person should know.

mod spread;

use serde::{Deserialize, Serialize};

pub use spread::{Recent, Spread};

/// How the run is doing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Health {
    /// Seconds since the run began.
    pub up_s: f64,
    /// How late a thread that had nothing to do woke up: what of the latencies is the machine's.
    pub wake_up_ms: Option<Spread>,
    /// Each camera, in the order of the configuration.
    pub cameras: Vec<CameraHealth>,
    /// Each sink, in the order in which they were opened.
    pub sinks: Vec<SinkHealth>,
}

/// How a camera is doing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraHealth {
    /// What it is called.
    pub name: String,
    /// Whether frames come.
    pub state: CameraState,
    /// Frames that were located since the run began.
    pub frames: u64,
    /// Frames that could not be read or located.
    pub failed: u64,
    /// Frames that came while an older one was being located, and gave way to a newer one.
    pub dropped: u64,
    /// Times that the camera was lost.
    pub lost: u64,
    /// Located frames per second, over the last second.
    pub rate_hz: f64,
    /// From the last frame that was located until now, s; `None` before the first.
    pub silent_s: Option<f64>,
    /// From the end of the exposure until the result was handed to the sinks, over the last frames; where nobody knows the exposure, from the arrival of the frame.
    pub latency_ms: Option<Spread>,
    /// Neighbours in the last frame.
    pub neighbours: usize,
    /// Exposure of the last frame, us, where it is known.
    pub exposure_us: Option<f64>,
}

/// Whether frames of a camera come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraState {
    /// It is being opened for the first time.
    Opening,
    /// It gives frames.
    Running,
    /// It could not be opened or gives no frames any more, and is tried again.
    Lost,
    /// Its frames are at their end.
    Ended,
}

/// How a sink is doing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SinkHealth {
    /// What it is called.
    pub name: String,
    /// Whether it still takes frames: one that failed is left out.
    pub running: bool,
    /// Whether it has written everything at the end of the run.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub finished: bool,
    /// Frames that it has taken.
    pub written: u64,
    /// Frames that it was too slow for.
    pub dropped: u64,
    /// What waits for it now.
    pub waiting: usize,
    /// Age of frames when it had taken them: from the end of the exposure, over the last frames.
    pub age_ms: Option<Spread>,
}

/// How much a notice matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Something differs from what one may think.
    Note,
    /// There is something to do.
    Warning,
    /// Something is missing from the results.
    Error,
}

/// What a person should know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notice {
    /// How much it matters.
    pub level: Level,
    /// Seconds since the run began.
    pub up_s: f64,
    /// What is the matter, and what to do.
    pub text: String,
}
