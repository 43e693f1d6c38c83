//! What was compared -> scores, over all and by range.

pub(crate) mod bounds;
pub(crate) mod classes;
pub(crate) mod distance;
pub(crate) mod followed;
pub(crate) mod gospa;
pub(crate) mod neighbours;
pub(crate) mod position;
pub(crate) mod probability;
pub(crate) mod range;
pub(crate) mod spots;
pub(crate) mod spread;
pub(crate) mod tracks;

use serde::Serialize;

use crate::frames::Compared;
use crate::{
    Bounds, ByRange, DistanceScore, FollowedScore, IdentityScore, Neighbours, PaperScore, PositionScore,
};
use crate::{ProbabilityScore, Settings, Spots, Spread, TrackScore};

/// Every number of an evaluation. `None` (`null`) is what nothing tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Frames on either side.
    pub frames: Frames,
    /// Spots against the LEDs of truth; `None` where truth lists no LED.
    pub spots: Option<Spots>,
    /// Neighbours against those of truth.
    pub neighbours: Neighbours,
    /// The probability of neighbours against how many are right; `None` where none claims one.
    pub probability: Option<ProbabilityScore>,
    /// Angle between the reported bearing and truth, rad, never negative.
    pub bearing_error_rad: ByRange<Spread>,
    /// Estimated distances.
    pub distance: ByRange<DistanceScore>,
    /// Bounds of distance.
    pub bounds: Bounds,
    /// Estimated positions and their covariances.
    pub position: ByRange<PositionScore>,
    /// The paper's l_A and l_B.
    pub paper: ByRange<PaperScore>,
    /// Identities; `None` where no neighbour was given one.
    pub identity: Option<IdentityScore>,
    /// Tracks; `None` where no neighbour is on one.
    pub tracks: Option<TrackScore>,
    /// Tracks, seen or not; `None` where nothing is followed.
    pub followed: Option<FollowedScore>,
    /// From the end of the exposure until the result stood, s; `None` where no record tells.
    pub latency_s: Option<Spread>,
}

/// Frames on either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// Frames that truth tells about.
    pub truth: usize,
    /// Those of them that the results hold.
    pub evaluated: usize,
    /// Those that they do not: all that was in them is missed.
    pub missing: usize,
    /// Frames of the results that truth does not tell about: they are left out.
    pub without_truth: usize,
}

/// Scores what was compared.
pub(crate) fn score(compared: &Compared<'_>, settings: &Settings) -> Scores {
    let (bins, pairs) = (&settings.bins, &compared.pairs);
    let evaluated = compared.frames.iter().filter(|frame| frame.record.is_some()).count();
    let truth = compared.frames.len();
    let latency_s = Spread::of(
        compared.frames.iter().filter_map(|frame| frame.record.and_then(|record| record.latency_s)),
    );
    Scores {
        frames: Frames {
            truth,
            evaluated,
            missing: truth - evaluated,
            without_truth: compared.without_truth,
        },
        spots: compared.has_leds.then(|| Spots::new(&compared.frames, bins)),
        neighbours: Neighbours::new(compared, bins),
        probability: ProbabilityScore::new(compared),
        bearing_error_rad: ByRange::new(
            bins,
            pairs,
            |pair| Some(pair.truth.distance_m),
            |pairs| Spread::of(pairs.iter().filter_map(|pair| pair.bearing_error_rad())),
        ),
        distance: ByRange::new(bins, pairs, |pair| Some(pair.truth.distance_m), DistanceScore::new),
        bounds: Bounds::new(pairs, bins),
        position: ByRange::new(bins, pairs, |pair| Some(pair.truth.distance_m), PositionScore::new),
        paper: ByRange::new(bins, pairs, |pair| Some(pair.truth.distance_m), PaperScore::new),
        identity: IdentityScore::new(compared),
        tracks: TrackScore::new(compared),
        followed: FollowedScore::new(compared, settings),
        latency_s: Some(latency_s).filter(|latency_s| latency_s.count > 0),
    }
}
