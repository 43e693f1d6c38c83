//! The one clock of a sink: nanoseconds of the epoch that never go back while it runs, and seconds since it began.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Set once; from then on only the steady clock counts, whatever is done to that of the machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SinkClock {
    began: Instant,
    epoch: Duration,
}

impl SinkClock {
    pub(crate) fn new() -> Self {
        let epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { began: Instant::now(), epoch }
    }

    /// Nanoseconds of the epoch.
    pub(crate) fn now_ns(&self) -> u64 {
        u64::try_from((self.epoch + self.began.elapsed()).as_nanos()).unwrap_or(u64::MAX)
    }

    /// Seconds since the beginning.
    #[cfg(any(feature = "ros2", feature = "zenoh", feature = "mavlink"))]
    pub(crate) fn now_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// The same of an instant; 0 of one before.
    #[cfg(any(feature = "ros2", feature = "zenoh", feature = "mavlink"))]
    pub(crate) fn seconds(&self, at: Instant) -> f64 {
        at.saturating_duration_since(self.began).as_secs_f64()
    }
}
