//! Candidates with their probabilities -> the neighbours of a frame.
//!
//! The likeliest candidates that share no observation are neighbours, each the vehicle that its surest observation is of. Others that have that observation,
//! and those of the same observations that are at the same place, are the same neighbour, seen by other markers: they add to its probability, widen its
//! covariance and bounds, and stand among its modes. The rest is what its observations may be otherwise.

use alloc::vec::Vec;

use nalgebra::Matrix3;

use super::candidates::Candidates;
use super::explanation::Explanation;
use super::neighbour::{Located, Neighbour, Position, RunnerUp};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::Mode;
use crate::ranging::{Estimate, Interval};

/// Candidates of one observation that are apart by more than this, in sigma, are different neighbours.
const SAME_SIGMAS: f64 = 5.0;
/// What is less likely than this takes no part.
const NEGLIGIBLE: f64 = 1e-3;
/// Room of a neighbour: few have more spots and modes.
const MEMBERS_EACH: usize = 32;
const MODES_EACH: usize = 128;

/// Room to tell neighbours in.
#[derive(Debug)]
pub(super) struct Telling {
    order: Vec<usize>,
    taken: Vec<bool>,
    /// Candidates that are the neighbour, with their probabilities.
    same: Vec<(usize, f64)>,
    /// Neighbours of earlier frames, for the room that they take.
    spare: Vec<Neighbour>,
}

impl Telling {
    /// Room for this many candidates.
    pub(super) fn with_room(count: usize) -> Self {
        Self {
            order: Vec::with_capacity(count),
            taken: Vec::new(),
            same: Vec::with_capacity(count),
            spare: Vec::new(),
        }
    }

    /// Puts the neighbours that are at `least` so likely, of so many observations, into `located`, in the order of their first observation.
    pub(super) fn tell(
        &mut self,
        candidates: &Candidates,
        explanation: &Explanation,
        (least, observations): (f64, usize),
        located: &mut Located,
    ) {
        self.spare.append(&mut located.neighbours);
        self.taken.clear();
        self.taken.resize(observations, false);
        self.order.clear();
        let negligible = NEGLIGIBLE.min(least);
        self.order
            .extend((0..candidates.len()).filter(|&index| explanation.probability(index) >= negligible));
        self.order.sort_unstable_by(|&a, &b| {
            explanation.probability(b).total_cmp(&explanation.probability(a)).then(a.cmp(&b))
        });
        for place in 0..self.order.len() {
            let index = self.order[place];
            if candidates.members(index).iter().any(|&spot| self.taken[spot]) {
                continue;
            }
            let runner_up = self.gather(candidates, explanation, index);
            let probability = self.same.iter().map(|&(_, probability)| probability).sum::<f64>().min(1.0);
            for &spot in candidates.members(index) {
                self.taken[spot] = true;
            }
            if probability >= least {
                self.put(candidates, index, probability, runner_up, located);
            }
        }
        located.neighbours.sort_unstable_by_key(|neighbour| neighbour.sightings[0]);
    }

    /// Gathers the candidates that are the same neighbour as `own`; the likeliest that shares an observation but is another is the runner-up,
    /// unless it is likelier that there is nothing but clutter.
    fn gather(&mut self, candidates: &Candidates, explanation: &Explanation, own: usize) -> RunnerUp {
        let members = candidates.members(own);
        let shares = |other: &usize| candidates.members(*other).iter().any(|spot| members.contains(spot));
        let surest = self.surest(candidates, explanation, own);
        self.same.clear();
        let mut other = RunnerUp { probability: 0.0, distance_m: None };
        let mut all = 0.0;
        for &index in self.order.iter().filter(|index| shares(index)) {
            let probability = explanation.probability(index);
            all += probability;
            if index == own && probability == 0.0 {
                // Unlikely to be chosen, but it is what the setting asks for.
                self.same.push((index, f64::MIN_POSITIVE));
            } else if candidates.members(index).contains(&surest) || is_same(candidates, own, index) {
                self.same.push((index, probability));
            } else if probability > other.probability {
                let distance_m = candidates.get(index).distance.estimate.map(|estimate| estimate.distance_m);
                other = RunnerUp { probability, distance_m };
            }
        }
        let clutter = (1.0 - all).max(0.0);
        if clutter >= other.probability { RunnerUp { probability: clutter, distance_m: None } } else { other }
    }

