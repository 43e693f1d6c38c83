//! The thread that reads one camera: opens it, puts its frames into the slot, and opens it anew when it is lost, with growing pauses.

use std::time::{Duration, Instant};

use photinus_io::Error;

use super::Shared;
use super::lane::Lane;
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
        let why = match open() {
            Ok(mut source) => match frames(lane, source.as_mut(), shared, &mut pause) {
                Some(error) => error,
                None if shared.is_over() => break,
                None => {
                    lane.end();
                    shared.tell(Level::Note, format!("{}: its frames are at their end", lane.name));
                    break;
                }
            },
            Err(error) => error,
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
