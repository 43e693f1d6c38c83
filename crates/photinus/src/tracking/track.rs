//! What is believed -> what is told: for each vehicle one mean and one covariance.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::component::{Component, merged};
use super::existence::Existence;
use super::motion::Motion;
use super::state::{MOST_COMPONENTS, State};
use super::step::Model;
use crate::locator::of_mean_calibration;
use crate::pose::Symmetry;

/// A vehicle that is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// The same as long as it is followed; never given to another.
    pub id: u64,
    /// Where its airframe's origin is relative to the camera, m, in axes that do not rotate and are the camera's at the stamp.
    pub position_m: Vector3<f64>,
    /// How that changes, m/s; of a camera of a rig, relative to the origin of the body that carries it: what swings the camera beside it is none of it.
    pub velocity_m_s: Vector3<f64>,
    /// Its attitude: maps the body's coordinates to the camera's, yaw as for [`crate::locator::Orientation`].
    pub camera_from_body: Rotation3<f64>,
    /// Covariance of the position, m^2.
    pub position_covariance_m2: Matrix3<f64>,
    /// Covariance of the velocity, m^2/s^2.
    pub velocity_covariance_m2_s2: Matrix3<f64>,
    /// Covariance of the position (lines) with the velocity (columns), m^2/s.
    pub position_velocity_covariance_m2_s: Matrix3<f64>,
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    pub orientation_covariance_rad2: Matrix3<f64>,
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    pub position_orientation_covariance_m_rad: Matrix3<f64>,
    /// How likely it exists, 0 to 1.
    pub existence: f64,
    /// Whether nothing of it was seen at the stamp: it coasts. Of a rig: nor in the last frame of another camera.
    pub is_predicted: bool,
    /// Who it was heard to be when it appeared.
    pub(crate) vehicle: Option<u32>,
    /// Whether its LEDs would be stronger or weaker than those of all others, were it where it is believed to be.
    pub(crate) is_odd: bool,
    /// Whether it would have shown by now where it is, if it was heard.
    is_lost: bool,
    first_member: usize,
    members: usize,
}

/// Where a frame came in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placed {
    /// It is the newest.
    #[default]
    Newest,
    /// It was late, and took its place.
    Late,
    /// The clock had jumped: all tracks were forgotten before it.
    Reset,
}

/// The tracks at a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracked {
    /// The stamp, s.
    pub time_s: f64,
    /// Which camera's axes all is told in.
    pub camera: usize,
    /// Where the frame that was handed in last came in.
    pub placed: Placed,
    /// The vehicles that are followed, in the order in which they appeared.
    pub tracks: Vec<Track>,
    members: Vec<usize>,
    markers: Vec<Option<u16>>,
}

impl Tracked {
    /// Which sightings of the frame updated a track, ascending; none where a time between frames was asked for.
    pub fn members(&self, track: &Track) -> &[usize] {
        own(&self.members, track)
    }

    /// Which marker of the airframe each of [`Self::members`] is, one for each: `None` where that is not clear. Of a symmetric airframe they are those of
    /// the told attitude.
    pub fn markers(&self, track: &Track) -> &[Option<u16>] {
        own(&self.markers, track)
    }

    /// Whether a vehicle that was heard is followed, and not lost.
    pub(crate) fn is_followed(&self, vehicle: u32) -> bool {
        self.tracks.iter().any(|track| track.vehicle == Some(vehicle) && !track.is_lost)
    }

    /// The same as another, in the room that it has.
    pub(crate) fn take_over(&mut self, other: &Self) {
        (self.time_s, self.camera, self.placed) = (other.time_s, other.camera, other.placed);
        self.tracks.clone_from(&other.tracks);
        self.members.clone_from(&other.members);
        self.markers.clone_from(&other.markers);
    }

    /// Turns vehicles, where a turn of their symmetric airframe is known to be the true one.
    pub(crate) fn turn<'a>(&mut self, turn: impl Fn(u64) -> Option<(&'a Symmetry, usize)>) {
        for track in &mut self.tracks {
            let Some((symmetry, turn)) = turn(track.id) else { continue };
            let symmetric = symmetry.turn(turn);
            // Covariances of the attitude are along the axes of the body, which turn.
            let axes = symmetric.matrix();
            track.camera_from_body *= symmetric;
            track.orientation_covariance_rad2 = axes.transpose() * track.orientation_covariance_rad2 * axes;
            track.position_orientation_covariance_m_rad *= axes;
            for marker in self.markers[track.first_member..][..track.members].iter_mut().flatten() {
                *marker = symmetry.turned(turn, *marker);
            }
        }
    }

    /// Tells what is believed, carried on by a motion.
    pub(super) fn tell(&mut self, model: &Model, state: &State, motion: Option<&Motion>) {
        let interval_s = motion.map_or(0.0, |motion| motion.interval_s);
        (self.time_s, self.camera) = (state.time_s + interval_s, state.camera);
        self.tracks.clear();
        self.members.clear();
        self.markers.clear();
        for target in &state.targets {
            let existence =
                Existence::new(target.existence, target.hidden).after(interval_s, &model.settings).total();
            if existence < model.settings.min_existence {
                continue;
            }
            let own = state.components(target);
            let carry = |component: &Component| {
                motion.map_or(*component, |motion| motion.predict(component, &model.settings))
            };
            // One room for all: no more distributions than that.
            let mut carried = [None; MOST_COMPONENTS];
            carried.iter_mut().zip(own).for_each(|(place, component)| *place = Some(carry(component)));
            let Some(one) = merged(carried.iter().flatten()) else { continue };
            let scale = model.pose.scale_sigma * model.pose.scale_sigma;
            let [p, v] = [one.pose.position_m, one.velocity_m_s];
            let (calibration_m2, _) = of_mean_calibration(&target.calibration_rad2, &p);
            let first_member = self.members.len();
            if motion.is_none() {
                self.members.extend_from_slice(state.members(target));
                self.markers.extend_from_slice(state.markers(target));
            }
            self.tracks.push(Track {
                id: target.id,
                position_m: p,
                velocity_m_s: v,
                camera_from_body: one.pose.camera_from_body,
                position_covariance_m2: one.block(0) + p * p.transpose() * scale + calibration_m2,
                velocity_covariance_m2_s2: one.block(1) + v * v.transpose() * scale,
                position_velocity_covariance_m2_s: one.covariance.fixed_view::<3, 3>(0, 3)
                    + p * v.transpose() * scale,
                orientation_covariance_rad2: one.block(2),
                position_orientation_covariance_m_rad: one.covariance.fixed_view::<3, 3>(0, 6).into_owned(),
                existence,
                is_predicted: target.is_predicted || interval_s > 0.0,
                vehicle: target.vehicle,
                is_odd: target.is_odd,
                is_lost: state.is_lost(target),
                first_member,
                members: self.members.len() - first_member,
            });
        }
    }
}

fn own<'a, T>(of_all: &'a [T], track: &Track) -> &'a [T] {
    of_all.get(track.first_member..).and_then(|rest| rest.get(..track.members)).unwrap_or(&[])
}
