//! Poses of recordings: written here by the definitions of the formats, and by programs that nobody here wrote.

use photinus_io::dataset::TimedPose;
use photinus_link::bag::Bag;
use photinus_link::poses::{pose_topics, read_poses};
use photinus_link::recording::{Recorder, Recording, Settings};
use photinus_link::ros::{
    Header, Message, Odometry, Pose, PoseStamped, PoseWithCovariance, PoseWithCovarianceStamped, Quaternion,
    Time, Transform, TransformStamped,
};
use photinus_testing::{BagMessage, bag, python_with};

const SCRIPT: &str = include_str!("write_poses.py");
/// Messages that the tests write, 0.1 s apart.
const COUNT: u32 = 30;

/// Where the vehicle is in message `number`: the script says the same.
fn pose(number: u32) -> Pose {
    let step = f64::from(number);
    let turn = libm::sqrt(1.0 - 0.01 * step * 0.01 * step);
    let orientation = Quaternion { x: 0.0, y: 0.0, z: 0.01 * step, w: turn };
    Pose { position: [0.5 * step, -2.0, 1.0 + 0.125 * step].into(), orientation }
}

/// When: since 1970, so that the last digits of a double are in play.
fn stamp(number: u32) -> Time {
    Time { sec: 1_700_000_000 + (number / 10) as i32, nanosec: number % 10 * 100_000_000 }
}

fn expected() -> Vec<TimedPose> {
    let timed = |number| {
        let Pose { position: p, orientation: q } = pose(number);
        TimedPose::new(stamp(number).seconds(), [p.x, p.y, p.z], [q.x, q.y, q.z, q.w]).expect("a pose")
    };
    (0..COUNT).map(timed).collect()
}

fn header(number: u32) -> Header {
    Header { stamp: stamp(number), frame_id: "map".to_owned() }
}

fn odometry(number: u32) -> Odometry {
    let pose = PoseWithCovariance { pose: pose(number), covariance: [[0.5; 6]; 6] };
    Odometry { header: header(number), child_frame_id: "base".to_owned(), pose, ..Odometry::default() }
}

/// What ROS 1 serializes of odometry, by the definitions of its messages.
fn odometry_of_ros1(number: u32) -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let Pose { position: p, orientation: q } = pose(number);
    let covariance_and_twist = vec![0.25; 36 + 6 + 36];
    let numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w].into_iter().chain(covariance_and_twist);
    let time = stamp(number);
    [
        number.to_le_bytes().to_vec(),
        (time.sec as u32).to_le_bytes().to_vec(),
        time.nanosec.to_le_bytes().to_vec(),
        text("map"),
        text("base_link"),
        numbers.flat_map(f64::to_le_bytes).collect(),
    ]
    .concat()
}

fn messages(topic: &'static str, numbers: impl Iterator<Item = u32>) -> Vec<BagMessage<'static>> {
    let message = |number| BagMessage {
        topic,
        kind: "nav_msgs/Odometry",
        time: (stamp(number).sec as u32, stamp(number).nanosec + 7),
        bytes: odometry_of_ros1(number),
    };
    numbers.map(message).collect()
}

fn lz4(bytes: Vec<u8>) -> (&'static str, Vec<u8>) {
    let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).expect("an encoder");
    std::io::Write::write_all(&mut encoder, &bytes).expect("it is packed");
    ("lz4", encoder.finish().0)
}

/// A file in a folder of its own.
fn file(bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flight.bag");
    std::fs::write(&path, bytes).expect("it is written");
    (folder, path)
}

#[test]
fn every_message_with_a_pose_is_read_back_from_mcap() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flight.mcap");
    let mut recorder = Recorder::create(&path, Settings::default(), None).expect("a file");
    fn put(recorder: &mut Recorder, topic: &str, message: &impl Message, number: u32) {
        recorder.message(topic, message, 0, u64::from(number)).expect("it is written");
    }
    // The stamps count: messages arrive in another order, and one of them twice.
    for number in (0..COUNT).rev().chain([7]) {
        let (header, pose) = (header(number), pose(number));
        let transform = Transform {
            translation: [pose.position.x, pose.position.y, pose.position.z].into(),
            rotation: pose.orientation,
        };
        put(&mut recorder, "/odom", &odometry(number), number);
        put(&mut recorder, "/pose", &PoseStamped { header: header.clone(), pose }, number);
        let with = PoseWithCovariance { pose, ..PoseWithCovariance::default() };
        put(
            &mut recorder,
            "/sure",
            &PoseWithCovarianceStamped { header: header.clone(), pose: with },
            number,
        );
        let child_frame_id = "base".to_owned();
        put(&mut recorder, "/vicon", &TransformStamped { header, child_frame_id, transform }, number);
    }
    recorder.finish().expect("it ends");
    for topic in ["/odom", "/pose", "/sure", "/vicon"] {
        assert_eq!(read_poses(&path, Some(topic)).expect(topic), expected(), "{topic}");
    }
    let recording = Recording::open(&path).expect("it is whole");
    assert_eq!(recording.span_ns(), Some((0, u64::from(COUNT - 1))));
    assert_eq!(pose_topics(recording.topics()).count(), 4);
    let refused = |topic: Option<&str>| read_poses(&path, topic).expect_err("refused").to_string();
    assert!(
        refused(None).ends_with(&format!("name one of them as {}:TOPIC", path.display())),
        "{}",
        refused(None)
    );
    assert!(
        refused(Some("/other"))
            .ends_with("it has no topic /other; topics with poses: /odom, /pose, /sure, /vicon")
    );
}

