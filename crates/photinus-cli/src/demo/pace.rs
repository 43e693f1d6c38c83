//! Which frames are drawn: one a second, so that pictures follow each other in even steps.

/// Between pictures, s.
const STEP_S: f64 = 1.0;

/// Tells frame by frame whether to draw it.
#[derive(Default)]
pub(crate) struct Pace {
    next_s: f64,
}

impl Pace {
    /// Whether the next frame, taken at this time, is to be drawn.
    pub(crate) fn is_due(&mut self, time_s: f64) -> bool {
        let is_due = time_s >= self.next_s;
        while self.next_s <= time_s {
            self.next_s += STEP_S;
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_even_whatever_the_rate() {
        for rate_hz in [0.4, 3.0, 70.0] {
            let mut pace = Pace::default();
            let times = (0..400).map(|n| 0.003 + f64::from(n) / rate_hz);
            let drawn: Vec<f64> = times.filter(|&s| pace.is_due(s)).collect();
            let steps = drawn.windows(2).map(|pair| pair[1] - pair[0]);
            let frame_s = 1.0 / rate_hz;
            assert!(steps.clone().all(|s| (s - STEP_S.max(frame_s)).abs() < frame_s), "{rate_hz}: {drawn:?}");
        }
    }
}
