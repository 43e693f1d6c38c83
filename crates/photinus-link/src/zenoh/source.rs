//! Images, and points of UVDAR's detector, that others put on a key, as sources of a run.

use std::time::Duration;

use photinus_run::source::{Next, Source};

use super::link::Inbox;
use super::{Link, Settings, ZenohError};
use crate::arriving::{Arriving, of_image, of_points};
use crate::ros::{Image, ImagePointsWithCovariancesStamped};

/// How long a message is waited for before it is looked whether the run goes on.
const LOOK: Duration = Duration::from_millis(20);

/// Messages that may wait: the newest ones.
const MOST_WAITING: usize = 5;

/// A key of images or points; their stamps are the times of the frames.
pub struct KeySource {
    take: Box<dyn FnMut(&mut Arriving) -> Next + Send>,
    arriving: Arriving,
    /// Subscriptions live as long as the session.
    _link: Link,
}

impl KeySource {
    /// Images, sensor_msgs/Image in CDR.
    ///
    /// # Errors
    /// As [`Link::open`] and [`Link::inbox`].
    pub fn images(settings: &Settings, key: &str) -> Result<Self, ZenohError> {
        let link = Link::open(settings)?;
        let mut images: Inbox<Image<'static>> = link.inbox(key, MOST_WAITING)?;
        let mut take = move || {
            Some(match images.wait(LOOK)? {
                Ok(message) => message.grey().map(|image| (message.header, image)),
                Err(error) => Err(error.to_string()),
            })
        };
        let take = move |arriving: &mut Arriving| arriving.next(&mut take, of_image);
        Ok(Self { take: Box::new(take), arriving: Arriving::new(key), _link: link })
    }

    /// Points, uvdar_core/ImagePointsWithCovariancesStamped in CDR.
    ///
    /// # Errors
    /// As [`Self::images`].
    pub fn points(settings: &Settings, key: &str) -> Result<Self, ZenohError> {
        let link = Link::open(settings)?;
        let mut points: Inbox<ImagePointsWithCovariancesStamped> = link.inbox(key, MOST_WAITING)?;
        let take = move |arriving: &mut Arriving| arriving.next(|| points.wait(LOOK), of_points);
        Ok(Self { take: Box::new(take), arriving: Arriving::new(key), _link: link })
    }
}

impl Source for KeySource {
    fn next(&mut self) -> Next {
        (self.take)(&mut self.arriving)
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        Some(self.arriving.interrupter())
    }
}
