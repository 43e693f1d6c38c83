//! Groups of observations that may be a neighbour, each with its pose and how well it explains them: kept until the frame is explained as a whole.

use alloc::vec::Vec;

use nalgebra::Vector3;

use super::clutter::LIGHT_RANGE;
use super::context::Context;
use super::neighbour::{Distance, Orientation, Position};
use crate::camera::Bearing;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::normal;
use crate::pose::{LightSpread, LogLight, Misfit, Missed, Mode, Tilting};

/// Modes that a candidate has at most, or nearly.
const MODES_EACH: usize = 32;
/// A candidate is clear that is likelier than clutter by this much, nats, ...
const CLEAR_GAIN: f64 = 12.0;
/// ... whose misfit is no more than this, in sigma of any one observation, and no rarer than that as a whole.
const CLEAR_SIGMAS: f64 = 5.0;
const CLEAR_P_VALUE: f64 = 0.01;
/// The share of spots whose light is not that of their markers, however much these differ: any light then is as likely.
const ODD_LIGHT: f64 = 0.02;

/// Observations that may be one neighbour, and what it then is.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Which of the kinds that are looked for.
    pub(super) kind: usize,
    pub(super) bearing: Bearing,
    pub(super) distance: Distance,
    pub(super) position: Option<Position>,
    pub(super) orientation: Option<Orientation>,
    pub(super) misfit: Misfit,
    /// Its markers that must show, and those of them that do not.
    pub(super) missed: Missed,
    pub(super) tilting: Tilting,
    /// How far the light of its LEDs is from what the airframe says.
    pub(super) light_spread: LightSpread,
    /// Largest misfit, in sigma.
    pub(super) worst_sigma: f64,
    /// Logarithm of the density of its observations as this neighbour, if it is there: per sr and per unit of the logarithm of light each, times
    /// 1 sr.
    pub(super) log_density: f64,
    first_member: usize,
    members: usize,
    first_mode: usize,
    modes: usize,
    /// The one before it with the same first observation.
    before: Option<usize>,
}

/// What is told of a candidate besides which observations it is of.
pub(super) struct Told {
    pub(super) kind: usize,
    pub(super) bearing: Bearing,
    pub(super) distance: Distance,
    pub(super) position: Option<Position>,
    pub(super) orientation: Option<Orientation>,
    pub(super) misfit: Misfit,
    pub(super) missed: Missed,
    pub(super) tilting: Tilting,
    pub(super) light_spread: LightSpread,
    pub(super) worst_sigma: f64,
    pub(super) log_density: f64,
    /// How far its outermost marker is from its origin, m.
    pub(super) reach_m: f64,
}

/// A spot that a marker of a candidate may be part of, though it is not one of its observations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merging {
    pub(super) spot: usize,
    pub(super) candidate: usize,
    pub(super) probability: f64,
    /// Logarithm of the density of the spot's place if two markers are in it, per sr.
    pub(super) place_log_density: f64,
    /// The spot's light, and what the marker adds to it, where light is used.
    pub(super) lights: Option<(LogLight, MergingLight)>,
}

/// The light that a marker adds to a spot.
#[derive(Clone, Copy, Debug)]
pub(super) struct MergingLight {
    pub(super) light: f64,
    /// Variance of its logarithm.
    pub(super) variance: f64,
}

/// Where a candidate's vehicle would be.
#[derive(Clone, Copy, Debug)]
struct Body {
    candidate: usize,
    at_m: Vector3<f64>,
    /// Along the line of sight, m^2.
    variance_m2: f64,
    reach_m: f64,
}

/// The candidates of a frame.
#[derive(Debug)]
pub(super) struct Candidates {
    all: Vec<Candidate>,
    members: Vec<usize>,
    modes: Vec<Mode>,
    merging: Vec<Merging>,
    /// Those of several observations, where they are.
    bodies: Vec<Body>,
    /// Two that have no observation in common but would be in one place, the earlier one first.
    colliding: Vec<[usize; 2]>,
    /// By observation: the last candidate of which it is the first.
    last: Vec<Option<usize>>,
    /// Groups that were weighed and are no candidate, one after the other, and where each ends.
    in_vain: Vec<usize>,
    ends_in_vain: Vec<usize>,
}

