//! ROS 2 topics of the vehicle's motion.

use photinus_run::motion::Motion;
use serde::de::DeserializeOwned;

use super::{Node, Ros2Error};
use crate::heard::{Heard, Saying, Unreadable};
use crate::messages::{Turning, of_imu, of_odometry, of_transforms};
use crate::ros::{Imu, Message, Odometry, TFMessage};
use crate::topics;

/// Topics of the vehicle's motion.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotionTopics {
    /// sensor_msgs/Imu, by its full name.
    pub imu: Option<String>,
    /// nav_msgs/Odometry, by its full name.
    pub odometry: Option<String>,
    /// Frames of `/tf`: one with z up, and the body whose parent it is.
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
            said.push(saying(node, topic, |imu: &Imu| Some(of_imu(imu)))?);
        }
        if let Some(topic) = &self.odometry {
            said.push(saying(node, topic, |odometry: &Odometry| Some(of_odometry(odometry)))?);
        }
        if let Some([world, body]) = self.tf.clone() {
            let of = move |told: &TFMessage| of_transforms(told, &world, &body);
            said.push(saying(node, topics::TRANSFORMS, of)?);
        }
        Ok(Heard::new(said, motion))
    }
}

fn saying<M: Message + DeserializeOwned + Send + 'static>(
    node: &mut Node,
    topic: &str,
    of: impl Fn(&M) -> Option<Turning> + Send + 'static,
) -> Result<Saying, Ros2Error> {
    let mut inbox = node.inbox::<M>(topic)?;
    Ok(Box::new(move || inbox.take().map(|taken| taken.map(|message| of(&message)).map_err(|_| Unreadable))))
}
