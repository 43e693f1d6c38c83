//! What is believed after a frame: every vehicle, as a sum of normal distributions, with how likely it exists.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Unit, Vector3};

use super::appearing::LOST_S;
use super::clutter::{self, ClutterPoint};
use super::component::Component;
use super::look::Moving;
use crate::camera::Rig;

/// Most vehicles that are followed at once.
pub(super) const MOST_TARGETS: usize = 64;
/// Most normal distributions of one vehicle.
pub(super) const MOST_COMPONENTS: usize = 12;
/// A vehicle is where one of its distributions has it from this weight on.
const SURELY_THERE: f64 = 0.9;
/// Points of clutter in a frame before any was seen.
const CLUTTER_BEFOREHAND: f64 = 0.5;

/// A vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    pub(super) id: u64,
    /// Who it was heard to be when it appeared.
    pub(super) vehicle: Option<u32>,
    /// How likely it exists.
    pub(super) existence: f64,
    /// How likely it is hidden, if it exists.
    pub(super) hidden: f64,
    /// When it was seen last, s, and by which camera; and when each saw it last.
    pub(super) seen_s: f64,
    pub(super) seen_by: usize,
    pub(super) seen_by_each_s: [f64; Rig::MOST],
    /// Whether it is not seen in this frame, nor was in the last one of another camera.
    pub(super) is_predicted: bool,
    /// Whether its LEDs would be stronger or weaker than those of all others, were it where it is believed to be.
    pub(super) is_odd: bool,
    /// What the camera's calibration leaves open of its direction, rad^2.
    pub(super) calibration_rad2: Matrix3<f64>,
    /// How likely it has settled for a wrong pose, as the logarithm of odds.
    pub(super) log_wrong: f64,
    pub(super) first_component: usize,
    pub(super) components: usize,
    pub(super) first_member: usize,
    pub(super) members: usize,
}

/// All that is believed at a time.
#[derive(Debug)]
pub(super) struct State {
    /// Whose axes all is told in.
    pub(super) camera: usize,
    pub(super) time_s: f64,
    pub(super) next_id: u64,
    /// Away from the ground, camera frame, where it is known.
    pub(super) up: Option<Unit<Vector3<f64>>>,
    /// How far vehicles tilt, where frames tell it, rad.
    pub(super) tilt_sigma_rad: Option<f64>,
    /// How what carries the camera moves, body axes, where it is known.
    pub(super) moving: Option<Moving>,
    /// Points of clutter in a frame, on average, by camera.
    pub(super) clutter: [f64; Rig::MOST],
    /// When the last frame of each camera was, s.
    pub(super) frames_s: [f64; Rig::MOST],
    pub(super) targets: Vec<Target>,
    pub(super) components: Vec<Component>,
    /// Sightings that updated a vehicle.
    pub(super) members: Vec<usize>,
    /// Which marker each of them most probably is.
    pub(super) markers: Vec<Option<u16>>,
    /// Lights that are nobody's.
    pub(super) persistent: Vec<ClutterPoint>,
}

impl State {
    /// Nobody yet.
    pub(super) fn empty(time_s: f64, next_id: u64) -> Self {
        Self {
            camera: 0,
            time_s,
            next_id,
            up: None,
            tilt_sigma_rad: None,
            moving: None,
            clutter: [CLUTTER_BEFOREHAND; Rig::MOST],
            frames_s: [f64::NEG_INFINITY; Rig::MOST],
            targets: Vec::with_capacity(MOST_TARGETS),
            components: Vec::with_capacity(2 * MOST_TARGETS),
            members: Vec::with_capacity(128),
            markers: Vec::with_capacity(128),
            persistent: Vec::with_capacity(clutter::MOST),
        }
    }

