//! Neighbours against those of truth: how many were found, missed, made up, taken together, taken apart.

use photinus_io::dataset::{TruthLed, TruthNeighbour};
use photinus_io::results::NeighbourRecord;
use serde::Serialize;

use super::range::{ByRange, RangeBins};
use super::spread::share;
use crate::frames::{Compared, ComparedFrame};

/// Neighbours against those of truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Neighbours {
    /// Over all, and by range: of truth, or, for false ones, of their estimate.
    #[serde(flatten)]
    pub by_range: ByRange<NeighbourScore>,
    /// Reported neighbours whose spots are of two or more of truth's.
    pub merged: usize,
    /// Neighbours of truth whose spots were given to two or more reported ones.
    pub split: usize,
}

/// A reported neighbour whose sigma is below this share of its distance is sure of itself, if it is likely: something
/// steers by it.
pub const SURE: f64 = 0.2;
/// A reported neighbour that is likelier than this, or tells no probability, is likely.
pub const LIKELY: f64 = 0.5;

/// Markers of two neighbours that are this far apart are two spots, px: twice what it takes to tell most pairs apart.
pub const APART_PX: f64 = 5.0;

/// How many neighbours were found. Counts are over frames: the same one in ten frames counts ten times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NeighbourScore {
    /// Those of truth with an LED in the image.
    pub visible: usize,
    /// Those of them that were found.
    pub found: usize,
    /// Those that were not.
    pub missed: usize,
    /// Those of truth with an LED in the image, none of which is nearer than [`APART_PX`] to one of another neighbour.
    pub apart: usize,
    /// Those of them that were found.
    pub apart_found: usize,
    /// Found with no LED in the image: neither right nor wrong.
    pub unseen: usize,
    /// Reported where none is.
    #[serde(rename = "false")]
    pub false_neighbours: usize,
    /// Those of them that are sure of themselves: a sigma below [`SURE`] of the distance, a probability above [`LIKELY`].
    pub sure_false: usize,
    /// found / visible.
    pub recall: Option<f64>,
    /// apart_found / apart.
    pub apart_recall: Option<f64>,
    /// found / (found + false).
    pub precision: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Count {
    Found { is_apart: bool },
    Missed { is_apart: bool },
    Unseen,
    False,
    SureFalse,
}

impl Neighbours {
    pub(crate) fn new(compared: &Compared<'_>, bins: &RangeBins) -> Self {
        let counts: Vec<(Option<f64>, Count)> =
            compared.frames.iter().flat_map(|frame| counts(frame, compared.has_leds)).collect();
        Self {
            by_range: ByRange::new(bins, &counts, |(range_m, _)| *range_m, NeighbourScore::new),
            merged: compared.frames.iter().map(merged).sum(),
            split: compared.frames.iter().map(split).sum(),
        }
    }
}

/// What one frame has to count, each with its range.
fn counts(frame: &ComparedFrame<'_>, has_leds: bool) -> Vec<(Option<f64>, Count)> {
    let mut counts = Vec::new();
    for (truth, there) in frame.truth.neighbours.iter().enumerate() {
        let is_found = frame.neighbours.iter().any(|pair| pair.0 == truth);
        let is_visible = frame.visible(has_leds).any(|visible| visible == truth);
        let is_apart = is_apart(&frame.truth.neighbours, truth);
        let count = match (is_visible, is_found) {
            (true, true) => Count::Found { is_apart },
            (true, false) => Count::Missed { is_apart },
            (false, true) => Count::Unseen,
            (false, false) => continue,
        };
        counts.push((Some(there.distance_m), count));
    }
    for (found, reported) in frame.found().iter().enumerate() {
        if !frame.neighbours.iter().any(|pair| pair.1 == found) {
            let count = if is_sure(reported) { Count::SureFalse } else { Count::False };
            counts.push((reported.distance_m.estimate, count));
        }
    }
    counts
}