impl Candidates {
    /// None yet, with room for this many.
    pub(super) fn with_room(count: usize) -> Self {
        Self {
            all: Vec::with_capacity(count),
            members: Vec::with_capacity(8 * count),
            modes: Vec::with_capacity(MODES_EACH * count),
            merging: Vec::with_capacity(count),
            bodies: Vec::with_capacity(count),
            colliding: Vec::with_capacity(count),
            last: Vec::new(),
            in_vain: Vec::with_capacity(4 * count),
            ends_in_vain: Vec::with_capacity(count),
        }
    }

    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.members.clear();
        self.modes.clear();
        self.merging.clear();
        self.bodies.clear();
        self.colliding.clear();
        self.last.clear();
        self.in_vain.clear();
        self.ends_in_vain.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    pub(super) fn get(&self, index: usize) -> &Candidate {
        &self.all[index]
    }

    /// Its observations, ascending.
    pub(super) fn members(&self, index: usize) -> &[usize] {
        let Candidate { first_member, members, .. } = self.all[index];
        &self.members[first_member..first_member + members]
    }

    /// The ways in which its observations can be the airframe, the likeliest first.
    pub(super) fn modes(&self, index: usize) -> &[Mode] {
        let Candidate { first_mode, modes, .. } = self.all[index];
        &self.modes[first_mode..first_mode + modes]
    }

    /// Which spots that are not its own a candidate's marker may be part of.
    pub(super) fn merging(&self) -> &[Merging] {
        &self.merging
    }

    /// Candidates that have no observation in common but are not two vehicles: they would be in one place.
    pub(super) fn colliding(&self) -> &[[usize; 2]] {
        &self.colliding
    }

    /// Whether two are not two vehicles.
    pub(super) fn collide(&self, a: usize, b: usize) -> bool {
        // They were noted in the order of the later one.
        self.colliding.binary_search_by_key(&(a.max(b), a.min(b)), |&[first, second]| (second, first)).is_ok()
    }

    /// Notes that a marker of the candidate that was added last may be part of a spot that is not its own.
    pub(super) fn merge(
        &mut self,
        spot: usize,
        probability: f64,
        place_log_density: f64,
        lights: Option<(LogLight, MergingLight)>,
    ) {
        let candidate = self.all.len() - 1;
        self.merging.push(Merging { spot, candidate, probability, place_log_density, lights });
    }

    /// The candidates of just these observations, ascending: one of each kind at most.
    fn of<'a>(&'a self, group: &'a [usize]) -> impl Iterator<Item = &'a Candidate> {
        let last = group.first().and_then(|&first| self.last.get(first).copied().flatten());
        let with_first = core::iter::successors(last, |&index| self.all[index].before);
        with_first.filter(move |&index| self.members(index) == group).map(|index| &self.all[index])
    }

    /// Notes that a group was weighed.
    pub(super) fn note(&mut self, group: &[usize]) {
        if !self.was_weighed(group) {
            self.in_vain.extend_from_slice(group);
            self.ends_in_vain.push(self.in_vain.len());
        }
    }

    /// Whether just these observations, ascending, are a candidate, or were found to be none.
    pub(super) fn was_weighed(&self, group: &[usize]) -> bool {
        let mut start = 0;
        let is_it = |&end: &usize| &self.in_vain[core::mem::replace(&mut start, end)..end] == group;
        self.of(group).next().is_some() || self.ends_in_vain.iter().any(is_it)
    }

    /// Logarithm of the density of just these observations, ascending, as the likeliest kind.
    pub(super) fn log_density(&self, group: &[usize]) -> Option<f64> {
        self.of(group).map(|candidate| candidate.log_density).reduce(f64::max)
    }

    /// Whether they are one of this kind.
    pub(super) fn has_as(&self, kind: usize, group: &[usize]) -> bool {
        self.of(group).any(|candidate| candidate.kind == kind)
    }

