//! Candidates and clutter -> how likely each is, all of the frame explained together.
//!
//! An explanation of a frame takes some candidates that share no observation; what is left is clutter. Its weight is the product of the densities.
//! What has no candidate in common is explained apart; in each such part the weights of *all* explanations are added up (dynamic programming over
//! subsets, as bit masks), which gives the probability of every candidate, and of every observation to be clutter.
//!
//! A spot in which markers of two neighbours merge is neither's: it lies between them, and would pull either away. Two candidates without it that each have a
//! marker there explain it together.
//!
//! Two vehicles are never in one place: candidates that would be claim that place as if it were one more observation, which only one of them can have.

use alloc::vec::Vec;

use super::candidates::{Candidates, Merging};

/// Most observations that are explained together.
const MOST_TOGETHER: usize = 12;
/// A candidate whose gain over clutter is this much less than that of another it shares an observation with is left out, nats; the
/// next is tried where too much hangs together.
const HOPELESS: [f64; 5] = [25.0, 14.0, 8.0, 4.0, 0.0];
/// Gains over clutter are cut off here, nats per observation, so that numbers stay finite: no candidate comes near it.
const LARGEST_GAIN: f64 = 55.0;

/// How likely candidates are.
#[derive(Debug)]
pub(super) struct Explanation {
    /// By candidate.
    probability: Vec<f64>,
    /// By observation.
    clutter: Vec<f64>,
    gains: Vec<f64>,
    /// The largest gain of a candidate with this observation.
    best: Vec<f64>,
    left: Vec<usize>,
    roots: Vec<usize>,
    /// Whether an observation is one of a candidate's that is left.
    claimed: Vec<bool>,
    spots: Vec<usize>,
    merging: Vec<Merging>,
    shared: Vec<Shared>,
    left_shared: Vec<usize>,
    left_colliding: Vec<[usize; 2]>,
    is_left: Vec<bool>,
    options: Vec<Choice>,
    sums: Vec<f64>,
    ways: Vec<f64>,
    done: Vec<bool>,
    /// By observation: the candidate that has it, better than clutter, which gains most for each of its members, and that gain.
    held: Vec<Option<(f64, usize)>>,
    log_gain: f64,
}

/// A candidate within a part of the frame.
#[derive(Clone, Copy, Debug)]
struct Choice {
    candidate: usize,
    /// The other one, where two share a spot.
    with: Option<usize>,
    mask: usize,
    weight: f64,
}

/// Two candidates and the spot that a marker of each is part of.
#[derive(Clone, Copy, Debug)]
struct Shared {
    candidates: [usize; 2],
    spot: usize,
    gain: f64,
}

impl Explanation {
    /// Nothing yet, with room for this many candidates and the largest part.
    pub(super) fn with_room(count: usize) -> Self {
        Self {
            probability: Vec::with_capacity(count),
            clutter: Vec::new(),
            gains: Vec::with_capacity(count),
            best: Vec::new(),
            left: Vec::with_capacity(count),
            roots: Vec::new(),
            claimed: Vec::new(),
            spots: Vec::with_capacity(512),
            merging: Vec::with_capacity(count),
            shared: Vec::with_capacity(count),
            left_shared: Vec::with_capacity(count),
            left_colliding: Vec::with_capacity(count),
            is_left: Vec::with_capacity(count),
            options: Vec::with_capacity(count),
            sums: Vec::with_capacity(1 << MOST_TOGETHER),
            ways: Vec::with_capacity(1 << MOST_TOGETHER),
            done: Vec::new(),
            held: Vec::new(),
            log_gain: 0.0,
        }
    }

    /// How likely a candidate is a neighbour, just of its observations.
    pub(super) fn probability(&self, candidate: usize) -> f64 {
        self.probability[candidate]
    }

    /// How likely an observation is clutter.
    pub(super) fn clutter(&self, observation: usize) -> f64 {
        self.clutter[observation]
    }

