//! Identities and tracks against the identities of truth.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::spread::{Spread, share};
use crate::frames::Compared;

/// Identities against those of truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IdentityScore {
    /// Neighbours that were found.
    pub found: usize,
    /// Those of them that were given an identity.
    pub identified: usize,
    /// Those whose identity is that of truth.
    pub correct: usize,
    /// correct / identified.
    pub accuracy: Option<f64>,
    /// identified / found.
    pub coverage: Option<f64>,
    /// From the first sight of a neighbour of truth until it first has its own identity, s.
    pub time_to_identity_s: Spread,
    /// Neighbours of truth that were seen and never had it.
    pub never: usize,
    /// How often a neighbour of truth had another identity than the last time that it had one.
    pub switches: usize,
    /// The longest that a neighbour of truth went on with a wrong identity, s; 0 where none did.
    pub longest_wrong_s: f64,
}

/// How one neighbour of truth was called.
#[derive(Default)]
struct Names {
    first_seen_s: Option<f64>,
    first_right_s: Option<f64>,
    last: Option<u32>,
    wrong_since_s: Option<f64>,
    switches: usize,
    longest_wrong_s: f64,
}

impl Names {
    fn called(&mut self, id: u32, truth: u32, time_s: f64) {
        self.switches += usize::from(self.last.is_some_and(|last| last != id));
        self.last = Some(id);
        if id == truth {
            self.first_right_s.get_or_insert(time_s);
            self.wrong_since_s = None;
        } else {
            let since_s = *self.wrong_since_s.get_or_insert(time_s);
            self.longest_wrong_s = self.longest_wrong_s.max(time_s - since_s);
        }
    }
}

impl IdentityScore {
    /// `None` where no neighbour was given an identity.
    pub(crate) fn new(compared: &Compared<'_>) -> Option<Self> {
        let pairs = &compared.pairs;
        let identified = pairs.iter().filter(|pair| pair.found.id.is_some()).count();
        let correct = pairs.iter().filter(|pair| pair.found.id == Some(pair.truth.id)).count();
        let names = names(compared);
        let time_s = |names: &Names| Some(names.first_right_s? - names.first_seen_s?);
        (identified > 0).then(|| Self {
            found: pairs.len(),
            identified,
            correct,
            accuracy: share(correct, identified),
            coverage: share(identified, pairs.len()),
            time_to_identity_s: Spread::of(names.values().filter_map(time_s)),
            never: names
                .values()
                .filter(|names| names.first_seen_s.is_some() && names.first_right_s.is_none())
                .count(),
            switches: names.values().map(|names| names.switches).sum(),
            longest_wrong_s: names.values().map(|names| names.longest_wrong_s).fold(0.0, f64::max),
        })
    }
}

/// How each neighbour of truth was called, over all frames.
fn names(compared: &Compared<'_>) -> BTreeMap<u32, Names> {
    let mut names: BTreeMap<u32, Names> = BTreeMap::new();
    for frame in &compared.frames {
        let time_s = frame.truth.time_s;
        for index in frame.visible(compared.has_leds) {
            let truth = frame.truth.neighbours[index].id;
            names.entry(truth).or_default().first_seen_s.get_or_insert(time_s);
        }
        for &(truth, found) in &frame.neighbours {
            let truth = frame.truth.neighbours[truth].id;
            if let Some(id) = frame.found()[found].id {
                names.entry(truth).or_default().called(id, truth, time_s);
            }
        }
    }
    names
}

/// Tracks against the neighbours of truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackScore {
    /// Neighbours of truth that were ever visible.
    pub neighbours: usize,
    /// Tracks in the results.
    pub tracks: usize,
    /// Those that never were with a neighbour of truth.
    pub false_tracks: usize,
    /// How often a neighbour of truth went on under another track.
    pub switches: usize,
    /// How often a neighbour of truth came back on a track after it was missed though visible.
    pub fragments: usize,
    /// The share of visible neighbours, over frames, that are on a track.
    pub coverage: Option<f64>,
}

/// What one neighbour of truth went through.
#[derive(Default)]
struct History {
    last: Option<u64>,
    is_lost: bool,
    visible: usize,
    tracked: usize,
    switches: usize,
    fragments: usize,
}

impl History {
    fn step(&mut self, track: Option<u64>, is_visible: bool) {
        self.visible += usize::from(is_visible);
        match track {
            Some(track) => {
                self.tracked += usize::from(is_visible);
                self.switches += usize::from(self.last.is_some_and(|last| last != track));
                self.fragments += usize::from(self.is_lost);
                (self.last, self.is_lost) = (Some(track), false);
            }
            // What cannot be seen is not lost.
            None => self.is_lost |= is_visible && self.last.is_some(),
        }
    }
}

