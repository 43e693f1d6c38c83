//! Which frames are drawn: those that follow each other in even steps.

/// Tells frame by frame whether to draw it.
pub(crate) struct Pace {
    step_s: f64,
    next_s: f64,
}

impl Pace {
    /// A picture whenever this much has gone by, s.
    pub(crate) fn every(step_s: f64) -> Self {
        Self { step_s, next_s: 0.0 }
    }

    /// Whether the next frame, taken at this time, is to be drawn.
    pub(crate) fn is_due(&mut self, time_s: f64) -> bool {
        let is_due = time_s >= self.next_s;
        while self.next_s <= time_s {
            self.next_s += self.step_s;
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_even_whatever_the_rate() {
        const STEP_S: f64 = 0.8;
        for rate_hz in [0.4, 3.0, 70.0] {
            let mut pace = Pace::every(STEP_S);
            let times = (0..400).map(|n| 0.003 + f64::from(n) / rate_hz);
            let drawn: Vec<f64> = times.filter(|&s| pace.is_due(s)).collect();
            let steps = drawn.windows(2).map(|pair| pair[1] - pair[0]);
            let frame_s = 1.0 / rate_hz;
            assert!(steps.clone().all(|s| (s - STEP_S.max(frame_s)).abs() < frame_s), "{rate_hz}: {drawn:?}");
        }
    }
}
