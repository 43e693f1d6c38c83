//! Which track follows which marker, over time.

use std::collections::BTreeSet;

use nalgebra::{Vector2, Vector3};
use photinus::camera::Bearing;
use photinus::following::MarkerTrack;

use crate::world::World;

/// A track farther from a marker than this, rad (4 px), and than 4 of its own standard deviations, does not follow it.
const FOLLOWS_RAD: f64 = 0.015;
const FOLLOWS_SIGMAS: f64 = 4.0;

/// A marker counts when it has been in the image for so many frames.
const SETTLED: usize = 60;

/// A track of any follower.
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    pub number: u64,
    pub ahead: Vector3<f64>,
    pub sigma_rad: f64,
    /// Whether it is said to be there, rather than not.
    pub is_there: bool,
}

impl From<&MarkerTrack> for Followed {
    fn from(track: &MarkerTrack) -> Self {
        Self {
            number: track.number,
            ahead: *track.bearing.vector(),
            sigma_rad: (0.5 * track.bearing_covariance_rad2().trace()).sqrt(),
            is_there: track.existence > 0.5,
        }
    }
}

impl Followed {
    pub fn gap(&self, ahead: &Vector3<f64>) -> f64 {
        (self.ahead - ahead).norm()
    }

    fn is_near(&self, ahead: &Vector3<f64>) -> bool {
        self.gap(ahead) < FOLLOWS_RAD.max(FOLLOWS_SIGMAS * self.sigma_rad)
    }
}

/// The nearest track to a direction, if it follows what is there.
pub fn nearest(tracks: &[Followed], ahead: &Vector3<f64>) -> Option<Followed> {
    let near = tracks.iter().filter(|track| track.is_near(ahead));
    near.min_by(|a, b| a.gap(ahead).total_cmp(&b.gap(ahead))).copied()
}

/// What happened to markers that have settled.
#[derive(Debug, Default)]
pub struct Score {
    /// By marker: the track that follows it.
    own: Vec<Option<u64>>,
    /// By marker: frames in the image in a row.
    inside: Vec<usize>,
    /// Markers without a track, added up over frames.
    pub lost: usize,
    /// How often a marker passed to another track.
    pub switches: usize,
    /// Tracks that no marker is near, well inside the image, added up over frames.
    pub false_tracks: usize,
    /// Markers, added up over frames.
    pub markers: usize,
    pub frames: usize,
}

impl Score {
    pub fn add(&mut self, world: &World, tracks: &[Followed]) {
        self.frames += 1;
        self.own.resize(world.markers.len(), None);
        self.inside.resize(world.markers.len(), 0);
        let mut near_one = BTreeSet::new();
        for index in 0..world.markers.len() {
            let (ahead, _) = world.truth(index);
            near_one.extend(tracks.iter().filter(|track| track.is_near(&ahead)).map(|track| track.number));
            self.inside[index] = if world.is_there(index) { self.inside[index] + 1 } else { 0 };
            if !self.is_settled(index) {
                self.own[index] = None;
                continue;
            }
            self.markers += 1;
            let own = tracks.iter().find(|track| Some(track.number) == self.own[index]);
            let own = own.filter(|track| track.is_near(&ahead)).copied();
            let Some(track) = own.or_else(|| nearest(tracks, &ahead)) else {
                self.lost += 1;
                continue;
            };
            self.switches += usize::from(self.own[index].is_some_and(|own| own != track.number));
            self.own[index] = Some(track.number);
        }
        let is_false = |track: &&Followed| {
            let is_inside = Bearing::new(track.ahead).is_some_and(|bearing| world.is_inside(&bearing));
            track.is_there && is_inside && !near_one.contains(&track.number)
        };
        self.false_tracks += tracks.iter().filter(is_false).count();
    }

    fn is_settled(&self, index: usize) -> bool {
        self.is_settled_for(index, SETTLED)
    }

    /// Whether a marker has been in the image for more frames than this.
    pub fn is_settled_for(&self, index: usize, frames: usize) -> bool {
        self.inside[index] > frames
    }

    /// The track of a marker that has settled.
    pub fn own(&self, index: usize) -> Option<u64> {
        self.own[index]
    }
}

/// Squared errors of bearing and rate by their covariances: 2 each on the mean where these are right.
#[derive(Debug, Default)]
pub struct Nees {
    sums: [f64; 2],
    count: usize,
}

impl Nees {
    pub fn add(&mut self, track: &MarkerTrack, (ahead, rate): (Vector3<f64>, Vector3<f64>)) {
        let off = track.axes.transpose() * (ahead - track.bearing.vector());
        let rate_off = track.axes.transpose() * (rate - track.rate_rad_s);
        let squared = |off: Vector2<f64>, at: usize| {
            let block = track.covariance.fixed_view::<2, 2>(at, at).into_owned();
            off.dot(&(block.try_inverse().unwrap() * off))
        };
        self.sums[0] += squared(off, 0);
        self.sums[1] += squared(rate_off, 2);
        self.count += 1;
    }

    pub fn means(&self) -> [f64; 2] {
        self.sums.map(|sum| sum / self.count as f64)
    }
}
