//! What is done with frames.

use photinus_io::Result;

use crate::{Clock, Entry};

/// What is done with frames.
pub trait Work {
    /// Completes the record of a frame.
    ///
    /// # Errors
    /// Those of the method, told of the frame.
    fn fill(&mut self, entry: &mut Entry, clock: &mut Clock) -> Result<()>;

    /// Whether frames still tell something of their camera.
    fn learns(&self) -> bool;

    /// Learns from a frame what [`Self::fill`] would have learnt; what that refuses teaches nothing.
    fn learn(&mut self, entry: &mut Entry);

    /// What a user should know of the frame.
    fn remarks(&mut self) -> Vec<String> {
        Vec::new()
    }
}
