//! Where a vehicle was, as the recording of a robot tells it: an MCAP recording of ROS 2 or a bag of ROS 1 and a topic come in, poses over
//! time come out.
//!
//! A topic carries poses as nav_msgs/Odometry, geometry_msgs/PoseStamped, geometry_msgs/PoseWithCovarianceStamped or
//! geometry_msgs/TransformStamped. Times are the stamps of the messages: when a pose was true, not when it was recorded.

use std::path::Path;

use photinus_io::dataset::TimedPose;
use photinus_io::kind::Kind;
use photinus_io::{Error, Result};

use crate::bag::Bag;
use crate::bag::serial::Fields;
use crate::cdr::{self, CdrError};
use crate::recording::{Recording, Topic};
use crate::ros::{
    Odometry, Pose, PoseStamped, PoseWithCovarianceStamped, Quaternion, Time, TransformStamped, Vector3,
};

/// A pose as a message tells it.
type Stamped = (Time, Pose);

/// A type of messages that tell a pose.
struct PoseKind {
    name: &'static str,
    /// As ROS 2 writes it.
    of_cdr: fn(&[u8]) -> std::result::Result<Stamped, CdrError>,
    /// Whether ROS 1 writes a second frame between the header and the pose.
    has_child: bool,
}

const KINDS: [PoseKind; 4] = [
    PoseKind {
        name: "nav_msgs/Odometry",
        of_cdr: |bytes| cdr::decode(bytes).map(|told: Odometry| (told.header.stamp, told.pose.pose)),
        has_child: true,
    },
    PoseKind {
        name: "geometry_msgs/PoseStamped",
        of_cdr: |bytes| cdr::decode(bytes).map(|told: PoseStamped| (told.header.stamp, told.pose)),
        has_child: false,
    },
    PoseKind {
        name: "geometry_msgs/PoseWithCovarianceStamped",
        of_cdr: |bytes| {
            cdr::decode(bytes).map(|told: PoseWithCovarianceStamped| (told.header.stamp, told.pose.pose))
        },
        has_child: false,
    },
    PoseKind {
        name: "geometry_msgs/TransformStamped",
        of_cdr: |bytes| {
            cdr::decode(bytes).map(|told: TransformStamped| {
                let (Vector3 { x, y, z }, orientation) =
                    (told.transform.translation, told.transform.rotation);
                (told.header.stamp, Pose { position: [x, y, z].into(), orientation })
            })
        },
        has_child: true,
    },
];

/// Those of a recording's topics that carry poses.
pub fn pose_topics(topics: Vec<Topic>) -> impl Iterator<Item = Topic> {
    topics.into_iter().filter(|topic| kind_of(topic).is_some())
}

/// The poses on `topic` of an MCAP recording or a bag, or on the only topic that carries some, in the order of their times.
///
/// # Errors
/// [`Error`] when the file is neither or cannot be read, when it has no such topic, or several and none is named, when a message is
/// none of its type or tells a pose that nothing has, or when two tell different poses at one time.
pub fn read_poses(path: impl AsRef<Path>, topic: Option<&str>) -> Result<Vec<TimedPose>> {
    let path = path.as_ref();
    let mut poses = Vec::new();
    match Kind::of(path)? {
        Kind::Bag => {
            let bag = Bag::open(path)?;
            let (topic, kind) = chosen(bag.topics(), topic, path)?;
            bag.messages(&topic, |bytes| {
                poses.push(timed(of_ros1(bytes, kind.has_child), &topic, poses.len(), path)?);
                Ok(())
            })?;
        }
        Kind::Recording => {
            let recording = Recording::open(path)?;
            let (topic, kind) = chosen(recording.topics(), topic, path)?;
            let mut messages = recording.messages([topic.name.as_str()], 0)?;
            while let Some(told) = messages.next(|_, bytes| (kind.of_cdr)(bytes).ok()) {
                poses.push(timed(told?, &topic, poses.len(), path)?);
            }
        }
        other => {
            return Err(other.refuse(
                path,
                "a recording with poses",
                "name an MCAP recording or a bag of ROS 1",
            ));
        }
    }
    in_order(poses, path)
}

fn kind_of(topic: &Topic) -> Option<&'static PoseKind> {
    KINDS.iter().find(|kind| kind.name == topic.kind)
}

fn chosen(topics: Vec<Topic>, named: Option<&str>, path: &Path) -> Result<(Topic, &'static PoseKind)> {
    let refuse = |reason: String, advice: &str| Err(Error::format(path, reason).advise(advice));
    if let Some(other) = topics.iter().find(|topic| named == Some(&topic.name) && kind_of(topic).is_none()) {
        let reason = format!("{} carries {}, which tells no pose", other.name, other.kind);
        return refuse(reason, "name a topic with odometry, poses or transforms");
    }
    let posed: Vec<Topic> = pose_topics(topics).collect();
    let names = posed.iter().map(|topic| topic.name.as_str()).collect::<Vec<_>>().join(", ");
    let mut meant = posed.iter().filter(|topic| named.is_none_or(|named| named == topic.name));
    match (meant.next(), meant.next(), named) {
        (Some(topic), None, _) => match kind_of(topic) {
            Some(kind) => Ok((topic.clone(), kind)),
            None => refuse(format!("{} tells no pose", topic.name), ""),
        },
        _ if names.is_empty() => {
            let kinds = KINDS.map(|kind| kind.name).join(", ");
            refuse("no topic of it carries poses".to_owned(), &format!("record one with {kinds}"))
        }
        (None, _, Some(named)) => {
            refuse(format!("it has no topic {named}"), &format!("topics with poses: {names}"))
        }
        _ => {
            let advice = format!("name one of them as {}:TOPIC", path.display());
            refuse(format!("several topics of it carry poses: {names}"), &advice)
        }
    }
}

/// The pose that message `number` of a topic tells.
fn timed(told: Option<Stamped>, topic: &Topic, number: usize, path: &Path) -> Result<TimedPose> {
    let place = || format!("message {number} of {}", topic.name);
    let Some((stamp, Pose { position, orientation })) = told else {
        return Err(Error::format(path, format!("{} is no {}", place(), topic.kind)));
    };
    let Quaternion { x, y, z, w } = orientation;
    TimedPose::new(stamp.seconds(), [position.x, position.y, position.z], [x, y, z, w])
        .map_err(|error| Error::format(path, format!("{}: {error}", place())))
}

/// By time. Messages may arrive out of order, and the same one twice.
fn in_order(mut poses: Vec<TimedPose>, path: &Path) -> Result<Vec<TimedPose>> {
    poses.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    poses.dedup();
    if poses.is_empty() {
        return Err(Error::format(path, "the topic has no message"));
    }
    match poses.windows(2).find(|pair| pair[0].time_s >= pair[1].time_s) {
        Some(pair) => {
            let reason = format!("two messages tell different poses at {} s", pair[1].time_s);
            Err(Error::format(path, reason).advise("give a topic that stamps its messages, of one vehicle"))
        }
        None => Ok(poses),
    }
}

/// The same as ROS 1 writes it.
fn of_ros1(bytes: &[u8], has_child: bool) -> Option<Stamped> {
    let mut fields = Fields(bytes);
    let stamp = fields.header()?.stamp;
    if has_child {
        fields.text()?;
    }
    let mut numbers = [0.0; 7];
    for number in &mut numbers {
        *number = fields.f64()?;
    }
    let [x, y, z, qx, qy, qz, qw] = numbers;
    Some((stamp, Pose { position: [x, y, z].into(), orientation: [qx, qy, qz, qw].into() }))
}
