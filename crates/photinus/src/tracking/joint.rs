//! What each vehicle may be seen by -> how likely each of it is, no spot being two vehicles' at once.
//!
//! A way to explain the frame takes for each vehicle one of its hypotheses, or none, so that no two share a spot. The weights of all ways are added up
//! exactly, forwards over the vehicles and backwards, by the set of spots that is taken (Y. Bar-Shalom, F. Daum, J. Huang, "The probabilistic data
//! association filter", IEEE Control Systems 29 (2009), for the events; dynamic programming in place of their list). Vehicles that have no spot in common
//! are explained apart. Of sets, the likeliest are gone on with where there are too many.

use alloc::vec::Vec;

use super::settings::Association;

/// Most sets of spots that are gone on with.
const MOST_SETS: usize = 128;

/// A set of spots, by bits.
pub(super) type Spots = u128;

/// One way in which one vehicle may be seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) vehicle: usize,
    pub(super) spots: Spots,
    /// Logarithm of its weight; that of not being seen is beside.
    pub(super) log_weight: f64,
    /// Which of all ways it is.
    pub(super) way: usize,
}

/// Room to add up in.
#[derive(Debug, Default)]
pub(super) struct Joint {
    /// Sets of taken spots before each vehicle, with their weights, one list after the other.
    forward: Vec<(Spots, f64)>,
    first: Vec<usize>,
    backward: Vec<(Spots, f64)>,
    next: Vec<(Spots, f64)>,
    taken: Vec<usize>,
    /// Spots that a vehicle may be seen by, and those that have some in common, directly or by others.
    reach: Vec<Spots>,
    together: Vec<usize>,
    /// Weights, the largest of each vehicle 1.
    weights: Vec<f64>,
    unseen_weights: Vec<f64>,
    /// How likely each choice is.
    pub(super) probability: Vec<f64>,
    /// How likely each vehicle is not seen.
    pub(super) unseen: Vec<f64>,
}

impl Joint {
    /// Tells how likely each choice is; `choices` is sorted by vehicle, `log_unseen` has the logarithm of the weight of not being seen, by vehicle.
    pub(super) fn explain(&mut self, choices: &[Choice], log_unseen: &[f64], association: Association) {
        self.probability.clear();
        self.probability.resize(choices.len(), 0.0);
        self.unseen.clear();
        self.unseen.resize(log_unseen.len(), 1.0);
        self.scale(choices, log_unseen);
        match association {
            Association::Joint => self.explain_parts(choices),
            Association::Nearest => self.take_the_best(choices),
        }
    }

    fn scale(&mut self, choices: &[Choice], log_unseen: &[f64]) {
        self.weights.clear();
        self.unseen_weights.clear();
        for (vehicle, &unseen) in log_unseen.iter().enumerate() {
            let own = choices.iter().filter(|choice| choice.vehicle == vehicle);
            let best = own.clone().map(|choice| choice.log_weight).fold(unseen, f64::max);
            self.weights.extend(own.map(|choice| libm::exp(choice.log_weight - best)));
            self.unseen_weights.push(libm::exp(unseen - best));
        }
    }

    /// Explains apart what has no spot in common.
    fn explain_parts(&mut self, choices: &[Choice]) {
        self.reach.clear();
        self.reach.resize(self.unseen.len(), 0);
        for choice in choices {
            self.reach[choice.vehicle] |= choice.spots;
        }
        for first in 0..self.reach.len() {
            let mut spots = self.reach[first];
            if spots == 0 {
                continue;
            }
            self.together.clear();
            self.together.push(first);
            self.reach[first] = 0;
            while let Some(next) = self.reach.iter().position(|own| own & spots != 0) {
                spots |= self.reach[next];
                self.reach[next] = 0;
                self.together.push(next);
            }
            self.together.sort_unstable();
            self.add_up(choices);
        }
    }

