//! ROS 2 as a sink of a run.

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::health::Health;
use photinus_run::sink::Sink;

use super::{Node, Ros2Error, Settings, Topics};
use crate::messages::{Messages, Viewpoint, diagnostics, parts};
use crate::ros::Time;
use crate::sink_clock::SinkClock;

/// Publishes what a run finds.
pub struct Ros2Sink {
    /// Topics live as long as the node.
    _node: Node,
    topics: Topics,
    views: Vec<Viewpoint>,
    clock: SinkClock,
}

impl Ros2Sink {
    /// Joins the domain and announces the topics; `views` are those of the run's cameras, in their order.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or a name is none.
    pub fn new(settings: Settings, views: Vec<Viewpoint>) -> std::result::Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let topics = Topics::new(&mut node)?;
        Ok(Self { _node: node, topics, views, clock: SinkClock::new() })
    }

    /// The topics: to tell mountings, and how much was lost.
    pub fn topics(&mut self) -> &mut Topics {
        &mut self.topics
    }
}

impl Sink for Ros2Sink {
    fn name(&self) -> String {
        "ros2".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        if let Some(view) = self.views.get(entry.camera) {
            self.topics.tell(Messages::of(&entry.record, &view.exposed(entry.exposure_s)));
        }
        Ok(())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        self.topics.tell_health(diagnostics(&parts(health), Time::from_nanoseconds(self.clock.now_ns())));
        Ok(())
    }
}
