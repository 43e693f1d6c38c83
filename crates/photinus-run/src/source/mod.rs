//! Where frames come from, one after the other. A source is called by one thread that is its own.
//!
//! ```text
//! recorded      a dataset folder, at its own pace or as fast as it is asked
//! takeoff       when recordings and scenes begin to fly
//! stream        Y4M or raw frames: standard input, a socket, the output of a command
//! v4l2          a camera of this machine, feature `v4l2`
//! pixel_format  how its pixels are laid out
//! ```

mod pixel_format;
mod recorded;
mod stream;
mod takeoff;
#[cfg(all(feature = "v4l2", target_os = "linux"))]
mod v4l2;

use photinus_io::{Error, Result};

use crate::Entry;

pub use pixel_format::PixelFormat;
pub use recorded::Recorded;
pub use stream::{Carrier, Stream, StreamFormat, Times};
pub use takeoff::Takeoff;
#[cfg(all(feature = "v4l2", target_os = "linux"))]
pub use v4l2::{V4l2, Wanted as V4l2Wanted};

/// What comes next.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "a frame is what nearly always comes")]
pub enum Next {
    /// A frame: with the camera's own time in its record, and when it was taken by the clock of this machine.
    Frame(Entry),
    /// A frame that cannot be used; the one after it may be.
    Bad(Error),
    /// The source is gone; it may come back when it is opened anew.
    Lost(Error),
    /// There are no more frames.
    End,
}

/// Frames of one camera.
pub trait Source: Send {
    /// What comes next, waited for.
    fn next(&mut self) -> Next;

    /// What ends a wait for the next frame from another thread, where something must: a child process is killed, a socket closed.
    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        None
    }

    /// How it was truly set, in words, where it can be set at all.
    fn told(&self) -> Option<String> {
        None
    }

    /// Exposes the frames that follow so long, us, and says what it was truly set to; `None` where exposure cannot be set.
    fn expose(&mut self, _exposure_us: f64) -> Option<f64> {
        None
    }
}

/// Opens a source: at the beginning, and anew after it was lost.
pub type Opener = Box<dyn FnMut() -> Result<Box<dyn Source>> + Send>;
