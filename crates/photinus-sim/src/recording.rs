//! What a recording says of frames, and what goes wrong with it: some are lost, some get a late time, some pairs have their images
//! swapped.

use nalgebra::{Unit, Vector3};
use photinus_io::dataset::TruthFrame;

use crate::draw::{self, Use};
use crate::render::Rendered;
use crate::scene::Scene;
use crate::sensor::hash;

/// How often each thing goes wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Recording {
    /// Share of the frames that are lost.
    pub lost: f64,
    /// Share of the frames whose time is late.
    pub late: f64,
    /// By how much at most, s; all lateness up to it is equally likely. Less than the time between frames.
    pub late_by_s: f64,
    /// Share of the frames that carry the image of another one: of pairs (0, 1), (2, 3), ...
    pub swapped: f64,
}

/// A frame as it is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recorded {
    /// How late its time is, s.
    pub late_s: f64,
    /// Number of the frame whose image it carries.
    pub shown: u64,
}

/// What a recording says of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// Where everything was; its time is what the camera's clock said.
    pub truth: TruthFrame,
    /// Direction of gravity (down) in the camera frame, as it was measured.
    pub gravity: Unit<Vector3<f64>>,
    /// Number of the frame whose image it carries.
    pub shown: u64,
}

impl Scene {
    /// What a recording of `frames` frames says of a rendered one of camera number `camera`; `None` when it is lost.
    pub fn take(&self, camera: usize, frames: u64, rendered: &Rendered) -> Option<Taken> {
        let (number, of_camera) = (rendered.truth.frame, hash(self.seed ^ hash(camera as u64)));
        let recorded = self.recording.of(number, frames, of_camera)?;
        let mounted = self.cameras.get(camera)?;
        let true_time_s = rendered.truth.time_s;
        let time_s = mounted.clock.reading_s(true_time_s) + recorded.late_s;
        let gravity = self.instruments.gravity.map_or(rendered.gravity, |gravity| {
            gravity.measure(&rendered.gravity, &mounted.body_from_camera, (camera as u64, number), self.seed)
        });
        let mut truth = rendered.truth.clone();
        truth.true_time_s = (time_s.to_bits() != true_time_s.to_bits()).then_some(true_time_s);
        truth.time_s = time_s;
        Some(Taken { truth, gravity, shown: recorded.shown })
    }
}

impl Recording {
    /// How frame `number` of `frames` is recorded; `None` when it is lost.
    pub fn of(&self, number: u64, frames: u64, seed: u64) -> Option<Recorded> {
        if self.loses(number, seed) {
            return None;
        }
        let draw = |what, kind| draw::uniform(draw::key(seed, what, &[number, kind]));
        let is_late = draw(Use::Late, 0) < self.late;
        let late_s = if is_late { self.late_by_s * draw(Use::Late, 1) } else { 0.0 };
        let other = number ^ 1;
        let swaps = draw::uniform(draw::key(seed, Use::Swap, &[number / 2])) < self.swapped;
        let can_swap = other < frames && !self.loses(other, seed);
        Some(Recorded { late_s, shown: if swaps && can_swap { other } else { number } })
    }

    fn loses(&self, number: u64, seed: u64) -> bool {
        draw::uniform(draw::key(seed, Use::Drop, &[number])) < self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAD: Recording = Recording { lost: 0.03, late: 0.2, late_by_s: 0.01, swapped: 0.1 };

    #[test]
    fn shares_are_kept_over_many_frames() {
        let frames = 100_000;
        let recorded: Vec<_> = (0..frames).map(|number| BAD.of(number, frames, 7)).collect();
        let share = |count: usize, of: usize| count as f64 / of as f64;
        let kept: Vec<(u64, Recorded)> =
            (0..frames).zip(&recorded).filter_map(|(n, r)| r.map(|r| (n, r))).collect();
        assert!(
            (share(recorded.iter().filter(|r| r.is_none()).count(), recorded.len()) - 0.03).abs() < 0.002
        );
        let late: Vec<f64> = kept.iter().map(|(_, r)| r.late_s).filter(|late_s| *late_s > 0.0).collect();
        assert!((share(late.len(), kept.len()) - 0.2).abs() < 0.005);
        assert!(
            (late.iter().sum::<f64>() / late.len() as f64 - 0.005).abs() < 1e-4,
            "half of the most, on average"
        );
        assert!(late.iter().all(|late_s| *late_s < 0.01));
        // a pair swaps when neither is lost
        let swapped = kept.iter().filter(|(n, r)| r.shown != *n).count();
        assert!((share(swapped, kept.len()) - 0.1 * 0.97).abs() < 0.005, "{swapped}");
    }

    #[test]
    fn swapped_images_are_there_and_each_stands_once() {
        let frames = 10_001;
        let shown: Vec<u64> = (0..frames).filter_map(|n| BAD.of(n, frames, 7)).map(|r| r.shown).collect();
        let kept: Vec<u64> = (0..frames).filter(|n| BAD.of(*n, frames, 7).is_some()).collect();
        let mut sorted = shown.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, kept);
        assert_ne!(shown, kept);
        let always = Recording { swapped: 1.0, ..Recording::default() };
        let shown =
            |frames: u64| (0..frames).map(|n| always.of(n, frames, 7).map(|r| r.shown)).collect::<Vec<_>>();
        assert_eq!(shown(4), [Some(1), Some(0), Some(3), Some(2)]);
        assert_eq!(shown(3), [Some(1), Some(0), Some(2)], "the last has no partner");
    }

    #[test]
    fn nothing_goes_wrong_unless_it_is_said() {
        let fine = Recording::default();
        assert!((0..1000).all(|n| fine.of(n, 1000, 3) == Some(Recorded { late_s: 0.0, shown: n })));
    }
}
