//! Tracks against truth -> a line of a table.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, Vector3};
use photinus::tracking::Track;
use photinus_evaluate::{CHI_SQUARE_3_50, CHI_SQUARE_3_95};

/// A track so far beside the line of sight to its vehicle is another's, m.
const BESIDE_M: f64 = 0.4;
/// A squared error of so many variances is five sigma and more.
const SURELY_WRONG: f64 = 25.0;

/// What was counted of vehicles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    /// Vehicles in frames.
    pub(crate) there: usize,
    /// Vehicle and track, of each seed.
    pub(crate) tracks: BTreeSet<(u64, u32, u64)>,
    beside: usize,
    /// Squared errors over covariances, of the position where it was seen and where it was predicted, and of the velocity.
    seen: Vec<f64>,
    predicted: Vec<f64>,
    velocity: Vec<f64>,
    /// How far off, as shares of the distance.
    off: Vec<f64>,
    /// Time of following, s.
    pub(crate) took_s: f64,
}

impl Score {
    pub(crate) const HEADS: &str = "| seed | named | beside | tracks of vehicles | NEES/3 seen, predicted | in 50, 95 % | > 25 | velocity | off, median | ms a frame |\n|---|---|---|---|---|---|---|---|---|---|";

    /// Takes in a track that is said to be a vehicle.
    pub(crate) fn see(&mut self, track: &Track, truth_m: &Vector3<f64>, velocity_m_s: Option<&Vector3<f64>>) {
        let off_m = track.position_m - truth_m;
        let ahead = truth_m.normalize();
        self.beside += usize::from((off_m - ahead * ahead.dot(&off_m)).norm() > BESIDE_M);
        let square = nees(&off_m, &track.position_covariance_m2);
        let kept = if track.is_predicted { &mut self.predicted } else { &mut self.seen };
        kept.push(square);
        self.off.push(off_m.norm() / truth_m.norm());
        if let Some(truth_m_s) = velocity_m_s {
            self.velocity.push(nees(&(track.velocity_m_s - truth_m_s), &track.velocity_covariance_m2_s2));
        }
    }

    /// Adds others.
    pub(crate) fn add(&mut self, other: &Self) {
        self.there += other.there;
        self.beside += other.beside;
        self.took_s += other.took_s;
        self.tracks.extend(&other.tracks);
        self.off.extend(&other.off);
        self.seen.extend(&other.seen);
        self.predicted.extend(&other.predicted);
        self.velocity.extend(&other.velocity);
    }

    /// As a line under [`Self::HEADS`]. The time is that of a frame with all six.
    pub(crate) fn line(&self, name: &str) -> String {
        let named = self.seen.len() + self.predicted.len();
        let all = || self.seen.iter().chain(&self.predicted);
        let share = |is: &dyn Fn(f64) -> bool| {
            100.0 * all().filter(|square| is(**square)).count() as f64 / named as f64
        };
        let mean = |squares: &[f64]| squares.iter().sum::<f64>() / (3.0 * squares.len() as f64);
        let vehicles: BTreeSet<(u64, u32)> = self.tracks.iter().map(|track| (track.0, track.1)).collect();
        format!(
            "| {name} | {named} of {} | {} | {} of {} | {:.2}, {:.2} | {:.0}, {:.0} | {:.1} % | {:.2} | {:.1} % | {:.1} |",
            self.there,
            self.beside,
            self.tracks.len(),
            vehicles.len(),
            mean(&self.seen),
            mean(&self.predicted),
            share(&|square| square < CHI_SQUARE_3_50),
            share(&|square| square < CHI_SQUARE_3_95),
            share(&|square| square > SURELY_WRONG),
            mean(&self.velocity),
            100.0 * median(&self.off),
            6e3 * self.took_s / self.there as f64,
        )
    }
}

fn median(all: &[f64]) -> f64 {
    let mut all = all.to_vec();
    all.sort_unstable_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The squared error in units of its covariance.
fn nees(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> f64 {
    covariance.cholesky().map_or(f64::INFINITY, |factor| error.dot(&factor.solve(error)))
}