    /// Forgets everybody.
    pub(super) fn clear(&mut self, camera: usize, time_s: f64, next_id: u64) {
        (self.camera, self.time_s, self.next_id) = (camera, time_s, next_id);
        (self.up, self.moving) = (None, None);
        self.clutter = [CLUTTER_BEFOREHAND; Rig::MOST];
        self.frames_s = [f64::NEG_INFINITY; Rig::MOST];
        self.targets.clear();
        self.components.clear();
        self.members.clear();
        self.markers.clear();
        self.persistent.clear();
    }

    /// Whether a vehicle that was heard would have shown by now where its track is.
    pub(super) fn is_lost(&self, target: &Target) -> bool {
        self.time_s - target.seen_s > LOST_S
    }

    /// Ends the younger of two tracks that surely stand in one place, where there is room for one vehicle of this radius only.
    pub(super) fn end_doubles(&mut self, radius_m: f64) {
        let mut place = 1;
        while place < self.targets.len() {
            let is_older = |older: &Target| self.is_double(older, &self.targets[place], radius_m);
            if self.targets[..place].iter().any(is_older) {
                self.targets.remove(place);
            } else {
                place += 1;
            }
        }
    }

    /// Whether each of two tracks is known to less than a radius, and they are nearer to each other than that.
    fn is_double(&self, one: &Target, other: &Target, radius_m: f64) -> bool {
        let [Some(one), Some(other)] = [one, other].map(|target| self.components(target).first()) else {
            return false;
        };
        let is_known =
            |own: &Component| own.weight > SURELY_THERE && own.block(0).trace() < radius_m * radius_m;
        let apart_m = (one.pose.position_m - other.pose.position_m).norm();
        apart_m < radius_m && is_known(one) && is_known(other)
    }

    /// The normal distributions of a vehicle, the heaviest first.
    pub(super) fn components(&self, target: &Target) -> &[Component] {
        &self.components[target.first_component..][..target.components]
    }

    /// The sightings of the last frame that updated it.
    pub(super) fn members(&self, target: &Target) -> &[usize] {
        &self.members[target.first_member..][..target.members]
    }

    /// Which marker each of these is.
    pub(super) fn markers(&self, target: &Target) -> &[Option<u16>] {
        &self.markers[target.first_member..][..target.members]
    }
}

#[cfg(test)]
impl Target {
    /// Somebody who is seen at a time, and of whom nothing else is known.
    pub(super) fn somebody(seen_s: f64) -> Self {
        Self {
            id: 0,
            vehicle: None,
            existence: 1.0,
            hidden: 0.0,
            seen_s,
            seen_by: 0,
            seen_by_each_s: [seen_s; Rig::MOST],
            is_predicted: false,
            is_odd: false,
            calibration_rad2: Matrix3::zeros(),
            log_wrong: 0.0,
            first_component: 0,
            components: 0,
            first_member: 0,
            members: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.4;

    /// Who is left of vehicles at these distances straight ahead, known to so much, m.
    fn left(places: &[(f64, f64)]) -> Vec<u64> {
        let mut state = State::empty(0.0, 0);
        for (place, &(ahead_m, sigma_m)) in places.iter().enumerate() {
            state.components.push(Component::somewhere(Vector3::z() * ahead_m, sigma_m));
            state.targets.push(Target {
                id: place as u64,
                first_component: place,
                components: 1,
                ..Target::somebody(0.0)
            });
        }
        state.end_doubles(RADIUS_M);
        state.targets.iter().map(|target| target.id).collect()
    }

    #[test]
    fn of_two_in_one_place_the_younger_ends() {
        assert_eq!(left(&[(5.0, 0.1), (9.0, 0.1), (5.2, 0.1), (5.1, 0.2)]), [0, 1]);
        // Two that nearly touch, and one that may be anywhere along the line of sight.
        assert_eq!(left(&[(5.0, 0.1), (5.5, 0.1)]), [0, 1]);
        assert_eq!(left(&[(5.0, 0.1), (5.1, 0.5)]), [0, 1]);
        assert!(left(&[]).is_empty());
    }
}
