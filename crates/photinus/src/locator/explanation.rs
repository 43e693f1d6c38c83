//! Candidates and clutter -> how likely each is, all of the frame explained together.
//!
//! An explanation of a frame takes some candidates that share no observation; what is left is clutter. Its weight is the product of the densities.
//! What has no candidate in common is explained apart; in each such part the weights of *all* explanations are added up (dynamic programming over
//! subsets, as bit masks), which gives the probability of every candidate, and of every observation to be clutter.

use super::candidates::Candidates;

/// Most observations that are explained together.
const MOST_TOGETHER: usize = 12;
/// A candidate whose gain over clutter is so much less than that of another it shares an observation with is left out, nats; the
/// next is tried where too much hangs together.
const HOPELESS: [f64; 5] = [25.0, 14.0, 8.0, 4.0, 0.0];
/// Gains over clutter are cut off here, nats: surer is not told, and numbers stay finite.
const LARGEST_GAIN: f64 = 50.0;

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
    spots: Vec<usize>,
    options: Vec<Choice>,
    sums: Vec<f64>,
    ways: Vec<f64>,
    done: Vec<bool>,
    log_gain: f64,
}

/// A candidate within a part of the frame.
#[derive(Clone, Copy, Debug)]
struct Choice {
    candidate: usize,
    mask: usize,
    odds: f64,
}

