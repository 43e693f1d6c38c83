//! Where results go. A sink is called by one thread that is its own: what it waits for, nobody else waits for.

mod bystanders;
mod health_lines;
mod json;
mod queue;

use photinus_io::Result;

use crate::Entry;
use crate::health::{Health, Notice};

pub use bystanders::{Address, Bystanders};
pub use health_lines::HealthLines;
pub use json::JsonLines;
pub use queue::{Fan, FullQueue, Outlets};

/// Takes what a run finds. An error ends this sink alone: it is told, and the run goes on without it; what can be mended (a socket whose reader went
/// away) a sink mends itself.
pub trait Sink: Send {
    /// What it is called in messages and in health, such as `json` or `mavlink`.
    fn name(&self) -> String;

    /// Takes a frame whose record is whole. Frames of one camera come in their order.
    ///
    /// # Errors
    /// [`photinus_io::Error`] when nothing more can be written.
    fn frame(&mut self, entry: &Entry) -> Result<()>;

    /// Takes how the run is doing, about once a second.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn health(&mut self, _health: &Health) -> Result<()> {
        Ok(())
    }

    /// Takes what a person should know: a camera that is gone or back, a frame that could not be used.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn notice(&mut self, _notice: &Notice) -> Result<()> {
        Ok(())
    }

    /// Comes about every 20 ms while nothing else does: for heartbeats and to say that answers have grown stale.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn idle(&mut self) -> Result<()> {
        Ok(())
    }

    /// The run ends: what is held back goes out. Nothing is called after it.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn finish(&mut self) -> Result<()> {
        Ok(())
    }
}
