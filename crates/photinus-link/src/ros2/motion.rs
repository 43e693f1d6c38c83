//! ROS 2 topics of the vehicle's motion.

use std::sync::{Arc, Mutex, PoisonError};

use photinus_run::motion::Motion;
use serde::de::DeserializeOwned;

use super::{Inbox, Node, Quality, Ros2Error};
use crate::heard::{Heard, Saying, Unreadable};
use crate::messages::{Tree, Turning, of_imu, of_odometry};
use crate::ros::{Imu, Message, Odometry, TFMessage};
use crate::topics;

/// Topics of the vehicle's motion.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotionTopics {
    /// sensor_msgs/Imu, by its full name.
    pub imu: Option<String>,
    /// nav_msgs/Odometry, by its full name.
    pub odometry: Option<String>,
    /// Frames of `/tf` and `/tf_static`: one with z up, and the body, whatever stands between them.
    pub tf: Option<[String; 2]>,
}

impl MotionTopics {
    /// Subscribes to them; what they say goes into `motion`.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or a name is none.
    pub fn subscribe(&self, node: &mut Node, motion: Motion) -> Result<Heard, Ros2Error> {
        let mut said = Vec::new();
        if let Some(topic) = &self.imu {
            said.push(saying(node.inbox(topic, Quality::Sensor)?, |imu: &Imu| Some(of_imu(imu))));
        }
        if let Some(topic) = &self.odometry {
            let of = |odometry: &Odometry| Some(of_odometry(odometry));
            said.push(saying(node.inbox(topic, Quality::Sensor)?, of));
        }
        if let Some([world, body]) = &self.tf {
            let tree = Arc::new(Mutex::new(Tree::new(world, body)));
            let topics = [
                (topics::TRANSFORMS, Quality::TransformsIn, false),
                (topics::STATIC_TRANSFORMS, Quality::StaticTransformsIn, true),
            ];
            for (topic, quality, is_fixed) in topics {
                let tree = tree.clone();
                let of = move |told: &TFMessage| {
                    tree.lock().unwrap_or_else(PoisonError::into_inner).hear(told, is_fixed)
                };
                said.push(saying(node.inbox(topic, quality)?, of));
            }
        }
        Ok(Heard::new(said, motion))
    }
}

fn saying<M: Message + DeserializeOwned + Send + 'static>(
    mut inbox: Inbox<M>,
    of: impl Fn(&M) -> Option<Turning> + Send + 'static,
) -> Saying {
    Box::new(move || inbox.take().map(|taken| taken.map(|message| of(&message)).map_err(|_| Unreadable)))
}