    /// Finds the best candidate of each observation, for [`Self::held`].
    pub(super) fn hold(&mut self, candidates: &Candidates) {
        self.held.clear();
        self.held.resize(self.clutter.len(), None);
        for (index, &gain) in self.gains.iter().enumerate() {
            let members = candidates.members(index);
            let each = gain / members.len() as f64;
            for &spot in members {
                if each > self.held[spot].map_or(0.0, |(most, _)| most) {
                    self.held[spot] = Some((each, index));
                }
            }
        }
    }

    /// What the best candidates of a handful's observations gain over clutter, nats, less what the observations that they would lose to it may gain without
    /// them: at most as much each as before, and one that is left alone nothing.
    pub(super) fn held(&self, candidates: &Candidates, handful: &[usize]) -> f64 {
        let mut held = 0.0;
        for (place, &spot) in handful.iter().enumerate() {
            let Some((each, holder)) = self.held[spot] else { continue };
            let is_same = |before: &usize| self.held[*before].is_some_and(|(_, other)| other == holder);
            if handful[..place].iter().any(is_same) {
                continue;
            }
            let members = candidates.members(holder);
            let taken = members.iter().filter(|member| handful.contains(member)).count();
            let lost = if members.len() - taken == 1 { members.len() } else { taken };
            held += each * lost as f64;
        }
        held
    }

    /// Logarithm of the density of all observations, where each has this one as clutter.
    pub(super) fn log_density(&self, clutter_log_density: &[f64]) -> f64 {
        self.log_gain + clutter_log_density.iter().sum::<f64>()
    }

    /// How many neighbours the frame has.
    pub(super) fn neighbours(&self) -> f64 {
        self.probability.iter().sum()
    }

    /// Supposes how likely each of so many observations is clutter.
    pub(super) fn suppose(&mut self, observations: usize, share: impl Fn(usize) -> f64) {
        self.clutter.clear();
        self.clutter.extend((0..observations).map(share));
    }

    /// Explains a frame of which each observation has the logarithm of its density as clutter, and neighbours have one per sr that may depend on how likely, as was supposed
    /// or explained before, one of them has a candidate's observations already.
    pub(super) fn explain(
        &mut self,
        candidates: &Candidates,
        clutter_log_density: &[f64],
        log_neighbours: impl Fn(f64) -> f64,
    ) {
        let count = clutter_log_density.len();
        self.probability.clear();
        self.probability.resize(candidates.len(), 0.0);
        // Whether its holders are asked for differs from frame to frame, but not the room for them.
        self.held.clear();
        self.held.resize(count, None);
        self.gains.clear();
        self.gains.extend((0..candidates.len()).map(|index| {
            let members = candidates.members(index);
            let clutter: f64 = members.iter().map(|&spot| clutter_log_density[spot]).sum();
            let own = members.iter().map(|&spot| 1.0 - self.clutter[spot]).fold(0.0, f64::max);
            let gain = candidates.get(index).log_density + log_neighbours(own) - clutter;
            if gain.is_nan() { f64::NEG_INFINITY } else { gain.min(LARGEST_GAIN * members.len() as f64) }
        }));
        self.clutter.fill(1.0);
        self.share(candidates, clutter_log_density);
        self.log_gain = 0.0;
        self.done.clear();
        self.done.resize(count, false);
        for (round, &hopeless) in HOPELESS.iter().enumerate() {
            self.leave_out(candidates, count, hopeless);
            self.join(candidates, count);
            self.sort_into_parts(candidates);
            let last = round + 1 == HOPELESS.len();
            let spots = core::mem::take(&mut self.spots);
            let mut rest = &spots[..];
            while let Some(&first) = rest.first() {
                let of_part = |&spot: &usize| self.roots[spot] == self.roots[first];
                let (part, others) = rest.split_at(rest.partition_point(of_part));
                self.explain_part(candidates, part, last);
                rest = others;
            }
            self.spots = spots;
            if self.spots.iter().all(|&spot| self.done[spot]) {
                break;
            }
        }
    }

