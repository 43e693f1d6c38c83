//! Pictures of what is found are drawn for a subscriber of cyclonedds, and for nobody.

use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use photinus::camera::{Camera as Lens, Ideal, IdealLaw, Model, Pixel};
use photinus_link::config::Camera;
use photinus_link::messages::Viewpoint;
use photinus_link::ros2::{Picture, Ros2Sink, Settings};
use photinus_run::Entry;
use photinus_run::health::Health;
use photinus_run::sink::Sink;
use photinus_testing::python_with;
use serde_json::{Value, json};

use crate::sample;

const SCRIPT: &str = concat!(
    include_str!("wire_types.py"),
    r#"
import sys
import time

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

# As RViz subscribes to images.
sensor = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
participant = DomainParticipant(int(sys.argv[1]))
topic = Topic(participant, "rt/uav1/photinus/left/overlay", Wire({}).of("sensor_msgs/msg/Image"), qos=sensor)
reader, end = DataReader(participant, topic, qos=sensor), time.monotonic() + 40
while time.monotonic() < end:
    for image in reader.take(1):
        told = plain(image)
        told["data"] = [len(told["data"]), sum(place % 251 * value for place, value in enumerate(told["data"]))]
        print(json.dumps(told), flush=True)
        sys.exit()
    time.sleep(0.01)
"#
);
/// Domains that no other test uses.
const FIRST_DOMAIN: u32 = 100;
const DOMAINS: u32 = 40;
const SIZE: [u32; 2] = [772, 554];

fn picture() -> Picture {
    let rgb = (0..SIZE[0] * SIZE[1] * 3).map(|place| (place % 253) as u8).collect();
    Picture { width: SIZE[0], height: SIZE[1], rgb }
}

fn health() -> Health {
    Health { up_s: 1.0, wake_up_ms: None, cameras: Vec::new(), sinks: Vec::new() }
}

fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [200.0; 2], Pixel::new(375.5, 239.5)).expect("a lens");
    let lens = Lens::new(Model::Ideal(lens), 752, 480, None).expect("a camera");
    Camera { view: Viewpoint::new(Some("left"), Some(1e-3)), lens, mask: None, mounting: None }
}

#[test]
fn pictures_are_drawn_while_somebody_subscribes_and_arrive_whole() {
    let Some(mut python) = python_with(&["cyclonedds", "rosbags"]) else { return };
    let domain = FIRST_DOMAIN + std::process::id() % DOMAINS;
    let mut settings = Settings::default();
    settings.domain = domain as u16;
    settings.namespace = "/uav1".to_owned();
    let mut sink = Ros2Sink::new(settings, vec![camera()]).expect("there is a network");
    let drawn = Arc::<AtomicU64>::default();
    let count = drawn.clone();
    let draw = Box::new(move |_: &Entry| {
        count.fetch_add(1, Ordering::Relaxed);
        Ok(picture())
    });
    let mut overlay = sink.overlay(draw).expect("a name");
    let began = Instant::now();
    let mut frame = || {
        sink.health(&health()).expect("it goes on");
        let entry = Entry::from_spots(sample::record(17, 1_700_000_000.25));
        overlay.frame(&entry).expect("it goes on");
        std::thread::sleep(Duration::from_millis(20));
        drawn.load(Ordering::Relaxed)
    };
    for _ in 0..50 {
        assert_eq!(frame(), 0, "nobody looks");
    }
    let mut child =
        python.args(["-c", SCRIPT, &domain.to_string()]).stdout(Stdio::piped()).spawn().expect("Python runs");
    let out = BufReader::new(child.stdout.take().expect("a pipe"));
    let (said, heard) = channel();
    std::thread::spawn(move || said.send(out.lines().next()));
    let until = Instant::now() + Duration::from_secs(60);
    let line = loop {
        frame();
        if let Ok(line) = heard.try_recv() {
            break line;
        }
        assert!(Instant::now() < until, "nothing was heard");
    };
    let read: Value = serde_json::from_str(&line.expect("a line").expect("text")).expect("JSON");
    assert_eq!(
        [&read["width"], &read["height"], &read["step"], &read["encoding"]],
        [&json!(SIZE[0]), &json!(SIZE[1]), &json!(3 * SIZE[0]), &json!("rgb8")]
    );
    let sum: u64 =
        picture().rgb.iter().enumerate().map(|(place, &value)| place as u64 % 251 * u64::from(value)).sum();
    assert_eq!(read["data"], json!([3 * SIZE[0] * SIZE[1], sum]));
    assert_eq!(read["header"]["frame_id"], "left_optical_frame");
    let nanoseconds = read["header"]["stamp"]["nanosec"].as_f64().expect("a number");
    assert!((nanoseconds - 250.5e6).abs() < 1e3, "{nanoseconds}: the middle of the exposure");
    // It is gone, and then nothing is drawn any more.
    assert!(child.wait().expect("it ended").success());
    let until = Instant::now() + Duration::from_secs(60);
    while (0..25).map(|_| frame()).collect::<std::collections::BTreeSet<_>>().len() > 1 {
        assert!(Instant::now() < until, "it draws for nobody");
    }
    let all = drawn.load(Ordering::Relaxed);
    assert!(all > 0 && all as f64 <= 1.0 + began.elapsed().as_secs_f64() / 0.2, "{all}");
}