/// Whether a neighbour has LEDs in the image, and none of them is near one of another.
fn is_apart(neighbours: &[TruthNeighbour], index: usize) -> bool {
    let others = neighbours.iter().enumerate().filter(|(other, _)| *other != index);
    let others: Vec<&TruthLed> = others.flat_map(|(_, other)| &other.leds).collect();
    let is_near = |one: &TruthLed, other: &TruthLed| {
        libm::hypot(one.u_px - other.u_px, one.v_px - other.v_px) < APART_PX
    };
    let own = &neighbours[index].leds;
    !own.is_empty() && own.iter().all(|led| others.iter().all(|other| !is_near(led, other)))
}

fn is_sure(reported: &NeighbourRecord) -> bool {
    let sigma_share =
        reported.distance_m.estimate.zip(reported.distance_m.sigma).map(|(mean, sigma)| sigma / mean);
    let is_likely = reported.probability.is_none_or(|probability| probability > LIKELY);
    is_likely && sigma_share.is_some_and(|share| share < SURE)
}

/// The neighbours of truth that a reported one's spots are of.
fn owners(frame: &ComparedFrame<'_>, reported: &NeighbourRecord) -> Vec<usize> {
    let owners = reported.spots.iter().filter_map(|&spot| frame.leds.neighbour_of_spot(spot));
    let mut owners: Vec<usize> = owners.collect();
    owners.sort_unstable();
    owners.dedup();
    owners
}

fn merged(frame: &ComparedFrame<'_>) -> usize {
    frame.found().iter().filter(|reported| owners(frame, reported).len() > 1).count()
}

fn split(frame: &ComparedFrame<'_>) -> usize {
    let mut parts = vec![0; frame.truth.neighbours.len()];
    for owner in frame.found().iter().flat_map(|reported| owners(frame, reported)) {
        parts[owner] += 1;
    }
    parts.into_iter().filter(|&parts| parts > 1).count()
}