    /// Finds the pairs of candidates that explain a spot together.
    fn share(&mut self, candidates: &Candidates, clutter_log_density: &[f64]) {
        let Self { merging, shared, gains, .. } = self;
        merging.clear();
        merging.extend_from_slice(candidates.merging());
        merging.sort_unstable_by_key(|own| (own.spot, own.candidate));
        shared.clear();
        for (place, one) in merging.iter().enumerate() {
            let Merging { spot, candidate, .. } = *one;
            for other in merging[place + 1..].iter().take_while(|other| other.spot == spot) {
                let [own, others] = [candidate, other.candidate].map(|index| candidates.members(index));
                let both = one.log_density_with(other) - clutter_log_density[spot];
                let gain = gains[candidate] + gains[other.candidate] + both;
                let is_apart = own.iter().all(|member| !others.contains(member));
                if both > 0.0 && gain > 0.0 && is_apart && !candidates.collide(candidate, other.candidate) {
                    shared.push(Shared { candidates: [candidate, other.candidate], spot, gain });
                }
            }
        }
    }

    /// Leaves out candidates that others beat by this much wherever they are, and those of what is done.
    fn leave_out(&mut self, candidates: &Candidates, count: usize, hopeless: f64) {
        self.best.clear();
        self.best.resize(count, 0.0);
        for (index, &gain) in self.gains.iter().enumerate() {
            for &spot in candidates.members(index) {
                self.best[spot] = self.best[spot].max(gain);
            }
        }
        self.left.clear();
        let Self { best, gains, left, done, .. } = self;
        left.extend((0..gains.len()).filter(|&index| {
            let members = candidates.members(index);
            let rival = members.iter().map(|&spot| best[spot]).fold(0.0, f64::max);
            gains[index] >= rival - hopeless && members.iter().all(|&spot| !done[spot])
        }));
        self.is_left.clear();
        self.is_left.resize(self.gains.len(), false);
        for &index in &self.left {
            self.is_left[index] = true;
        }
        let Self { best, shared, left_shared, is_left, done, .. } = self;
        left_shared.clear();
        left_shared.extend((0..shared.len()).filter(|&index| {
            let own = &shared[index];
            let rival = own.spots(candidates).map(|spot| best[spot]).fold(0.0, f64::max);
            own.gain >= rival - hopeless
                && !done[own.spot]
                && own.candidates.iter().all(|&candidate| is_left[candidate])
        }));
        let Self { gains, left_colliding, is_left, .. } = self;
        left_colliding.clear();
        // What is no likelier than clutter is hardly one of two.
        let counts = |candidate: &usize| is_left[*candidate] && gains[*candidate] > 0.0;
        left_colliding.extend(candidates.colliding().iter().filter(|both| both.iter().all(counts)));
        let gain = |[a, b]: &[usize; 2]| gains[*a] + gains[*b];
        left_colliding.sort_unstable_by(|a, b| gain(b).total_cmp(&gain(a)).then(a.cmp(b)));
    }

    /// Joins the observations that candidates have in common.
    fn join(&mut self, candidates: &Candidates, count: usize) {
        self.roots.clear();
        self.roots.extend(0..count);
        self.claimed.clear();
        self.claimed.resize(count, false);
        for &index in &self.left {
            let members = candidates.members(index);
            for &spot in members {
                self.claimed[spot] = true;
                tie(&mut self.roots, members[0], spot);
            }
        }
        for &index in &self.left_shared {
            let own = self.shared[index];
            self.claimed[own.spot] = true;
            own.spots(candidates).for_each(|spot| tie(&mut self.roots, own.spot, spot));
        }
        for both in &self.left_colliding {
            let [first, second] = both.map(|index| candidates.members(index)[0]);
            tie(&mut self.roots, first, second);
        }
        for spot in 0..count {
            self.roots[spot] = root(&mut self.roots, spot);
        }
    }

