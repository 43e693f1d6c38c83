//! Images of a camera driver, and points of UVDAR's detector, as sources of a run.

use photinus_run::source::{Next, Source};

use super::{Images, Inbox, Node, Quality, Ros2Error, Settings};
use crate::arriving::{Arriving, of_image, of_points};
use crate::ros::ImagePointsWithCovariancesStamped;

/// Images of a topic; their stamps are the times of the frames.
pub struct ImageSource {
    images: Images,
    arriving: Arriving,
    /// Subscriptions live as long as the node.
    _node: Node,
}

impl ImageSource {
    /// Subscribes to `topic`, by its full name.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the name is not valid.
    pub fn new(settings: Settings, topic: &str) -> Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let images = node.images(topic)?;
        Ok(Self { images, arriving: Arriving::new(topic), _node: node })
    }
}

impl Source for ImageSource {
    fn next(&mut self) -> Next {
        let images = &mut self.images;
        self.arriving.next(|| images.take(), of_image)
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        Some(self.arriving.interrupter())
    }
}

/// Points of a topic of UVDAR's detector (uvdar_core/ImagePointsWithCovariancesStamped), in place of images.
pub struct PointSource {
    points: Inbox<ImagePointsWithCovariancesStamped>,
    arriving: Arriving,
    _node: Node,
}

impl PointSource {
    /// Subscribes to `topic`, by its full name.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the name is none.
    pub fn new(settings: Settings, topic: &str) -> Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let points = node.inbox(topic, Quality::Sensor)?;
        Ok(Self { points, arriving: Arriving::new(topic), _node: node })
    }
}

impl Source for PointSource {
    fn next(&mut self) -> Next {
        let points = &mut self.points;
        self.arriving.next(|| points.take(), of_points)
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        Some(self.arriving.interrupter())
    }
}
