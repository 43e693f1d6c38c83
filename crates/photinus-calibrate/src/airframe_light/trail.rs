//! Where the markers of the last frame went: tells which marker is which in the next, without any belief about lobes or yaw.

use nalgebra::Vector3;

use super::flight::Sighting;

/// Markers of the last frame lead nowhere after this many seconds.
const LOST_S: f64 = 0.5;
/// Markers have gone where they were expected but for this share of the least gap between two of them.
const GATE_SHARE: f64 = 0.4;

/// The markers of the last frame, and how they moved.
#[derive(Clone, Debug, Default)]
pub(super) struct Trail {
    time_s: f64,
    markers: Vec<Moving>,
}

#[derive(Clone, Copy, Debug)]
struct Moving {
    marker: usize,
    direction: Vector3<f64>,
    per_s: Vector3<f64>,
}

impl Trail {
    /// The turn in which markers are where they were expected; `None` where there is none. `turned` are the sightings in a turn.
    pub(super) fn turn(
        &self,
        time_s: f64,
        turns: usize,
        turned: &dyn Fn(usize) -> Vec<Sighting>,
    ) -> Option<usize> {
        let after_s = time_s - self.time_s;
        if !(0.0..=LOST_S).contains(&after_s) {
            return None;
        }
        let off_rad = |seen: &Sighting| {
            let last = self.markers.iter().find(|last| last.marker == seen.marker)?;
            Some((last.direction + last.per_s * after_s - seen.direction).norm())
        };
        let fit = |turn: usize| {
            let worst_rad = turned(turn).iter().filter_map(off_rad).reduce(f64::max)?;
            Some((worst_rad, turn))
        };
        let best = (0..turns).filter_map(fit).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 < GATE_SHARE * least_gap_rad(&turned(0))).then_some(best.1)
    }

    /// Goes on with the markers of a frame.
    pub(super) fn go_on(&mut self, time_s: f64, sightings: &[Sighting]) {
        let after_s = time_s - self.time_s;
        let moved = |seen: &Sighting| {
            let last = self.markers.iter().find(|last| last.marker == seen.marker && after_s > 0.0)?;
            Some((seen.direction - last.direction) / after_s)
        };
        let known: Vec<Vector3<f64>> =
            sightings.iter().filter(|_| after_s <= LOST_S).filter_map(moved).collect();
        let mean = known.iter().sum::<Vector3<f64>>() / (known.len().max(1) as f64);
        let go_on = |seen: &Sighting| Moving { marker: seen.marker, direction: seen.direction, per_s: mean };
        self.markers = sightings.iter().map(go_on).collect();
        self.time_s = time_s;
    }
}

/// The least angle between two sightings.
fn least_gap_rad(sightings: &[Sighting]) -> f64 {
    let pairs = sightings.iter().enumerate().flat_map(|(index, first)| {
        sightings[index + 1..].iter().map(move |second| (first.direction - second.direction).norm())
    });
    pairs.fold(f64::INFINITY, f64::min)
}
