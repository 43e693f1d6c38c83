//! What is known of one camera while it runs: written by the thread that reads it and the one that locates, read once a second for its health.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::slot::Slot;
use crate::health::{CameraHealth, CameraState, Recent};
use crate::{Entry, Oddity, Quantiles};

/// One camera while it runs.
pub(super) struct Lane {
    pub(super) name: String,
    pub(super) number: usize,
    pub(super) slot: Slot,
    counts: Mutex<Counts>,
}

struct Counts {
    state: CameraState,
    lost: u64,
    frames: u64,
    failed: u64,
    last: Option<Instant>,
    latency_ms: Recent,
    all_latencies_ms: Quantiles,
    neighbours: usize,
    exposure_us: Option<f64>,
    /// Frames when the rate was told last, and when that was.
    told: (u64, Instant),
    interrupter: Option<Box<dyn Fn() + Send>>,
    /// Oddities of frames that were told.
    odd: Vec<&'static str>,
}

impl Lane {
    pub(super) fn new(name: String, number: usize) -> Self {
        let counts = Counts {
            state: CameraState::Opening,
            lost: 0,
            frames: 0,
            failed: 0,
            last: None,
            latency_ms: Recent::default(),
            all_latencies_ms: Quantiles::default(),
            neighbours: 0,
            exposure_us: None,
            told: (0, Instant::now()),
            interrupter: None,
            odd: Vec::new(),
        };
        Self { name, number, slot: Slot::default(), counts: Mutex::new(counts) }
    }

    /// A frame was located.
    pub(super) fn count(&self, entry: &Entry) {
        let mut counts = self.counts();
        counts.frames += 1;
        counts.last = Some(Instant::now());
        counts.neighbours = entry.record.neighbours.len();
        counts.exposure_us = entry.exposure_s.map(|exposure_s| 1e6 * exposure_s);
        if let Some(latency_s) = entry.record.latency_s {
            counts.latency_ms.add(1e3 * latency_s);
            counts.all_latencies_ms.add(1e3 * latency_s);
        }
    }

    /// A frame could not be read or located; how many that are now.
    pub(super) fn count_failed(&self) -> u64 {
        let mut counts = self.counts();
        counts.failed += 1;
        counts.failed
    }

    /// Whether a frame is the first of its kind.
    pub(super) fn is_first(&self, oddity: Oddity) -> bool {
        let mut counts = self.counts();
        let is_new = !counts.odd.contains(&oddity.kind());
        if is_new {
            counts.odd.push(oddity.kind());
        }
        is_new
    }

    /// Its frames are at their end.
    pub(super) fn end(&self) {
        self.counts().state = CameraState::Ended;
    }

    /// It is gone; whether that is news.
    pub(super) fn lose(&self) -> bool {
        let mut counts = self.counts();
        let is_news = counts.state != CameraState::Lost;
        counts.lost += u64::from(is_news);
        counts.state = CameraState::Lost;
        is_news
    }

    /// A frame came; whether it had been lost before.
    pub(super) fn find(&self) -> bool {
        let mut counts = self.counts();
        let was_lost = counts.state == CameraState::Lost;
        counts.state = CameraState::Running;
        was_lost
    }

    /// How a wait for its next frame is ended from elsewhere.
    pub(super) fn set_interrupter(&self, interrupter: Option<Box<dyn Fn() + Send>>) {
        self.counts().interrupter = interrupter;
    }

    /// Ends a wait for its next frame.
    pub(super) fn interrupt(&self) {
        if let Some(interrupt) = &self.counts().interrupter {
            interrupt();
        }
    }

    /// How it is doing, the rate since this was asked for last.
    pub(super) fn health(&self) -> CameraHealth {
        let mut counts = self.counts();
        let now = Instant::now();
        let frames = counts.frames;
        let (before, then) = std::mem::replace(&mut counts.told, (frames, now));
        let elapsed_s = (now - then).as_secs_f64().max(1e-3);
        CameraHealth {
            name: self.name.clone(),
            state: counts.state,
            frames: counts.frames,
            failed: counts.failed,
            dropped: self.slot.dropped(),
            lost: counts.lost,
            rate_hz: (counts.frames - before) as f64 / elapsed_s,
            silent_s: counts.last.map(|last| (now - last).as_secs_f64()),
            latency_ms: counts.latency_ms.spread(),
            neighbours: counts.neighbours,
            exposure_us: counts.exposure_us,
        }
    }

    /// Every latency of the run, ms.
    pub(super) fn latencies_ms(&self) -> Quantiles {
        self.counts().all_latencies_ms.clone()
    }

    fn counts(&self) -> MutexGuard<'_, Counts> {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
