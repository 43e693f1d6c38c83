//! ROS 2 as a sink of a run, and as what tells the run how the vehicle moves.

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::health::Health;
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;

use super::overlay::Watched;
use super::{Draw, MotionTopics, Node, OverlaySink, Ros2Error, Settings, Topics, UvdarTopics};
use crate::config::Camera;
use crate::heard::Heard;
use crate::messages::{Messages, Uvdar, diagnostics, parts};
use crate::ros::Time;
use crate::sink_clock::SinkClock;

/// Publishes what a run finds.
pub struct Ros2Sink {
    /// Topics live as long as the node.
    node: Node,
    topics: Topics,
    uvdar: Option<UvdarTopics>,
    watched: Watched,
    heard: Option<Heard>,
    cameras: Vec<Camera>,
    clock: SinkClock,
}

impl Ros2Sink {
    /// Joins the domain and announces the topics; `cameras` are those of the run, in their order.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or a name is none.
    pub fn new(settings: Settings, cameras: Vec<Camera>) -> std::result::Result<Self, Ros2Error> {
        let mut node = Node::new(settings)?;
        let topics = Topics::new(&mut node)?;
        let watched = Watched::default();
        Ok(Self { node, topics, uvdar: None, watched, heard: None, cameras, clock: SinkClock::new() })
    }

    /// Publishes on the topics of UVDAR's own stack, too.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn beside_uvdar(mut self) -> std::result::Result<Self, Ros2Error> {
        let cameras = self.cameras.iter().map(|camera| camera.view.camera.as_str());
        self.uvdar = Some(UvdarTopics::new(&mut self.node, cameras)?);
        Ok(self)
    }

    /// What publishes pictures by `draw` while somebody subscribes: a sink beside this one, which looks who does.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn overlay(&mut self, draw: Draw) -> std::result::Result<OverlaySink, Ros2Error> {
        let (sink, watched) = OverlaySink::new(&mut self.node, &self.cameras, draw)?;
        self.watched = watched;
        Ok(sink)
    }

    /// Hears of the vehicle's motion on these topics; what they say goes into `motion`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn hearing(mut self, topics: &MotionTopics, motion: Motion) -> std::result::Result<Self, Ros2Error> {
        self.heard = Some(topics.subscribe(&mut self.node, motion)?).filter(Heard::is_wanted);
        Ok(self)
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
        if let Some(camera) = self.cameras.get(entry.camera) {
            let view = camera.view.exposed(entry.exposure_s);
            let told = Messages::of(&entry.record, &view);
            if let Some(uvdar) = &self.uvdar {
                let size_px = [camera.lens.width(), camera.lens.height()];
                let lost = uvdar.tell(entry.camera, Uvdar::of(&entry.record, &told, &view, size_px));
                self.topics.count_lost(lost);
            }
            self.topics.tell(told);
        }
        if let Some(heard) = &mut self.heard {
            heard.frame(entry);
            heard.hear();
        }
        Ok(())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        self.watched.look(&self.node);
        let mut parts = parts(health);
        parts.extend(self.heard.as_ref().map(|heard| heard.health("ROS 2 topics")));
        self.topics.tell_health(diagnostics(&parts, Time::from_nanoseconds(self.clock.now_ns())));
        Ok(())
    }

    fn idle(&mut self) -> Result<()> {
        if let Some(heard) = &mut self.heard {
            heard.hear();
        }
        Ok(())
    }
}
