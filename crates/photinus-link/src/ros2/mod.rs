//! ROS 2 topics without ROS: DDS by the crate ros2-client, behind traits of our own.
//!
//! In: [`Messages`]. Out: what any ROS 2 node of the same domain subscribes to, and [`Images`] of theirs. Nothing here waits: a message that
//! the network does not take at once is lost and counted, because the next one is newer.

mod motion;
mod node;
mod overlay;
mod sink;
mod source;
mod uvdar;

use photinus_io::calibration::MountingFile;

pub use motion::MotionTopics;
pub use node::{Images, Inbox, Node, Ros2Error};
pub use overlay::{Draw, OverlaySink, Picture};
pub use sink::Ros2Sink;
pub use source::{ImageSource, PointSource};
pub use uvdar::UvdarTopics;

use crate::messages::{Messages, mounting_transform};
use crate::ros::{
    Detection3DArray, DiagnosticArray, Header, MarkerArray, Message, NeighbourArray, TFMessage,
};
use crate::topics;

/// Who takes part in ROS.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Settings {
    /// `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Before every topic but /tf, /tf_static and /diagnostics; empty or `/uav1`.
    pub namespace: String,
    /// Full names of topics and what they are called instead.
    pub remaps: Vec<(String, String)>,
}

impl Settings {
    /// What a topic is called on the network.
    #[must_use]
    pub fn name(&self, topic: &str) -> String {
        let is_shared = [topics::TRANSFORMS, topics::STATIC_TRANSFORMS, topics::DIAGNOSTICS].contains(&topic);
        let own = match self.namespace.trim_matches('/') {
            namespace if !is_shared && !namespace.is_empty() => format!("/{namespace}{topic}"),
            _ => topic.to_owned(),
        };
        self.remaps.iter().find(|(from, _)| *from == own).map_or(own, |(_, to)| to.clone())
    }
}

/// How messages of a topic travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Reliable, the last ten.
    Results,
    /// Reliable, the last hundred: tf.
    Transforms,
    /// Reliable, and who comes later gets the last one, too: tf_static.
    Latched,
    /// Reliable, the last two: pictures, which are large.
    Picture,
    /// Best effort, the last five: images and other sensors.
    Sensor,
    /// Best effort, the last hundred: tf of others.
    TransformsIn,
    /// Reliable, also what was said before: tf_static of others.
    StaticTransformsIn,
}

/// Where messages of one type go.
pub trait Publisher<M: Message> {
    /// Hands a message to the network.
    ///
    /// # Errors
    /// [`Ros2Error`] when it does not take it at once.
    fn publish(&self, message: M) -> Result<(), Ros2Error>;
}

/// The topics of Photinus. None comes or goes with neighbours.
pub struct Topics {
    detections: Box<dyn Publisher<Detection3DArray> + Send>,
    neighbours: Box<dyn Publisher<NeighbourArray> + Send>,
    tracks: Box<dyn Publisher<NeighbourArray> + Send>,
    markers: Box<dyn Publisher<MarkerArray> + Send>,
    transforms: Box<dyn Publisher<TFMessage> + Send>,
    fixed: Box<dyn Publisher<TFMessage> + Send>,
    diagnostics: Box<dyn Publisher<DiagnosticArray> + Send>,
    lost: u64,
}

impl Topics {
    /// Announces them.
    ///
    /// # Errors
    /// [`Ros2Error`] when a name is not valid.
    pub fn new(node: &mut Node) -> Result<Self, Ros2Error> {
        Ok(Self {
            detections: Box::new(node.publisher(topics::DETECTIONS, Quality::Results)?),
            neighbours: Box::new(node.publisher(topics::NEIGHBOURS, Quality::Results)?),
            tracks: Box::new(node.publisher(topics::TRACKS, Quality::Results)?),
            markers: Box::new(node.publisher(topics::MARKERS, Quality::Results)?),
            transforms: Box::new(node.publisher(topics::TRANSFORMS, Quality::Transforms)?),
            fixed: Box::new(node.publisher(topics::STATIC_TRANSFORMS, Quality::Latched)?),
            diagnostics: Box::new(node.publisher(topics::DIAGNOSTICS, Quality::Results)?),
            lost: 0,
        })
    }

    /// Tells what was found in a frame. What the network does not take is counted.
    pub fn tell(&mut self, told: Messages) {
        let has_transforms = !told.transforms.transforms.is_empty();
        let results = [
            self.detections.publish(told.detections),
            self.neighbours.publish(told.neighbours),
            self.tracks.publish(told.tracks),
            self.markers.publish(told.markers),
            if has_transforms { self.transforms.publish(told.transforms) } else { Ok(()) },
        ];
        self.count(&results);
    }

    /// Tells how the program is.
    pub fn tell_health(&mut self, health: DiagnosticArray) {
        let result = self.diagnostics.publish(health);
        self.count(&[result]);
    }

    /// Tells how cameras sit on their vehicle, whose body frame is `base`: who comes later is told, too.
    pub fn tell_mountings(&mut self, base: &str, mountings: &[(Header, MountingFile)]) {
        let transform =
            |(optical, mounting): &(Header, MountingFile)| mounting_transform(mounting, base, optical);
        let result =
            self.fixed.publish(TFMessage { transforms: mountings.iter().filter_map(transform).collect() });
        self.count(&[result]);
    }

    /// How many messages the network did not take.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Messages of other topics of this program that the network did not take.
    pub(super) fn count_lost(&mut self, lost: u64) {
        self.lost += lost;
    }

    fn count(&mut self, results: &[Result<(), Ros2Error>]) {
        self.lost += results.iter().filter(|result| result.is_err()).count() as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_the_namespace_and_then_their_remap() {
        let remaps = vec![("/uav1/photinus/detections".to_owned(), "/seen".to_owned())];
        let settings = Settings { namespace: "/uav1/".to_owned(), remaps, ..Settings::default() };
        assert_eq!(settings.name(topics::DETECTIONS), "/seen");
        assert_eq!(settings.name(topics::NEIGHBOURS), "/uav1/photinus/neighbours");
        assert_eq!(settings.name(topics::TRANSFORMS), "/tf");
        assert_eq!(Settings::default().name(topics::TRACKS), "/photinus/tracks");
    }
}
