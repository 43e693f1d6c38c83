//! A pose -> which spot is which marker: the nearest, each marker once.

use alloc::vec::Vec;

use super::observation::Observation;
use super::problem::Pose;
use crate::airframe::Airframe;

/// Room for pairs of spot and marker.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    /// Squared distance of directions, spot, marker.
    pairs: Vec<(f64, u16, u16)>,
    taken: Vec<bool>,
}

impl Assignment {
    /// Room for this many spots and markers.
    pub(crate) fn with_room(markers: usize) -> Self {
        Self { pairs: Vec::with_capacity(markers * markers), taken: Vec::with_capacity(2 * markers) }
    }

    /// Gives every spot the nearest marker that shines towards the camera and is not yet taken, the nearest pairs first;
    /// `None` where no marker is left. Returns whether any spot changed.
    pub(crate) fn assign(
        &mut self,
        airframe: &Airframe,
        pose: &Pose,
        observations: &[Observation],
        markers: &mut [Option<u16>],
    ) -> bool {
        let camera_in_body_m = pose.camera_in_body_m();
        self.pairs.clear();
        for (number, marker) in airframe.markers().iter().enumerate() {
            if !airframe.is_visible(number, &camera_in_body_m) {
                continue;
            }
            let direction = (pose.camera_from_body * marker.position_m + pose.position_m).normalize();
            for (spot, seen) in observations.iter().enumerate() {
                let gap = (seen.bearing.vector() - direction).norm_squared();
                self.pairs.push((gap, spot as u16, number as u16));
            }
        }
        self.pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        self.taken.clear();
        self.taken.resize(airframe.markers().len() + observations.len(), false);
        let mut changed = false;
        for &(_, spot, marker) in &self.pairs {
            let (of_marker, of_spot) = (usize::from(marker), airframe.markers().len() + usize::from(spot));
            if self.taken[of_marker] || self.taken[of_spot] {
                continue;
            }
            self.taken[of_marker] = true;
            self.taken[of_spot] = true;
            let place = &mut markers[usize::from(spot)];
            changed |= *place != Some(marker);
            *place = Some(marker);
        }
        for (spot, place) in markers.iter_mut().enumerate() {
            if !self.taken[airframe.markers().len() + spot] {
                changed |= place.is_some();
                *place = None;
            }
        }
        changed
    }
}
