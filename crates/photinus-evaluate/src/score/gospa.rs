//! Sets of vehicles against each other: one number for places, misses and false ones together.
//!
//! Frame by frame the least sum, over ways to put those there and those reported side by side, of their squared distances and of half the
//! squared cut-off for each that is left alone: GOSPA with p = alpha = 2 (Rahmathullah, Garcia-Fernandez, Svensson, "Generalized optimal
//! sub-pattern assignment metric", FUSION 2017). Its probabilistic form takes what is reported as a Bernoulli density with a normal
//! distribution, by the Wasserstein distance to the place of truth: it scores covariances and probabilities of existence, too (Xia et al.,
//! "Probabilistic GOSPA", arXiv 2412.11482; truth surely exists).

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::spread::mean;
use crate::pairing::assignment::{Candidate, assign};

/// Mean over frames of the distance between those there and those reported.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GospaScore {
    /// Frames.
    pub frames: usize,
    /// Mean of the metric, m.
    pub mean_m: Option<f64>,
    /// Its square's mean share of errors of place, m^2.
    pub place_m2: Option<f64>,
    /// Its square's mean share of probabilities below 1 of who is there, m^2; 0 in the form without probabilities.
    pub existence_m2: Option<f64>,
    /// Its square's mean share of who was missed, m^2.
    pub missed_m2: Option<f64>,
    /// Its square's mean share of who is not there, m^2.
    pub false_m2: Option<f64>,
}

/// A vehicle that was reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reported {
    pub(crate) probability: f64,
    pub(crate) position_m: Vector3<f64>,
    pub(crate) covariance_m2: Matrix3<f64>,
}

impl Reported {
    /// Surely there, and just there.
    fn plain(self) -> Self {
        Self { probability: 1.0, covariance_m2: Matrix3::zeros(), ..self }
    }

    /// Squared Wasserstein distance to a place, m^2.
    fn squared_m2(&self, place_m: &Vector3<f64>) -> f64 {
        (self.position_m - place_m).norm_squared() + self.covariance_m2.trace()
    }
}

/// The squared metric of one frame, part by part, m^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Parts {
    place_m2: f64,
    existence_m2: f64,
    missed_m2: f64,
    false_m2: f64,
}

impl Parts {
    fn sum_m2(&self) -> f64 {
        self.place_m2 + self.existence_m2 + self.missed_m2 + self.false_m2
    }

    /// Of those reported with probabilities and covariances.
    pub(crate) fn probabilistic(there_m: &[Vector3<f64>], reported: &[Reported], cutoff_m: f64) -> Self {
        let most_m2 = cutoff_m * cutoff_m;
        let mut candidates = Vec::new();
        for (row, place_m) in there_m.iter().enumerate() {
            for (column, found) in reported.iter().enumerate() {
                // What a pair saves against two that are alone, probability (cutoff^2 - d^2), is to be the most.
                let saved = found.probability * (1.0 - found.squared_m2(place_m) / most_m2);
                if saved > 0.0 {
                    candidates.push(Candidate { row, column, cost: 1.0 - saved });
                }
            }
        }
        let mut parts = Self::default();
        let mut is_alone = vec![true; reported.len()];
        let pairs = assign(&candidates);
        for &(row, column) in &pairs {
            let found = &reported[column];
            is_alone[column] = false;
            parts.place_m2 += found.probability * found.squared_m2(&there_m[row]);
            parts.existence_m2 += 0.5 * most_m2 * (1.0 - found.probability);
        }
        parts.missed_m2 = 0.5 * most_m2 * (there_m.len() - pairs.len()) as f64;
        let alone = reported.iter().zip(is_alone).filter(|(_, is_alone)| *is_alone);
        parts.false_m2 = alone.map(|(found, _)| 0.5 * most_m2 * found.probability).sum();
        parts
    }

    /// Of those reported as likelier than not, as if they surely were just there.
    pub(crate) fn plain(there_m: &[Vector3<f64>], reported: &[Reported], cutoff_m: f64) -> Self {
        let likely = reported.iter().filter(|found| found.probability >= 0.5);
        let likely: Vec<Reported> = likely.map(|found| found.plain()).collect();
        Self::probabilistic(there_m, &likely, cutoff_m)
    }
}

