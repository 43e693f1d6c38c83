//! What a track has heard of its marker's code.
//!
//! Most tracks that begin are clutter and end within frames: what a new one sees is only kept, and is told to a listener once it is likely
//! a marker.

use alloc::vec::Vec;

use crate::identity::Evidence;
use crate::identity::decoder::{Decoder, Listener, Who};

/// Frames that are kept for a listener at most.
const KEPT: usize = 8;

/// Listeners that no track has at the moment.
#[derive(Debug)]
pub(super) struct Listeners {
    decoder: Option<Decoder>,
    idle: Vec<Listener>,
}

/// What was heard of one marker.
#[derive(Debug, Default)]
pub(super) struct Hearing {
    kept: [Option<Heard>; KEPT],
    listener: Option<Listener>,
    /// Since when it surely blinks what nobody knows, s.
    stranger_since_s: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Heard {
    time_s: f64,
    exposure_s: f64,
    evidence: Evidence,
}

/// A marker surely blinks what nobody knows from this probability on.
const STRANGER: f64 = 0.8;
/// How likely a marker shines of which nothing is known yet: half of the time.
const UNKNOWN: f64 = 0.5;
/// How likely one shines that is steady.
const STEADY: f64 = 0.999;

impl Listeners {
    /// Without a decoder all markers are steady.
    pub(super) fn new(decoder: Option<Decoder>) -> Self {
        Self { decoder, idle: Vec::new() }
    }

    pub(super) fn decoder(&self) -> Option<&Decoder> {
        self.decoder.as_ref()
    }

    /// The mean share of the exposure that a marker shines, beforehand.
    pub(super) fn light_at(&self, hearing: &Hearing, time_s: f64, exposure_s: f64) -> f64 {
        let Some(decoder) = &self.decoder else { return STEADY };
        let Some(listener) = &hearing.listener else { return UNKNOWN };
        decoder.light_at(listener, time_s, exposure_s).map_or(UNKNOWN, |lit| lit.clamp(1e-3, 1.0 - 1e-3))
    }

    /// Hears a frame.
    pub(super) fn hear(&self, hearing: &mut Hearing, time_s: f64, exposure_s: f64, evidence: Evidence) {
        match (&self.decoder, &mut hearing.listener) {
            (Some(decoder), Some(listener)) => {
                // frames come in order: the follower has seen to it
                let _ = decoder.hear(listener, time_s, exposure_s, &evidence);
            }
            (Some(_), None) => {
                hearing.kept.rotate_left(1);
                hearing.kept[KEPT - 1] = Some(Heard { time_s, exposure_s, evidence });
            }
            (None, _) => {}
        }
    }

    /// Listens anew to a marker that for so long blinked what nobody knows, or not at all.
    pub(super) fn doubt(&self, hearing: &mut Hearing, time_s: f64, after_s: f64) {
        let Hearing { listener: Some(listener), stranger_since_s, .. } = hearing else { return };
        let Some(decoder) = &self.decoder else { return };
        let known_to_nobody =
            decoder.probability(listener, Who::Unknown) + decoder.probability(listener, Who::Dark);
        if known_to_nobody < STRANGER {
            *stranger_since_s = None;
            return;
        }
        if time_s - *stranger_since_s.get_or_insert(time_s) > after_s {
            decoder.restart(listener);
            *stranger_since_s = None;
        }
    }

    /// Gives a listener to a track that has none, and tells it what was kept.
    pub(super) fn give(&mut self, hearing: &mut Hearing) {
        let Some(decoder) = self.decoder.as_ref().filter(|_| hearing.listener.is_none()) else { return };
        let mut listener = match self.idle.pop() {
            Some(mut idle) => {
                decoder.restart(&mut idle);
                idle
            }
            None => decoder.listener(),
        };
        for Heard { time_s, exposure_s, evidence } in hearing.kept.iter_mut().filter_map(Option::take) {
            let _ = decoder.hear(&mut listener, time_s, exposure_s, &evidence);
        }
        (hearing.listener, hearing.stranger_since_s) = (Some(listener), None);
    }

    /// Takes the listener of a track that ends.
    pub(super) fn take(&mut self, hearing: &mut Hearing) {
        self.idle.extend(hearing.listener.take());
    }
}

impl Hearing {
    pub(super) fn listener(&self) -> Option<&Listener> {
        self.listener.as_ref()
    }
}