    /// The observation of a candidate that is most surely a neighbour's.
    fn surest(&self, candidates: &Candidates, explanation: &Explanation, own: usize) -> usize {
        let members = candidates.members(own);
        let of_any = |spot: usize| -> f64 {
            let with = self.order.iter().filter(|&&index| candidates.members(index).contains(&spot));
            with.map(|&index| explanation.probability(index)).sum()
        };
        let surer = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
        let each = members.iter().map(|&spot| (spot, of_any(spot)));
        each.reduce(surer).map_or(members[0], |(spot, _)| spot)
    }

    /// Adds a neighbour: the mixture of the candidates that it is.
    fn put(
        &mut self,
        candidates: &Candidates,
        own: usize,
        probability: f64,
        runner_up: RunnerUp,
        located: &mut Located,
    ) {
        let candidate = candidates.get(own);
        let (mut sightings, mut modes) = match self.spare.pop() {
            Some(Neighbour { sightings, modes, .. }) => (sightings, modes),
            None => (Vec::with_capacity(MEMBERS_EACH), Vec::with_capacity(MODES_EACH)),
        };
        sightings.clear();
        sightings.extend_from_slice(candidates.members(own));
        modes.clear();
        let is_kind = |&&(index, _): &&(usize, f64)| candidates.get(index).kind == candidate.kind;
        let all: f64 = self.same.iter().map(|&(_, share)| share).sum();
        let of_kind: f64 = self.same.iter().filter(is_kind).map(|&(_, share)| share).sum();
        for &(index, share) in self.same.iter().filter(is_kind) {
            let weigh = |mode: &Mode| Mode { weight: mode.weight * share, ..*mode };
            modes.extend(candidates.modes(index).iter().map(weigh));
        }
        modes.sort_unstable_by(|a, b| b.weight.total_cmp(&a.weight));
        let total: f64 = modes.iter().map(|mode| mode.weight).sum();
        modes.iter_mut().for_each(|mode| mode.weight /= total);
        let (position, estimate, bounds) = self.mixture(candidates);
        let mut distance = candidate.distance;
        distance.estimate = estimate.or(distance.estimate);
        distance.bounds = bounds.unwrap_or(distance.bounds);
        located.neighbours.push(Neighbour {
            kind: candidate.kind,
            kind_probability: of_kind / all,
            bearing: candidate.bearing,
            distance,
            position: position.or(candidate.position),
            orientation: candidate.orientation,
            probability,
            misfit: candidate.misfit,
            runner_up,
            sightings,
            modes,
        });
    }

    /// Mean and covariance over the candidates, and bounds that hold for each of them.
    fn mixture(&self, candidates: &Candidates) -> (Option<Position>, Option<Estimate>, Option<Interval>) {
        if let [(only, _)] = self.same[..] {
            let candidate = candidates.get(only);
            return (candidate.position, candidate.distance.estimate, Some(candidate.distance.bounds));
        }
        let total: f64 = self.same.iter().map(|&(_, share)| share).sum();
        let (mut mean_m, mut square_m2) = (nalgebra::Vector3::zeros(), Matrix3::zeros());
        let (mut distance_m, mut distance2_m2) = (0.0, 0.0);
        let mut bounds: Option<Interval> = None;
        for &(index, share) in &self.same {
            let candidate = candidates.get(index);
            let (Some(position), Some(estimate)) = (candidate.position, candidate.distance.estimate) else {
                continue;
            };
            let weight = share / total;
            mean_m += position.mean_m * weight;
            square_m2 += (position.covariance_m2 + position.mean_m * position.mean_m.transpose()) * weight;
            distance_m += estimate.distance_m * weight;
            distance2_m2 +=
                (estimate.sigma_m * estimate.sigma_m + estimate.distance_m * estimate.distance_m) * weight;
            let own = candidate.distance.bounds;
            bounds = Some(bounds.map_or(own, |all| all.hull(&own)));
        }
        // The mean of places all around is nearer than any of them.
        let (length_m, within) =
            (mean_m.norm(), bounds.unwrap_or(candidates.get(self.same[0].0).distance.bounds));
        let within_m = length_m.clamp(within.min_m(), within.max_m());
        let position = Position { mean_m, covariance_m2: square_m2 - mean_m * mean_m.transpose() };
        let position = Position { mean_m: position.mean_m * (within_m / length_m), ..position };
        let sigma_m = (distance2_m2 - distance_m * distance_m).max(0.0).sqrt();
        (Some(position), Some(Estimate { distance_m, sigma_m }), bounds)
    }
}

