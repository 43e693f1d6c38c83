//! Between the thread that reads a camera and the one that locates: room for one frame. A newer one takes its place, and the older is counted.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use photinus_io::{Error, Result};

use crate::Entry;

/// How long a reader of the slot sleeps before it looks whether the run is over.
const LOOK: Duration = Duration::from_millis(50);

/// Room for one frame.
#[derive(Default)]
pub(super) struct Slot {
    state: Mutex<State>,
    came: Condvar,
}

#[derive(Default)]
struct State {
    frame: Option<Entry>,
    /// Frames that could not be read, until they are told.
    bad: Vec<Error>,
    dropped: u64,
    ended: bool,
    /// What the frames that follow are to be exposed with, us.
    wish_us: Option<f64>,
}

impl Slot {
    /// Puts a frame in; the one that is there gives way.
    pub(super) fn put(&self, mut entry: Entry) {
        let mut state = self.state();
        // What the camera itself dropped.
        state.dropped += entry.dropped;
        if let Some(older) = state.frame.take() {
            state.dropped += 1;
            entry.dropped += older.dropped + 1;
        }
        state.frame = Some(entry);
        self.came.notify_one();
    }

    /// Puts in what cannot be used: as many as there is room for.
    pub(super) fn put_bad(&self, error: Error) {
        let mut state = self.state();
        if state.bad.len() < 64 {
            state.bad.push(error);
        }
        self.came.notify_one();
    }

    /// Nothing comes any more.
    pub(super) fn end(&self) {
        self.state().ended = true;
        self.came.notify_all();
    }

    /// Frames that gave way to newer ones, here or in the camera.
    pub(super) fn dropped(&self) -> u64 {
        self.state().dropped
    }

    /// How long the frames that follow are to be exposed, us.
    pub(super) fn wish(&self, exposure_us: f64) {
        self.state().wish_us = Some(exposure_us);
    }

    /// What was wished for since it was asked for last.
    pub(super) fn take_wish(&self) -> Option<f64> {
        self.state().wish_us.take()
    }

    /// The next frame, waited for until `is_over`; `None` at the end.
    pub(super) fn take(&self, is_over: &dyn Fn() -> bool) -> Option<Result<Entry>> {
        let mut state = self.state();
        loop {
            if let Some(error) = state.bad.pop() {
                return Some(Err(error));
            }
            if let Some(entry) = state.frame.take() {
                return Some(Ok(entry));
            }
            if state.ended || is_over() {
                return None;
            }
            state = self.came.wait_timeout(state, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
