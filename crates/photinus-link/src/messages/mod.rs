//! A located frame -> the messages that tell it.
//!
//! In: a [`FrameRecord`] as `photinus locate` writes it, and the [`Viewpoint`] of its camera. Out: [`Messages`], the same for every link that
//! carries ROS messages. Two things are told and never mixed: what was measured in this frame (`detections`, `neighbours`), and who is
//! followed over time, also through the dark (`tracks`).
//!
//! Frames are those of REP 103: messages stand in the camera's optical frame, x right, y down, z forward, which is the camera frame of
//! Photinus. Covariances are about fixed axes of that frame, and never zero. Stamps are of the middle of the exposure.

mod covariance;
mod detections;
mod health;
mod markers;
mod motion;
mod neighbours;
mod running;
mod transforms;
mod tree;
mod uvdar;

use photinus_io::results::FrameRecord;

pub use covariance::{bearing_covariance, pose_covariance};
pub use health::{Health, diagnostics};
pub use motion::{Turning, of_imu, of_odometry};
pub use running::parts;
pub use transforms::mounting_transform;
pub use tree::Tree;
pub use uvdar::{Uvdar, spots_of};

use crate::ros::{Detection3DArray, Header, MarkerArray, NeighbourArray, TFMessage, Time};

/// How messages of one camera are headed.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoint {
    /// The camera's name.
    pub camera: String,
    /// Name of its optical frame.
    pub frame_id: String,
    /// How long a frame is exposed, s, where that is known: times of frames are those of its beginning.
    pub exposure_s: Option<f64>,
}

/// What is told of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Messages {
    /// Who was measured in this frame, a hypothesis per mode.
    pub detections: Detection3DArray,
    /// The same with all that vision_msgs cannot hold.
    pub neighbours: NeighbourArray,
    /// Who is followed, also those that were not seen.
    pub tracks: NeighbourArray,
    /// Ellipsoids and bounds to look at.
    pub markers: MarkerArray,
    /// Where those are whose id is known.
    pub transforms: TFMessage,
}

impl Messages {
    /// What a frame is in ROS's words.
    #[must_use]
    pub fn of(record: &FrameRecord, view: &Viewpoint) -> Self {
        let header = view.header(record.time_s);
        Self {
            detections: detections::of(record, &header),
            neighbours: neighbours::measured(record, view, &header),
            tracks: neighbours::followed(record, view, &header),
            markers: markers::of(record, view, &header),
            transforms: transforms::of(record, &header),
        }
    }
}

impl Viewpoint {
    /// A camera of this name with the frame that REP 103 suggests for it, `NAME_optical_frame`; a camera without a name is `camera`.
    #[must_use]
    pub fn new(camera: Option<&str>, exposure_s: Option<f64>) -> Self {
        let camera = camera.unwrap_or("camera").to_owned();
        Self { frame_id: format!("{camera}_optical_frame"), camera, exposure_s }
    }

    /// The same for a frame whose own exposure is known.
    #[must_use]
    pub fn exposed(&self, exposure_s: Option<f64>) -> Self {
        Self { exposure_s: exposure_s.or(self.exposure_s), ..self.clone() }
    }

    /// The header of a frame whose exposure began then: the middle of it. A frame without time has the stamp 0.
    #[must_use]
    pub fn header(&self, time_s: Option<f64>) -> Header {
        let middle_s = time_s.map_or(0.0, |time_s| time_s + self.exposure_s.unwrap_or(0.0) / 2.0);
        Header { stamp: Time::from_seconds(middle_s), frame_id: self.frame_id.clone() }
    }
}

/// What a vehicle is called: its id, or the number of its track, or nothing.
fn name(id: Option<u32>, track: Option<u64>) -> String {
    match (id, track) {
        (Some(id), _) => id.to_string(),
        (None, Some(track)) => format!("track-{track}"),
        (None, None) => String::new(),
    }
}
