//! Which track follows which marker, over time.

use std::collections::BTreeSet;

use nalgebra::{Vector2, Vector3};
use photinus::following::MarkerTrack;

use crate::world::World;

/// A track farther from a marker than this, rad (4 px), and than 4 of its own standard deviations, does not follow it.
const FOLLOWS_RAD: f64 = 0.015;
const FOLLOWS_SIGMAS: f64 = 4.0;

/// A marker counts when it has been in the image for so many frames.
const SETTLED: usize = 60;

/// What happened to markers that have settled.
#[derive(Debug, Default)]
pub struct Score {
    /// By marker: the track that follows it.
    own: Vec<Option<u64>>,
    /// By marker: frames in the image in a row.
    inside: Vec<usize>,
    /// Frames in which a marker had no track.
    pub lost: usize,
    /// How often a marker passed to another track.
    pub switches: usize,
    /// Tracks that no marker is near, added up over frames.
    pub false_tracks: usize,
    pub frames: usize,
    pub numbers: BTreeSet<u64>,
    pub closest: Vec<(f64, f64)>,
    nees: [f64; 2],
    counted: usize,
}

impl Score {
    pub fn add(&mut self, world: &World, tracks: &[MarkerTrack]) {
        self.frames += 1;
        self.own.resize(world.markers.len(), None);
        self.inside.resize(world.markers.len(), 0);
        let mut near_one = BTreeSet::new();
        self.closest.resize(world.markers.len(), (1.0, 0.0));
        for index in 0..world.markers.len() {
            for o in 0..world.markers.len() { if o != index && world.is_there(o) {
                let d = (world.markers[o].ahead - world.markers[index].ahead).norm();
                if d < self.closest[index].0 { self.closest[index] = (d, world.time_s); }
            } }
            let (ahead, rate) = world.truth(index);
            let gap = |track: &MarkerTrack| (track.bearing.vector() - ahead).norm();
            let sigma = |track: &MarkerTrack| (0.5 * track.bearing_covariance_rad2().trace()).sqrt();
            let near = |track: &&MarkerTrack| gap(track) < FOLLOWS_RAD.max(FOLLOWS_SIGMAS * sigma(track));
            near_one.extend(tracks.iter().filter(near).map(|track| track.number));
            self.inside[index] = if world.is_there(index) { self.inside[index] + 1 } else { 0 };
            if !self.is_settled(index) {
                self.own[index] = None;
                continue;
            }
            let own = tracks.iter().find(|track| Some(track.number) == self.own[index]).filter(near);
            let nearest = tracks.iter().filter(near).min_by(|a, b| gap(a).total_cmp(&gap(b)));
            let Some(track) = own.or(nearest) else {
                println!("lost {index} at {} closest {:?} {:?}", world.time_s, self.closest[index], self.own[index]);
                self.lost += 1;
                continue;
            };
            if self.own[index].is_some_and(|own| own != track.number) {
                println!("switch {index} at {} closest {:?} {:?}->{}", world.time_s, self.closest[index], self.own[index], track.number);
                self.switches += 1;
            }
            if std::env::var("DBG").is_ok_and(|v| v == format!("{index}")) {
                println!("{:.3} #{} gap {:.4} sig {:.4} ex {:.3} lit {:.2} s {:?} {:.2} {:?} rate {:.2} true {:.3?} at {:.3?}", world.time_s, track.number, gap(track), track.covariance[(0,0)].sqrt(), track.existence, track.lit, track.sighting, track.sighting_probability, track.identity, track.rate_rad_s.norm(), rate.as_slice(), ahead.as_slice());
            }
            self.own[index] = Some(track.number);
            self.count(track, &ahead, &rate);
        }
        self.numbers.extend(tracks.iter().map(|track| track.number));
        self.false_tracks += tracks.iter().filter(|track| track.existence > 0.5 && !near_one.contains(&track.number) && world.camera.pixel(&track.bearing).is_some_and(|p| p.u>8.0&&p.u<744.0&&p.v>8.0&&p.v<472.0)).count();
    }

    pub fn is_settled(&self, index: usize) -> bool {
        self.inside[index] > SETTLED
    }

    fn count(&mut self, track: &MarkerTrack, ahead: &Vector3<f64>, rate: &Vector3<f64>) {
        let off = track.axes.transpose() * (ahead - track.bearing.vector());
        let rate_off = track.axes.transpose() * (rate - track.rate_rad_s);
        let squared = |off: Vector2<f64>, at: usize| {
            let block = track.covariance.fixed_view::<2, 2>(at, at).into_owned();
            off.dot(&(block.try_inverse().unwrap() * off))
        };
        self.nees[0] += squared(off, 0);
        self.nees[1] += squared(rate_off, 2);
        self.counted += 1;
    }

    /// Mean squared errors of bearing and rate by their covariances: 2 each where these are right.
    pub fn nees(&self) -> [f64; 2] {
        self.nees.map(|sum| sum / self.counted as f64)
    }
}
