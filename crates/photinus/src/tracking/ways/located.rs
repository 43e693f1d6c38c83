//! Located neighbours -> ways to see a vehicle: their poses say which spots may be which markers, and where to begin.
//!
//! A prediction may be wrong for good: two spots fit two poses, and a track may have settled for the other one. Where a neighbour's spots cannot all be the
//! predicted markers, there is a way to begin the track anew from them, as one about which nothing is known, at a price.

use nalgebra::Vector3;

use super::super::appearing::turned_next_to;
use super::super::branches::Pairs;
use super::super::component::{Component, Covariance, Step};
use super::super::look::Appearance;
use super::super::step::Model;
use super::super::update::Prior;
use super::{Origin, Scene, Way, Ways};
use crate::pose::{Mode, Pose};

/// A prediction whose yaw is less sure than this, rad, cannot tell markers apart by itself.
const UNSURE_YAW_RAD: f64 = 0.15;
/// A neighbour farther off than this, squared and in variances, is another.
const NEIGHBOUR_GATE: f64 = 36.0;
/// Most of a neighbour's poses that are begun from; those with less weight are not.
const MOST_STARTS: usize = 6;
const LEAST_START: f64 = 0.02;
/// A track has settled for the wrong pose so seldom, ...
const WRONG: f64 = 1e-3;
/// ... and then nothing is known of it but this: its distance to this much of itself, and yaw, rad.
const ANEW_SHARE: f64 = 0.5;
const ANEW_YAW_RAD: f64 = 1.0;
impl Ways {
    /// The ways that a neighbour's poses offer, where the prediction does not tell by itself which of its spots are which markers.
    pub(super) fn begin_at_neighbour(
        &mut self,
        scene: &Scene<'_>,
        origin: &Origin<'_>,
        appearance: &Appearance,
    ) {
        let Scene { model, moment, .. } = *scene;
        let (members, predicted) = (moment.members(appearance), &origin.prior.component);
        let is_whole = |pairs: &Pairs| {
            pairs.as_slice().len() == members.len() && members.iter().all(|&spot| pairs.has_spot(spot))
        };
        let is_sure = predicted.covariance[(8, 8)] < UNSURE_YAW_RAD * UNSURE_YAW_RAD;
        if is_sure && self.tried.iter().any(is_whole) {
            return;
        }
        let turns = if members.iter().all(|&spot| moment.signals[spot].is_none()) {
            model.symmetry.turns()
        } else {
            1
        };
        for mode in
            moment.modes(appearance).iter().take_while(|mode| mode.weight > LEAST_START).take(MOST_STARTS)
        {
            let off_m = mode.pose.position_m - predicted.pose.position_m;
            let covariance_m2 = predicted.block(0) + mode.position_covariance_m2;
            let Some(factor) = covariance_m2.cholesky() else { continue };
            if off_m.dot(&factor.solve(&off_m)) > NEIGHBOUR_GATE {
                continue;
            }
            let start = turned_next_to(model, Component { pose: mode.pose, ..*predicted }, predicted, turns);
            let Some(pairs) = self.pairs_of(model, members, &start.pose) else { continue };
            if !(is_sure && self.tried.iter().any(|tried| tried.is_same(&pairs))) {
                self.tried.push(pairs);
                self.try_way(scene, origin, pairs, start);
            }
        }
    }

    /// The ways to begin a track anew at a neighbour that shares spots with it, where none of its own ways explains all of them.
    pub(super) fn begin_anew(
        &mut self,
        scene: &Scene<'_>,
        vehicle: usize,
        log_shown: f64,
        appearance: &Appearance,
    ) {
        let Scene { model, moment, .. } = *scene;
        let members = moment.members(appearance);
        let shared = |way: &Way| members.iter().filter(|&&spot| way.pairs.has_spot(spot)).count();
        let most = self.of(vehicle).map(|(_, way)| shared(way)).max().unwrap_or(0);
        if most == 0 || most == members.len() {
            return;
        }
        for mode in
            moment.modes(appearance).iter().take_while(|mode| mode.weight > LEAST_START).take(MOST_STARTS)
        {
            let Some(pairs) = self.pairs_of(model, members, &mode.pose) else { continue };
            let Some(prior) = Prior::of(&anew(model, mode)) else { continue };
            let log_weight = log_shown + libm::log(WRONG * mode.weight);
            let origin = Origin { vehicle, from: usize::MAX, log_weight, prior: &prior };
            self.try_way(scene, &origin, pairs, prior.component);
        }
    }

    /// Which of these spots are which markers at a pose: the nearest.
    fn pairs_of(&mut self, model: &Model, members: &[usize], pose: &Pose) -> Option<Pairs> {
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
fn anew(model: &Model, mode: &Mode) -> Component {
    let far_m = ANEW_SHARE * mode.pose.position_m.norm();
    let speed_m_s = model.settings.velocity_sigma_m_s;
    let tilt_rad = model.pose.tilt_sigma_rad;
    let sigmas = [far_m, far_m, far_m, speed_m_s, speed_m_s, speed_m_s, tilt_rad, tilt_rad, ANEW_YAW_RAD];
    let covariance = Covariance::from_diagonal(&Step::from_iterator(sigmas.map(|sigma| sigma * sigma)));
    Component { weight: mode.weight, pose: mode.pose, velocity_m_s: Vector3::zeros(), covariance }
}