    /// Sorts what is not done yet, so that what hangs together is together. What no candidate claims is clutter, as it began.
    fn sort_into_parts(&mut self, candidates: &Candidates) {
        let Self { spots, left, left_shared, shared, roots, done, claimed, .. } = self;
        spots.clear();
        spots.extend((0..roots.len()).filter(|&spot| claimed[spot] && !done[spot]));
        spots.sort_unstable_by_key(|&spot| (roots[spot], spot));
        left.sort_unstable_by_key(|&index| (roots[candidates.members(index)[0]], index));
        left_shared.sort_unstable_by_key(|&index| (roots[shared[index].spot], index));
    }

    /// Explains a part of a frame; if it is too large, only what is certain to be the `last` try.
    fn explain_part(&mut self, candidates: &Candidates, spots: &[usize], last: bool) {
        if spots.len() > MOST_TOGETHER && !last {
            return;
        }
        let Self { options, left, left_shared, left_colliding, shared, gains, roots, .. } = self;
        let part = |index: usize| roots[candidates.members(index)[0]];
        let first = left.partition_point(|&index| part(index) < roots[spots[0]]);
        let own = left[first..].iter().take_while(|&&index| part(index) == roots[spots[0]]);
        options.clear();
        options.extend(own.map(|&candidate| Choice { candidate, with: None, mask: 0, weight: 0.0 }));
        if spots.len() > MOST_TOGETHER {
            self.take_the_best(candidates);
            return;
        }
        for choice in options.iter_mut() {
            choice.mask = mask_of(spots, candidates.members(choice.candidate).iter().copied());
            choice.weight = gains[choice.candidate];
        }
        let own = left_colliding.iter().filter(|both| part(both[0]) == roots[spots[0]]);
        let places = claim_places(own, options, spots.len(), candidates);
        let first = left_shared.partition_point(|&index| roots[shared[index].spot] < roots[spots[0]]);
        for &index in
            left_shared[first..].iter().take_while(|&&index| roots[shared[index].spot] == roots[spots[0]])
        {
            let own = &shared[index];
            let [candidate, with] = own.candidates;
            let place_of = |candidate: usize| {
                options.iter().find(|choice| choice.candidate == candidate).map_or(0, |choice| choice.mask)
            };
            let mask = mask_of(spots, own.spots(candidates)) | place_of(candidate) | place_of(with);
            options.push(Choice { candidate, with: Some(with), mask, weight: own.gain });
        }
        let of_spots = (1 << spots.len()) - 1;
        let count = |choice: &Choice| f64::from((choice.mask & of_spots).count_ones());
        let scale = options.iter().map(|choice| choice.weight / count(choice)).fold(0.0, f64::max);
        for choice in options.iter_mut() {
            choice.weight = libm::exp(choice.weight - scale * count(choice));
        }
        options.sort_unstable_by_key(|choice| (choice.mask.trailing_zeros(), choice.candidate, choice.with));
        self.add_up(spots, places, scale);
    }

