//! The last frames with what was believed after each: a late frame takes its place among them, and all after it are gone through again.

use alloc::vec::Vec;

use super::Tracker;
use super::error::TrackError;
use super::look::{Look, Moment};
use super::state::State;
use super::step::{Model, Stepper};
use crate::camera::Rig;

/// Frames that are kept of each camera: half a second at up to 120 a second.
const MOST_FRAMES: usize = 64;

/// A frame, and what was believed after it.
#[derive(Debug)]
struct Entry {
    moment: Moment,
    state: State,
}

/// The last frames, in the order of their times.
#[derive(Debug)]
pub(super) struct History {
    entries: Vec<Entry>,
    /// Room of frames that are forgotten.
    spare: Vec<Entry>,
    /// What was believed before the first frame.
    nobody: State,
    /// Whether the first frame since the last reset is still kept.
    is_whole: bool,
    most_frames: usize,
    /// By camera: the time of its last frame, if that had no place among its own.
    misplaced_s: [Option<f64>; Rig::MOST],
}

impl History {
    /// Of the frames of these cameras.
    pub(super) fn of(rig: &Rig) -> Self {
        let most_frames = MOST_FRAMES * rig.cameras().len();
        Self {
            most_frames,
            entries: Vec::with_capacity(most_frames + 1),
            spare: Vec::with_capacity(most_frames + 1),
            nobody: State::empty(0.0, 0),
            is_whole: true,
            misplaced_s: [None; Rig::MOST],
        }
    }

    /// Whether a frame is of another clock than those before: a second one in a row of its camera, each after the other, that has no place among its own.
    pub(super) fn is_of_another_clock(&self, camera: usize, time_s: f64) -> bool {
        let before = self.misplaced_s.get(camera).copied().flatten();
        before.is_some_and(|before_s| time_s > before_s) && self.is_misplaced(camera, time_s)
    }

    /// Whether a frame that is late for its own camera lies where that has no gap: it is nearer to another one of it than half of the time between its frames; or it is
    /// later than can be made up for.
    fn is_misplaced(&self, camera: usize, time_s: f64) -> bool {
        let own = || self.entries.iter().map(|entry| &entry.moment).filter(|own| own.camera == camera);
        let Some(newest_s) = own().next_back().map(|own| own.time_s).filter(|newest_s| time_s < *newest_s)
        else {
            return false;
        };
        let between_s = |(a, b): (&Moment, &Moment)| b.time_s - a.time_s;
        let usual_s = own().zip(own().skip(1)).map(between_s).fold(f64::INFINITY, f64::min);
        let gap_s = own().map(|own| (own.time_s - time_s).abs()).fold(f64::INFINITY, f64::min);
        newest_s - time_s > Tracker::MOST_LATE_S || gap_s < 0.5 * usual_s
    }

    /// Notes where a camera's frame stands among its own.
    pub(super) fn note(&mut self, camera: usize, time_s: f64) {
        self.misplaced_s[camera] = self.is_misplaced(camera, time_s).then_some(time_s);
    }

    /// What is believed after the newest frame.
    pub(super) fn newest(&self) -> Option<&State> {
        self.entries.last().map(|entry| &entry.state)
    }

    /// What was believed after the newest frame that is no later than this.
    pub(super) fn at(&self, time_s: f64) -> Option<&State> {
        self.entries.iter().rev().map(|entry| &entry.state).find(|state| state.time_s <= time_s)
    }

    /// Forgets all frames; no track gets an id again.
    pub(super) fn forget(&mut self) {
        self.nobody.next_id = self.newest().map_or(self.nobody.next_id, |state| state.next_id);
        self.spare.append(&mut self.entries);
        self.is_whole = true;
        self.misplaced_s = [None; Rig::MOST];
    }

    /// Takes a frame in at its place.
    pub(super) fn take_in(
        &mut self,
        stepper: &mut Stepper,
        model: &Model,
        look: &Look<'_>,
    ) -> Result<(), TrackError> {
        // Of frames of one time, the one that came last is the later one.
        let place = self.entries.partition_point(|entry| entry.moment.time_s <= look.time_s);
        self.check(place, look)?;
        let mut entry = self
            .spare
            .pop()
            .unwrap_or_else(|| Entry { moment: Moment::with_room(), state: State::empty(look.time_s, 0) });
        entry.moment.keep(look, model.rig.mounting(look.camera), model.settings.kind);
        if place > 0 && place < self.entries.len() {
            let before_s = self.entries[place - 1].moment.time_s;
            self.entries[place].moment.follow(&mut entry.moment, before_s);
        }
        self.entries.insert(place, entry);
        for index in place..self.entries.len() {
            let (before, from) = self.entries.split_at_mut(index);
            let Entry { moment, state } = &mut from[0];
            // Nobody was there a second before the first frame.
            self.nobody.time_s = moment.time_s - 1.0;
            let before = before.last().map_or(&self.nobody, |entry| &entry.state);
            stepper.step(model, before, moment, state);
        }
        self.forget_oldest();
        Ok(())
    }

    fn check(&self, place: usize, &Look { camera, time_s, .. }: &Look<'_>) -> Result<(), TrackError> {
        let Some(newest) = self.newest() else { return Ok(()) };
        let mut of_one_time = self.entries[..place].iter().rev().map(|entry| &entry.moment);
        let mut of_one_time = of_one_time.by_ref().take_while(|moment| moment.time_s >= time_s);
        if of_one_time.any(|moment| moment.camera == camera) {
            return Err(TrackError::Repeated { time_s });
        }
        let behind_s = newest.time_s - time_s;
        if behind_s > Tracker::MOST_LATE_S || (place == 0 && !self.is_whole) {
            return Err(TrackError::TooLate { time_s, behind_s });
        }
        Ok(())
    }

    /// Forgets what no late frame can come before.
    fn forget_oldest(&mut self) {
        let Some(newest_s) = self.newest().map(|state| state.time_s) else { return };
        while self.entries.len() > self.most_frames
            || self.entries.get(1).is_some_and(|next| next.moment.time_s < newest_s - Tracker::MOST_LATE_S)
        {
            let oldest = self.entries.remove(0);
            self.spare.push(oldest);
            self.is_whole = false;
        }
    }
}
