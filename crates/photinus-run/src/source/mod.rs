//! Where frames come from, one after the other. A source is called by one thread that is its own.

use photinus_io::Result;

use crate::Entry;

/// Frames of one camera.
pub trait Source: Send {
    /// The next frame, waited for: with the camera's own time in its record, and when it was taken by this machine's clock; `None` at the end.
    /// A frame that cannot be used is an error in its place.
    fn next(&mut self) -> Option<Result<Entry>>;

    /// What ends a wait for the next frame from another thread, where something must: a child process is killed, a socket closed.
    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        None
    }

    /// Exposes the frames that follow so long, us, and says what it was truly set to; `None` where exposure cannot be set.
    fn expose(&mut self, _exposure_us: f64) -> Option<f64> {
        None
    }
}

/// Opens a source anew: at the beginning, and after it was lost.
pub type Opener = Box<dyn FnMut() -> Result<Box<dyn Source>> + Send>;
