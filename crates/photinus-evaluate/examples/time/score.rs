//! Tracks against truth -> a line of the table.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use photinus::lookout::Lookout;
use photinus::tracking::Track;
use photinus_io::dataset::TruthNeighbour;

use crate::scene::Airframe;

/// A track so far beside the line of sight to a vehicle is not its own: at least so many rad, or m.
const BESIDE_RAD: f64 = 0.05;
const BESIDE_M: f64 = 0.6;
/// An id is told from this probability on.
pub(crate) const SURE: f64 = 0.9;
/// A squared error of so many variances is five sigma and more.
const SURELY_WRONG: f64 = 25.0;
/// A vehicle whose squared errors are on average so many variances is more sure than it may be: 3 is right.
pub(crate) const DISHONEST: f64 = 4.0;

/// What was counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    frames: usize,
    /// Vehicles in frames, and those of them with the right name, with another's, and without a track.
    there: usize,
    right: usize,
    wrong: usize,
    untracked: usize,
    /// Tracks in frames that are no vehicle's.
    false_tracks: usize,
    /// Vehicles that go on under another track.
    switches: usize,
    /// Squared errors over covariances, of the position where it was seen and where it was predicted, and of the velocity.
    seen: Vec<f64>,
    predicted: Vec<f64>,
    velocity: Vec<f64>,
    /// What was said: names in frames that are contested, frames that are refused, or late, and clocks that jumped.
    contested: usize,
    refused: usize,
    pub(crate) late: usize,
    pub(crate) resets: usize,
    /// By vehicle: the sum of the squares of its position, and how many there are.
    squares: BTreeMap<u32, (f64, usize)>,
    /// Vehicles of flights, and those whose positions have a mean square of this many variances and more.
    vehicles: usize,
    dishonest: usize,
    /// By vehicle: the track that it had last.
    last: BTreeMap<u32, u64>,
}

impl Score {
    pub(crate) const HEADS: &str = "| airframe | fault | named right, wrong, not, % | without track % | false tracks % | switches | NEES seen, predicted | > 25: seen, predicted % | vehicles with NEES > 4 | NEES of velocity, > 25 % | said |\n|---|---|---|---|---|---|---|---|---|---|---|";

    /// Takes in what is told of a frame.
    pub(crate) fn see(&mut self, lookout: &Lookout, truth: &[TruthNeighbour]) {
        let tracks = &lookout.tracked().tracks;
        self.there += truth.len();
        let pairs = pair(tracks, truth);
        self.untracked += truth.len() - pairs.len();
        self.false_tracks += tracks.len() - pairs.len();
        self.contested += lookout.names().iter().filter(|name| name.is_contested).count();
        for (track, there) in pairs {
            let name = lookout.name(track.id).filter(|name| name.probability >= SURE);
            self.right += usize::from(name.is_some_and(|name| name.id == there.id));
            self.wrong += usize::from(name.is_some_and(|name| name.id != there.id));
            let last = self.last.insert(there.id, track.id);
            self.switches += usize::from(last.is_some_and(|last| last != track.id));
            let square = nees(&off_m(track, there), &track.position_covariance_m2);
            let kept = if track.is_predicted { &mut self.predicted } else { &mut self.seen };
            kept.push(square);
            let (sum, count) = self.squares.entry(there.id).or_default();
            (*sum, *count) = (*sum + square, *count + 1);
            if let Some(truth_m_s) = there.velocity_m_s.map(Vector3::from) {
                self.velocity.push(nees(&(track.velocity_m_s - truth_m_s), &track.velocity_covariance_m2_s2));
            }
        }
    }

    /// Takes in a frame that is refused: nobody is told.
    pub(crate) fn refuse(&mut self, there: usize) {
        self.there += there;
        self.untracked += there;
        self.refused += 1;
    }

    pub(crate) fn end_frame(&mut self) {
        self.frames += 1;
    }

