//! Messages with images or spots that arrive -> frames of a run, waited for until it ends.

use std::fmt::Display;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::Error;
use photinus_io::frames::{Frame, Moved};
use photinus_io::image::GreyImage;
use photinus_run::Entry;
use photinus_run::source::Next;

use crate::messages::spots_of;
use crate::ros::{Header, ImagePointsWithCovariancesStamped};

/// How long is looked away between two looks for a message, a share of what a frame takes.
const LOOK: Duration = Duration::from_micros(500);

/// A topic that is waited for.
pub(crate) struct Arriving {
    name: String,
    next: u64,
    is_ended: Arc<AtomicBool>,
}

impl Arriving {
    pub(crate) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), next: 0, is_ended: Arc::default() }
    }

    /// What comes next, waited for: `take` says what is there by now, `entry` makes a frame of it, given its number and source.
    pub(crate) fn next<M, E: Display>(
        &mut self,
        mut take: impl FnMut() -> Option<Result<M, E>>,
        entry: impl FnOnce(M, u64, &str) -> Entry,
    ) -> Next {
        while !self.is_ended.load(Ordering::Relaxed) {
            let Some(taken) = take() else {
                std::thread::sleep(LOOK);
                continue;
            };
            let index = self.next;
            self.next += 1;
            return match taken {
                Ok(message) => {
                    Next::Frame(Entry { taken: Some(Instant::now()), ..entry(message, index, &self.name) })
                }
                Err(error) => Next::Bad(Error::format(&self.name, error.to_string())),
            };
        }
        Next::End
    }

    pub(crate) fn interrupter(&self) -> Box<dyn Fn() + Send> {
        let is_ended = Arc::clone(&self.is_ended);
        Box::new(move || is_ended.store(true, Ordering::Relaxed))
    }
}

/// An image as a frame; its stamp is the frame's time.
pub(crate) fn of_image((header, image): (Header, GreyImage), index: u64, source: &str) -> Entry {
    Entry::from_frame(Frame {
        image,
        index,
        time_s: Some(header.stamp.seconds()),
        source: source.to_owned(),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    })
}

/// Points of UVDAR's detector as a frame whose spots are found.
pub(crate) fn of_points(points: ImagePointsWithCovariancesStamped, index: u64, source: &str) -> Entry {
    Entry::of_spots(index, points.stamp.seconds(), source, spots_of(&points))
}
