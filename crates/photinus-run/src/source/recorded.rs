//! A camera of a dataset folder, as if it were flying now, or as fast as it is asked.

use std::time::{Duration, Instant};

use photinus_io::Result;
use photinus_io::dataset::{Dataset, FrameRow};
use photinus_io::frames::FrameSource;

use super::{Next, Source};
use crate::Entry;

/// A camera of a dataset.
pub struct Recorded {
    frames: FrameSource,
    exposure_s: f64,
    /// When its clock showed 0 by ours, where it flies at its own pace.
    began: Option<Instant>,
    /// The shortest time from a frame to the next one.
    least_gap: Duration,
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
        let least_gap = least_gap(rows(dataset, camera));
        let frames = FrameSource::dataset_camera(dataset.clone(), camera);
        Self { frames, exposure_s, began, least_gap, due: None, again: None }
    }

    /// Begins anew at its end, with times and numbers that go on. The seam is the mean of the gaps between frames.
    #[must_use]
    pub fn repeated(self, dataset: &Dataset, camera: usize) -> Self {
        let rows = rows(dataset, camera);
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return self };
        let gaps = (rows.len() - 1).max(1) as f64;
        let span_s = (last.time_s - first.time_s) * (1.0 + 1.0 / gaps);
        let again = Again {
            dataset: dataset.clone(),
            camera,
            span_s,
            frames: last.frame - first.frame + 1,
            rounds: 0,
        };
        Self { again: Some(again), ..self }
    }

    /// Waits half of the shortest gap after a frame: a camera does not decode files, and who is at that frame is not to be kept from it. No frame
    /// is late for that, however the recording pauses.
    fn wait_to_read(&self) {
        if let Some(due) = self.due {
            std::thread::sleep((due + self.least_gap / 2).saturating_duration_since(Instant::now()));
        }
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

/// The frames of a camera; none where there is no such camera.
fn rows(dataset: &Dataset, camera: usize) -> &[FrameRow] {
    dataset.cameras().get(camera).map_or(&[], |camera| &camera.frames)
}

/// The shortest time from a frame to the next one; nothing where times run backwards.
fn least_gap(rows: &[FrameRow]) -> Duration {
    let gaps_s = rows.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    Duration::try_from_secs_f64(gaps_s.fold(f64::INFINITY, f64::min)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_keeps_no_frame_of_a_recording_from_being_read_in_time() {
        let least = |times_s: &[f64]| {
            let row = |(frame, &time_s): (u64, &f64)| FrameRow {
                frame,
                time_s,
                image: "image.png".into(),
                gravity: None,
                line: 0,
            };
            least_gap(&(0..).zip(times_s).map(row).collect::<Vec<_>>())
        };
        assert_eq!(least(&[1.0, 1.25, 1.5, 61.5, 62.0]), Duration::from_millis(250));
        assert_eq!([least(&[]), least(&[3.0]), least(&[3.0, 2.0])], [Duration::ZERO; 3]);
    }
}