    /// Adds up the weights of all explanations of a part: forwards the weight of what is left, backwards the ways to come there. What is explained next
    /// is the first observation that is left. Weights are those over clutter, less so many nats for each observation; a place that nobody has costs nothing.
    fn add_up(&mut self, spots: &[usize], places: usize, scale: f64) {
        let Self { options, sums, ways, probability, clutter, done, log_gain, .. } = self;
        let mut of_first = [0; MOST_TOGETHER + 1];
        for (first, end) in of_first.iter_mut().enumerate() {
            *end = options.partition_point(|choice| (choice.mask.trailing_zeros() as usize) < first);
        }
        let choices = |mask: usize| {
            let first = mask.trailing_zeros() as usize;
            options[of_first[first]..of_first[first + 1]]
                .iter()
                .filter(move |choice| choice.mask & !mask == 0)
        };
        let all = (1usize << (spots.len() + places)) - 1;
        let clutter_alone = libm::exp(-scale);
        let alone =
            |mask: usize| if (mask.trailing_zeros() as usize) < spots.len() { clutter_alone } else { 1.0 };
        sums.clear();
        sums.push(1.0);
        for mask in 1..=all {
            let rest = mask & (mask - 1);
            let taken: f64 = choices(mask).map(|choice| choice.weight * sums[mask & !choice.mask]).sum();
            sums.push(alone(mask) * sums[rest] + taken);
        }
        ways.clear();
        ways.resize(all + 1, 0.0);
        ways[all] = 1.0;
        let total = sums[all];
        *log_gain += libm::log(total) + scale * spots.len() as f64;
        for &spot in spots {
            clutter[spot] = 0.0;
            done[spot] = true;
        }
        for mask in (1..=all).rev() {
            let here = ways[mask];
            if here == 0.0 {
                continue;
            }
            let rest = mask & (mask - 1);
            ways[rest] += here * alone(mask);
            if let Some(&spot) = spots.get(mask.trailing_zeros() as usize) {
                clutter[spot] += here * alone(mask) * (sums[rest] / total);
            }
            for choice in choices(mask) {
                let rest = mask & !choice.mask;
                ways[rest] += here * choice.weight;
                let share = here * choice.weight * (sums[rest] / total);
                probability[choice.candidate] += share;
                if let Some(with) = choice.with {
                    probability[with] += share;
                }
            }
        }
    }

    /// Where too much hangs together to weigh it all: the best candidates that share nothing, each against clutter alone.
    fn take_the_best(&mut self, candidates: &Candidates) {
        let Self { options, gains, probability, clutter, done, log_gain, .. } = self;
        options.sort_unstable_by(|a, b| {
            gains[b.candidate].total_cmp(&gains[a.candidate]).then(a.candidate.cmp(&b.candidate))
        });
        for (place, Choice { candidate, .. }) in options.iter().enumerate() {
            let members = candidates.members(*candidate);
            let is_there = |before: &Choice| {
                probability[before.candidate] > 0.5 && candidates.collide(before.candidate, *candidate)
            };
            if members.iter().any(|&spot| done[spot]) || options[..place].iter().any(is_there) {
                continue;
            }
            let gain = gains[*candidate];
            probability[*candidate] = 1.0 / (1.0 + libm::exp(-gain));
            *log_gain += gain.max(0.0) + libm::log1p(libm::exp(-gain.abs()));
            for &spot in members {
                clutter[spot] = 1.0 / (1.0 + libm::exp(gain));
                done[spot] = true;
            }
        }
    }
}

impl Shared {
    /// The observations of both, and the one that they share.
    fn spots<'a>(&self, candidates: &'a Candidates) -> impl Iterator<Item = usize> + use<'a> {
        let [first, second] = self.candidates.map(|index| candidates.members(index).iter().copied());
        first.chain(second).chain([self.spot])
    }
}

/// Gives each place that two candidates of a part would be in a bit after those of its `spots`, as far as there is room, and to all in it that could not be there
/// together. Returns how many places there are.
fn claim_places<'a>(
    colliding: impl Iterator<Item = &'a [usize; 2]>,
    options: &mut [Choice],
    spots: usize,
    candidates: &Candidates,
) -> usize {
    let mut places = 0;
    for &[a, b] in colliding {
        let find = |candidate: usize| options.iter().position(|choice| choice.candidate == candidate);
        let (Some(a), Some(b)) = (find(a), find(b)) else { continue };
        if options[a].mask & options[b].mask != 0 {
            continue;
        }
        let may_enter = |new: usize, place: usize| {
            let mut within = options.iter().filter(|choice| choice.mask >> place & 1 == 1);
            within.all(|choice| candidates.collide(choice.candidate, options[new].candidate))
        };
        let known = (spots..spots + places).find_map(|place| {
            let has = |option: usize| options[option].mask >> place & 1 == 1;
            match (has(a), has(b)) {
                (true, false) if may_enter(b, place) => Some((b, place)),
                (false, true) if may_enter(a, place) => Some((a, place)),
                _ => None,
            }
        });
        if let Some((new, place)) = known {
            options[new].mask |= 1 << place;
        } else if spots + places < MOST_TOGETHER {
            let place = 1 << (spots + places);
            options[a].mask |= place;
            options[b].mask |= place;
            places += 1;
        }
    }
    places
}

