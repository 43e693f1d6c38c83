//! The thread that reads one camera: opens it, puts its frames into the slot, and opens it anew when it is lost, with growing pauses.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use photinus_io::Error;

use super::Shared;
use super::lane::Lane;
use crate::fault;
use crate::health::Level;
use crate::source::{Next, Opener, Source};

/// The first pause before a lost camera is tried again.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
/// The longest one.
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
/// How often a pause looks whether the run is over.
const LOOK: Duration = Duration::from_millis(20);

/// Reads until the end of the frames or of the run.
pub(super) fn read(lane: &Lane, mut open: Opener, shared: &Shared) {
    let mut pause = FIRST_PAUSE;
    while !shared.is_over() {
        // A driver's library that panics is a camera that is lost, not the end of the run.
        let ended = catch_unwind(AssertUnwindSafe(|| {
            let mut source = open()?;
            Ok(frames(lane, source.as_mut(), shared, &mut pause))
        }));
        let ended = ended.unwrap_or_else(|payload| {
            Err(Error::format(&lane.name, fault::told(payload.as_ref())).advise(fault::ADVICE))
        });
        let why = match ended {
            Ok(Some(error)) | Err(error) => error,
            Ok(None) if shared.is_over() => break,
            Ok(None) => {
                lane.end();
                shared.tell(Level::Note, format!("{}: its frames are at their end", lane.name));
                break;
            }
        };
        if lane.lose() {
            let told = format!("{}: {why}; tried again until it is back", lane.name);
            shared.tell(Level::Warning, told);
        }
        rest(pause, shared);
        pause = (pause * 2).min(LONGEST_PAUSE);
    }
    lane.set_interrupter(None);
    lane.slot.end();
}

/// Takes frames as long as they come; why they do not any more, unless that is their end.
fn frames(lane: &Lane, source: &mut dyn Source, shared: &Shared, pause: &mut Duration) -> Option<Error> {
    lane.set_interrupter(source.interrupter());
    let mut told = source.told();
    while !shared.is_over() {
        if let Some(exposure_us) = lane.slot.take_wish() {
            // Frames say how they were exposed.
            let _ = source.expose(exposure_us);
        }
        match source.next() {
            Next::Frame(mut entry) => {
                if lane.find() {
                    shared.tell(Level::Note, format!("{}: it is back", lane.name));
                }
                if let Some(told) = told.take() {
                    shared.tell(Level::Note, format!("{}: {told}", lane.name));
                }
                *pause = FIRST_PAUSE;
                entry.camera = lane.number;
                entry.record.camera = Some(lane.name.clone());
                lane.slot.put(entry);
            }
            Next::Bad(error) => lane.slot.put_bad(error),
            Next::Lost(error) => return Some(error),
            Next::End => return None,
        }
    }
    None
}

fn rest(pause: Duration, shared: &Shared) {
    let until = Instant::now() + pause;
    while Instant::now() < until && !shared.is_over() {
        std::thread::sleep(LOOK.min(pause));
    }
}