#[test]
fn poses_of_a_bag_are_read_plain_and_packed() {
    let chunks = [
        messages("/odom", 0..10),
        messages("/odom", 10..COUNT).into_iter().chain(messages("/other", 0..5)).collect(),
        vec![BagMessage { topic: "/imu", kind: "sensor_msgs/Imu", time: (1, 0), bytes: vec![1, 2, 3] }],
    ];
    for (packed, pack) in [("none", (|bytes| ("none", bytes)) as fn(Vec<u8>) -> _), ("lz4", lz4)] {
        let (_folder, path) = file(&bag(&chunks, pack));
        assert_eq!(read_poses(&path, Some("/odom")).expect(packed), expected(), "{packed}");
        let opened = Bag::open(&path).expect(packed);
        let told: Vec<_> =
            opened.topics().into_iter().map(|topic| (topic.name, topic.kind, topic.messages)).collect();
        let odometry = |name: &str, count| (name.to_owned(), "nav_msgs/Odometry".to_owned(), Some(count));
        let imu = ("/imu".to_owned(), "sensor_msgs/Imu".to_owned(), Some(1));
        assert_eq!(told, [imu, odometry("/odom", 30), odometry("/other", 5)]);
        assert_eq!(opened.span_ns(), Some((1_000_000_000, 1_700_000_002_900_000_007)));
        let refused = read_poses(&path, Some("/imu")).expect_err("no poses").to_string();
        assert!(refused.contains("/imu carries sensor_msgs/Imu, which tells no pose"), "{refused}");
    }
    let (_folder, path) = file(&bag(&chunks, |bytes| ("bz2", bytes)));
    let refused = read_poses(&path, Some("/odom")).expect_err("bzip2").to_string();
    assert!(refused.contains("compressed with bz2, which is not read; `rosbag decompress`"), "{refused}");
}

#[test]
fn poses_that_nothing_has_are_told() {
    let told = |messages: Vec<BagMessage<'_>>| {
        let (_folder, path) = file(&bag(&[messages], |bytes| ("none", bytes)));
        read_poses(&path, None).expect_err("refused").to_string()
    };
    let changed = |change: fn(&mut Vec<u8>)| {
        let mut messages = messages("/odom", 0..4);
        change(&mut messages[2].bytes);
        told(messages)
    };
    // Number 4, stamp 8, texts 4 + 3 and 4 + 9: the place begins at byte 32.
    let still = changed(|bytes| bytes[56..88].fill(0));
    assert!(still.ends_with("message 2 of /odom: the quaternion has length 0, not 1"), "{still}");
    let nowhere = changed(|bytes| bytes[32..40].copy_from_slice(&f64::NAN.to_le_bytes()));
    assert!(nowhere.ends_with("message 2 of /odom: the coordinate NaN m is out of range"), "{nowhere}");
    let short = changed(|bytes| bytes.truncate(60));
    assert!(short.ends_with("message 2 of /odom is no nav_msgs/Odometry"), "{short}");
    let two = changed(|bytes| bytes[8..12].fill(0));
    assert!(
        two.contains("two messages tell different poses at 1700000000 s; give a topic that stamps"),
        "{two}"
    );
    let (_folder, path) = file(&bag(&[vec![]], |bytes| ("none", bytes)));
    assert!(read_poses(&path, None).expect_err("empty").to_string().contains("no topic of it carries poses"));
}

#[test]
fn damaged_bags_are_errors_or_poses() {
    let chunks = [messages("/odom", 0..6), messages("/odom", 6..12)];
    let bytes = bag(&chunks, lz4);
    let (_folder, path) = file(&bytes);
    let (mut refused, mut read) = (0, 0);
    // The header is mostly spaces: what matters is before and behind them.
    let places: Vec<usize> = (0..130).chain(4100..bytes.len()).collect();
    for case in 0..3_000_usize {
        let at = places[case.wrapping_mul(2_654_435_761) % places.len()];
        let damaged = photinus_testing::damage(bytes.clone(), (case % 3) as u8, at, (case / 7) as u8);
        std::fs::write(&path, damaged).expect("it is written");
        match read_poses(&path, None) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Ok(poses) => read += poses.len(),
        }
    }
    assert!(refused > 500 && read > 500, "{refused} {read}");
}

#[test]
fn recordings_of_others_tell_the_same_poses() {
    let Some(mut python) = python_with(&["mcap_ros2", "rosbags"]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let output =
        python.args(["-c", SCRIPT]).arg(folder.path()).arg(COUNT.to_string()).output().expect("Python runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["plain.bag", "packed.bag", "rosbags.mcap", "mcap_ros2.mcap"] {
        for topic in ["/odom", "/pose"] {
            let read = read_poses(folder.path().join(name), Some(topic));
            assert_eq!(read.unwrap_or_else(|error| panic!("{error}")), expected(), "{name} {topic}");
        }
    }
    let topics = Bag::open(folder.path().join("packed.bag")).expect("it is whole").topics();
    assert!(topics.iter().all(|topic| topic.messages == Some(u64::from(COUNT))), "{topics:?}");
    let refused = read_poses(folder.path().join("bzip2.bag"), Some("/odom")).expect_err("bzip2").to_string();
    assert!(refused.contains("bz2, which is not read"), "{refused}");
}
