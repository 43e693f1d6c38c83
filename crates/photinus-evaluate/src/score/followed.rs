//! Tracks against truth, seen or not: places, velocities, existence, and what becomes of vehicles that are hidden.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use photinus_io::dataset::TruthNeighbour;
use photinus_io::results::TrackRecord;
use serde::Serialize;

use super::gospa::{GospaScore, Parts, Reported};
use super::position::Consistency;
use super::spread::{Spread, share};
use crate::Settings;
use crate::frames::{Compared, ComparedFrame};
use crate::pairing::assignment::{Candidate, assign};

/// Tracks, as they are at each frame, against truth. Counts are over frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FollowedScore {
    /// Neighbours of truth with an LED in the image.
    pub visible: usize,
    /// Those of them that are followed.
    pub followed: usize,
    /// Tracks where none is.
    #[serde(rename = "false")]
    pub false_tracks: usize,
    /// followed / visible.
    pub recall: Option<f64>,
    /// followed / (followed + false).
    pub precision: Option<f64>,
    /// Neighbours of truth without an LED in the image, between two sights of them no farther apart than
    /// [`Settings::occlusion_s`].
    pub hidden: usize,
    /// Those of them that are followed on the track that they had.
    pub hidden_followed: usize,
    /// hidden_followed / hidden.
    pub hidden_recall: Option<f64>,
    /// How much of truth and tracks is one and the same over all frames, a neighbour of truth to a track: 2 both / (truth + tracks)
    /// (Ristani et al., "Performance measures and a data set for multi-target, multi-camera tracking", 2016).
    pub idf1: Option<f64>,
    /// Distance from the place of truth, m, of whom a spot of the frame shows.
    pub seen_error_m: Spread,
    /// Whether their covariances keep their word.
    pub seen: Consistency,
    /// Distance from the place of truth, m, of whom none shows.
    pub predicted_error_m: Spread,
    /// Whether their covariances keep their word.
    pub predicted: Consistency,
    /// Error of the velocity, m/s, where truth tells it.
    pub velocity_error_m_s: Spread,
    /// Whether its covariances keep their word.
    pub velocity: Consistency,
    /// Those likelier than not, as points.
    pub gospa: GospaScore,
    /// All, with their probabilities and covariances.
    pub probabilistic_gospa: GospaScore,
}

/// A track beside the neighbour of truth that it is.
struct Beside<'a> {
    truth: &'a TruthNeighbour,
    track: &'a TrackRecord,
}

/// The last sight of a neighbour of truth, and who was hidden since.
#[derive(Default)]
struct Sight {
    time_s: Option<f64>,
    track: Option<u64>,
    hidden: usize,
    hidden_followed: usize,
}

impl FollowedScore {
    /// `None` where nobody is followed.
    pub(crate) fn new(compared: &Compared<'_>, settings: &Settings) -> Option<Self> {
        let frames = &compared.frames;
        frames.iter().any(|frame| !frame.followed().is_empty()).then_some(())?;
        let beside: Vec<Beside<'_>> = frames.iter().flat_map(beside).collect();
        let of = |is_predicted| beside.iter().filter(move |beside| beside.track.predicted == is_predicted);
        let position = |beside: &Beside<'_>| {
            let error_m = Vector3::from(beside.track.position_m) - Vector3::from(beside.truth.position_m);
            (error_m, Some(Matrix3::from(beside.track.position_covariance_m2)))
        };
        let velocity = |beside: &Beside<'_>| {
            let error_m_s =
                Vector3::from(beside.track.velocity_m_s) - Vector3::from(beside.truth.velocity_m_s?);
            Some((error_m_s, Some(Matrix3::from(beside.track.velocity_covariance_m2_s2))))
        };
        let size = |(error, _): (Vector3<f64>, _)| error.norm();
        let counts = Counts::new(compared);
        let hidden = hidden(compared, settings);
        let parts = |of: fn(&[Vector3<f64>], &[Reported], f64) -> Parts| {
            let frame = |frame| {
                let (there_m, reported) = sets(frame, compared.has_leds);
                of(&there_m, &reported, settings.gospa_cutoff_m)
            };
            frames.iter().map(frame).collect::<Vec<_>>()
        };
        Some(Self {
            visible: counts.visible,
            followed: counts.followed,
            false_tracks: counts.false_tracks,
            recall: share(counts.followed, counts.visible),
            precision: share(counts.followed, counts.followed + counts.false_tracks),
            hidden: hidden.0,
            hidden_followed: hidden.1,
            hidden_recall: share(hidden.1, hidden.0),
            idf1: share(2 * counts.same, counts.visible + counts.followed + counts.false_tracks),
            seen_error_m: Spread::of(of(false).map(position).map(size)),
            seen: Consistency::new(of(false).map(position)),
            predicted_error_m: Spread::of(of(true).map(position).map(size)),
            predicted: Consistency::new(of(true).map(position)),
            velocity_error_m_s: Spread::of(beside.iter().filter_map(velocity).map(size)),
            velocity: Consistency::new(beside.iter().filter_map(velocity)),
            gospa: GospaScore::new(&parts(Parts::plain)),
            probabilistic_gospa: GospaScore::new(&parts(Parts::probabilistic)),
        })
    }
}