    /// Whether these observations may be something else than one neighbour, for all that is known.
    pub(super) fn is_doubtful(&self, context: &Context<'_>, group: &[usize]) -> bool {
        let is_clear = |Candidate { log_density, misfit, worst_sigma, .. }: &Candidate| {
            context.gain(group, *log_density) > CLEAR_GAIN
                && *worst_sigma < CLEAR_SIGMAS
                && misfit.p_value() > CLEAR_P_VALUE
        };
        group.len() < 2 || !self.of(group).any(is_clear)
    }

    /// Adds a candidate.
    pub(super) fn push(&mut self, group: &[usize], modes: &[Mode], told: Told) {
        let Told {
            kind,
            bearing,
            distance,
            position,
            orientation,
            misfit,
            missed,
            tilting,
            light_spread,
            worst_sigma,
            log_density,
            reach_m,
        } = told;
        self.last.resize(self.last.len().max(group[0] + 1), None);
        let before = self.last[group[0]].replace(self.all.len());
        self.all.push(Candidate {
            kind,
            bearing,
            distance,
            position,
            orientation,
            misfit,
            missed,
            tilting,
            light_spread,
            worst_sigma,
            log_density,
            first_member: self.members.len(),
            members: group.len(),
            first_mode: self.modes.len(),
            modes: modes.len(),
            before,
        });
        self.members.extend_from_slice(group);
        self.modes.extend_from_slice(modes);
        self.note_collisions(group, reach_m);
    }

    /// Notes which candidates of several observations collide with the one of these that was added last. One spot alone does not tell where its neighbour is.
    fn note_collisions(&mut self, group: &[usize], reach_m: f64) {
        let Self { all, members, bodies, colliding, .. } = self;
        let candidate = all.len() - 1;
        let Some(Position { mean_m, covariance_m2 }) = all[candidate].position.filter(|_| group.len() > 1)
        else {
            return;
        };
        let ahead = *all[candidate].bearing.vector();
        let variance_m2 = ahead.dot(&(covariance_m2 * ahead));
        let own = Body { candidate, at_m: mean_m, variance_m2, reach_m };
        let is_apart = |other: usize| {
            let Candidate { first_member, members: count, .. } = all[other];
            let others = &members[first_member..][..count];
            group.iter().all(|spot| !others.contains(spot))
        };
        let there = bodies.iter().filter(|other| own.is_among(other, &ahead) && is_apart(other.candidate));
        colliding.extend(there.map(|other| [other.candidate, candidate]));
        bodies.push(own);
    }
}

impl Merging {
    /// Logarithm of how likely the spot is where and as bright as it is, for markers of these two candidates being in it: their lights add up.
    pub(super) fn log_density_with(&self, other: &Self) -> f64 {
        let log_light = match (self.lights, other.lights) {
            (Some((seen, own)), Some((_, others))) => {
                let both = own.light + others.light;
                let [own, others] = [own, others].map(|part| {
                    let share = part.light / both;
                    share * share * part.variance
                });
                let sigma = (seen.sigma * seen.sigma + own + others).sqrt();
                let off = (seen.value - libm::log(both)) / sigma;
                libm::log((1.0 - ODD_LIGHT) * normal::density(off, sigma) + ODD_LIGHT / LIGHT_RANGE)
            }
            _ => 0.0,
        };
        libm::log(self.probability * other.probability) + self.place_log_density + log_light
    }
}

