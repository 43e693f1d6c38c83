//! Observations by direction -> those nearest to one: a k-d tree over unit vectors, in which far ones are not looked at.
//!
//! Gaps are chords, rad for all that are near each other.

use alloc::vec::Vec;

use nalgebra::Vector3;

use super::Sighting;

/// So few are searched one by one.
const LEAF: usize = 8;

/// The directions of a frame's observations, to be searched.
#[derive(Debug, Default)]
pub(super) struct Near {
    /// Directions with the observation of each; every stretch is split at its middle, along the axis where it is widest.
    places: Vec<(Vector3<f64>, usize)>,
    /// The axis along which the stretch with this middle is split.
    axes: Vec<u8>,
    /// Of each observation the nearest, as many as were asked for, with the squared gaps.
    beside: Vec<(f64, usize)>,
    most: usize,
    nearest: Vec<(f64, usize)>,
}

impl Near {
    /// Sorts the observations of a frame, and finds the `most` that are nearest to each.
    pub(super) fn sort(&mut self, sightings: &[Sighting], most: usize) {
        self.places.clear();
        let directions = sightings.iter().map(|sighting| *sighting.bearing.vector());
        self.places.extend(directions.enumerate().map(|(index, direction)| (direction, index)));
        self.axes.clear();
        self.axes.resize(self.places.len(), 0);
        split(&mut self.places, &mut self.axes);
        self.most = (most + 1).min(sightings.len());
        self.beside.clear();
        let mut nearest = core::mem::take(&mut self.nearest);
        for sighting in sightings {
            self.nearest(sighting.bearing.vector(), self.most, &mut nearest);
            self.beside.extend_from_slice(&nearest);
        }
        self.nearest = nearest;
    }

    /// The observations nearest to one with their squared gaps, the nearest first: as many as the frame was sorted for, and one more where others are at
    /// its very place.
    pub(super) fn beside(&self, observation: usize) -> impl Iterator<Item = (f64, usize)> {
        let nearest = &self.beside[observation * self.most..][..self.most];
        nearest.iter().copied().filter(move |&(_, other)| other != observation)
    }

    /// Calls `with` for every observation that is nearer to a direction than `reach_rad`, and with the squared gap.
    pub(super) fn each_within(
        &self,
        direction: &Vector3<f64>,
        reach_rad: f64,
        mut with: impl FnMut(f64, usize),
    ) {
        search(&self.places, &self.axes, direction, &mut |gap2, index| {
            if gap2 < reach_rad * reach_rad {
                with(gap2, index);
            }
            reach_rad * reach_rad
        });
    }

    /// The `most` observations nearest to a direction with their squared gaps, the nearest first.
    fn nearest(&self, direction: &Vector3<f64>, most: usize, nearest: &mut Vec<(f64, usize)>) {
        nearest.clear();
        let before = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).is_lt();
        search(&self.places, &self.axes, direction, &mut |gap2, index| {
            let own = (gap2, index);
            if nearest.len() < most || before(&own, &nearest[most - 1]) {
                nearest.truncate(most - 1);
                let place = nearest.partition_point(|other| before(other, &own));
                nearest.insert(place, own);
            }
            if nearest.len() < most { f64::INFINITY } else { nearest[most - 1].0 }
        });
    }
}

/// Splits a stretch of places, and what it is split into.
fn split(places: &mut [(Vector3<f64>, usize)], axes: &mut [u8]) {
    if places.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = (places[0].0, places[0].0);
    for (place, _) in places.iter() {
        (low, high) = (low.inf(place), high.sup(place));
    }
    let axis = (high - low).imax();
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (before, rest) = places.split_at_mut(middle);
    let (axes_before, axes_rest) = axes.split_at_mut(middle);
    split(before, axes_before);
    split(&mut rest[1..], &mut axes_rest[1..]);
}

/// Shows the places of a stretch with their squared gaps, near ones first; what is shown tells the squared gap beyond which no more is asked for.
fn search(
    places: &[(Vector3<f64>, usize)],
    axes: &[u8],
    direction: &Vector3<f64>,
    show: &mut impl FnMut(f64, usize) -> f64,
) {
    if places.len() <= LEAF {
        for (place, index) in places {
            show((place - direction).norm_squared(), *index);
        }
        return;
    }
    let middle = places.len() / 2;
    let (place, index) = places[middle];
    let axis = usize::from(axes[middle]);
    let off = direction[axis] - place[axis];
    let before = (&places[..middle], &axes[..middle]);
    let after = (&places[middle + 1..], &axes[middle + 1..]);
    let (near, far) = if off < 0.0 { (before, after) } else { (after, before) };
    search(near.0, near.1, direction, show);
    let reach2 = show((place - direction).norm_squared(), index);
    if off * off <= reach2 {
        search(far.0, far.1, direction, show);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_is_nearest_is_what_one_by_one_would_find(
            places in prop::collection::vec(prop::array::uniform3(-3i32..3), 1..80),
            at in prop::array::uniform3(-4i32..4),
            most in 1usize..12,
            reach in 1u32..8,
        ) {
            let vector = |place: [i32; 3]| Vector3::from(place.map(f64::from));
            let mut near = Near::default();
            near.places.extend(places.iter().enumerate().map(|(index, place)| (vector(*place), index)));
            near.axes.resize(places.len(), 0);
            split(&mut near.places, &mut near.axes);
            let (at, reach) = (vector(at), f64::from(reach));
            let gap2 = |place: &[i32; 3]| (vector(*place) - at).norm_squared();
            let mut all: Vec<(f64, usize)> = places.iter().map(gap2).zip(0..).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut within = Vec::new();
            near.each_within(&at, reach, |gap2, index| within.push((gap2, index)));
            within.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            prop_assert_eq!(&within[..], &all[..all.partition_point(|(gap2, _)| *gap2 < reach * reach)]);
            let mut nearest = Vec::new();
            near.nearest(&at, most, &mut nearest);
            all.truncate(most);
            prop_assert_eq!(nearest, all);
        }
    }
}
