//! A camera of a recording: frames leave as a run took them in, with all that was known of them.

use std::path::PathBuf;

use photinus_io::Result;
use photinus_link::recording::Frames;
use photinus_run::Entry;
use photinus_run::source::{Next, Opener, Source};

/// What opens the frames of a camera of a recording, one after the other.
///
/// # Errors
/// [`photinus_io::Error`] when it cannot be read, or has several cameras or none of that name.
pub(crate) fn opener(path: PathBuf, camera: Option<&str>) -> Result<Opener> {
    let camera = camera.map(str::to_owned);
    // What is wrong with it is told before anything runs.
    drop(Frames::open(&path, camera.as_deref())?);
    Ok(Box::new(move || Ok(Box::new(Replayed(Frames::open(&path, camera.as_deref())?)) as Box<dyn Source>)))
}

/// The frames of a recording.
struct Replayed(Frames);

impl Source for Replayed {
    fn next(&mut self) -> Next {
        match self.0.next() {
            Some(Ok(frame)) => Next::Frame(Entry::from_frame(frame)),
            Some(Err(error)) => Next::Bad(error),
            None => Next::End,
        }
    }
}
