//! Pictures of what is found, for who wants to look: sensor_msgs/Image, drawn only while somebody subscribes, by a thread of their own.
//!
//! In: located frames, and what draws them. Out: a topic per camera, a few pictures a second. [`Ros2Sink`](super::Ros2Sink) looks once a second who
//! subscribes, so that one node is enough.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::sink::Sink;

use super::{Node, Publisher, Quality, Ros2Error};
use crate::config::Camera;
use crate::ros::Image;
use crate::topics;

/// From one picture of a camera to the next, at least.
const LEAST: Duration = Duration::from_millis(200);

/// A picture in colour.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue, row by row.
    pub rgb: Vec<u8>,
}

/// Draws what was found in a frame.
pub type Draw = Box<dyn FnMut(&Entry) -> Result<Picture> + Send>;

/// Publishes pictures of what is found.
pub struct OverlaySink {
    cameras: Vec<OfCamera>,
    draw: Draw,
}

struct OfCamera {
    camera: Camera,
    publisher: Box<dyn Publisher<Image<'static>> + Send>,
    is_wanted: Arc<AtomicBool>,
    last: Option<Instant>,
}

/// Who looks at the pictures of each camera.
#[derive(Default)]
pub(super) struct Watched(Vec<(String, Arc<AtomicBool>)>);

impl Watched {
    /// Asks the network.
    pub(super) fn look(&self, node: &Node) {
        for (topic, is_wanted) in &self.0 {
            is_wanted.store(node.subscribers(topic) > 0, Ordering::Relaxed);
        }
    }
}

impl OverlaySink {
    /// Announces a topic per camera.
    pub(super) fn new(
        node: &mut Node,
        cameras: &[Camera],
        draw: Draw,
    ) -> std::result::Result<(Self, Watched), Ros2Error> {
        let (mut all, mut watched) = (Vec::new(), Watched::default());
        for camera in cameras {
            let topic = topics::of_camera(&camera.view.camera, "overlay");
            let publisher = Box::new(node.publisher(&topic, Quality::Picture)?);
            let is_wanted = Arc::<AtomicBool>::default();
            watched.0.push((topic, is_wanted.clone()));
            all.push(OfCamera { camera: camera.clone(), publisher, is_wanted, last: None });
        }
        Ok((Self { cameras: all, draw }, watched))
    }
}

impl Sink for OverlaySink {
    fn name(&self) -> String {
        "ros2 overlay".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        let Some(own) = self.cameras.get_mut(entry.camera) else { return Ok(()) };
        let is_due = own.last.is_none_or(|last| last.elapsed() >= LEAST);
        if !is_due || !own.is_wanted.load(Ordering::Relaxed) {
            return Ok(());
        }
        own.last = Some(Instant::now());
        let Picture { width, height, rgb } = (self.draw)(entry)?;
        let header = own.camera.view.exposed(entry.exposure_s).header(entry.record.time_s);
        let (encoding, data) = ("rgb8".to_owned(), Cow::Owned(rgb));
        let image = Image { header, height, width, encoding, is_bigendian: 0, step: 3 * width, data };
        // One that the network does not take is followed by a newer one.
        let _ = own.publisher.publish(image);
        Ok(())
    }
}