/// Whether two candidates that share an observation are one neighbour: no further apart than they are unsure, or of the same observations, which are one
/// vehicle of whatever kind.
fn is_same(candidates: &Candidates, a: usize, b: usize) -> bool {
    if a == b || candidates.members(a) == candidates.members(b) {
        return true;
    }
    let (Some(first), Some(second)) = (candidates.get(a).position, candidates.get(b).position) else {
        return false;
    };
    let off_m = first.mean_m - second.mean_m;
    let covariance_m2 = first.covariance_m2 + second.covariance_m2 + Matrix3::identity() * 1e-9;
    let squared = covariance_m2.cholesky().map(|factor| off_m.dot(&factor.solve(&off_m)));
    squared.is_some_and(|squared| squared < SAME_SIGMAS * SAME_SIGMAS)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::super::candidates::Told;
    use super::super::neighbour::Distance;
    use super::*;
    use crate::camera::Bearing;
    use crate::pose::{LightSpread, Misfit, Missed, Tilting};

    const SIGMA_M: f64 = 0.1;

    /// Of observations at a distance.
    fn told(distance_m: f64, log_density: f64) -> Told {
        let bounds = Interval::new(distance_m - 1.0, distance_m + 1.0).unwrap();
        let estimate = Some(Estimate { distance_m, sigma_m: SIGMA_M });
        Told {
            kind: 0,
            bearing: Bearing::new(Vector3::z()).unwrap(),
            distance: Distance { estimate, bounds, perpendicular_m: None, inline_m: None },
            position: Some(Position {
                mean_m: Vector3::z() * distance_m,
                covariance_m2: Matrix3::identity() * (SIGMA_M * SIGMA_M),
            }),
            orientation: None,
            misfit: Misfit { chi_square: 0.0, degrees: 0 },
            missed: Missed::default(),
            tilting: Tilting::default(),
            light_spread: LightSpread::default(),
            worst_sigma: 0.0,
            log_density,
            reach_m: 0.1,
        }
    }

    /// What is told of candidates, each of observations at a distance, where clutter has a density of 1.
    fn neighbours(of: &[(&[usize], f64, f64)], observations: usize) -> Vec<Neighbour> {
        let mut candidates = Candidates::with_room(of.len());
        candidates.clear();
        for &(members, distance_m, log_density) in of {
            candidates.push(members, &[], told(distance_m, log_density));
        }
        let mut explanation = Explanation::with_room(of.len());
        explanation.suppose(observations, |_| 1.0);
        explanation.explain(&candidates, &alloc::vec![0.0; observations], |_| 0.0);
        let mut located = Located::default();
        Telling::with_room(of.len()).tell(&candidates, &explanation, (0.5, observations), &mut located);
        located.neighbours
    }

    #[test]
    fn with_or_without_a_lamp_for_a_marker_it_is_one_vehicle_at_either_place() {
        let likelier = libm::log(0.7 / 0.3);
        let [only] = &neighbours(&[(&[0, 1, 2], 5.0, 20.0 + likelier), (&[0, 1], 9.0, 20.0)], 3)[..] else {
            panic!("one vehicle");
        };
        assert!(only.probability > 0.999, "{only:?}");
        let estimate = only.distance.estimate.unwrap();
        assert!((estimate.distance_m - (0.7 * 5.0 + 0.3 * 9.0)).abs() < 1e-6, "{estimate:?}");
        let variance_m2 = 0.7 * 0.3 * 16.0 + SIGMA_M * SIGMA_M;
        assert!((estimate.sigma_m - variance_m2.sqrt()).abs() < 1e-6, "{estimate:?}");
        assert!((only.position.unwrap().covariance_m2[(2, 2)] - variance_m2).abs() < 1e-6, "{only:?}");
        assert_eq!(only.distance.bounds, Interval::new(4.0, 10.0).unwrap());
    }

    #[test]
    fn what_has_only_a_less_sure_one_of_its_observations_elsewhere_is_another_vehicle() {
        let of: [(&[usize], f64, f64); 3] = [(&[0, 1], 5.0, 22.0), (&[0], 5.0, 20.0), (&[1], 9.0, 1.0)];
        let found = neighbours(&of, 2);
        let [first, ..] = &found[..] else { panic!("a vehicle") };
        assert!(first.sightings == [0, 1] && first.distance.bounds.max_m() < 9.0, "{first:?}");
        assert!(first.runner_up.distance_m == Some(9.0), "{first:?}");
    }
}
