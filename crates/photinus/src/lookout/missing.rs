//! Markers that were heard, the tracks that they belong to, and names -> vehicles of a fleet that have no track of their own.
//!
//! A vehicle that shows one LED beside another that shows two looks like one neighbour of three, in every frame in which both are lit, and one LED alone may be
//! any light. What they blink tells: a track that has markers of two vehicles is neither, and who is heard is there.

use alloc::vec::Vec;

use super::SURELY_HEARD;
use super::belonging::Belongings;
use super::directory::Directory;
use super::naming::Naming;
use crate::following::MarkerTrack;
use crate::tracking::{Calls, Tracked};

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
        let Self { heard, calls } = self;
        heard.clear();
        calls.clear();
        for marker in markers {
            let identity = marker.identity.filter(|own| own.probability > SURELY_HEARD);
            let Some(entry) = identity.and_then(|own| directory.entry(own.who)) else { continue };
            let own = belongings.of_marker(camera, marker.number);
            match own {
                Some(own) if own.share > SURELY_ITS => heard.push((entry.vehicle, Some(own.track))),
                Some(own) if own.share > SURELY_NOT => {}
                _ => heard.push((entry.vehicle, None)),
            }
        }
        let is_followed = |vehicle: u32| tracked.is_followed(vehicle);
        let is_named = |vehicle: u32, but: Option<u64>| {
            naming.likely_track(vehicle).is_some_and(|track| Some(track) != but)
        };
        // Who would have LEDs unlike all others' is to be placed by what was heard of it, too.
        for track in tracked.tracks.iter().filter(|track| track.is_odd) {
            let name = heard.iter().map(|own| own.0).find(|&own| naming.likely_track(own) == Some(track.id));
            calls.extend(name.map(|vehicle| (vehicle, Calls::Doubting(track.id))));
        }
        for place in 0..heard.len() {
            let (vehicle, track) = heard[place];
            if calls.iter().any(|call| call.0 == vehicle) || is_followed(vehicle) || is_named(vehicle, track)
            {
                continue;
            }
            let Some(track) = track else {
                // Another of its markers may have a track.
                if !heard.iter().any(|other| other.0 == vehicle && other.1.is_some()) {
                    calls.push((vehicle, Calls::New));
                }
                continue;
            };
            let of_track = |own: &&(u32, Option<u64>)| own.1 == Some(track);
            let is_mixed = heard.iter().filter(of_track).any(|other| other.0 != vehicle);
            let count = |of: u32| heard.iter().filter(of_track).filter(|own| own.0 == of).count();
            let is_its = naming.likely_track(vehicle) == Some(track);
            let has_most = heard.iter().filter(of_track).all(|other| {
                other.0 == vehicle
                    || naming.likely_track(other.0) != Some(track) && count(other.0) <= count(vehicle)
            });
            let is_taken = calls.iter().any(|call| call.1 == Calls::InsteadOf(track));
            if is_mixed && !is_taken && (is_its || has_most) {
                calls.push((vehicle, Calls::InsteadOf(track)));
            }
        }
    }

    /// How a vehicle may call, if it is one of them.
    pub(super) fn call(&self, vehicle: u32) -> Option<Calls> {
        self.calls.iter().find(|call| call.0 == vehicle).map(|call| call.1)
    }
}
