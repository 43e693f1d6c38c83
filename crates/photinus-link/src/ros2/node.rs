//! The one file that knows ros2-client.

use photinus_io::image::GreyImage;
use ros2_client::dds::rustdds::Topic;
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    Context, ContextOptions, MessageTypeName, Name, NodeName, NodeOptions, QosProfile, Subscription,
};

use serde::de::DeserializeOwned;

use super::{Publisher, Quality, Settings};
use crate::ros::{Header, Image, Message};

/// Why ROS is not there.
#[derive(Debug, thiserror::Error)]
pub enum Ros2Error {
    /// A name that ROS does not allow.
    #[error("{0} is no name of a topic: letters, digits and _ between slashes are")]
    Name(String),
    /// The network refuses.
    #[error("{0}")]
    Network(String),
    /// The message was not taken.
    #[error("nobody takes messages: {0}")]
    Full(String),
}

/// This program as a node.
pub struct Node {
    node: ros2_client::Node,
    settings: Settings,
}

impl Node {
    /// Joins the domain as `photinus`.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or the namespace is not valid.
    pub fn new(settings: Settings) -> Result<Self, Ros2Error> {
        let refuse = |error: &dyn std::fmt::Display| Ros2Error::Network(error.to_string());
        let context = Context::with_options(ContextOptions::new().domain_id(settings.domain))
            .map_err(|error| refuse(&error))?;
        let namespace = format!("/{}", settings.namespace.trim_matches('/'));
        let name = NodeName::new(&namespace, "photinus").map_err(|_| Ros2Error::Name(namespace))?;
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let node = context.new_node(name, options).map_err(|error| refuse(&error))?;
        Ok(Self { node, settings })
    }

    /// Announces a topic.
    ///
    /// # Errors
    /// [`Ros2Error`] when its name is not valid, or the network refuses.
    pub fn publisher<M: Message + 'static>(
        &mut self,
        topic: &str,
        quality: Quality,
    ) -> Result<impl Publisher<M> + Send + use<M>, Ros2Error>
    where
        ros2_client::Publisher<M>: Send,
    {
        let topic = self.topic(topic, M::NAME, quality)?;
        self.node.create_publisher::<M>(&topic, None).map_err(|error| Ros2Error::Network(error.to_string()))
    }

    /// Subscribes to the images of a camera driver; `topic` is its full name.
    ///
    /// # Errors
    /// As [`Node::publisher`].
    pub fn images(&mut self, topic: &str) -> Result<Images, Ros2Error> {
        let topic = self.named(topic, Image::NAME, Quality::Sensor)?;
        let images = self.node.create_subscription::<Image<'static>>(&topic, None);
        images.map(Images).map_err(|error| Ros2Error::Network(error.to_string()))
    }

    /// Subscribes to messages of others; `topic` is its full name.
    ///
    /// # Errors
    /// As [`Node::publisher`].
    pub fn inbox<M: Message + DeserializeOwned + 'static>(
        &mut self,
        topic: &str,
        quality: Quality,
    ) -> Result<Inbox<M>, Ros2Error> {
        let topic = self.named(topic, M::NAME, quality)?;
        let inbox = self.node.create_subscription::<M>(&topic, None);
        inbox.map(Inbox).map_err(|error| Ros2Error::Network(error.to_string()))
    }

    /// How many subscribe to a topic of this node, as far as is known by now.
    #[must_use]
    pub fn subscribers(&self, topic: &str) -> usize {
        self.node.subscription_count(&self.settings.name(topic))
    }

    fn topic(&self, topic: &str, kind: &str, quality: Quality) -> Result<Topic, Ros2Error> {
        self.named(&self.settings.name(topic), kind, quality)
    }

    fn named(&self, topic: &str, kind: &str, quality: Quality) -> Result<Topic, Ros2Error> {
        let refuse = || Ros2Error::Name(topic.to_owned());
        let name = Name::parse(topic).map_err(|_| refuse())?;
        let (package, kind) = kind.split_once('/').ok_or_else(refuse)?;
        let kind = MessageTypeName::new(package, kind);
        let made = self.node.create_topic(&name, kind, &profile(quality));
        made.map_err(|error| Ros2Error::Network(error.to_string()))
    }
}

fn profile(quality: Quality) -> QosProfile {
    let reliable = QosProfile::publisher_default().reliability_reliable(WhenFull::Fail);
    let last = |depth| History::KeepLast { depth };
    match quality {
        Quality::Results => reliable.history(last(10)),
        Quality::Transforms => reliable.history(last(100)),
        Quality::Latched => reliable.history(last(1)).durability(Durability::TransientLocal),
        Quality::Picture => reliable.history(last(2)),
        Quality::Sensor => QosProfile::subscription_default().history(last(5)),
        Quality::TransformsIn => QosProfile::subscription_default().history(last(100)),
        // The last one of each of their publishers, all on one topic.
        Quality::StaticTransformsIn => reliable.history(last(100)).durability(Durability::TransientLocal),
    }
}

impl<M: Message> Publisher<M> for ros2_client::Publisher<M> {
    fn publish(&self, message: M) -> Result<(), Ros2Error> {
        ros2_client::Publisher::publish(self, message).map_err(|error| Ros2Error::Full(error.to_string()))
    }
}

/// Messages of a sensor.
pub struct Inbox<M: Message + DeserializeOwned + 'static>(Subscription<M>);

impl<M: Message + DeserializeOwned + 'static> Inbox<M> {
    /// The next message, when there is one by now; one that cannot be read says why.
    pub fn take(&mut self) -> Option<Result<M, Ros2Error>> {
        let taken = self.0.take().map(|taken| taken.map(|(message, _)| message));
        taken.map_err(|error| Ros2Error::Network(error.to_string())).transpose()
    }
}

/// Images of a camera driver.
pub struct Images(Subscription<Image<'static>>);

impl Images {
    /// The next image, when there is one by now; one that cannot be used says why.
    pub fn take(&mut self) -> Option<Result<(Header, GreyImage), Ros2Error>> {
        match self.0.take() {
            Ok(None) => None,
            Ok(Some((message, _))) => {
                let image = message.grey().map_err(Ros2Error::Network);
                Some(image.map(|image| (message.header, image)))
            }
            Err(error) => Some(Err(Ros2Error::Network(error.to_string()))),
        }
    }
}
