//! Images of a camera driver, and points of UVDAR's detector, as sources of a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::Error;
use photinus_io::frames::Frame;
use photinus_run::Entry;
use photinus_run::source::{Next, Source};

use super::{Images, Inbox, Node, Ros2Error, Settings};
use crate::messages::spots_of;
use crate::ros::ImagePointsWithCovariancesStamped;

/// How long is looked away between two looks for a message, a share of what a frame takes.
const LOOK: Duration = Duration::from_micros(500);

/// A topic that is waited for.
struct Topic {
    /// Subscriptions live as long as the node.
    _node: Node,
    name: String,
    next: u64,
    is_ended: Arc<AtomicBool>,
}

impl Topic {
    fn new(node: Node, name: &str) -> Self {
        Self { _node: node, name: name.to_owned(), next: 0, is_ended: Arc::default() }
    }

    /// What comes next, waited for: `take` says what is there by now, `entry` makes a frame of it, given its number.
    fn next<M>(
        &mut self,
        mut take: impl FnMut() -> Option<Result<M, Ros2Error>>,
        entry: impl FnOnce(M, u64, &str) -> Entry,
    ) -> Next {
        while !self.is_ended.load(Ordering::Relaxed) {
            let Some(taken) = take() else {
                std::thread::sleep(LOOK);
                continue;
            };
            let index = self.next;
            self.next += 1;
            return match taken {
                Ok(message) => {
                    Next::Frame(Entry { taken: Some(Instant::now()), ..entry(message, index, &self.name) })
                }
                Err(error) => Next::Bad(Error::format(&self.name, error.to_string())),
            };
        }
        Next::End
    }

    fn interrupter(&self) -> Box<dyn Fn() + Send> {
        let is_ended = Arc::clone(&self.is_ended);
        Box::new(move || is_ended.store(true, Ordering::Relaxed))
    }
}

/// Images of a topic; their stamps are the times of the frames.
pub struct ImageSource {
    images: Images,
    topic: Topic,
}

impl ImageSource {
    /// Subscribes to `topic`, by its full name.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the name is not valid.
    pub fn new(settings: Settings, topic: &str) -> std::result::Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let images = node.images(topic)?;
        Ok(Self { images, topic: Topic::new(node, topic) })
    }
}

impl Source for ImageSource {
    fn next(&mut self) -> Next {
        let images = &mut self.images;
        self.topic.next(
            || images.take(),
            |(header, image), index, source| {
                let time_s = Some(header.stamp.seconds());
                let source = source.to_owned();
                Entry::from_frame(Frame {
                    image,
                    index,
                    time_s,
                    source,
                    gravity: None,
                    conversions: Vec::new(),
                })
            },
        )
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        Some(self.topic.interrupter())
    }
}

/// Points of a topic of UVDAR's detector (uvdar_core/ImagePointsWithCovariancesStamped), in place of images.
pub struct PointSource {
    points: Inbox<ImagePointsWithCovariancesStamped>,
    topic: Topic,
}

impl PointSource {
    /// Subscribes to `topic`, by its full name.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the name is none.
    pub fn new(settings: Settings, topic: &str) -> std::result::Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let points = node.inbox(topic)?;
        Ok(Self { points, topic: Topic::new(node, topic) })
    }
}

impl Source for PointSource {
    fn next(&mut self) -> Next {
        let points = &mut self.points;
        self.topic.next(
            || points.take(),
            |message, index, source| {
                Entry::of_spots(index, message.stamp.seconds(), source, spots_of(&message))
            },
        )
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        Some(self.topic.interrupter())
    }
}
