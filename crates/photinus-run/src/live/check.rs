//! Whether a camera would run: it is opened, gives a frame, and that is of the size of its calibration.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use photinus_io::{Error, Result};

use super::Camera;
use crate::source::Next;
use crate::{Clock, Work};

/// So long may a camera take to give its first frame.
const PATIENCE: Duration = Duration::from_secs(10);

impl Camera {
    /// Takes one frame and locates in it; what came, in words.
    ///
    /// # Errors
    /// What is in the way of a run.
    pub fn check(self) -> Result<String> {
        let Self { name, mut source, mut view, .. } = self;
        let (sender, first) = channel();
        let _ = std::thread::Builder::new().name("check".to_owned()).spawn(move || {
            let first = source().map(|mut source| (source.told(), source.next()));
            // Who asked may have given up.
            let _ = sender.send(first);
        });
        let refuse = |reason: &str, advice: &str| Err(Error::format(&name, reason).advise(advice));
        let (told, mut entry) = match first.recv_timeout(PATIENCE) {
            Ok(Ok((told, Next::Frame(entry)))) => (told, entry),
            Ok(Ok((_, Next::Bad(error) | Next::Lost(error))) | Err(error)) => return Err(error),
            Ok(Ok((_, Next::End))) => return refuse("it holds no frame", "check where its frames come from"),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                return refuse("no frame came within 10 s", "check the cable, and what sends the frames");
            }
        };
        crate::guarded(&mut entry, &mut Clock::new(), &mut view)?;
        let size = entry.image.as_ref().map(|image| image.view());
        let size = size.map_or("spots".to_owned(), |view| format!("{} x {} px", view.width(), view.height()));
        let (spots, neighbours) = (entry.record.spots.len(), entry.record.neighbours.len());
        let _ = view.remarks();
        let told = told.map_or(String::new(), |told| format!(", {told}"));
        Ok(format!("{size}, {spots} spots, {neighbours} neighbours{told}"))
    }
}
