//! Located neighbours -> ways to see a vehicle: their poses say which spots may be which markers, and where to begin.
//!
//! A prediction may be wrong for good: two spots fit two poses, and a track may have settled for the other one. Where a neighbour's spots cannot all be the
//! predicted markers, there is a way to begin the track anew from them, as one about which nothing is known, at a price.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::super::appearing::turn_next_to;
use super::super::branches::Pairs;
use super::super::component::{Component, Covariance, Step, pose_step};
use super::super::doubting::WRONG;
use super::super::look::Appearance;
use super::super::power::Power;
use super::super::silent::Silent;
use super::super::step::Model;
use super::super::update::Prior;
use super::candidates::Candidate;
use super::{Scene, Ways};
use crate::pose::{Mode, Pose};

/// A neighbour farther off than this, squared and in variances, is another.
const NEIGHBOUR_GATE: f64 = 36.0;
/// Most of a neighbour's poses that are begun from; those with less weight are not.
const MOST_STARTS: usize = 6;
const LEAST_START: f64 = 0.02;
/// Of a track that has settled for the wrong pose nothing is known but this: its distance to this much of itself, and yaw, rad.
const ANEW_SHARE: f64 = 0.5;
const ANEW_YAW_RAD: f64 = 1.0;

impl Ways {
    /// Gathers the ways that a neighbour's poses offer a distribution, where none of its own takes all of the neighbour's spots; `first` is its first
    /// candidate.
    pub(super) fn gather_at_neighbour(
        &mut self,
        scene: &Scene<'_>,
        first: usize,
        predicted: &Component,
        appearance: &Appearance,
    ) {
        let Scene { model, moment, .. } = *scene;
        let members = moment.members(appearance);
        let is_whole = |pairs: &Pairs| {
            pairs.as_slice().len() == members.len() && members.iter().all(|&spot| pairs.has_spot(spot))
        };
        if self.candidates[first..].iter().any(|own| is_whole(&own.pairs)) {
            return;
        }
        let turns = if moment.is_turned_anyhow(appearance) { model.symmetry.turns() } else { 1 };
        for mode in
            moment.modes(appearance).iter().take_while(|mode| mode.weight > LEAST_START).take(MOST_STARTS)
        {
            let turn = turn_next_to(model, &mode.pose, &predicted.pose, turns);
            let turn = turn.map_or(Rotation3::identity(), |turn| *model.symmetry.turn(turn));
            let start = Pose { camera_from_body: mode.pose.camera_from_body * turn, ..mode.pose };
            let off = pose_step(&predicted.pose, &start);
            let mut covariance = predicted.pose_covariance();
            let mut add = |first: usize, own: &Matrix3<f64>| {
                let mut block = covariance.fixed_view_mut::<3, 3>(first, first);
                block += own;
            };
            add(0, &mode.position_covariance_m2);
            add(3, &(turn.inverse() * mode.orientation_covariance_rad2 * turn));
            let Some(factor) = covariance.cholesky() else { continue };
            if off.dot(&factor.solve(&off)) > NEIGHBOUR_GATE {
                continue;
            }
            let Some(pairs) = self.pairs_of(model, members, &start) else { continue };
            if !self.candidates[first..].iter().any(|own| own.pairs.is_same(&pairs)) {
                self.add_candidate(pairs, start, f64::NEG_INFINITY);
            }
        }
    }

    /// Adds to the spots that a vehicle may be seen by those of the neighbours at which it may begin anew.
    pub(super) fn reach_neighbours(&mut self, scene: &Scene<'_>, vehicle: usize) {
        let Scene { moment, .. } = *scene;
        let (gathered, who) = (self.reach[vehicle], self.who);
        for appearance in moment.appearances.iter().filter(|own| own.may_be(who)) {
            let mut spots = Some(0);
            for &spot in moment.members(appearance) {
                spots = spots.and_then(|spots| Some(spots | self.bit_of(spot)?));
            }
            if let Some(spots) = spots.filter(|spots| spots & gathered != 0) {
                self.reach[vehicle] |= spots;
            }
        }
    }

    /// Tries to begin a track anew at a neighbour that shares spots with it, where none of its own ways explains all of them.
    pub(super) fn begin_anew(&mut self, scene: &Scene<'_>, vehicle: usize, appearance: &Appearance) {
        let Scene { model, moment, .. } = *scene;
        let members = moment.members(appearance);
        let shared = |own: &Candidate| members.iter().filter(|&&spot| own.pairs.has_spot(spot)).count();
        let most = self.candidates[self.gathered(vehicle)].iter().map(shared).max().unwrap_or(0);
        if most == 0 || most == members.len() {
            return;
        }
        let tilt_rad = model.tilt_sigma_rad(moment.tilt_sigma_rad);
        for mode in
            moment.modes(appearance).iter().take_while(|mode| mode.weight > LEAST_START).take(MOST_STARTS)
        {
            let Some(pairs) = self.pairs_of(model, members, &mode.pose) else { continue };
            let Some(spots) = self.spots_of(&pairs) else { continue };
            let Some(prior) = Prior::of(&anew(model, tilt_rad, mode)) else { continue };
            let log_weight = self.log_shown[vehicle] + libm::log(WRONG * mode.weight);
            let anew = Candidate { from: None, pairs, spots, start: mode.pose, promise: 0.0 };
            self.try_way(scene, vehicle, log_weight, &prior, &anew);
        }
    }

    /// Which of these spots are which markers at a pose: the nearest.
    pub(super) fn pairs_of(&mut self, model: &Model, members: &[usize], pose: &Pose) -> Option<Pairs> {
        self.own.clear();
        self.own.extend(members.iter().map(|&spot| self.observations[spot]));
        self.own_markers.clear();
        self.own_markers.resize(members.len(), None);
        self.assignment.assign(&model.airframe, pose, &self.own, &mut self.own_markers);
        let mut pairs = Pairs::default();
        for (&spot, marker) in members.iter().zip(&self.own_markers) {
            pairs.push(spot, usize::from((*marker)?));
        }
        Some(pairs)
    }
}

/// What is known of a vehicle near a pose of which nothing is known.
fn anew(model: &Model, tilt_rad: f64, mode: &Mode) -> Component {
    let far_m = ANEW_SHARE * mode.pose.position_m.norm();
    let speed_m_s = model.settings.velocity_sigma_m_s;
    let rate_rad_s = model.settings.yaw_rate_sigma_rad_s;
    let of_place = [far_m, far_m, far_m, speed_m_s, speed_m_s, speed_m_s];
    let of_attitude = [tilt_rad, tilt_rad, ANEW_YAW_RAD, rate_rad_s];
    let sigmas = of_place.into_iter().chain(of_attitude);
    let covariance = Covariance::from_diagonal(&Step::from_iterator(sigmas.map(|sigma| sigma * sigma)));
    Component {
        weight: mode.weight,
        pose: mode.pose,
        velocity_m_s: Vector3::zeros(),
        yaw_rate_rad_s: 0.0,
        covariance,
        silent: Silent::BEFOREHAND,
        power: Power::UNKNOWN,
    }
}