/// Which of the spots of a part, ascending, these are, as bits.
fn mask_of(spots: &[usize], own: impl Iterator<Item = usize>) -> usize {
    own.map(|spot| spots.binary_search(&spot).map_or(0, |bit| 1 << bit)).sum()
}

/// Puts two spots, and all that hangs together with either, together.
fn tie(roots: &mut [usize], a: usize, b: usize) {
    let [a, b] = [a, b].map(|spot| root(roots, spot));
    roots[a.max(b)] = a.min(b);
}

fn root(roots: &mut [usize], mut spot: usize) -> usize {
    while roots[spot] != spot {
        roots[spot] = roots[roots[spot]];
        spot = roots[spot];
    }
    spot
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::candidates::Told;
    use super::super::neighbour::Distance;
    use super::*;
    use crate::camera::Bearing;
    use crate::locator::neighbour::Position;
    use crate::pose::{LightSpread, Misfit, Missed, Tilting};
    use crate::ranging::Interval;

    /// Observations of a part that is explained at once.
    const SPOTS: usize = 7;

    /// Of these observations and densities, in these places.
    fn candidates(of: &[(Vec<usize>, f64)], places: &[f64], merging: &[(usize, usize, f64)]) -> Candidates {
        let mut candidates = Candidates::with_room(of.len());
        candidates.clear();
        for (index, (members, log_density)) in of.iter().enumerate() {
            let bearing = Bearing::new(nalgebra::Vector3::z()).unwrap();
            let distance =
                Distance { estimate: None, bounds: Interval::ANY, perpendicular_m: None, inline_m: None };
            let misfit = Misfit { chi_square: 0.0, degrees: 0 };
            let told = Told {
                kind: index,
                bearing,
                distance,
                position: places.get(index).map(|&z| Position {
                    mean_m: nalgebra::Vector3::new(0.0, 0.0, z),
                    covariance_m2: nalgebra::Matrix3::identity() * 1e-4,
                }),
                orientation: None,
                misfit,
                missed: Missed::default(),
                tilting: Tilting::default(),
                light_spread: LightSpread::default(),
                worst_sigma: 0.0,
                log_density: *log_density,
                reach_m: ROOM_M,
            };
            candidates.push(members, &[], told);
            for &(_, spot, probability) in
                merging.iter().filter(|own| own.0 == index && !members.contains(&own.1))
            {
                candidates.merge(spot, probability, MERGED, None);
            }
        }
        candidates
    }

    /// Candidates that are nearer to each other are in one place.
    const ROOM_M: f64 = 1.0;

    /// The logarithm of the density of a spot in which two markers are.
    const MERGED: f64 = 1.0;

    /// The weights of all explanations, one by one: of all, of those with each candidate, and of those in which each spot is clutter.
    struct Weights {
        all: f64,
        with: Vec<f64>,
        clutter: Vec<f64>,
    }

    /// Goes on with an explanation that has these candidates and pairs of them, by what comes from `next` on.
    fn explain_one_by_one(
        choices: &[(Vec<usize>, Vec<usize>, f64)],
        collide: &dyn Fn(usize, usize) -> bool,
        next: usize,
        (taken, by, weight): (&mut Vec<usize>, &mut Vec<usize>, f64),
        weights: &mut Weights,
    ) {
        let Some((members, of, own)) = choices.get(next) else {
            weights.all += weight;
            by.iter().for_each(|&candidate| weights.with[candidate] += weight);
            (0..SPOTS).filter(|spot| !taken.contains(spot)).for_each(|spot| weights.clutter[spot] += weight);
            return;
        };
        explain_one_by_one(choices, collide, next + 1, (taken, by, weight), weights);
        let is_there = of.iter().any(|&own| by.iter().any(|&other| collide(own, other)));
        if members.iter().all(|spot| !taken.contains(spot)) && !is_there {
            let before = (taken.len(), by.len());
            taken.extend(members);
            by.extend(of);
            explain_one_by_one(choices, collide, next + 1, (taken, by, weight * own), weights);
            taken.truncate(before.0);
            by.truncate(before.1);
        }
    }

    proptest! {
        #[test]
        fn probabilities_are_those_of_all_explanations_one_by_one(
            of in prop::collection::vec((1_usize..1 << SPOTS, -2.0_f64..6.0), 1..7),
            places in prop::collection::vec(0.0_f64..8.0, 6),
            merging in prop::collection::vec((0_usize..6, 0_usize..SPOTS, 0.05_f64..1.0), 0..8),
            density in -6.0_f64..0.0,
        ) {
            let members = |mask: usize| (0..SPOTS).filter(|spot| mask >> spot & 1 == 1).collect::<Vec<_>>();
            let of: Vec<(Vec<usize>, f64)> = of.into_iter().map(|(mask, gain)| {
                let own = members(mask);
                let log_density = gain + density * own.len() as f64;
                (own, log_density)
            }).collect();
            let candidates = candidates(&of, &places, &merging);
            let clutter = [density; SPOTS];
            let mut choices: Vec<(Vec<usize>, Vec<usize>, f64)> = Vec::new();
            let gain = |index: usize| of[index].1 - density * of[index].0.len() as f64;
            let are_in_one_place = |a: usize, b: usize| {
                [a, b].iter().all(|&index| of[index].0.len() > 1) && (places[a] - places[b]).abs() < ROOM_M
            };
            // What is no likelier than clutter claims no place.
            let collide = |a: usize, b: usize| are_in_one_place(a, b) && gain(a) > 0.0 && gain(b) > 0.0;
            for (index, (own, _)) in of.iter().enumerate() {
                choices.push((own.clone(), vec![index], libm::exp(gain(index))));
            }
            for (place, first) in candidates.merging().iter().enumerate() {
                for second in candidates.merging()[place + 1..].iter().filter(|second| second.spot == first.spot) {
                    let (a, b) = (first.candidate, second.candidate);
                    let both = libm::log(first.probability * second.probability) + MERGED - density;
                    let is_apart = a != b && of[a].0.iter().all(|spot| !of[b].0.contains(spot));
                    if is_apart && !are_in_one_place(a, b) && both > 0.0 && gain(a) + gain(b) + both > 0.0 {
                        let own = [&of[a].0[..], &of[b].0, &[first.spot]].concat();
                        choices.push((own, vec![a, b], libm::exp(gain(a) + gain(b) + both)));
                    }
                }
            }
            let mut weights = Weights { all: 0.0, with: vec![0.0; of.len()], clutter: vec![0.0; SPOTS] };
            explain_one_by_one(&choices, &collide, 0, (&mut Vec::new(), &mut Vec::new(), 1.0), &mut weights);
            let mut explanation = Explanation::with_room(of.len());
            explanation.suppose(SPOTS, |_| 1.0);
            explanation.explain(&candidates, &clutter, |_| 0.0);
            for index in 0..of.len() {
                let expected = weights.with[index] / weights.all;
                prop_assert!((explanation.probability(index) - expected).abs() < 1e-9, "{index}: {} {expected}", explanation.probability(index));
            }
            for spot in 0..SPOTS {
                prop_assert!((explanation.clutter(spot) - weights.clutter[spot] / weights.all).abs() < 1e-9);
            }
            prop_assert!((explanation.log_density(&clutter) - libm::log(weights.all) - density * SPOTS as f64).abs() < 1e-9);
        }
    }
}
