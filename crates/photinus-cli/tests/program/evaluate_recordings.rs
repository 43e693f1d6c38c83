//! `photinus evaluate` and `photinus info` on what ROS recorded: an MCAP recording with the poses of both vehicles, bags of ROS 1.

use photinus_io::dataset::{TimedPose, read_poses};
use photinus_link::recording::{Recorder, Settings};
use photinus_link::ros::{Header, Odometry, Pose, PoseStamped, PoseWithCovariance, Time};
use photinus_testing::{BagMessage, bag};

use crate::evaluate::two_logs;
use crate::stage::Stage;

fn message(told: &TimedPose) -> (Header, Pose) {
    let header = Header { stamp: Time::from_seconds(told.time_s), frame_id: "world".to_owned() };
    let (place, turn) = (told.pose.translation.vector, told.pose.rotation);
    let position = [place.x, place.y, place.z].into();
    (header, Pose { position, orientation: turn.into() })
}

/// The flight of two_logs, as flight.mcap: the observer's odometry and the target's poses.
pub(crate) fn recorded(stage: &Stage) {
    two_logs(stage);
    let [observer, target] = ["observer.csv", "target.csv"].map(|name| read_poses(stage.path(name)).unwrap());
    let mut recorder = Recorder::create(stage.path("flight.mcap"), Settings::default(), None).unwrap();
    for (observer, target) in observer.iter().zip(&target) {
        let arrived_ns = Time::from_seconds(observer.time_s).nanoseconds();
        let (header, pose) = message(observer);
        let pose = PoseWithCovariance { pose, ..PoseWithCovariance::default() };
        let odometry = Odometry { header, pose, ..Odometry::default() };
        recorder.message("/observer/odom", &odometry, 0, arrived_ns).unwrap();
        let (header, pose) = message(target);
        recorder.message("/target/odom", &PoseStamped { header, pose }, 0, arrived_ns).unwrap();
    }
    recorder.finish().unwrap();
}

/// The poses of a log as a bag of ROS 1.
fn bagged(stage: &Stage, log: &str, name: &str) {
    let poses = read_poses(stage.path(log)).unwrap();
    let message = |told: &TimedPose| {
        let (Header { stamp, .. }, Pose { position: p, orientation: q }) = message(told);
        let numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w].into_iter().flat_map(f64::to_le_bytes);
        let words = [0, stamp.sec as u32, stamp.nanosec, 0].into_iter().flat_map(u32::to_le_bytes);
        let time = (stamp.sec as u32, stamp.nanosec);
        BagMessage {
            topic: "/pose",
            kind: "geometry_msgs/PoseStamped",
            time,
            bytes: words.chain(numbers).collect(),
        }
    };
    stage.file(name, bag(&[poses.iter().map(message).collect()], |bytes| ("none", bytes)));
}

#[test]
fn recordings_of_poses_score_as_the_same_poses_in_tables() {
    let stage = Stage::new("evaluate-recordings");
    recorded(&stage);
    bagged(&stage, "observer.csv", "observer.bag");
    bagged(&stage, "target.csv", "target.bag");
    let scores = |logs: &str| {
        let done = stage.run(&format!("evaluate {logs}"));
        assert_eq!((done.code, done.err.as_str()), (0, ""), "{logs}");
        done.out
    };
    let of_tables = scores("observer.csv results.jsonl --target target.csv");
    let of_mcap = scores("flight.mcap:/observer/odom results.jsonl --target flight.mcap:/target/odom");
    assert_eq!(of_mcap, of_tables);
    let of_bags = scores("observer.bag results.jsonl --target target.bag:/pose");
    assert_eq!(of_bags, of_tables);

    let told = stage.run("info flight.mcap observer.bag").out;
    for words in [
        "flight.mcap: an MCAP recording",
        "poses     /observer/odom, /target/odom",
        "observer.bag: a bag of ROS 1",
        "poses     /pose",
        "duration  70.0 s",
        "nav_msgs/Odometry           3500",
        "geometry_msgs/PoseStamped   3500",
    ] {
        assert!(told.contains(words), "{words}\n{told}");
    }
}

#[test]
fn what_is_no_log_of_poses_is_told() {
    let stage = Stage::new("evaluate-no-poses");
    recorded(&stage);
    bagged(&stage, "target.csv", "target.bag");
    let bytes = std::fs::read(stage.path("target.bag")).unwrap();
    stage.file("cut.bag", &bytes[..bytes.len() / 2]);
    stage.file("old.bag", "#ROSBAG V1.2\n");
    for (words, told) in [
        (
            "flight.mcap results.jsonl",
            "flight.mcap: this is an MCAP recording; to get truth from poses, give the log of the other",
        ),
        (
            "flight.mcap:/target/odom results.jsonl",
            "to get truth from poses, give the log of the other vehicle, too: --target FILE",
        ),
        (
            "flight.mcap results.jsonl --target target.csv",
            "flight.mcap: several topics of it carry poses: /observer/odom, /target/odom; name one of them as flight.mcap:TOPIC",
        ),
        (
            "flight.mcap:/odom results.jsonl --target target.csv",
            "flight.mcap: it has no topic /odom; topics with poses: /observer/odom, /target/odom",
        ),
        (
            "observer.csv:/odom results.jsonl --target target.csv",
            "this is a table of poses, which has no topic /odom; name the file alone",
        ),
        ("observer.csv results.jsonl --target gone.mcap:/odom", "gone.mcap:/odom: "),
        (
            "observer.csv results.jsonl --target cut.bag",
            "cut.bag: it was cut off, or its records contradict each other; `rosbag reindex`",
        ),
        (
            "observer.csv results.jsonl --target old.bag",
            "old.bag: it does not begin as a bag of format 2.0 does; `rosbag reindex`",
        ),
    ] {
        stage.refuses(&format!("evaluate {words}"), &[told]);
    }
    let refused = stage.run("locate target.bag --camera camera.toml --airframe hexa.toml");
    assert!(refused.code == 2 && refused.err.contains("target.bag: it holds no images"), "{}", refused.err);
}
