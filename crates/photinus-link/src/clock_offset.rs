//! Two clocks: messages that are stamped by one and arrive by the other -> how far they are apart.

/// The offset between two clocks, from messages that are stamped by one and arrive by the other: the way takes no less than nothing, so
/// the least difference of late is nearest to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockOffset {
    /// The least difference of this stretch of time and of the one before, s.
    least_s: [Option<f64>; 2],
    began_s: f64,
}

/// A stretch of time, s: clocks of crystals drift apart by less than 1 ms in it.
const STRETCH_S: f64 = 10.0;
/// A difference that is so much less than before, s, is of a clock that was set: the autopilot began anew.
const SET_S: f64 = 1.0;

impl ClockOffset {
    /// Hears of a message with this stamp that arrives now, and says when it was stamped on the clock of arrivals.
    pub fn hear(&mut self, stamp_s: f64, arrived_s: f64) -> f64 {
        let off_s = arrived_s - stamp_s;
        if self.offset_s().is_some_and(|known_s| (off_s - known_s).abs() > SET_S) {
            *self = Self::default();
        }
        if self.least_s[0].is_none() || arrived_s - self.began_s > STRETCH_S {
            self.least_s = [None, self.least_s[0]];
            self.began_s = arrived_s;
        }
        self.least_s[0] = Some(self.least_s[0].map_or(off_s, |least_s| least_s.min(off_s)));
        stamp_s + self.offset_s().unwrap_or(off_s)
    }

    /// How much later the clock of arrivals is than that of the stamps, s, once something was heard.
    #[must_use]
    pub fn offset_s(&self) -> Option<f64> {
        self.least_s.into_iter().flatten().min_by(f64::total_cmp)
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Exp1};
    use rand_pcg::Pcg64;

    use super::*;

    #[test]
    fn an_offset_is_found_through_ways_of_uneven_length_and_a_drift() {
        let (mut clock, mut random) = (ClockOffset::default(), Pcg64::new(4, 4));
        let (offset_s, drift) = (1234.5, 20e-6);
        for count in 0..6_000 {
            let stamp_s = f64::from(count) * 0.02;
            let way_s: f64 = Exp1.sample(&mut random);
            let true_s = stamp_s * (1.0 + drift) + offset_s;
            let told_s = clock.hear(stamp_s, true_s + 2e-4 + 3e-3 * way_s);
            assert!(count < 50 || (told_s - true_s).abs() < 1e-3, "{count}: {}", told_s - true_s);
        }
        // The autopilot begins anew.
        assert!((clock.hear(0.1, 5_000.0) - 5_000.0).abs() < 1e-9);
    }
}
