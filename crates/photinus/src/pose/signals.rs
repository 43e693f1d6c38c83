//! Decoded signals -> which markers, and which turns of a symmetric airframe, they speak for.
//!
//! A spot that was seen to blink a signal is one of the markers that carry it, but for a wrong decoding: that costs, and
//! no more than others are right about. Turns that differ in their signals are modes of their own.

use super::symmetry::Symmetry;

/// What it costs that a decoded signal is not the marker's: one in a hundred and fifty is wrong.
const WRONG_SIGNAL_NATS: f64 = 5.0;

impl Symmetry {
    /// What it costs, nats, that spots that blink `signals` are these markers, turned.
    pub(super) fn signal_nats(
        &self,
        turn: usize,
        signals: impl Iterator<Item = Option<u32>>,
        markers: &[Option<u16>],
    ) -> f64 {
        let is_wrong = |(signal, marker): &(Option<u32>, &Option<u16>)| match (signal, marker) {
            (Some(signal), Some(marker)) => !self.carries(self.turned(turn, *marker), *signal),
            _ => false,
        };
        WRONG_SIGNAL_NATS * signals.zip(markers).filter(is_wrong).count() as f64
    }

    /// The same in the turn that fits best.
    pub(crate) fn least_signal_nats(
        &self,
        signals: impl Iterator<Item = Option<u32>> + Clone,
        markers: &[Option<u16>],
    ) -> f64 {
        if signals.clone().all(|signal| signal.is_none()) {
            return 0.0;
        }
        let nats = |turn| self.signal_nats(turn, signals.clone(), markers);
        (0..self.told_apart()).map(nats).fold(f64::INFINITY, f64::min)
    }
}
