//! One clock for all that happens on this machine: it never jumps, and tells the time of day as it was when the run began.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// A clock that never jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostClock {
    began: Instant,
    began_unix_s: f64,
}

impl HostClock {
    /// A clock that is set now.
    pub fn start() -> Self {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { began: Instant::now(), began_unix_s: unix.as_secs_f64() }
    }

    /// A moment as seconds since 1970.
    pub fn unix_s(&self, at: Instant) -> f64 {
        match at.checked_duration_since(self.began) {
            Some(since) => self.began_unix_s + since.as_secs_f64(),
            None => self.began_unix_s - self.began.duration_since(at).as_secs_f64(),
        }
    }

    /// Seconds since it was set.
    pub fn up_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }
}
