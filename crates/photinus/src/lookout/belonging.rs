//! Which marker track belongs to which vehicle's track, as which of its markers: told by the sightings that both have, and kept while a marker is dark.

use alloc::vec::Vec;

use crate::following::{Follower, MarkerTrack};
use crate::tracking::Tracked;

/// What a first sighting in common says.
const FIRST: f64 = 0.5;
/// By what share of what is missing to 1 each one more draws nearer, and by what share one with another vehicle takes away.
const NEARER: f64 = 0.25;
const FARTHER: f64 = 0.5;
/// Below this it belongs to the other.
const LEAST: f64 = 0.25;
/// No marker belongs to a vehicle more surely: what looks like one light may be two.
const MOST: f64 = 0.999;

/// A marker track, and the vehicle that it belongs to.
#[derive(Debug, Default)]
pub(super) struct Belonging {
    /// The camera that shows it, and the number of its marker track there.
    pub(super) camera: usize,
    pub(super) number: u64,
    /// The vehicle's track.
    pub(super) track: u64,
    /// The marker of the airframe, as the track is turned.
    pub(super) marker: Option<u16>,
    /// How sure that is, 0 to 1.
    pub(super) share: f64,
    /// How likely it is each word of the book; empty where too little was heard.
    pub(super) words: Vec<f64>,
}

/// All of them. Keeps its room.
#[derive(Debug, Default)]
pub(super) struct Belongings {
    all: Vec<Belonging>,
    spare: Vec<Belonging>,
}

impl Belongings {
    /// Those of a vehicle.
    pub(super) fn of(&self, track: u64) -> impl Iterator<Item = &Belonging> {
        self.all.iter().filter(move |own| own.track == track)
    }

    /// That of a marker track of a camera.
    pub(super) fn of_marker(&self, camera: usize, number: u64) -> Option<&Belonging> {
        self.all.iter().find(|own| (own.camera, own.number) == (camera, number))
    }

    /// Moves those of a camera on by a frame of it. Those whose marker is followed no more, or whose vehicle is not, end: `ended` is told the last that was
    /// heard of each.
    pub(super) fn follow(
        &mut self,
        camera: usize,
        follower: &Follower,
        tracked: &Tracked,
        mut ended: impl FnMut(&Belonging),
    ) {
        let (markers, spare) = (follower.tracks(), &mut self.spare);
        let is_over = |own: &mut Belonging| {
            let is_followed = || tracked.tracks.iter().any(|track| track.id == own.track);
            own.camera == camera && (find(markers, own.number).is_none() || !is_followed())
        };
        for over in self.all.extract_if(.., is_over) {
            ended(&over);
            spare.push(over);
        }
        for marker in markers {
            let seen = marker.sighting.and_then(|sighting| whose(tracked, sighting));
            let is_known = |own: &&mut Belonging| (own.camera, own.number) == (camera, marker.number);
            let known = self.all.iter_mut().find(is_known);
            match (known, seen) {
                (Some(own), Some((track, place))) => own.see(track, place),
                (None, Some((track, place))) => {
                    let mut own = spare.pop().unwrap_or_default();
                    (own.camera, own.number) = (camera, marker.number);
                    (own.track, own.marker, own.share) = (track, place, FIRST);
                    self.all.push(own);
                }
                // A light that is in no track is no marker of this one.
                (Some(own), None) if marker.sighting.is_some() => own.share *= 1.0 - FARTHER,
                (_, None) => {}
            }
        }
        for own in self.all.iter_mut().filter(|own| own.camera == camera) {
            follower.tell_words(own.number, &mut own.words);
        }
    }

    /// Forgets all.
    pub(super) fn forget(&mut self) {
        self.spare.append(&mut self.all);
    }
}

impl Belonging {
    /// It has a sighting in common with a vehicle.
    fn see(&mut self, track: u64, marker: Option<u16>) {
        if track == self.track {
            self.share = (self.share + NEARER * (1.0 - self.share)).min(MOST);
            self.marker = marker.or(self.marker);
            return;
        }
        self.share *= 1.0 - FARTHER;
        if self.share < LEAST {
            (self.track, self.marker, self.share) = (track, marker, FIRST);
        }
    }
}

/// The marker track of a number; they ascend.
fn find(markers: &[MarkerTrack], number: u64) -> Option<&MarkerTrack> {
    let place = markers.binary_search_by_key(&number, |marker| marker.number).ok()?;
    markers.get(place)
}

/// The vehicle that has a sighting, and which of its markers it is.
fn whose(tracked: &Tracked, sighting: usize) -> Option<(u64, Option<u16>)> {
    tracked.tracks.iter().find_map(|track| {
        let place = tracked.members(track).iter().position(|&own| own == sighting)?;
        Some((track.id, tracked.markers(track)[place]))
    })
}