impl NeighbourScore {
    fn new(counts: &[&(Option<f64>, Count)]) -> Self {
        let count = |of: Count| counts.iter().filter(|(_, count)| *count == of).count();
        let found_of = |is_apart| count(Count::Found { is_apart });
        let missed_of = |is_apart| count(Count::Missed { is_apart });
        let (found, missed) = (found_of(true) + found_of(false), missed_of(true) + missed_of(false));
        let sure_false = count(Count::SureFalse);
        let false_neighbours = count(Count::False) + sure_false;
        Self {
            visible: found + missed,
            found,
            missed,
            apart: found_of(true) + missed_of(true),
            apart_found: found_of(true),
            unseen: count(Count::Unseen),
            false_neighbours,
            sure_false,
            recall: share(found, found + missed),
            apart_recall: share(found_of(true), found_of(true) + missed_of(true)),
            precision: share(found, found + false_neighbours),
        }
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::results::{Distance, FrameRecord};

    use super::*;
    use crate::hand_made::{found_at, record, shining, spot, there, truth};
    use crate::{Settings, evaluate};

    const LEFT: [f64; 3] = [-1.0, 0.0, 5.0];
    const RIGHT: [f64; 3] = [1.0, 0.0, 5.0];

    #[test]
    fn found_missed_false_and_unseen_by_hand() {
        let truth = [
            truth(0, vec![shining(1, LEFT, &[[10.0, 10.0]]), shining(2, RIGHT, &[[30.0, 10.0]])]),
            truth(1, vec![there(1, LEFT), there(2, RIGHT)]),
            truth(2, vec![shining(1, LEFT, &[[10.0, 10.0]])]),
        ];
        let results = [
            record(0, vec![], vec![found_at(LEFT), found_at([0.0, -3.0, 3.0])]),
            record(1, vec![], vec![found_at(RIGHT)]),
        ];
        let evaluation = evaluate(&truth, &results, &Settings::default()).unwrap();
        let all = evaluation.scores.neighbours.by_range.overall;
        assert_eq!((all.visible, all.found, all.missed), (3, 1, 2), "the frame without a result is missed");
        assert_eq!((all.unseen, all.false_neighbours), (1, 1));
        assert_eq!((all.recall, all.precision), (Some(1.0 / 3.0), Some(0.5)));
        assert_eq!(evaluation.pairs.len(), 2, "the errors of what is unseen count");
        let frames = evaluation.scores.frames;
        assert_eq!((frames.truth, frames.evaluated, frames.missing, frames.without_truth), (3, 2, 1, 0));
    }

    #[test]
    fn a_likely_false_neighbour_with_a_small_sigma_is_a_sure_one() {
        let truth = [truth(0, vec![shining(1, LEFT, &[[10.0, 10.0]])])];
        let with = |sigma| {
            let there = found_at([0.0, -3.0, 4.0]);
            NeighbourRecord { distance_m: Distance { sigma, ..there.distance_m }, ..there }
        };
        let doubtful = |probability| NeighbourRecord { probability: Some(probability), ..with(Some(0.9)) };
        // of 5 m: 18 %, 22 %, none; then 18 % as likely as not and a little likelier
        let reported =
            vec![found_at(LEFT), with(Some(0.9)), with(Some(1.1)), with(None), doubtful(0.5), doubtful(0.51)];
        let results = [record(0, vec![], reported)];
        let all =
            evaluate(&truth, &results, &Settings::default()).unwrap().scores.neighbours.by_range.overall;
        assert_eq!((all.found, all.false_neighbours, all.sure_false), (1, 5, 2));
    }

    #[test]
    fn those_are_apart_whose_leds_are_near_nobody_elses() {
        let [near, far] = [APART_PX - 0.1, APART_PX + 0.1];
        let own = [[10.0, 10.0], [12.0, 10.0]];
        for (other, apart) in [([12.0 + near, 10.0], 0), ([12.0, 10.0 + far], 2)] {
            let truth = [truth(0, vec![shining(1, LEFT, &own), shining(2, RIGHT, &[other])])];
            let results = [record(0, vec![], vec![found_at(LEFT)])];
            let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;
            let all = scores.neighbours.by_range.overall;
            assert_eq!((all.visible, all.found, all.apart, all.apart_found), (2, 1, apart, apart / 2));
            assert_eq!(all.apart_recall, (apart > 0).then_some(0.5));
        }
    }

    #[test]
    fn without_leds_every_neighbour_counts_as_visible() {
        let truth = [truth(0, vec![there(1, LEFT), there(2, RIGHT)])];
        let results = [record(0, vec![], vec![found_at(LEFT)])];
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;
        assert_eq!(scores.neighbours.by_range.overall.recall, Some(0.5));
        assert_eq!(scores.neighbours.by_range.overall.apart_recall, None, "nobody says where LEDs are");
        assert!(scores.spots.is_none());
    }

    #[test]
    fn spots_taken_together_and_apart_are_counted() {
        let leds = |u_px: f64| [[u_px, 10.0], [u_px + 10.0, 10.0]];
        let truth = [truth(0, vec![shining(1, LEFT, &leds(10.0)), shining(2, RIGHT, &leds(50.0))])];
        let spots: Vec<_> = [10.0, 20.0, 50.0, 60.0].map(|u_px| spot(u_px, 10.0, 1)).to_vec();
        let of = |spots: &[usize]| NeighbourRecord { spots: spots.to_vec(), ..found_at(LEFT) };
        let scored = |groups: &[&[usize]]| {
            let neighbours = groups.iter().map(|group| of(group)).collect();
            let results: [FrameRecord; 1] = [record(0, spots.clone(), neighbours)];
            let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores.neighbours;
            (scores.merged, scores.split)
        };
        assert_eq!(scored(&[&[0, 1], &[2, 3]]), (0, 0));
        assert_eq!(scored(&[&[0, 1, 2, 3]]), (1, 0));
        assert_eq!(scored(&[&[0], &[1], &[2, 3]]), (0, 1));
        assert_eq!(scored(&[&[0, 2], &[1, 3, 77]]), (2, 2), "an index of no spot is of nobody");
    }
}
