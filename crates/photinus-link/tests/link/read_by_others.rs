//! The recording is read by mcap-ros2-support and by rosbags, which decode by the schemas in the file: every field of every message is compared.

use photinus_io::frames::Moved;
use photinus_io::image::GreyImage;
use photinus_link::messages::{Health, Messages, Viewpoint, diagnostics};
use photinus_link::recording::{Located, Pixels, Recorder, Settings};
use photinus_link::ros::{
    CameraInfo, DiagnosticArray, Frame, Imu, Level, Quaternion, TFMessage, Text, Time, TransformStamped,
};
use photinus_link::topics;
use photinus_testing::python_with;
use serde_json::{Value, json};

use crate::sample;

const SCRIPT: &str = concat!(include_str!("plain.py"), include_str!("read_recording.py"));

fn view() -> Viewpoint {
    Viewpoint::new(Some("left"), Some(1e-3))
}

/// Every definition in the schema of a message, by its name.
#[cfg(any(feature = "ros2", feature = "zenoh"))]
pub(crate) fn definitions(name: &str) -> Vec<(String, String)> {
    let schema = photinus_link::ros::schema(name).expect("it is known");
    let rule = format!("{}\nMSG: ", "=".repeat(80));
    let mut parts = schema.split(&rule);
    let own = (name.to_owned(), parts.next().expect("its own").to_owned());
    let others = parts.map(|part| part.split_once('\n').expect("a name and a text"));
    let others = others.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let long = |(name, text): (String, String)| (name.replacen('/', "/msg/", 1), text);
    std::iter::once(own).chain(others).map(long).collect()
}

pub(crate) fn health() -> DiagnosticArray {
    let values = vec![("rate_hz".to_owned(), "59.9".to_owned())];
    let part = Health { name: "left".to_owned(), level: Level::Warn, message: "slow".to_owned(), values };
    diagnostics(&[part], Time { sec: 5, nanosec: 6 })
}

fn imu() -> Imu {
    Imu {
        header: view().header(Some(2.0)),
        orientation: Quaternion { x: 0.1, y: 0.2, z: 0.3, w: 0.4 },
        orientation_covariance: [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
        angular_velocity: [0.5, 0.6, 0.7].into(),
        ..Imu::default()
    }
}

fn camera_info() -> CameraInfo {
    CameraInfo {
        height: 3,
        width: 4,
        distortion_model: "equidistant".to_owned(),
        d: vec![0.5, 0.25],
        ..CameraInfo::default()
    }
}

/// A number that JSON does not hold is null on both sides.
fn nested(value: Value) -> Value {
    value
}

/// A matrix is told as ROS tells it: one row after the other.
pub(crate) fn flat(value: Value) -> Value {
    let is_matrix = |rows: &Vec<Value>| {
        rows.len() > 1
            && rows.iter().all(|row| {
                row.as_array()
                    .is_some_and(|row| row.len() == rows.len() && row.iter().all(|cell| !cell.is_object()))
            })
    };
    match value {
        Value::Array(rows) if is_matrix(&rows) => {
            rows.into_iter().flat_map(|row| row.as_array().cloned().unwrap_or_default()).collect()
        }
        Value::Array(list) => list.into_iter().map(flat).collect(),
        Value::Object(fields) => {
            Value::Object(fields.into_iter().map(|(key, field)| (key, flat(field))).collect())
        }
        other => nested(other),
    }
}

#[test]
fn every_field_of_every_message_is_read_by_others() {
    let Some(mut python) = python_with(&["mcap_ros2", "rosbags"]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.mcap");
    let fixed = TFMessage {
        transforms: vec![TransformStamped {
            child_frame_id: "left_optical_frame".to_owned(),
            ..TransformStamped::default()
        }],
    };
    let mut settings = Settings::default();
    settings.pixels = Pixels::Raw;
    let mut recorder = Recorder::create(&path, settings, Some(fixed.clone())).expect("a file");
    let record = sample::record(17, 1_700_000_000.25);
    let image = GreyImage::new((0..=255).collect(), 16, 16).expect("a size");
    let located =
        Located { record: &record, image: Some(image.view()), gravity: None, moved: Moved::default() };
    recorder.located(&located, &view(), 1_000).expect("it is written");
    recorder.message(topics::DIAGNOSTICS, &health(), 1, 2_000).expect("it is written");
    recorder.message("/imu", &imu(), 1, 3_000).expect("it is written");
    recorder.message("/photinus/left/camera_info", &camera_info(), 1, 4_000).expect("it is written");
    recorder.finish().expect("it ends");

    let told = Messages::of(&record, &view());
    let header = view().header(record.time_s);
    let known = Frame {
        header: header.clone(),
        camera: "left".to_owned(),
        frame: 17,
        time: 1_700_000_000.25,
        exposure: 1e-3,
        source: record.source.clone(),
        gravity: vec![],
        turned: vec![],
        moving: vec![],
        order: vec![],
        turned_since_any: vec![],
    };
    let mut line = Vec::new();
    photinus_io::results::ResultsWriter::new(&mut line, "t").write(&record).expect("it is written");
    let line = Text { data: String::from_utf8(line).expect("text").trim_end().to_owned() };
    let raw = json!({"header": header, "height": 16, "width": 16, "encoding": "mono8", "is_bigendian": 0, "step": 16, "data": image.pixels()});
    let expected = json!({
        "/tf_static": fixed, "/tf": told.transforms, topics::DETECTIONS: told.detections, topics::NEIGHBOURS: told.neighbours,
        topics::TRACKS: told.tracks, topics::MARKERS: told.markers, topics::RESULTS: line, topics::DIAGNOSTICS: health(),
        "/imu": imu(), "/photinus/left/camera_info": camera_info(), "/photinus/left/frame": known, "/photinus/left/image": raw,
    });
    let expected = flat(expected);
    for library in ["mcap_ros2", "rosbags"] {
        let output = python.args(["-c", SCRIPT, library]).arg(&path).output().expect("Python runs");
        assert!(output.status.success(), "{library}: {}", String::from_utf8_lossy(&output.stderr));
        let read: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        for (topic, message) in expected.as_object().expect("topics") {
            assert_eq!(&read[topic], message, "{library} reads {topic}");
        }
        assert_eq!(
            read.as_object().map(serde_json::Map::len),
            expected.as_object().map(serde_json::Map::len)
        );
        python = python_with(&["mcap_ros2", "rosbags"]).expect("it was there before");
    }
}
