//! Markers that were heard, the tracks that they belong to, and names -> vehicles of a fleet that have no track of their own.
//!
//! A vehicle that shows one LED beside another that shows two looks like one neighbour of three, in every frame in which both are lit, and one LED alone may be
//! any light. What they blink tells: a track that has markers of two vehicles is neither, and who is heard is there.

use alloc::vec::Vec;

use super::belonging::Belongings;
use super::directory::Directory;
use super::naming::Naming;
use crate::following::MarkerTrack;
use crate::tracking::{Calls, SURELY_HEARD, Tracked};

/// A marker belongs to a track from this share on, and to none below the other.
const SURELY_ITS: f64 = 0.9;
const SURELY_NOT: f64 = 0.25;

/// Vehicles that have no track of their own. Keeps its room.
#[derive(Debug, Default)]
pub(super) struct Missing {
    /// Vehicle, and the track that surely has the marker.
    heard: Vec<(u32, Option<u64>)>,
    calls: Vec<(u32, Calls)>,
}

impl Missing {
    /// Finds them among the markers that are followed in a camera.
    pub(super) fn find(
        &mut self,
        (camera, markers): (usize, &[MarkerTrack]),
        directory: &Directory,
        (belongings, naming): (&Belongings, &Naming),
        tracked: &Tracked,
    ) {
        self.hear(camera, markers, directory, belongings);
        self.calls.clear();
        // Who would have LEDs unlike all others' is to be placed by what was heard of it, too.
        for track in tracked.tracks.iter().filter(|track| track.is_odd) {
            let is_name = |heard: &&(u32, Option<u64>)| naming.likely_track(heard.0) == Some(track.id);
            let name = self.heard.iter().find(is_name);
            self.calls.extend(name.map(|&(vehicle, _)| (vehicle, Calls::Doubting(track.id))));
        }
        for place in 0..self.heard.len() {
            let (vehicle, track) = self.heard[place];
            let has_other_track = naming.likely_track(vehicle).is_some_and(|other| Some(other) != track);
            if has_other_track || tracked.is_followed(vehicle) || self.call(vehicle).is_some() {
                continue;
            }
            let calls = match track {
                Some(track) => self.is_mixed_into(track, vehicle, naming).then_some(Calls::InsteadOf(track)),
                // Another of its markers may have a track.
                None => {
                    self.heard.iter().all(|own| own.0 != vehicle || own.1.is_none()).then_some(Calls::New)
                }
            };
            self.calls.extend(calls.map(|calls| (vehicle, calls)));
        }
    }

    /// Takes in whose markers are heard, and which tracks have them; those for which that is not clear are left out.
    fn hear(
        &mut self,
        camera: usize,
        markers: &[MarkerTrack],
        directory: &Directory,
        belongings: &Belongings,
    ) {
        self.heard.clear();
        for marker in markers {
            let identity = marker.identity.filter(|own| own.probability > SURELY_HEARD);
            let Some(entry) = identity.and_then(|own| directory.entry(own.who)) else { continue };
            match belongings.of_marker(camera, marker.number) {
                Some(own) if own.share > SURELY_ITS => self.heard.push((entry.vehicle, Some(own.track))),
                Some(own) if own.share > SURELY_NOT => {}
                _ => self.heard.push((entry.vehicle, None)),
            }
        }
    }

    /// Whether a track has another vehicle's markers beside those of this one, and is rather this one: by its name, or else by most of its markers. One vehicle
    /// is enough for a track.
    fn is_mixed_into(&self, track: u64, vehicle: u32, naming: &Naming) -> bool {
        let of_track = || self.heard.iter().filter(|own| own.1 == Some(track)).map(|own| own.0);
        if of_track().all(|own| own == vehicle)
            || self.calls.iter().any(|own| own.1 == Calls::InsteadOf(track))
        {
            return false;
        }
        let is_name = |own: u32| naming.likely_track(own) == Some(track);
        let count = |of: u32| of_track().filter(|&own| own == of).count();
        is_name(vehicle)
            || of_track().all(|own| own == vehicle || !is_name(own) && count(own) <= count(vehicle))
    }

    /// How a vehicle may call, if it is one of them.
    pub(super) fn call(&self, vehicle: u32) -> Option<Calls> {
        self.calls.iter().find(|call| call.0 == vehicle).map(|call| call.1)
    }
}
