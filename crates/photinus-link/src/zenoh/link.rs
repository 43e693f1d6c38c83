//! The one file that opens a session of Zenoh.

use std::borrow::Cow;
use std::marker::PhantomData;
use std::time::Duration;

use ::zenoh::Wait;
use ::zenoh::bytes::Encoding;
use ::zenoh::handlers::{RingChannel, RingChannelHandler};
use ::zenoh::key_expr::KeyExpr;
use ::zenoh::pubsub::Subscriber;
use ::zenoh::qos::CongestionControl;
use ::zenoh::sample::Sample;
use serde::de::DeserializeOwned;

use crate::cdr::{self, CdrError};
use crate::ros::Message;

/// The largest message that is taken, bytes: a raw image of 64 MB.
const MOST_BYTES: usize = 1 << 26;

/// Who takes part in Zenoh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Settings {
    /// What this vehicle is called in keys.
    pub vehicle: String,
    /// Addresses such as `tcp/0.0.0.0:7447` at which others may come; any free port where nothing is said.
    pub listen: Option<Vec<String>>,
    /// Addresses of others, tried until they are there.
    pub connect: Vec<String>,
    /// Whether others are looked for by multicast.
    pub scouting: bool,
}

/// Why Zenoh is not there.
#[derive(Debug, thiserror::Error)]
pub enum ZenohError {
    /// A name that cannot stand in a key.
    #[error("{0:?} cannot stand in a key: letters, digits, - and _ can, between single slashes")]
    Name(String),
    /// An address is none or taken, or the network refuses.
    #[error("{0}")]
    Network(#[from] ::zenoh::Error),
    /// The message cannot be written.
    #[error("{0}")]
    Message(#[from] CdrError),
}

/// This program as a peer.
pub struct Link {
    session: ::zenoh::Session,
    vehicle: String,
}

impl Link {
    /// Joins the network as a peer.
    ///
    /// # Errors
    /// [`ZenohError`] when an address is none or taken, or the vehicle's name cannot stand in a key.
    pub fn open(settings: &Settings) -> Result<Self, ZenohError> {
        let vehicle = settings.vehicle.clone();
        let is_plain = |name: &str| {
            !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte))
        };
        if !vehicle.split('/').all(is_plain) {
            return Err(ZenohError::Name(vehicle));
        }
        let mut config = ::zenoh::Config::default();
        let json = |addresses: &[String]| serde_json::Value::from(addresses).to_string();
        config.insert_json5("mode", "\"peer\"")?;
        if let Some(listen) = &settings.listen {
            config.insert_json5("listen/endpoints", &json(listen))?;
        }
        config.insert_json5("connect/endpoints", &json(&settings.connect))?;
        config.insert_json5("scouting/multicast/enabled", &settings.scouting.to_string())?;
        config.insert_json5("transport/link/rx/max_message_size", &MOST_BYTES.to_string())?;
        let session = ::zenoh::open(config).wait()?;
        Ok(Self { session, vehicle })
    }

    /// The key of a topic of this vehicle: `photinus/VEHICLE/tracks` of `/photinus/tracks`.
    #[must_use]
    pub fn key(&self, topic: &str) -> String {
        let own = topic.strip_prefix("/photinus").unwrap_or(topic);
        format!("photinus/{}{own}", self.vehicle)
    }

    /// Puts a message on the key of its topic.
    ///
    /// # Errors
    /// [`ZenohError`] when the session has ended, or the message cannot be written.
    pub fn tell<M: Message>(&self, topic: &str, message: &M) -> Result<(), ZenohError> {
        self.session
            .put(self.key(topic), cdr::encode(message)?)
            .encoding(Encoding::APPLICATION_CDR.with_schema(M::NAME))
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait()?;
        Ok(())
    }

    /// Listens to a key or an expression of several; the last `most` messages wait, older ones give way.
    ///
    /// # Errors
    /// [`ZenohError`] when it is no key.
    pub fn inbox<M: Message + DeserializeOwned>(
        &self,
        key: &str,
        most: usize,
    ) -> Result<Inbox<M>, ZenohError> {
        let key = KeyExpr::try_from(key.to_owned()).map_err(|_| ZenohError::Name(key.to_owned()))?;
        let samples = self.session.declare_subscriber(key).with(RingChannel::new(most)).wait()?;
        Ok(Inbox { samples, kind: PhantomData })
    }
}

/// Messages of one kind that others put.
pub struct Inbox<M> {
    samples: Subscriber<RingChannelHandler<Sample>>,
    kind: PhantomData<fn() -> M>,
}

impl<M: Message + DeserializeOwned> Inbox<M> {
    /// The next message, when there is one by now; one that cannot be read says why.
    pub fn take(&mut self) -> Option<Result<M, CdrError>> {
        Self::read(self.samples.try_recv())
    }

    /// The same, waited for.
    pub fn wait(&mut self, most: Duration) -> Option<Result<M, CdrError>> {
        Self::read(self.samples.recv_timeout(most))
    }

    fn read(sample: ::zenoh::Result<Option<Sample>>) -> Option<Result<M, CdrError>> {
        let sample = sample.ok()??;
        let bytes: Cow<'_, [u8]> = sample.payload().to_bytes();
        Some(cdr::decode(&bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(vehicle: &str) -> Settings {
        Settings { vehicle: vehicle.to_owned(), listen: Some(Vec::new()), ..Settings::default() }
    }

    #[test]
    fn keys_have_the_vehicle_and_names_that_would_be_expressions_are_refused() {
        for name in ["", "uav*", "a//b", "uav 1", "/uav1", "$*", "a?b", "a#b"] {
            assert!(matches!(Link::open(&settings(name)), Err(ZenohError::Name(_))), "{name}");
        }
        let link = Link::open(&settings("red/uav1")).unwrap();
        assert_eq!(link.key(crate::topics::TRACKS), "photinus/red/uav1/tracks");
        assert_eq!(link.key(crate::topics::TRANSFORMS), "photinus/red/uav1/tf");
    }

    #[test]
    fn an_address_that_is_taken_or_none_is_refused() {
        let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let taken = format!("tcp/{}", taken.local_addr().unwrap());
        for address in [taken.as_str(), "nothing", "quic/127.0.0.1:0"] {
            let listen = Some(vec![address.to_owned()]);
            assert!(Link::open(&Settings { listen, ..settings("uav1") }).is_err(), "{address}");
        }
    }
}