impl Body {
    /// Whether the middle of either is more likely than not among the markers of the other, where no vehicle can be, seen in this direction.
    fn is_among(&self, other: &Self, ahead: &Vector3<f64>) -> bool {
        let gap_m = other.at_m - self.at_m;
        let reach_m = self.reach_m.max(other.reach_m);
        let room_m2 = reach_m * reach_m - gap_m.norm_squared();
        if room_m2 <= 0.0 {
            return false;
        }
        // Across the line of sight they are where they are seen.
        let along_m = gap_m.dot(ahead);
        let room_m = (room_m2 + along_m * along_m).sqrt();
        let sigma_m = (self.variance_m2 + other.variance_m2).sqrt().max(1e-9);
        let below = |limit_m: f64| normal::below((limit_m - along_m) / sigma_m);
        below(room_m) - below(-room_m) > 0.5
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::ranging::Interval;

    const REACH_M: f64 = 0.4;

    /// Of these observations, in this place, its distance known so well.
    fn push(candidates: &mut Candidates, group: &[usize], at: [f64; 3], sigma_m: f64) {
        let mean_m = Vector3::from(at);
        let ahead = mean_m.normalize();
        let covariance_m2 = Matrix3::identity() * 1e-6 + ahead * ahead.transpose() * (sigma_m * sigma_m);
        let distance =
            Distance { estimate: None, bounds: Interval::ANY, perpendicular_m: None, inline_m: None };
        let told = Told {
            kind: 0,
            bearing: Bearing::new(mean_m).unwrap(),
            distance,
            position: Some(Position { mean_m, covariance_m2 }),
            orientation: None,
            misfit: Misfit { chi_square: 0.0, degrees: 0 },
            missed: Missed::default(),
            tilting: Tilting::default(),
            light_spread: LightSpread::default(),
            worst_sigma: 0.0,
            log_density: 0.0,
            reach_m: REACH_M,
        };
        candidates.push(group, &[], told);
    }

    #[test]
    fn two_in_one_place_collide_unless_their_distances_are_hardly_known() {
        let collide = |group: &[usize], at: [f64; 3], sigma_m: f64| {
            let mut candidates = Candidates::with_room(2);
            push(&mut candidates, &[0, 1, 2], [1.0, 2.0, 7.0], 0.1);
            push(&mut candidates, group, at, sigma_m);
            assert_eq!(candidates.collide(0, 1), candidates.collide(1, 0));
            candidates.collide(1, 0)
        };
        assert!(collide(&[3, 4], [1.1, 2.0, 7.1], 0.1));
        assert!(!collide(&[2, 4], [1.1, 2.0, 7.1], 0.1), "they cannot both be anyway");
        assert!(!collide(&[4], [1.1, 2.0, 7.1], 0.1), "one spot");
        assert!(!collide(&[3, 4], [1.1, 2.0, 7.1], 1.0), "anywhere along the line of sight");
        for (gap_m, is_there) in [(0.3, true), (0.5, false)] {
            assert_eq!(collide(&[3, 4], [1.0 + gap_m, 2.0, 7.0], 0.1), is_there, "across, {gap_m} m");
            assert_eq!(collide(&[3, 4], [1.0, 2.0, 7.0 + gap_m], 0.1), is_there, "along, {gap_m} m");
        }
    }

    /// What a marker of light 2 and one of 6 make of a spot of this light, their variances being these.
    fn together(seen: f64, variances: [f64; 2]) -> f64 {
        let merging = |light: f64, variance: f64| Merging {
            spot: 0,
            candidate: 0,
            probability: 0.5,
            place_log_density: 3.0,
            lights: Some((LogLight { value: libm::log(seen), sigma: 0.1 }, MergingLight { light, variance })),
        };
        merging(2.0, variances[0]).log_density_with(&merging(6.0, variances[1]))
    }

    #[test]
    fn lights_of_two_markers_in_a_spot_add_up() {
        // By hand: a standard deviation of the sum of sqrt(2^2 0.04 + 6^2 0.09) / 8.
        let sigma = (0.01_f64 + (4.0 * 0.04 + 36.0 * 0.09) / 64.0).sqrt();
        let density = 0.98 * 0.25 * libm::exp(3.0) / (normal::ROOT_OF_TAU * sigma);
        assert!((together(8.0, [0.04, 0.09]) - libm::log(density)).abs() < 2e-2);
        // No other light is likelier, and one that fits neither is as likely as any.
        for seen in [1.0, 2.0, 4.0, 6.0, 7.0, 9.0, 16.0] {
            assert!(together(seen, [0.04, 0.09]) < together(8.0, [0.04, 0.09]));
        }
        assert!((together(1e3, [0.04, 0.09]) - together(1e6, [0.04, 0.09])).abs() < 1e-9);
        // The brighter one's doubt counts for more.
        assert!(together(12.0, [0.04, 0.25]) > together(12.0, [0.25, 0.04]));
    }

    #[test]
    fn where_light_is_not_used_any_will_do() {
        let blind = Merging { spot: 0, candidate: 0, probability: 0.5, place_log_density: 3.0, lights: None };
        assert!((blind.log_density_with(&blind) - (libm::log(0.25) + 3.0)).abs() < 1e-12);
    }
}