    /// Adds up all ways of the vehicles that are together.
    fn add_up(&mut self, choices: &[Choice]) {
        let of = |vehicle: usize| {
            let first = choices.partition_point(|choice| choice.vehicle < vehicle);
            first..choices.partition_point(|choice| choice.vehicle <= vehicle)
        };
        let Self {
            forward,
            first,
            backward,
            next,
            together,
            weights,
            unseen_weights,
            probability,
            unseen,
            ..
        } = self;
        forward.clear();
        first.clear();
        forward.push((0, 1.0));
        first.push(0);
        for (place, &vehicle) in together.iter().enumerate() {
            let (own, from) = (of(vehicle), &forward[first[place]..]);
            first.push(forward.len());
            extend(from, &choices[own.clone()], &weights[own], unseen_weights[vehicle], next);
            forward.extend_from_slice(next);
        }
        backward.clear();
        backward.push((0, 1.0));
        for (place, &vehicle) in together.iter().enumerate().rev() {
            let before = &forward[first[place]..first[place + 1]];
            let none = unseen_weights[vehicle] * ways(before, 0, backward);
            let mut total = none;
            for index in of(vehicle) {
                probability[index] = weights[index] * ways(before, choices[index].spots, backward);
                total += probability[index];
            }
            // Of very many sets so few are gone on with that none may fit: then nothing is said of this vehicle.
            let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
            of(vehicle).for_each(|index| probability[index] *= scale);
            unseen[vehicle] = if total > 0.0 { none * scale } else { 1.0 };
            let own = of(vehicle);
            extend(backward, &choices[own.clone()], &weights[own], unseen_weights[vehicle], next);
            core::mem::swap(backward, next);
        }
    }

    /// The likeliest choice of each vehicle, the clearest first, each spot once.
    fn take_the_best(&mut self, choices: &[Choice]) {
        let Self { taken, weights, unseen_weights, probability, unseen, .. } = self;
        taken.clear();
        taken.extend(0..choices.len());
        let odds = |index: usize| weights[index] / unseen_weights[choices[index].vehicle];
        taken.sort_unstable_by(|&a, &b| odds(b).total_cmp(&odds(a)).then(a.cmp(&b)));
        let mut spots: Spots = 0;
        for &index in taken.iter() {
            let Choice { vehicle, spots: own, .. } = choices[index];
            if unseen[vehicle] > 0.0 && own & spots == 0 && odds(index) > 1.0 {
                spots |= own;
                unseen[vehicle] = 0.0;
                probability[index] = 1.0;
            }
        }
    }
}

/// Weight of all ways that are disjoint with `own`.
fn ways(before: &[(Spots, f64)], own: Spots, after: &[(Spots, f64)]) -> f64 {
    let fits = before.iter().filter(|(spots, _)| spots & own == 0);
    fits.map(|(taken, weight)| {
        let rest = after.iter().filter(|(spots, _)| spots & (own | taken) == 0);
        weight * rest.map(|(_, weight)| weight).sum::<f64>()
    })
    .sum()
}

/// Goes on with every set by one vehicle.
fn extend(
    from: &[(Spots, f64)],
    choices: &[Choice],
    weights: &[f64],
    unseen: f64,
    to: &mut Vec<(Spots, f64)>,
) {
    to.clear();
    for &(taken, weight) in from {
        add(to, taken, weight * unseen);
        for (choice, own) in choices.iter().zip(weights) {
            if choice.spots & taken == 0 {
                add(to, taken | choice.spots, weight * own);
            }
        }
    }
    to.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    to.truncate(MOST_SETS);
    // Far down the weights would vanish.
    if let Some(&(_, most)) = to.first().filter(|(_, most)| *most > 0.0) {
        to.iter_mut().for_each(|(_, weight)| *weight /= most);
    }
}

fn add(to: &mut Vec<(Spots, f64)>, spots: Spots, weight: f64) {
    match to.iter_mut().find(|(own, _)| *own == spots) {
        Some((_, sum)) => *sum += weight,
        None => to.push((spots, weight)),
    }
}
