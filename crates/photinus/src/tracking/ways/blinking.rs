//! Markers that blink and are followed one by one -> which markers of a vehicle are lit, if it is turned so.
//!
//! A marker of the vehicle is lit as the followed one is that is where it must be, whoever that is. Where none is, those that are known to blink the same
//! signal tell it; else nobody does. It is told anew for each way to see a vehicle: which marker is which is just what ways differ in.

use alloc::vec::Vec;

use super::super::look::Followed;
use super::super::step::Model;
use crate::pose::Pose;

/// A marker is the followed one so near to it, in radii of the vehicle: markers stand farther apart.
const SAME_PLACE_RADII: f64 = 0.25;

/// This share of exposures straddles an edge of what an LED blinks, and a marker that shines for a part of one shows so likely.
const PARTLY: f64 = 0.06;
const DIM_SHOWS: f64 = 0.5;

/// The markers that are followed near a vehicle. Keeps its room.
#[derive(Debug, Default)]
pub(super) struct Blinking {
    near: Vec<Followed>,
    /// The followed marker of each of the airframe's, by place.
    found: Vec<Option<usize>>,
    track: u64,
}

impl Blinking {
    /// Begins with a vehicle.
    pub(super) fn begin<'a>(&mut self, track: u64, near: impl Iterator<Item = &'a Followed>) {
        self.track = track;
        self.near.clear();
        self.near.extend(near);
    }

    /// How likely the LEDs of a vehicle that blink alike are lit, at a pose: those that are known to be its own tell it, else those that are where its markers must
    /// be and are not known to be another's.
    pub(super) fn alike(&mut self, model: &Model, pose: &Pose, others_lit: f64) -> f64 {
        self.find(model, pose);
        let is_own = |own: &usize| self.signal(*own).is_some();
        let is_free = |own: &usize| self.near[*own].signal.is_none();
        let there = self.found.iter().flatten().copied();
        let own = self.mean_lit((0..self.near.len()).filter(is_own));
        own.or_else(|| self.mean_lit(there.filter(is_free))).unwrap_or(others_lit)
    }

    fn mean_lit(&self, markers: impl Iterator<Item = usize>) -> Option<f64> {
        let (lit, count) = markers.fold((0.0, 0), |(lit, count), own| (lit + self.near[own].lit, count + 1));
        (count > 0).then(|| lit / f64::from(count))
    }

    /// Fills in how likely each marker is lit at a pose, where LEDs blink each for itself.
    pub(super) fn light(&mut self, model: &Model, pose: &Pose, others_lit: f64, lit: &mut [f64]) {
        self.find(model, pose);
        let turn = self.likeliest_turn(model);
        for (marker, lit) in lit.iter_mut().enumerate() {
            let own = self.found[marker].map(|own| self.near[own].lit);
            *lit = own.or_else(|| self.same_signal(model, marker, turn?)).unwrap_or(others_lit);
        }
    }

    /// Finds the followed marker that is where each of the airframe's must be at a pose.
    fn find(&mut self, model: &Model, pose: &Pose) {
        let Self { near, found, .. } = self;
        let reach = SAME_PLACE_RADII * model.airframe.max_radius_m() / pose.position_m.norm().max(1e-3);
        found.clear();
        found.extend(model.airframe.markers().iter().map(|marker| {
            let ahead = (pose.camera_from_body * marker.position_m + pose.position_m).normalize();
            let off = near.iter().map(|own| (own.bearing.vector() - ahead).norm_squared()).enumerate();
            off.min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|nearest| nearest.1 < reach * reach)
                .map(|nearest| nearest.0)
        }));
    }

    /// The signal that a followed marker of this vehicle blinks, where it is known.
    fn signal(&self, own: usize) -> Option<u32> {
        self.near[own].signal.filter(|signal| signal.0 == self.track).map(|signal| signal.1)
    }

    /// The turn of a symmetric airframe in which most markers blink what they must; `None` where no signal is known.
    fn likeliest_turn(&self, model: &Model) -> Option<usize> {
        (0..self.near.len()).find_map(|own| self.signal(own))?;
        let is_right = |turn: usize, (marker, own): (usize, &Option<usize>)| {
            let signal = own.and_then(|own| self.signal(own));
            signal.is_some_and(|signal| model.blinks(model.symmetry.turned(turn, marker as u16), signal))
        };
        let right =
            |turn: &usize| self.found.iter().enumerate().filter(|&pair| is_right(*turn, pair)).count();
        (0..model.symmetry.told_apart()).max_by_key(|turn| (right(turn), core::cmp::Reverse(*turn)))
    }

    /// How likely a marker is lit by those that blink as it does.
    fn same_signal(&self, model: &Model, marker: usize, turn: usize) -> Option<f64> {
        let place = model.symmetry.turned(turn, marker as u16);
        let is_same = |own: &usize| self.signal(*own).is_some_and(|signal| model.blinks(place, signal));
        (0..self.near.len()).find(is_same).map(|own| self.near[own].lit)
    }
}

/// How likely LEDs that blink alike show, lit so likely: in an exposure that straddles an edge they do so dimly. Those beside one that is seen shine as it does, and show as far as
/// its light says.
pub(super) fn show(alike: f64) -> f64 {
    (1.0 - PARTLY) * alike + PARTLY * DIM_SHOWS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dark_shows_where_the_exposure_straddles_an_edge() {
        assert!((0.01..0.05).contains(&show(0.0)));
        assert!((0.45..0.55).contains(&show(0.5)));
        assert!((0.95..1.0).contains(&show(1.0)));
    }
}
