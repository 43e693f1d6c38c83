//! The paper's two estimates of distance, from the pair of neighbouring markers that is seen the widest.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::Vector3;

use super::Sighting;
use crate::airframe::Airframe;
use crate::ranging::AdjacentPair;

/// Pairs of markers that are neighbours in the ring of one kind of airframe.
#[derive(Debug)]
pub(super) struct Pairs {
    pair: Option<AdjacentPair>,
    /// The place of each marker in the ring, where the airframe is one.
    place_in_ring: Vec<usize>,
}

impl Pairs {
    pub(super) fn new(airframe: &Airframe) -> Self {
        let pair = airframe.ring().map(|ring| AdjacentPair::of(&ring));
        let count = airframe.markers().len() as f64;
        let centre_m =
            airframe.markers().iter().map(|marker| marker.position_m).sum::<Vector3<f64>>() / count;
        let yaw_rad = |marker: usize| {
            let from_centre_m = airframe.markers()[marker].position_m - centre_m;
            libm::atan2(from_centre_m.y, from_centre_m.x)
        };
        let mut order: Vec<usize> = (0..airframe.markers().len()).collect();
        order.sort_by(|&a, &b| yaw_rad(a).total_cmp(&yaw_rad(b)));
        let mut place_in_ring = vec![0; order.len()];
        for (place, marker) in order.into_iter().enumerate() {
            place_in_ring[marker] = place;
        }
        Self { pair, place_in_ring }
    }

    /// The paper's l_A and l_B of the widest angle between two markers that are neighbours in the ring, m.
    pub(super) fn distances_m(
        &self,
        sightings: &[Sighting],
        group: &[usize],
        markers: &[Option<u16>],
    ) -> [Option<f64>; 2] {
        let Some(pair) = self.pair else { return [None; 2] };
        let mut widest_rad: Option<f64> = None;
        for (i, first) in markers.iter().enumerate() {
            for (j, second) in markers[..i].iter().enumerate() {
                let (Some(first), Some(second)) = (first, second) else { continue };
                let [a, b] = [first, second].map(|&marker| self.place_in_ring[usize::from(marker)]);
                let apart = a.abs_diff(b);
                if apart == 1 || apart == self.place_in_ring.len() - 1 {
                    let alpha_rad = sightings[group[i]].bearing.angle_to(&sightings[group[j]].bearing);
                    widest_rad = Some(widest_rad.map_or(alpha_rad, |widest| widest.max(alpha_rad)));
                }
            }
        }
        let Some(alpha_rad) = widest_rad else { return [None; 2] };
        [pair.perpendicular_m(alpha_rad), pair.inline_m(alpha_rad)]
    }
}