impl TrackScore {
    /// `None` where no neighbour is on a track.
    pub(crate) fn new(compared: &Compared<'_>) -> Option<Self> {
        let reported = compared.frames.iter().flat_map(|frame| frame.found());
        let tracks: BTreeSet<u64> = reported.filter_map(|found| found.track).collect();
        let mut histories: BTreeMap<u32, History> = BTreeMap::new();
        let mut right = BTreeSet::new();
        for frame in &compared.frames {
            for (truth, there) in frame.truth.neighbours.iter().enumerate() {
                let found = frame.neighbours.iter().find(|pair| pair.0 == truth);
                let track = found.and_then(|pair| frame.found()[pair.1].track);
                right.extend(track);
                let is_visible = !compared.has_leds || !there.leds.is_empty();
                histories.entry(there.id).or_default().step(track, is_visible);
            }
        }
        let sum = |of: fn(&History) -> usize| histories.values().map(of).sum::<usize>();
        (!tracks.is_empty()).then(|| Self {
            neighbours: sum(|history| usize::from(history.visible > 0)),
            tracks: tracks.len(),
            false_tracks: tracks.difference(&right).count(),
            switches: sum(|history| history.switches),
            fragments: sum(|history| history.fragments),
            coverage: share(sum(|history| history.tracked), sum(|history| history.visible)),
        })
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::results::NeighbourRecord;

    use crate::hand_made::{found_at, record, shining, there, truth};
    use crate::{Settings, evaluate};

    const PLACE: [f64; 3] = [0.0, 0.0, 5.0];
    const ELSEWHERE: [f64; 3] = [5.0, 0.0, 0.0];

    fn on(track: u64, id: u32, position_m: [f64; 3]) -> NeighbourRecord {
        NeighbourRecord { track: Some(track), id: Some(id), ..found_at(position_m) }
    }

    #[test]
    fn switches_fragments_and_identities_by_hand() {
        let seen = |frame| truth(frame, vec![shining(4, PLACE, &[[10.0, 10.0]])]);
        let hidden = |frame| truth(frame, vec![there(4, PLACE)]);
        let truth = [seen(0), seen(1), seen(2), hidden(3), seen(4), seen(5)];
        let results = [
            record(0, vec![], vec![on(1, 4, PLACE)]),
            record(1, vec![], vec![]),
            record(2, vec![], vec![on(1, 4, PLACE)]),
            record(3, vec![], vec![]),
            record(4, vec![], vec![on(1, 9, PLACE), on(3, 4, ELSEWHERE)]),
            record(5, vec![], vec![on(2, 4, PLACE)]),
        ];
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;
        let tracks = scores.tracks.unwrap();
        assert_eq!((tracks.neighbours, tracks.tracks, tracks.false_tracks), (1, 3, 1));
        assert_eq!((tracks.switches, tracks.fragments), (1, 1), "what was hidden was not lost");
        assert_eq!(tracks.coverage, Some(0.8));
        let identity = scores.identity.unwrap();
        assert_eq!((identity.found, identity.identified, identity.correct), (4, 4, 3));
        assert_eq!((identity.accuracy, identity.coverage), (Some(0.75), Some(1.0)));
        assert_eq!((identity.switches, identity.never), (2, 0), "from 4 to 9 and back");
    }

    #[test]
    fn time_to_identity_is_from_the_first_sight_and_wrong_names_last() {
        let seen = |frame| truth(frame, vec![shining(4, PLACE, &[[10.0, 10.0]])]);
        let truth: Vec<_> = (0..8).map(seen).collect();
        let called = |frame, id| record(frame, vec![], vec![NeighbourRecord { id, ..found_at(PLACE) }]);
        let ids = [None, Some(9), None, Some(9), Some(4), None, Some(7), Some(4)];
        let results: Vec<_> = (0..).zip(ids).map(|(frame, id)| called(frame, id)).collect();
        let identity = evaluate(&truth, &results, &Settings::default()).unwrap().scores.identity.unwrap();
        assert!((identity.time_to_identity_s.median.unwrap() - 0.4).abs() < 1e-12);
        assert!((identity.longest_wrong_s - 0.2).abs() < 1e-12, "frames 1 to 3 at 10 frames/s");
        assert_eq!((identity.switches, identity.never), (3, 0));
    }

    #[test]
    fn results_without_identities_have_no_such_scores() {
        let truth = [truth(0, vec![there(4, PLACE)])];
        let results = [record(0, vec![], vec![found_at(PLACE)])];
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;
        assert_eq!((scores.identity, scores.tracks), (None, None));
    }
}
