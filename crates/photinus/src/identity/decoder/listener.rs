//! What is known of one marker, and how a frame moves it on.

use alloc::vec;
use alloc::vec::Vec;

use super::super::evidence::Evidence;
use super::Decoder;
use super::phases::{self, Step};
use super::stranger::Stranger;
use super::window::{PLACES, Window};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// The time of a frame is not after that of the frame before: nothing was changed. A clock that was set back wants
/// [`Decoder::restart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the time of a frame is not after that of the frame before")]
pub struct TimeStands;

/// Words this improbable are not looked at while nothing is in doubt.
const ASLEEP_BELOW: f64 = 1e-6;

/// Nothing is in doubt while what blinks and is unknown is less probable than this.
const DOUBT_BELOW: f64 = 1e-3;

/// When it is more probable than this, all words are looked at again.
const DOUBT_ABOVE: f64 = 5e-3;

/// Words in no book that are less probable than this, all together, have learnt nothing worth keeping.
const NEW_BELOW: f64 = 1e-6;

/// A word is learnt when it is it with this probability.
const LEARNT: f64 = 0.99;

/// Of what is unknown this share has a word of the length of the book's, the rest has no pattern.
const PATTERNED: f64 = 0.75;

/// The posterior of one marker. It is moved on by [`Decoder::hear`]; its memory has a fixed size.
#[derive(Clone, Debug, PartialEq)]
pub struct Listener {
    last_s: Option<f64>,
    /// Bits of the nominal clock, from 0 to the length of a word.
    pub(super) base: f64,
    /// Phases of each word, row by row; meaningless while it sleeps.
    pub(super) phases: Vec<f32>,
    /// What each word weighs; 0 while it sleeps.
    pub(super) words: Vec<f64>,
    /// Words that are looked at; the others weigh nothing.
    pub(super) awake: Vec<usize>,
    /// How far phases strayed since they were last let: a probability each way.
    strayed: f64,
    /// What all answers weigh.
    pub(super) total: f64,
    pub(super) stranger: Stranger,
    /// Whether among the words in no book one of the book may be.
    twin_is_in: bool,
    pub(super) others: Others,
}

/// What the answers weigh that are in no book.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Others {
    /// Blinks without a pattern; also where what contradicts everything else goes first.
    pub(super) random: f64,
    pub(super) patterned: f64,
    pub(super) steady: f64,
    pub(super) dark: f64,
}

impl Decoder {
    /// A marker of which nothing was seen yet. Allocates; a listener that is not needed any more can be restarted.
    pub fn listener(&self) -> Listener {
        let words = self.signals.len();
        let mut listener = Listener {
            last_s: None,
            base: 0.0,
            phases: vec![0.0; words * self.block()],
            words: vec![0.0; words],
            awake: (0..words).collect(),
            strayed: 0.0,
            total: 1.0,
            stranger: Stranger::new(self.length),
            twin_is_in: true,
            others: self.others(),
        };
        self.restart(&mut listener);
        listener
    }

    /// Forgets all that was seen.
    pub fn restart(&self, listener: &mut Listener) {
        let each = self.settings.known / self.signals.len() as f64;
        listener.last_s = None;
        listener.base = 0.0;
        listener.words.fill(each);
        listener.awake.clear();
        listener.awake.extend(0..self.signals.len());
        listener.strayed = 0.0;
        let phase = (each / (PLACES * self.length) as f64) as f32;
        for row in listener.phases.chunks_exact_mut(phases::row(self.length)) {
            row.fill(0.0);
            row[..self.length].fill(phase);
        }
        listener.stranger.restart();
        listener.twin_is_in = true;
        listener.others = self.others();
        listener.total = self.settings.known + listener.others.sum();
    }

    /// A frame whose exposure begins at `time_s` and lasts `exposure_s` (taken for a bit where it is longer).
    ///
    /// # Errors
    /// [`TimeStands`] when the frame is not after the one before, or the time is no number.
    pub fn hear(
        &self,
        listener: &mut Listener,
        time_s: f64,
        exposure_s: f64,
        evidence: &Evidence,
    ) -> Result<(), TimeStands> {
        let (passed, base) = self.passed(listener, time_s)?;
        let windows = Window::all(base, exposure_s * self.settings.bit_rate_hz, self.length, evidence);
        listener.twin_is_in |= base < listener.base || passed >= self.length as f64;
        listener.last_s = Some(time_s);
        listener.base = base;
        listener.wake_or_let_sleep();
        let share = self.change(listener, passed);
        let scale = 1.0 / listener.total;
        let steps = self.stray(listener, passed);
        let keep = (scale * (1.0 - self.leave(passed))) as f32;
        let step = Step { keep, share: (scale * share) as f32, windows: &windows };
        let words = self.step_words(listener, steps, &step);
        // what was only just added to it has learnt nothing
        let is_new = listener.others.patterned < NEW_BELOW * listener.total;
        let patterned = match is_new {
            true => listener.stranger.skip(evidence),
            false => listener.stranger.hear(&windows, steps),
        };
        listener.others.weigh(scale, patterned, evidence);
        if !is_new {
            self.leave_out_twin(listener);
        }
        listener.total = words + listener.others.sum();
        Ok(())
    }

    /// Moves the phases of all words that are awake: they stray in this many steps, and are weighed. Returns what they weigh together.
    fn step_words(&self, listener: &mut Listener, (steps, each_way): (usize, f32), step: &Step<'_>) -> f64 {
        let block = self.block();
        let mut sum = 0.0;
        for &word in &listener.awake {
            let phases = &mut listener.phases[word * block..][..block];
            for _ in 0..steps {
                phases::wander(phases, self.length, each_way);
            }
            let weight = f64::from(phases::weigh(phases, &self.signals[word], self.length, step));
            listener.words[word] = weight;
            sum += weight;
        }
        sum
    }

