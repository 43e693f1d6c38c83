//! A camera of a dataset folder, as if it were flying now, or as fast as it is asked.

use std::time::{Duration, Instant};

use photinus_io::Result;
use photinus_io::dataset::Dataset;
use photinus_io::frames::FrameSource;

use super::{Next, Source};
use crate::Entry;

/// A camera of a dataset.
pub struct Recorded {
    frames: FrameSource,
    exposure_s: f64,
    /// When its clock showed 0 by ours, where it flies at its own pace.
    began: Option<Instant>,
    /// From frame to frame, s.
    gap_s: f64,
    /// When the last frame was due.
    due: Option<Instant>,
    /// What is begun anew at its end, where that is wanted.
    again: Option<Again>,
}

/// A recording that never ends.
struct Again {
    dataset: Dataset,
    camera: usize,
    /// From its first frame until it begins anew, s, and how many frames that are.
    span_s: f64,
    frames: u64,
    rounds: u64,
}

impl Recorded {
    /// Camera number `camera` of a dataset. With `began`, the frame of time t is taken that many seconds after it, or as soon after as it is read: all
    /// cameras of a vehicle are given the same.
    pub fn new(dataset: &Dataset, camera: usize, began: Option<Instant>) -> Self {
        let exposure_s = dataset.cameras().get(camera).map_or(0.0, |camera| 1e-6 * camera.exposure_us);
        let rows = dataset.cameras().get(camera).map_or(&[][..], |camera| &camera.frames);
        let gap_s = rows
            .first()
            .zip(rows.last())
            .map_or(0.0, |(first, last)| (last.time_s - first.time_s) / (rows.len() - 1).max(1) as f64);
        let frames = FrameSource::dataset_camera(dataset.clone(), camera);
        Self { frames, exposure_s, began, gap_s, due: None, again: None }
    }

    /// Begins anew at its end, with times and numbers that go on. The seam is the mean of the gaps between frames.
    #[must_use]
    pub fn repeated(self, dataset: &Dataset, camera: usize) -> Self {
        let rows = dataset.cameras().get(camera).map_or(&[][..], |camera| &camera.frames);
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return self };
        let span_s = last.time_s - first.time_s + self.gap_s;
        let again = Again {
            dataset: dataset.clone(),
            camera,
            span_s,
            frames: last.frame - first.frame + 1,
            rounds: 0,
        };
        Self { again: Some(again), ..self }
    }

    /// Waits until half of the gap to the next frame is over: a camera does not decode files, and who is at the frame before is not to be kept from it.
    fn wait_to_read(&self) {
        let half = Duration::try_from_secs_f64(0.5 * self.gap_s).unwrap_or_default();
        let from = self.due.map(|due| due + half);
        std::thread::sleep(from.unwrap_or_else(Instant::now).saturating_duration_since(Instant::now()));
    }

    fn read(&mut self) -> Option<Result<Entry>> {
        let read = self.frames.next();
        let (None, Some(again)) = (&read, &mut self.again) else {
            return read.map(|frame| frame.map(|frame| self.counted(Entry::from_frame(frame))));
        };
        again.rounds += 1;
        self.frames = FrameSource::dataset_camera(again.dataset.clone(), again.camera);
        let first = self.frames.next()?;
        Some(first.map(|frame| self.counted(Entry::from_frame(frame))))
    }

    fn counted(&self, mut entry: Entry) -> Entry {
        if let Some(again) = &self.again {
            entry.record.frame = entry.record.frame.map(|frame| frame + again.rounds * again.frames);
            entry.record.time_s =
                entry.record.time_s.map(|time_s| time_s + again.rounds as f64 * again.span_s);
        }
        entry
    }
}

impl Source for Recorded {
    fn next(&mut self) -> Next {
        self.wait_to_read();
        let mut entry = match self.read() {
            None => return Next::End,
            Some(Err(error)) => return Next::Bad(error),
            Some(Ok(entry)) => entry,
        };
        entry.exposure_s = Some(self.exposure_s);
        if let (Some(began), Some(time_s)) = (self.began, entry.record.time_s) {
            let since = Duration::try_from_secs_f64(time_s + self.exposure_s).unwrap_or_default();
            let due = began + since;
            let now = Instant::now();
            std::thread::sleep(due.saturating_duration_since(now));
            entry.taken = Some(due.max(now));
            self.due = Some(due);
        }
        Next::Frame(entry)
    }
}