impl GospaScore {
    pub(crate) fn new(frames: &[Parts]) -> Self {
        let of = |part: fn(&Parts) -> f64| mean(frames.iter().map(part));
        Self {
            frames: frames.len(),
            mean_m: of(|parts| parts.sum_m2().sqrt()),
            place_m2: of(|parts| parts.place_m2),
            existence_m2: of(|parts| parts.existence_m2),
            missed_m2: of(|parts| parts.missed_m2),
            false_m2: of(|parts| parts.false_m2),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(x_m: f64) -> Vector3<f64> {
        Vector3::new(x_m, 0.0, 5.0)
    }

    fn reported(x_m: f64, probability: f64, variance_m2: f64) -> Reported {
        let covariance_m2 = Matrix3::from_diagonal_element(variance_m2);
        Reported { probability, position_m: at(x_m), covariance_m2 }
    }

    #[test]
    fn by_hand() {
        let there = [at(0.0), at(10.0)];
        // one 0.3 m off, one missed, one where none is; cut-off 2 m
        let found = [reported(0.3, 0.9, 0.01), reported(-20.0, 0.6, 0.04), reported(40.0, 0.2, 0.04)];
        let plain = Parts::plain(&there, &found, 2.0);
        assert!((plain.sum_m2() - (0.09 + 2.0 + 2.0)).abs() < 1e-12, "{plain:?}");
        let parts = Parts::probabilistic(&there, &found, 2.0);
        let expected = [0.9 * (0.09 + 0.03), 0.1 * 2.0, 2.0, 0.8 * 2.0];
        let is = [parts.place_m2, parts.existence_m2, parts.missed_m2, parts.false_m2];
        for (is, expected) in is.iter().zip(expected) {
            assert!((is - expected).abs() < 1e-12, "{parts:?}");
        }
        let score = GospaScore::new(&[plain, Parts::default()]);
        assert!((score.mean_m.unwrap() - 4.09f64.sqrt() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_right_probability_and_covariance_is_the_best_on_average() {
        // three of four times it is there, normally about its place with a variance of 0.09 m^2 an axis
        let drawn = |claimed: f64| {
            let there = Parts::probabilistic(&[at(0.2)], &[reported(0.0, claimed, 0.09)], 2.0).sum_m2();
            let gone = Parts::probabilistic(&[], &[reported(0.0, claimed, 0.09)], 2.0).sum_m2();
            0.75 * there + 0.25 * gone
        };
        assert!(drawn(1.0) < drawn(0.75) && drawn(0.75) < drawn(0.2), "it rewards the likelier answer");
        let wide = Parts::probabilistic(&[at(0.0)], &[reported(0.0, 1.0, 0.5)], 2.0);
        let narrow = Parts::probabilistic(&[at(0.0)], &[reported(0.0, 1.0, 0.01)], 2.0);
        assert!(wide.sum_m2() > narrow.sum_m2(), "what is less sure is worse where both are right");
    }

    /// The least sum over all ways, by trying each.
    fn by_trying(there_m: &[Vector3<f64>], reported: &[Reported], cutoff_m: f64) -> f64 {
        let half_m2 = 0.5 * cutoff_m * cutoff_m;
        let Some((first, rest)) = there_m.split_first() else {
            return reported.iter().map(|found| half_m2 * found.probability).sum();
        };
        let mut least = half_m2 + by_trying(rest, reported, cutoff_m);
        for (index, found) in reported.iter().enumerate() {
            let mut others = reported.to_vec();
            others.remove(index);
            let pair = found.probability * found.squared_m2(first) + (1.0 - found.probability) * half_m2;
            least = least.min(pair + by_trying(rest, &others, cutoff_m));
        }
        least
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn it_is_the_least_over_all_ways(
            there in proptest::collection::vec(-4.0..4.0f64, 0..4),
            found in proptest::collection::vec((-4.0..4.0f64, 0.0..1.0f64, 0.0..0.5f64), 0..4),
            cutoff_m in 0.5..4.0f64,
        ) {
            let there: Vec<_> = there.into_iter().map(at).collect();
            let found: Vec<_> = found.into_iter().map(|(x, p, v)| reported(x, p, v)).collect();
            let parts = Parts::probabilistic(&there, &found, cutoff_m);
            prop_assert!((parts.sum_m2() - by_trying(&there, &found, cutoff_m)).abs() < 1e-9);
        }
    }
}