fn beside<'a, 'b>(frame: &'b ComparedFrame<'a>) -> impl Iterator<Item = Beside<'a>> + use<'a, 'b> {
    frame.tracks.iter().map(|&(truth, track)| Beside {
        truth: &frame.truth.neighbours[truth],
        track: &frame.followed()[track],
    })
}

/// Places of the visible, and all tracks but those of who is there unseen: they are neither right nor false.
fn sets(frame: &ComparedFrame<'_>, has_leds: bool) -> (Vec<Vector3<f64>>, Vec<Reported>) {
    let visible: Vec<usize> = frame.visible(has_leds).collect();
    let there_m = visible.iter().map(|&index| frame.truth.neighbours[index].position_m.into()).collect();
    let unseen = |track: usize| frame.tracks.iter().any(|pair| pair.1 == track && !visible.contains(&pair.0));
    let reported = frame.followed().iter().enumerate().filter(|&(index, _)| !unseen(index));
    let reported = reported.map(|(_, track)| Reported {
        probability: track.probability,
        position_m: track.position_m.into(),
        covariance_m2: track.position_covariance_m2.into(),
    });
    (there_m, reported.collect())
}

/// Sums over frames.
#[derive(Default)]
struct Counts {
    visible: usize,
    followed: usize,
    false_tracks: usize,
    /// Frames in which a neighbour of truth is on the track that is its own over all frames.
    same: usize,
}

impl Counts {
    fn new(compared: &Compared<'_>) -> Self {
        let mut counts = Self::default();
        let mut together: BTreeMap<(u32, u64), usize> = BTreeMap::new();
        for frame in &compared.frames {
            let visible: Vec<usize> = frame.visible(compared.has_leds).collect();
            counts.visible += visible.len();
            counts.false_tracks += frame.followed().len() - frame.tracks.len();
            for &(truth, track) in frame.tracks.iter().filter(|pair| visible.contains(&pair.0)) {
                counts.followed += 1;
                let ids = (frame.truth.neighbours[truth].id, frame.followed()[track].track);
                *together.entry(ids).or_default() += 1;
            }
        }
        counts.same = most_in_common(&together);
        counts
    }
}

/// The most frames that neighbours of truth and tracks have in common, one to one.
fn most_in_common(together: &BTreeMap<(u32, u64), usize>) -> usize {
    let mut neighbours: Vec<u32> = together.keys().map(|ids| ids.0).collect();
    let mut tracks: Vec<u64> = together.keys().map(|ids| ids.1).collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    tracks.sort_unstable();
    tracks.dedup();
    let most = together.values().copied().max().unwrap_or(0) as f64;
    let candidate = |(ids, &frames): (&(u32, u64), &usize)| Candidate {
        row: neighbours.binary_search(&ids.0).unwrap_or_default(),
        column: tracks.binary_search(&ids.1).unwrap_or_default(),
        cost: 1.0 - frames as f64 / (most + 1.0),
    };
    let candidates: Vec<Candidate> = together.iter().map(candidate).collect();
    assign(&candidates)
        .iter()
        .filter_map(|&(row, column)| together.get(&(neighbours[row], tracks[column])))
        .sum()
}

/// How many were hidden between two sights, and how many of them were followed meanwhile on the track that they had.
fn hidden(compared: &Compared<'_>, settings: &Settings) -> (usize, usize) {
    let mut sights: BTreeMap<u32, Sight> = BTreeMap::new();
    let mut counted = (0, 0);
    for frame in &compared.frames {
        let visible: Vec<usize> = frame.visible(compared.has_leds).collect();
        for (index, there) in frame.truth.neighbours.iter().enumerate() {
            let on = frame.tracks.iter().find(|pair| pair.0 == index);
            let track = on.map(|pair| frame.followed()[pair.1].track);
            let sight = sights.entry(there.id).or_default();
            if !visible.contains(&index) {
                sight.hidden += 1;
                sight.hidden_followed += usize::from(track.is_some() && track == sight.track);
                continue;
            }
            let time_s = frame.truth.time_s;
            if sight.time_s.is_some_and(|last_s| time_s - last_s <= settings.occlusion_s) {
                counted = (counted.0 + sight.hidden, counted.1 + sight.hidden_followed);
            }
            *sight = Sight { time_s: Some(time_s), track, ..Sight::default() };
        }
    }
    counted
}

