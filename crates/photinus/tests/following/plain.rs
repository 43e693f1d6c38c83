//! Plain nearest assignment, to compare with: fixed gains, the nearest pairs first, a track ends when it was not seen for a while.

use nalgebra::{Rotation3, Vector3};
use photinus::locator::Sighting;

use crate::score::Followed;

const PLACE_GAIN: f64 = 0.8;
const RATE_GAIN: f64 = 0.4;
/// How far a sighting may be, rad, and by how much farther for each frame without one: 3 px, 1 px.
const GATE_RAD: f64 = 0.011;
const WIDER_RAD: f64 = 0.004;
/// Frames without a sighting, in a row: longer than any run of the book, with a few frames lost.
const MOST_MISSED: usize = 6;
/// It is told when it was seen so often.
const SEEN: usize = 4;

#[derive(Debug, Default)]
pub struct Plain {
    tracks: Vec<Track>,
    next: u64,
}

#[derive(Debug)]
struct Track {
    number: u64,
    ahead: Vector3<f64>,
    rate_rad_s: Vector3<f64>,
    /// Seconds since it was seen.
    unseen_s: f64,
    missed: usize,
    seen: usize,
}

impl Plain {
    pub fn follow(&mut self, sightings: &[Sighting], passed_s: f64, turn: &Rotation3<f64>) -> Vec<Followed> {
        let mut pairs = Vec::new();
        for (index, track) in self.tracks.iter_mut().enumerate() {
            track.rate_rad_s = turn * track.rate_rad_s;
            track.ahead = (turn * track.ahead + track.rate_rad_s * passed_s).normalize();
            track.unseen_s += passed_s;
            track.missed += 1;
            let gate = GATE_RAD + WIDER_RAD * (track.missed - 1) as f64;
            for (sighting, seen) in sightings.iter().enumerate() {
                let gap = (seen.bearing.vector() - track.ahead).norm();
                if gap < gate {
                    pairs.push((gap, index, sighting));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut taken = vec![false; sightings.len()];
        for (_, index, sighting) in pairs {
            let track = &mut self.tracks[index];
            if track.missed == 0 || taken[sighting] {
                continue;
            }
            taken[sighting] = true;
            let off = sightings[sighting].bearing.vector() - track.ahead;
            track.ahead = (track.ahead + off * PLACE_GAIN).normalize();
            track.rate_rad_s += off * (RATE_GAIN / track.unseen_s);
            (track.missed, track.unseen_s, track.seen) = (0, 0.0, track.seen + 1);
        }
        self.tracks.retain(|track| track.missed <= MOST_MISSED);
        for (seen, _) in sightings.iter().zip(taken).filter(|(_, taken)| !taken) {
            let (number, ahead) = (self.next, *seen.bearing.vector());
            let rate_rad_s = Vector3::zeros();
            self.tracks.push(Track { number, ahead, rate_rad_s, unseen_s: 0.0, missed: 0, seen: 1 });
            self.next += 1;
        }
        let told = self.tracks.iter().filter(|track| track.seen >= SEEN);
        told.map(|track| Followed {
            number: track.number,
            ahead: track.ahead,
            sigma_rad: 0.0,
            is_there: true,
        })
        .collect()
    }
}
