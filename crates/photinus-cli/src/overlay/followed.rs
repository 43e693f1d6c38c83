//! Tracks from picture to picture: a record enters, and where each track was, is and goes leaves.

use std::collections::VecDeque;

use nalgebra::Vector3;
use photinus_io::results::{FrameRecord, TrackRecord};

use super::names::Name;

/// How long a tail is, s.
pub(super) const TAIL_S: f64 = 2.0;
/// How far ahead an arrow shows, s.
pub(super) const AHEAD_S: f64 = 0.5;
/// A tail has no more places than this.
const MOST_PLACES: usize = 240;

/// A track in a picture; places are in the camera frame, m.
pub(super) struct Followed<'a> {
    pub(super) name: &'a Name,
    /// Where it was, the oldest first: as seen from the camera at the time.
    pub(super) tail_m: Vec<Vector3<f64>>,
    pub(super) position_m: Vector3<f64>,
    /// Where it will be in [`AHEAD_S`] if it goes on so.
    pub(super) ahead_m: Vector3<f64>,
    /// Whether nothing of it shows in this frame.
    pub(super) is_unseen: bool,
}

/// Where tracks were in the last pictures of a camera.
#[derive(Default)]
pub(super) struct Tails(Vec<Tail>);

struct Tail {
    track: u64,
    places: VecDeque<(f64, Vector3<f64>)>,
}

impl Tails {
    /// The tracks of a record by their names, each with its tail.
    pub(super) fn follow<'a>(&mut self, record: &FrameRecord, names: &'a [Name]) -> Vec<Followed<'a>> {
        let time_s = record.time_s.unwrap_or_default();
        for tail in &mut self.0 {
            // A time that jumps back begins all tails anew.
            tail.places.retain(|&(at_s, _)| at_s <= time_s && at_s >= time_s - TAIL_S);
        }
        self.0.retain(|tail| !tail.places.is_empty());
        record.tracks.iter().zip(names).map(|(track, name)| self.see(track, name, time_s)).collect()
    }

    fn see<'a>(&mut self, track: &TrackRecord, name: &'a Name, time_s: f64) -> Followed<'a> {
        let position_m = Vector3::from(track.position_m);
        let known = self.0.iter().position(|tail| tail.track == track.track);
        let known = known.unwrap_or_else(|| {
            self.0.push(Tail { track: track.track, places: VecDeque::new() });
            self.0.len() - 1
        });
        let places = &mut self.0[known].places;
        places.push_back((time_s, position_m));
        if places.len() > MOST_PLACES {
            places.pop_front();
        }
        Followed {
            name,
            tail_m: places.iter().map(|&(_, place_m)| place_m).collect(),
            position_m,
            ahead_m: position_m + Vector3::from(track.velocity_m_s) * AHEAD_S,
            is_unseen: track.predicted,
        }
    }
}
