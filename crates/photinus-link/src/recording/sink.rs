//! A recording as a sink of a run: it holds the order in which things were processed.

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::health::{Health, Notice};
use photinus_run::sink::Sink;

use super::{Located, Recorder};
use crate::messages::{Viewpoint, diagnostics, parts};
use crate::ros::{Text, Time};
use crate::sink_clock::SinkClock;
use crate::topics;

/// Records what a run finds.
pub struct RecordSink {
    recorder: Option<Recorder>,
    /// Of each camera, in the order of the run.
    views: Vec<Viewpoint>,
    clock: SinkClock,
}

impl RecordSink {
    /// Records into `recorder`; `views` are those of the run's cameras, in their order.
    #[must_use]
    pub fn new(recorder: Recorder, views: Vec<Viewpoint>) -> Self {
        Self { recorder: Some(recorder), views, clock: SinkClock::new() }
    }
}

impl Sink for RecordSink {
    fn name(&self) -> String {
        "record".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        let (Some(recorder), Some(view)) = (&mut self.recorder, self.views.get(entry.camera)) else {
            return Ok(());
        };
        let image = entry.image.as_ref().map(|image| image.view());
        let (gravity, moved) = (entry.gravity, entry.moved);
        let located = Located { record: &entry.record, image, gravity, moved };
        recorder.located(&located, &view.exposed(entry.exposure_s), self.clock.now_ns())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        let now_ns = self.clock.now_ns();
        let told = diagnostics(&parts(health), Time::from_nanoseconds(now_ns));
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        recorder.message(topics::DIAGNOSTICS, &told, now_ns, now_ns)?;
        // Where no frames come, nothing else writes what is there by now.
        recorder.flush()
    }

    fn notice(&mut self, notice: &Notice) -> Result<()> {
        let now_ns = self.clock.now_ns();
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        recorder.message(topics::NOTICES, &Text { data: notice.text.clone() }, now_ns, now_ns)
    }

    fn finish(&mut self) -> Result<()> {
        self.recorder.take().map_or(Ok(()), Recorder::finish)
    }
}