    /// Adds another flight's.
    pub(crate) fn add(&mut self, other: &Self) {
        let own = [
            &mut self.frames,
            &mut self.there,
            &mut self.right,
            &mut self.wrong,
            &mut self.untracked,
            &mut self.false_tracks,
            &mut self.switches,
            &mut self.contested,
            &mut self.refused,
            &mut self.late,
            &mut self.resets,
        ];
        let others = [
            other.frames,
            other.there,
            other.right,
            other.wrong,
            other.untracked,
            other.false_tracks,
            other.switches,
            other.contested,
            other.refused,
            other.late,
            other.resets,
        ];
        own.into_iter().zip(others).for_each(|(own, other)| *own += other);
        self.vehicles += other.squares.len();
        self.dishonest += other.dishonest();
        self.seen.extend(&other.seen);
        self.predicted.extend(&other.predicted);
        self.velocity.extend(&other.velocity);
    }

    /// Vehicles of a flight that are more sure than they may be.
    fn dishonest(&self) -> usize {
        self.squares.values().filter(|(sum, count)| sum / *count as f64 >= DISHONEST).count()
    }

    /// Squares over covariances: seen, predicted, of velocities.
    pub(crate) fn nees(&self) -> [f64; 3] {
        [&self.seen, &self.predicted, &self.velocity].map(|squares| mean(squares))
    }

    /// As a line under [`Self::HEADS`].
    pub(crate) fn line(&self, airframe: Airframe, fault: &str) -> String {
        let percent = |count: usize| 100.0 * count as f64 / self.there as f64;
        let not = self.there - self.right - self.wrong - self.untracked;
        let [seen, predicted, velocity] = self.nees();
        let off = |squares: &[f64]| {
            let count = squares.iter().filter(|square| **square > SURELY_WRONG).count();
            100.0 * count as f64 / squares.len() as f64
        };
        let said = [
            (self.resets, "resets"),
            (self.late, "late"),
            (self.refused, "refused"),
            (self.contested, "contested"),
        ];
        let said: Vec<String> =
            said.iter().filter(|said| said.0 > 0).map(|(count, what)| format!("{count} {what}")).collect();
        format!(
            "| {} | {fault} | {:.1}, {:.2}, {:.1} | {:.2} | {:.2} | {} | {:.2}, {:.2} | {:.2}, {:.2} | {} of {} | {:.2}, {:.2} | {} |",
            airframe.name,
            percent(self.right),
            percent(self.wrong),
            percent(not),
            percent(self.untracked),
            percent(self.false_tracks),
            self.switches,
            seen,
            predicted,
            off(&self.seen),
            off(&self.predicted),
            self.dishonest + self.dishonest() * usize::from(self.vehicles == 0),
            self.vehicles.max(self.squares.len()),
            velocity,
            off(&self.velocity),
            said.join(", "),
        )
    }
}

pub(crate) fn off_m(track: &Track, there: &TruthNeighbour) -> Vector3<f64> {
    track.position_m - Vector3::from(there.position_m)
}

/// Which track is which vehicle's, the nearest to its line of sight first.
pub(crate) fn pair<'a>(
    tracks: &'a [Track],
    truth: &'a [TruthNeighbour],
) -> Vec<(&'a Track, &'a TruthNeighbour)> {
    let aside_m = |track: &Track, there: &TruthNeighbour| {
        let (off_m, ahead) = (off_m(track, there), Vector3::from(there.position_m).normalize());
        let aside_m = (off_m - ahead * ahead.dot(&off_m)).norm();
        (aside_m < BESIDE_M.max(BESIDE_RAD * there.distance_m)).then_some(aside_m)
    };
    let near =
        |track: &'a Track| truth.iter().filter_map(move |there| Some((aside_m(track, there)?, track, there)));
    let mut all: Vec<_> = tracks.iter().flat_map(near).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pairs: Vec<(&Track, &TruthNeighbour)> = Vec::new();
    for (_, track, there) in all {
        if pairs.iter().all(|pair| pair.0.id != track.id && pair.1.id != there.id) {
            pairs.push((track, there));
        }
    }
    pairs
}

/// The squared error in units of its covariance.
pub(crate) fn nees(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> f64 {
    covariance.cholesky().map_or(f64::INFINITY, |factor| error.dot(&factor.solve(error)))
}

fn mean(squares: &[f64]) -> f64 {
    squares.iter().sum::<f64>() / squares.len() as f64
}
