//! Keys of Zenoh are heard by eclipse-zenoh and read by rosbags; what eclipse-zenoh puts is heard here.

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::process::Stdio;
use std::sync::mpsc::{TryRecvError, channel};
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use photinus_link::config::Zenoh;
use photinus_link::messages::Messages;
use photinus_run::Entry;
use photinus_run::health::Health;
use photinus_run::motion::Motion;
use photinus_run::source::Next;
use photinus_testing::python_with;
use serde_json::{Value, json};

use crate::read_by_others::{definitions, flat};
use crate::sample;
use crate::sinks::{camera, table};

const SCRIPT: &str = concat!(include_str!("plain.py"), include_str!("zenoh_peer.py"));

/// A port that was free just now.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").and_then(|taken| taken.local_addr()).expect("a port").port()
}

#[test]
fn eclipse_zenoh_hears_every_key_and_is_heard() {
    let Some(mut python) = python_with(&["zenoh", "rosbags", "numpy"]) else { return };
    let (ours, theirs) = (free_port(), free_port());
    let link: Zenoh = table(&format!(
        "vehicle = \"uav1\"\nlisten = [\"tcp/127.0.0.1:{ours}\"]\nscouting = false\nimu = \"uav1/imu\""
    ));
    // Sources go where the camera driver is.
    let from: Zenoh =
        table(&format!("vehicle = \"uav1\"\nconnect = [\"tcp/127.0.0.1:{theirs}\"]\nscouting = false"));
    let motion = Motion::default();
    let mut sink = link.open(&[camera()], motion.clone()).expect("the port is free");
    let (came, frames) = channel();
    let taking = [("uav1/image", false), ("uav1/points", true)].map(|(key, spots)| {
        let (mut source, came) = (from.source(key, spots)().expect("a key"), came.clone());
        let end = source.interrupter().expect("it waits");
        let thread = std::thread::spawn(move || {
            while let Next::Frame(entry) = source.next() {
                let _ = came.send((key, entry));
            }
        });
        (end, thread)
    });
    let kinds = [
        ("photinus/uav1/detections", "vision_msgs/Detection3DArray"),
        ("photinus/uav1/neighbours", "photinus_msgs/NeighbourArray"),
        ("photinus/uav1/tracks", "photinus_msgs/NeighbourArray"),
        ("photinus/uav1/markers", "visualization_msgs/MarkerArray"),
        ("photinus/uav1/tf", "tf2_msgs/TFMessage"),
        ("photinus/uav1/tf_static", "tf2_msgs/TFMessage"),
        ("photinus/uav1/diagnostics", "diagnostic_msgs/DiagnosticArray"),
    ];
    let long = |kind: &str| kind.replacen('/', "/msg/", 1);
    let keys: serde_json::Map<String, Value> =
        kinds.iter().map(|(key, kind)| ((*key).to_owned(), long(kind).into())).collect();
    let defined: serde_json::Map<String, Value> = kinds
        .iter()
        .map(|(_, kind)| *kind)
        .chain(["sensor_msgs/Imu", "uvdar_core/ImagePointsWithCovariancesStamped"])
        .flat_map(definitions)
        .map(|(name, text)| (name, text.into()))
        .collect();
    let asked = json!({"keys": keys, "definitions": defined, "listen": format!("tcp/127.0.0.1:{theirs}")});
    let mut child = python
        .args(["-c", SCRIPT, &format!("tcp/127.0.0.1:{ours}"), &asked.to_string()])
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python runs");
    let out = BufReader::new(child.stdout.take().expect("a pipe"));
    let (said, heard) = channel();
    std::thread::spawn(move || said.send(out.lines().next()));

    let mut record = sample::record(17, 1_700_000_000.25);
    record.tracks[0].id = Some(1);
    let health = Health { up_s: 1.0, wake_up_ms: None, cameras: Vec::new(), sinks: Vec::new() };
    let (end, mut line, mut image, mut points) = (Instant::now() + Duration::from_secs(60), None, None, None);
    while (line.is_none() || image.is_none() || points.is_none() || motion.rates().is_empty())
        && Instant::now() < end
    {
        let entry = Entry::of_spots(17, 0.0, "", Vec::new());
        sink.frame(&Entry { record: record.clone(), taken: Some(Instant::now()), ..entry })
            .expect("it goes on");
        sink.health(&health).expect("it goes on");
        for (key, entry) in frames.try_iter() {
            *if key == "uav1/image" { &mut image } else { &mut points } = Some(entry);
        }
        match heard.try_recv() {
            Ok(said) => line = said,
            Err(TryRecvError::Disconnected) if line.is_none() => break,
            Err(_) => {}
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    for (end, thread) in taking {
        end();
        thread.join().expect("it ends when it is told to");
    }
    let _ = child.kill();
    let _ = child.wait();
    let line = line.expect("it says something").expect("text");
    let read: Value = serde_json::from_str(&line).expect("JSON");
    for (key, kind) in kinds {
        assert_eq!(read[key]["encoding"], json!(format!("application/cdr;{kind}")), "{key}");
    }
    let told = Messages::of(&record, &camera().view);
    let expected = flat(json!({
        "photinus/uav1/detections": told.detections, "photinus/uav1/neighbours": told.neighbours,
        "photinus/uav1/tracks": told.tracks, "photinus/uav1/markers": told.markers, "photinus/uav1/tf": told.transforms,
    }));
    for (key, message) in expected.as_object().expect("keys") {
        assert_eq!(&read[key]["message"], message, "{key}");
    }
    let fixed = &read["photinus/uav1/tf_static"]["message"]["transforms"][0];
    assert_eq!(
        (&fixed["child_frame_id"], &fixed["header"]["frame_id"]),
        (&json!("left_optical_frame"), &json!("base_link"))
    );
    let motion_told = &read["photinus/uav1/diagnostics"]["message"]["status"];
    assert!(motion_told.to_string().contains("keys of Zenoh"), "{motion_told}");

    let image = image.expect("images were put");
    assert_eq!((image.record.time_s, image.record.source.as_str()), (Some(12.5), "uav1/image"));
    let pixel = |u: usize, v: usize| ((7 * (24 * v + u)) % 256) as u8;
    let sent: Vec<u8> = (0..16).flat_map(|v| (0..20).map(move |u| pixel(u, v))).collect();
    assert_eq!(
        image.image.expect("pixels").pixels(),
        sent,
        "the rows end with four bytes that are no pixels"
    );
    let points = points.expect("points were put");
    assert_eq!((points.record.time_s, points.record.spots.len()), (Some(12.5), 1));
    assert!((points.record.spots[0].u_px - 20.5).abs() < 1e-12);
    let (_, rate) = motion.rates()[0];
    assert!((rate - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
}