impl Explanation {
    /// Nothing yet, with room for so many candidates and the largest part.
    pub(super) fn with_room(count: usize) -> Self {
        Self {
            probability: Vec::with_capacity(count),
            clutter: Vec::new(),
            gains: Vec::with_capacity(count),
            best: Vec::new(),
            left: Vec::with_capacity(count),
            roots: Vec::new(),
            spots: Vec::with_capacity(512),
            options: Vec::with_capacity(count),
            sums: Vec::with_capacity(1 << MOST_TOGETHER),
            ways: Vec::with_capacity(1 << MOST_TOGETHER),
            done: Vec::new(),
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

    /// Logarithm of the density of all observations, where each has this one as clutter.
    pub(super) fn log_density(&self, clutter_log_density: &[f64]) -> f64 {
        self.log_gain + clutter_log_density.iter().sum::<f64>()
    }

    /// How many neighbours the frame has.
    pub(super) fn neighbours(&self) -> f64 {
        self.probability.iter().sum()
    }

    /// Explains a frame of which each observation has the logarithm of its density as clutter, and neighbours have one per sr.
    pub(super) fn explain(
        &mut self,
        candidates: &Candidates,
        clutter_log_density: &[f64],
        log_neighbours: f64,
    ) {
        let count = clutter_log_density.len();
        self.probability.clear();
        self.probability.resize(candidates.len(), 0.0);
        self.clutter.clear();
        self.clutter.resize(count, 1.0);
        self.gains.clear();
        self.gains.extend((0..candidates.len()).map(|index| {
            let clutter: f64 = candidates.members(index).iter().map(|&spot| clutter_log_density[spot]).sum();
            let gain = candidates.get(index).log_density + log_neighbours - clutter;
            if gain.is_nan() { f64::NEG_INFINITY } else { gain.min(LARGEST_GAIN) }
        }));
        self.log_gain = 0.0;
        self.done.clear();
        self.done.resize(count, false);
        for (round, &hopeless) in HOPELESS.iter().enumerate() {
            self.leave_out(candidates, count, hopeless);
            self.join(candidates, count);
            let last = round + 1 == HOPELESS.len();
            for root in 0..count {
                if self.roots[root] == root && !self.done[root] {
                    self.explain_part(candidates, root, last);
                }
            }
        }
    }

    /// Leaves out candidates that others beat by so much wherever they are, and those of what is done.
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
    }

    /// Joins the observations that candidates have in common.
    fn join(&mut self, candidates: &Candidates, count: usize) {
        self.roots.clear();
        self.roots.extend(0..count);
        for &index in &self.left {
            let members = candidates.members(index);
            for &spot in members {
                let [a, b] = [members[0], spot].map(|spot| root(&mut self.roots, spot));
                self.roots[a.max(b)] = a.min(b);
            }
        }
        for spot in 0..count {
            self.roots[spot] = root(&mut self.roots, spot);
        }
    }

    /// Explains the part of a frame whose first observation is `first`; if it is too large, only what is certain to be the `last` try.
    fn explain_part(&mut self, candidates: &Candidates, first: usize, last: bool) {
        self.spots.clear();
        self.spots.extend((first..self.roots.len()).filter(|&spot| self.roots[spot] == first));
        if self.spots.len() > MOST_TOGETHER && !last {
            return;
        }
        self.options.clear();
        let Self { options, spots, left, gains, roots, .. } = self;
        options.extend(
            left.iter()
                .filter(|&&index| roots[candidates.members(index)[0]] == first)
                .map(|&candidate| Choice { candidate, mask: 0, odds: libm::exp(gains[candidate]) }),
        );
        if spots.len() > MOST_TOGETHER {
            self.take_the_best(candidates);
            return;
        }
        for choice in options.iter_mut() {
            let bit = |spot: &usize| spots.iter().position(|own| own == spot).map_or(0, |bit| 1 << bit);
            choice.mask = candidates.members(choice.candidate).iter().map(bit).sum();
        }
        self.add_up();
    }

    /// Adds up the weights of all explanations of a part: forwards the weight of what is left, backwards the ways to come there.
    fn add_up(&mut self) {
        let Self { spots, options, sums, ways, probability, clutter, done, log_gain, .. } = self;
        let all = (1usize << spots.len()) - 1;
        sums.clear();
        sums.push(1.0);
        for mask in 1..=all {
            let first = mask & mask.wrapping_neg();
            let fits = |choice: &&Choice| choice.mask & first != 0 && choice.mask & !mask == 0;
            let taken: f64 =
                options.iter().filter(fits).map(|choice| choice.odds * sums[mask & !choice.mask]).sum();
            sums.push(sums[mask & !first] + taken);
        }
        ways.clear();
        ways.resize(all + 1, 0.0);
        ways[all] = 1.0;
        let total = sums[all];
        *log_gain += libm::log(total);
        for &spot in spots.iter() {
            clutter[spot] = 0.0;
            done[spot] = true;
        }
        for mask in (1..=all).rev() {
            if ways[mask] == 0.0 {
                continue;
            }
            let first = mask & mask.wrapping_neg();
            let here = ways[mask];
            ways[mask & !first] += here;
            clutter[spots[first.trailing_zeros() as usize]] += here * sums[mask & !first] / total;
            for choice in options.iter().filter(|choice| choice.mask & first != 0 && choice.mask & !mask == 0)
            {
                let rest = mask & !choice.mask;
                ways[rest] += here * choice.odds;
                probability[choice.candidate] += here * choice.odds * (sums[rest] / total);
            }
        }
    }

    /// Where too much hangs together to weigh it all: the best candidates that share nothing, each against clutter alone.
    fn take_the_best(&mut self, candidates: &Candidates) {
        let Self { options, probability, clutter, done, log_gain, .. } = self;
        options.sort_unstable_by(|a, b| b.odds.total_cmp(&a.odds).then(a.candidate.cmp(&b.candidate)));
        for Choice { candidate, odds, .. } in options.iter() {
            let members = candidates.members(*candidate);
            if members.iter().any(|&spot| done[spot]) {
                continue;
            }
            probability[*candidate] = odds / (1.0 + odds);
            *log_gain += libm::log(1.0 + odds);
            for &spot in members {
                clutter[spot] = 1.0 / (1.0 + odds);
                done[spot] = true;
            }
        }
    }
}

fn root(roots: &mut [usize], mut spot: usize) -> usize {
    while roots[spot] != spot {
        roots[spot] = roots[roots[spot]];
        spot = roots[spot];
    }
    spot
}
