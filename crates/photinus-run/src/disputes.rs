//! Tracks of several kinds of vehicles -> those that are told. Each kind is followed by itself, so that one vehicle may be followed as two kinds.
//!
//! In: the tracks of a frame. Out: of any two that were seen by the same spots, as different kinds, the one that is told: who is named, then who more likely
//! exists, then who was there first. A track that lost such a dispute stays untold: it follows another kind's vehicle.

use photinus_io::results::TrackRecord;

/// The tracks that lost a dispute.
#[derive(Debug, Default)]
pub(crate) struct Disputes {
    lost: Vec<u64>,
}

impl Disputes {
    /// Leaves out of the tracks of all kinds those that follow another kind's vehicle.
    pub(crate) fn settle(&mut self, tracks: &mut Vec<TrackRecord>) {
        self.lost.retain(|lost| tracks.iter().any(|track| track.track == *lost));
        tracks.retain(|track| !self.lost.contains(&track.track));
        let lost = |own: &&TrackRecord| tracks.iter().any(|other| is_same(own, other) && is_told(other, own));
        let lost: Vec<u64> = tracks.iter().filter(lost).map(|track| track.track).collect();
        tracks.retain(|track| !lost.contains(&track.track));
        self.lost.extend(lost);
    }
}

/// Whether both were seen by the same spot, as different kinds.
fn is_same(one: &TrackRecord, other: &TrackRecord) -> bool {
    one.airframe != other.airframe && one.spots.iter().any(|spot| other.spots.contains(spot))
}

/// Whether the first of two is told, and not the second.
fn is_told(first: &TrackRecord, second: &TrackRecord) -> bool {
    let by_name = first.id.is_some().cmp(&second.id.is_some());
    let by_existence = || first.probability.total_cmp(&second.probability);
    by_name.then_with(by_existence).then(second.track.cmp(&first.track)).is_gt()
}
