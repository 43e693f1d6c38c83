//! Images of a camera driver as a source of a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::Error;
use photinus_io::frames::Frame;
use photinus_run::Entry;
use photinus_run::source::{Next, Source};

use super::{Images, Node, Ros2Error, Settings};

/// How long is looked away between two looks for an image, a share of what a frame takes.
const LOOK: Duration = Duration::from_micros(500);

/// Images of a topic; their stamps are the times of the frames.
pub struct ImageSource {
    /// Topics live as long as the node.
    _node: Node,
    images: Images,
    topic: String,
    next: u64,
    is_ended: Arc<AtomicBool>,
}

impl ImageSource {
    /// Subscribes to `topic`, by its full name.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the name is not valid.
    pub fn new(settings: Settings, topic: &str) -> std::result::Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let images = node.images(topic)?;
        Ok(Self { _node: node, images, topic: topic.to_owned(), next: 0, is_ended: Arc::default() })
    }
}

impl Source for ImageSource {
    fn next(&mut self) -> Next {
        while !self.is_ended.load(Ordering::Relaxed) {
            let Some(taken) = self.images.take() else {
                std::thread::sleep(LOOK);
                continue;
            };
            let index = self.next;
            self.next += 1;
            let entry = taken.map(|(header, image)| {
                let time_s = Some(header.stamp.seconds());
                let source = self.topic.clone();
                let frame = Frame { image, index, time_s, source, gravity: None, conversions: Vec::new() };
                Entry { taken: Some(Instant::now()), ..Entry::from_frame(frame) }
            });
            return match entry {
                Ok(entry) => Next::Frame(entry),
                Err(error) => Next::Bad(Error::format(&self.topic, error.to_string())),
            };
        }
        Next::End
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        let is_ended = Arc::clone(&self.is_ended);
        Some(Box::new(move || is_ended.store(true, Ordering::Relaxed)))
    }
}
