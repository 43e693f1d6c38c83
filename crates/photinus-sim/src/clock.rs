//! Clocks that are not the world's: a vehicle's that times its LEDs, a camera's that times its frames.

/// A clock that was set wrong and runs at a rate of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// What it reads at time 0 of the world, s.
    pub offset_s: f64,
    /// By how many millionths it is fast.
    pub ppm: f64,
}

impl Clock {
    /// What it reads at a time of the world, s.
    pub fn reading_s(&self, time_s: f64) -> f64 {
        time_s * self.rate() + self.offset_s
    }

    /// The time of the world at which it reads `reading_s`, s.
    pub fn time_s(&self, reading_s: f64) -> f64 {
        (reading_s - self.offset_s) / self.rate()
    }

    fn rate(&self) -> f64 {
        1.0 + self.ppm * 1e-6
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_clock_reads_more_and_a_right_one_reads_the_time_itself() {
        let clock = Clock { offset_s: 0.25, ppm: 40.0 };
        // 40 millionths of a day are 3.456 s
        assert!((clock.reading_s(86_400.0) - 86_403.706).abs() < 1e-9);
        assert!((clock.time_s(clock.reading_s(1234.5)) - 1234.5).abs() < 1e-9);
        let right = Clock::default();
        assert_eq!(
            (right.reading_s(0.1).to_bits(), right.time_s(0.7).to_bits()),
            (0.1_f64.to_bits(), 0.7_f64.to_bits())
        );
    }
}
