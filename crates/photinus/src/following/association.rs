//! Which sighting is which track's: probabilities over all ways at once in which each sighting is of one track at most, and each track
//! has one sighting at most.
//!
//! In: for each track and sighting near it how much more likely the frame is if they belong together than if the track has none and the
//! sighting is of no track. Out: the probability of each pair, and what the others say about it. By passing messages between tracks and
//! sightings (J. L. Williams, R. A. Lau, "Approximate evaluation of marginal association probabilities with belief propagation", IEEE
//! Trans. AES 50(4), 2014): exact where the graph has no loop, near where it has, and each round costs no more than there are pairs,
//! however large a cluster is; listing all ways grows beyond bounds with the cluster.

use alloc::vec::Vec;

/// Rounds of messages at most.
const ROUNDS: usize = 60;
/// Messages that change by less than this stand.
const STANDS: f64 = 1e-5;

/// A track and a sighting near it.
#[derive(Clone, Copy, Debug)]
struct Pair {
    track: usize,
    sighting: usize,
    weight: f64,
    /// To the sighting: how much the track wants it.
    claim: f64,
    /// To the track: the probability that no other track has the sighting.
    free: f64,
}

/// All pairs of a frame.
#[derive(Debug, Default)]
pub(crate) struct Association {
    /// By track.
    pairs: Vec<Pair>,
    /// Claims on each sighting, together.
    claims: Vec<f64>,
}

impl Association {
    /// Nothing yet, for this many sightings.
    pub(crate) fn begin(&mut self, sightings: usize) {
        self.pairs.clear();
        self.claims.clear();
        self.claims.resize(sightings, 0.0);
    }

    /// Adds a pair; tracks ascend.
    pub(crate) fn add(&mut self, track: usize, sighting: usize, weight: f64) {
        self.pairs.push(Pair { track, sighting, weight, claim: 0.0, free: 1.0 });
    }

    /// Passes messages until they stand.
    pub(crate) fn solve(&mut self) {
        for _ in 0..ROUNDS {
            for own in self.pairs.chunk_by_mut(|a, b| a.track == b.track) {
                let all: f64 = own.iter().map(|pair| pair.weight * pair.free).sum();
                for pair in own {
                    pair.claim = pair.weight / (1.0 + (all - pair.weight * pair.free).max(0.0));
                }
            }
            self.claims.fill(0.0);
            for pair in &self.pairs {
                self.claims[pair.sighting] += pair.claim;
            }
            let mut change = 0.0_f64;
            for pair in &mut self.pairs {
                let free = 1.0 / (1.0 + (self.claims[pair.sighting] - pair.claim).max(0.0));
                change = change.max((free - pair.free).abs());
                pair.free = free;
            }
            if change < STANDS {
                break;
            }
        }
    }

    /// For each pair, in the order in which they were added, the probability that no other track has the sighting.
    pub(crate) fn free(&self, pair: usize) -> f64 {
        self.pairs[pair].free
    }

    /// The probability that a sighting is of no track.
    pub(crate) fn is_unexplained(&self, sighting: usize) -> f64 {
        1.0 / (1.0 + self.claims[sighting])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Adds up all ways: probabilities of pairs, by track and sighting.
    fn all_ways(weights: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (mut sums, mut total) = (vec![[0.0; 3]; weights.len()], 0.0);
        for way in 0..4_usize.pow(weights.len() as u32) {
            // each digit to the base of 4 is a track's sighting, 3 is none
            let of = |track: usize| way / 4_usize.pow(track as u32) % 4;
            let has_one =
                |sighting: usize| (0..weights.len()).filter(|&track| of(track) == sighting).count() <= 1;
            if !(0..3).all(has_one) {
                continue;
            }
            let taken: Vec<(usize, usize)> =
                (0..weights.len()).map(|track| (track, of(track))).filter(|&(_, of)| of < 3).collect();
            let product: f64 = taken.iter().map(|&(track, of)| weights[track][of]).product();
            total += product;
            taken.iter().for_each(|&(track, of)| sums[track][of] += product);
        }
        sums.iter().map(|row| row.map(|sum| sum / total)).collect()
    }

    fn by_messages(weights: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut association = Association::default();
        association.begin(3);
        for (track, row) in weights.iter().enumerate() {
            row.iter().enumerate().for_each(|(sighting, &weight)| association.add(track, sighting, weight));
        }
        association.solve();
        let of = |(track, row): (usize, &[f64; 3])| {
            let share = |sighting: usize| row[sighting] * association.free(3 * track + sighting);
            let all = 1.0 + (0..3).map(share).sum::<f64>();
            [0, 1, 2].map(|sighting| share(sighting) / all)
        };
        weights.iter().enumerate().map(of).collect()
    }

    fn largest_error(weights: &[[f64; 3]]) -> f64 {
        let (near, exact) = (by_messages(weights), all_ways(weights));
        let errors =
            near.iter().flatten().zip(exact.iter().flatten()).map(|(near, exact)| (near - exact).abs());
        errors.fold(0.0, f64::max)
    }

    proptest! {
        /// Where tracks all share sightings with one another they are near: the largest error of a cluster is 0.03 on the mean, and 0.27 was
        /// the largest of 6000 clusters.
        #[test]
        fn probabilities_are_near_those_of_all_ways(logs in proptest::collection::vec(proptest::array::uniform3(-4.0..8.0_f64), 1..5)) {
            let weights: Vec<[f64; 3]> = logs.iter().map(|row| row.map(f64::exp2)).collect();
            let most = if weights.len() == 1 { 1e-9 } else { 0.4 };
            prop_assert!(largest_error(&weights) < most, "{weights:?}");
        }

        /// Where no way leads back, as in a row of neighbours, they are exact.
        #[test]
        fn probabilities_in_a_row_are_exact(logs in proptest::array::uniform5(-4.0..12.0_f64)) {
            let [a, b, c, d, e] = logs.map(f64::exp2);
            let weights = [[a, b, 0.0], [0.0, c, d], [0.0, 0.0, e]];
            prop_assert!(largest_error(&weights) < 1e-3, "{weights:?}");
        }

        /// Tracks that all want one sighting.
        #[test]
        fn a_sighting_is_shared_exactly(logs in proptest::collection::vec(-4.0..20.0_f64, 1..6)) {
            let mut association = Association::default();
            association.begin(1);
            let weights: Vec<f64> = logs.iter().map(|log| log.exp2()).collect();
            weights.iter().enumerate().for_each(|(track, &weight)| association.add(track, 0, weight));
            association.solve();
            let all = 1.0 + weights.iter().sum::<f64>();
            for (track, weight) in weights.iter().enumerate() {
                let share = weight * association.free(track);
                prop_assert!((share / (1.0 + share) - weight / all).abs() < 1e-4);
            }
            prop_assert!((association.is_unexplained(0) - 1.0 / all).abs() < 1e-9);
        }
    }
}