#[cfg(test)]
mod tests {
    use photinus_io::dataset::TruthNeighbour;
    use photinus_io::results::{FrameRecord, TrackRecord};

    use crate::hand_made::{record, shining, there, track, truth};
    use crate::{FollowedScore, Settings, evaluate};

    const PLACE: [f64; 3] = [0.0, 0.0, 5.0];
    const ELSEWHERE: [f64; 3] = [5.0, 0.0, 0.0];

    fn with(frame: u64, tracks: Vec<TrackRecord>) -> FrameRecord {
        FrameRecord { tracks, ..record(frame, vec![], vec![]) }
    }

    fn scored(truth: &[photinus_io::dataset::TruthFrame], results: &[FrameRecord]) -> FollowedScore {
        evaluate(truth, results, &Settings::default()).unwrap().scores.followed.unwrap()
    }

    #[test]
    fn who_is_hidden_counts_where_it_shows_again_soon() {
        let seen = |frame| truth(frame, vec![shining(4, PLACE, &[[10.0, 10.0]])]);
        let hidden = |frame| truth(frame, vec![there(4, PLACE)]);
        let predicted = |number| TrackRecord { predicted: true, ..track(number, PLACE) };
        // seen, hidden for 0.2 s, seen; hidden to the end
        let truth = [seen(0), hidden(1), hidden(2), seen(3), hidden(4)];
        let results = [
            with(0, vec![track(1, PLACE)]),
            with(1, vec![predicted(1)]),
            with(2, vec![predicted(9)]),
            with(3, vec![track(1, PLACE), track(2, ELSEWHERE)]),
            with(4, vec![predicted(1)]),
        ];
        let score = scored(&truth, &results);
        assert_eq!((score.visible, score.followed, score.false_tracks), (2, 2, 1));
        assert_eq!((score.hidden, score.hidden_followed), (2, 1), "on another track it is not the same");
        assert_eq!((score.seen_error_m.count, score.predicted_error_m.count), (2, 3));
        assert_eq!(score.idf1, Some(2.0 * 2.0 / (2.0 + 3.0)));
        // frame 3 has one false of probability 1, the others are right: sqrt(cutoff^2 / 2) once in 5
        let expected = (0.5f64 * 4.0).sqrt() / 5.0;
        assert!((score.gospa.mean_m.unwrap() - expected).abs() < 1e-12);
        assert!(score.probabilistic_gospa.mean_m > score.gospa.mean_m, "covariances cost");
    }

    #[test]
    fn one_to_one_over_all_frames_is_the_most_in_common() {
        let there = |frame| truth(frame, vec![shining(4, PLACE, &[[10.0, 10.0]])]);
        let truth: Vec<_> = (0..5).map(there).collect();
        let results: Vec<_> =
            (0..5).map(|frame| with(frame, vec![track(u64::from(frame >= 2), PLACE)])).collect();
        assert_eq!(scored(&truth, &results).idf1, Some(2.0 * 3.0 / 10.0), "three frames on the second track");
    }

    #[test]
    fn velocities_are_held_against_truth_where_it_tells_them() {
        let moving =
            |id, velocity_m_s| TruthNeighbour { velocity_m_s, ..shining(id, PLACE, &[[10.0, 10.0]]) };
        let truth = [truth(0, vec![moving(1, Some([1.0, 0.0, 0.0]))]), truth(1, vec![moving(1, None)])];
        let at = |frame| with(frame, vec![TrackRecord { velocity_m_s: [1.2, 0.0, 0.0], ..track(1, PLACE) }]);
        let score = scored(&truth, &[at(0), at(1)]);
        assert_eq!(score.velocity_error_m_s.count, 1);
        assert!((score.velocity_error_m_s.rms.unwrap() - 0.2).abs() < 1e-12);
        assert!((score.velocity.nees.unwrap() - 4.0).abs() < 1e-9, "0.2 m/s of a sigma of 0.1");
    }
}