    /// Among all words of its length the stranger may be the very word that is most probable, at its phase: that one is not unknown.
    /// It is left out once it is learnt, and once a round: what is left over would not be left over twice.
    fn leave_out_twin(&self, listener: &mut Listener) {
        let Some(best) = self.heaviest(listener).filter(|_| listener.twin_is_in) else { return };
        let shift = self.likeliest(listener, best) / PLACES;
        let twin = f64::from(listener.stranger.is(&self.signals[best], shift));
        if twin > LEARNT {
            listener.others.patterned *= 1.0 - twin;
            listener.twin_is_in = false;
        }
    }

    /// Bits since the last frame, and where the nominal clock is.
    pub(super) fn passed(&self, listener: &Listener, time_s: f64) -> Result<(f64, f64), TimeStands> {
        let passed_s = listener.last_s.map_or(0.0, |last_s| time_s - last_s);
        let is_later = time_s.is_finite() && (listener.last_s.is_none() || passed_s > 0.0);
        if !is_later {
            return Err(TimeStands);
        }
        let passed = passed_s * self.settings.bit_rate_hz;
        let length = self.length as f64;
        let bits = listener.base + passed;
        let base = bits - length * (bits / length).floor();
        // rounding must not reach the end
        Ok((passed, if base < length { base } else { 0.0 }))
    }

    /// How likely a track took on another light.
    fn leave(&self, passed: f64) -> f64 {
        (self.settings.change * passed).min(0.5)
    }

    /// In how many steps phases stray now, and with what probability each way in each: not in every frame, and after a long time they
    /// are anywhere near.
    fn stray(&self, listener: &mut Listener, passed: f64) -> (usize, f32) {
        const LEAST: f64 = 0.06;
        const MOST: f64 = 0.25;
        const STEPS: f64 = 32.0;
        let all = listener.strayed + (self.settings.stray * PLACES as f64 / 4.0 * passed).min(MOST * STEPS);
        if all < LEAST {
            listener.strayed = all;
            return (0, 0.0);
        }
        listener.strayed = 0.0;
        let steps = (all / MOST).ceil();
        (steps as usize, (all / steps) as f32)
    }

    /// Lets all answers go over to what has no pattern, and that to all others; returns what each phase of each word gets.
    fn change(&self, listener: &mut Listener, passed: f64) -> f64 {
        let leave = self.leave(passed);
        let back = (passed / (2.0 * self.length as f64)).min(0.5);
        let others = &mut listener.others;
        let each = self.settings.known / self.signals.len() as f64;
        let awake = listener.awake.len() as f64;
        let given = back * others.random;
        let rest = self.others();
        let left = leave * (listener.total - others.random);
        // the share of words that sleep, and its own, stay with it
        others.random += left - given * (each * awake + rest.patterned + rest.steady + rest.dark);
        others.patterned = others.patterned * (1.0 - leave) + given * rest.patterned;
        if others.patterned >= NEW_BELOW * listener.total {
            listener.stranger.dilute((given * rest.patterned / others.patterned) as f32);
        }
        others.steady = others.steady * (1.0 - leave) + given * rest.steady;
        others.dark = others.dark * (1.0 - leave) + given * rest.dark;
        given * each / (PLACES * self.length) as f64
    }

    /// What is believed of the others beforehand.
    fn others(&self) -> Others {
        let super::Settings { known, steady, unknown, .. } = self.settings;
        Others {
            random: unknown * (1.0 - PATTERNED),
            patterned: unknown * PATTERNED,
            steady,
            dark: (1.0 - known - steady - unknown).max(1e-3),
        }
    }

    /// Numbers of a word's phases.
    pub(super) fn block(&self) -> usize {
        PLACES * phases::row(self.length)
    }
}

impl Others {
    /// By the evidence of a frame, which has likelihood `patterned` for words that are in no book.
    fn weigh(&mut self, scale: f64, patterned: f32, evidence: &Evidence) {
        let (off, on) = (f64::from(evidence.off()), f64::from(evidence.on()));
        self.random *= scale * 0.5 * (off + on);
        self.patterned *= scale * f64::from(patterned);
        self.steady *= scale * on;
        self.dark *= scale * off;
    }

    fn sum(&self) -> f64 {
        self.random + self.patterned + self.steady + self.dark
    }
}

impl Listener {
    /// When the last frame was.
    pub fn last_s(&self) -> Option<f64> {
        self.last_s
    }

    /// Words that are as good as excluded are left out while nothing is in doubt.
    fn wake_or_let_sleep(&mut self) {
        let Self { words, awake, phases, others, total, .. } = self;
        let doubt = others.random + others.patterned;
        if doubt > DOUBT_ABOVE * *total && awake.len() < words.len() {
            let block = phases.len() / words.len();
            let asleep = |word: &usize| !awake.contains(word);
            for word in (0..words.len()).filter(asleep) {
                phases[word * block..][..block].fill(0.0);
            }
            awake.clear();
            awake.extend(0..words.len());
        } else if doubt < DOUBT_BELOW * *total {
            awake.retain(|&word| {
                let stays = words[word] >= ASLEEP_BELOW * *total;
                if !stays {
                    others.random += words[word];
                    words[word] = 0.0;
                }
                stays
            });
        }
    }
}
