//! Truth's neighbours and reported ones of one frame -> which is which.
//!
//! The gate is in bearing alone: a neighbour reported in the right direction and at a wrong distance is that neighbour with
//! a wrong distance, which the scores must show, not a false one beside a missed one. Distance decides between neighbours
//! behind each other.

use nalgebra::Vector3;
use photinus_io::dataset::TruthNeighbour;
use photinus_io::results::{NeighbourRecord, TrackRecord};

use super::assignment::{Candidate, assign};
use crate::Settings;

/// A distance wrong by this factor or more counts as wholly wrong.
const FACTOR: f64 = 4.0;

/// Where a neighbour is reported.
pub(crate) trait Placed {
    /// Towards it, of any length.
    fn towards(&self) -> Vector3<f64>;
    /// Of the distances that it is said to have, m, the one nearest to `truth_m`.
    fn distance_m(&self, truth_m: f64) -> f64;
}

impl Placed for NeighbourRecord {
    fn towards(&self) -> Vector3<f64> {
        self.bearing.into()
    }

    fn distance_m(&self, truth_m: f64) -> f64 {
        let told = &self.distance_m;
        // Where there is no estimate, the bounds have their say.
        told.estimate.unwrap_or_else(|| truth_m.max(told.min).min(told.max.unwrap_or(f64::INFINITY)))
    }
}

impl Placed for TrackRecord {
    fn towards(&self) -> Vector3<f64> {
        self.position_m.into()
    }

    fn distance_m(&self, _truth_m: f64) -> f64 {
        Vector3::from(self.position_m).norm()
    }
}

/// The pairs (truth, found), by truth.
pub(crate) fn pair(
    truth: &[TruthNeighbour],
    found: &[impl Placed],
    settings: &Settings,
) -> Vec<(usize, usize)> {
    let mut candidates = Vec::new();
    for (row, there) in truth.iter().enumerate() {
        for (column, reported) in found.iter().enumerate() {
            if let Some(cost) = cost(there, reported, settings) {
                candidates.push(Candidate { row, column, cost });
            }
        }
    }
    assign(&candidates)
}

/// Half the share of the gate in bearing, half the error of distance; `None` outside the gate.
fn cost(truth: &TruthNeighbour, found: &impl Placed, settings: &Settings) -> Option<f64> {
    let gate_rad = settings.bearing_gate_rad.max(libm::atan2(settings.lateral_gate_m, truth.distance_m));
    let share = bearing_error_rad(truth, found)? / gate_rad;
    let log_ratio = libm::log(found.distance_m(truth.distance_m) / truth.distance_m).abs();
    let wrong = if log_ratio.is_finite() { (log_ratio / libm::log(FACTOR)).min(1.0) } else { 1.0 };
    (share < 1.0).then_some((share + wrong) / 2.0)
}

/// The angle between truth and report, rad; `None` where the report points nowhere.
pub(crate) fn bearing_error_rad(truth: &TruthNeighbour, found: &impl Placed) -> Option<f64> {
    let there = Vector3::from(truth.position_m).try_normalize(0.0)?;
    let reported = found.towards().try_normalize(0.0)?;
    let angle_rad = libm::atan2(there.cross(&reported).norm(), there.dot(&reported));
    angle_rad.is_finite().then_some(angle_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand_made::{found_at, there};

    fn pairs(truth: &[TruthNeighbour], found: &[NeighbourRecord]) -> Vec<(usize, usize)> {
        pair(truth, found, &Settings::default())
    }

    #[test]
    fn neighbours_behind_each_other_are_told_apart_by_distance() {
        let truth = [there(1, [0.0, 0.0, 4.0]), there(2, [0.0, 0.0, 8.0])];
        let found = [found_at([0.0, 0.0, 7.0]), found_at([0.0, 0.0, 4.5])];
        assert_eq!(pairs(&truth, &found), [(0, 1), (1, 0)]);
    }

    #[test]
    fn a_wrong_distance_is_no_other_neighbour_but_a_wrong_direction_is() {
        let truth = [there(1, [0.0, 0.0, 10.0])];
        assert_eq!(pairs(&truth, &[found_at([0.0, 0.0, 1.0])]), [(0, 0)]);
        assert_eq!(pairs(&truth, &[found_at([2.0, 0.0, 10.0])]), []);
        // Near by, half a metre aside is the same robot.
        assert_eq!(pairs(&[there(1, [0.0, 0.0, 1.0])], &[found_at([0.4, 0.0, 1.0])]), [(0, 0)]);
    }

    #[test]
    fn angles_are_right_where_cosines_are_blind() {
        let error =
            |found: [f64; 3]| bearing_error_rad(&there(1, [0.0, 0.0, 2.0]), &found_at(found)).unwrap();
        assert!((error([1e-9, 0.0, 1.0]) - 1e-9).abs() < 1e-20);
        assert!((error([0.0, 0.0, -1.0]) - std::f64::consts::PI).abs() < 1e-15);
        let nowhere = NeighbourRecord { bearing: [0.0; 3], ..found_at([0.0, 0.0, 1.0]) };
        assert_eq!(pairs(&[there(1, [0.0, 0.0, 1.0])], &[nowhere]), []);
    }
}
