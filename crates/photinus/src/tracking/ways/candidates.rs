//! What is believed of a vehicle, and the spots around -> which ways to see it are worth a try, and where to begin.

use super::super::branches::{Around, Pairs};
use super::super::component::Component;
use super::super::joint::Spots;
use super::super::update::Prior;
use super::{Scene, Ways, signal_nats};
use crate::pose::Pose;

/// One way that is worth a try.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Which of the priors it comes from; `None` for none of them.
    pub(super) from: Option<usize>,
    pub(super) pairs: Pairs,
    pub(super) spots: Spots,
    pub(super) start: Pose,
    /// How likely it seems at first sight, nats: the likeliest are tried first.
    pub(super) promise: f64,
}

/// A first-order step of more than this share of the distance leads nobody knows where.
const FAR_SHARE: f64 = 0.5;

impl Ways {
    /// Gathers the ways that a distribution offers: by itself, and at neighbours.
    pub(super) fn gather(&mut self, scene: &Scene<'_>, vehicle: usize, component: &Component) {
        let first = self.candidates.len();
        self.grow(scene, vehicle, component);
        let who = self.who;
        for appearance in scene.moment.appearances.iter().filter(|own| own.may_be(who)) {
            self.gather_at_neighbour(scene, first, component, appearance);
        }
        if self.candidates.len() == first {
            return;
        }
        match Prior::of(component) {
            Some(prior) => self.priors.push(prior),
            None => self.candidates.truncate(first),
        }
        for candidate in &self.candidates[first..] {
            self.reach[vehicle] |= candidate.spots;
        }
    }

    /// Which candidates are a vehicle's.
    pub(super) fn gathered(&self, vehicle: usize) -> core::ops::Range<usize> {
        let end = self.first_candidate.get(vehicle + 1).copied().unwrap_or(self.candidates.len());
        self.first_candidate[vehicle]..end
    }

    /// Gathers the ways that a distribution offers by itself.
    fn grow(&mut self, scene: &Scene<'_>, vehicle: usize, component: &Component) {
        let Scene { model, moment, .. } = *scene;
        self.light(scene, vehicle, component, &component.pose);
        let around = Around {
            airframe: &model.airframe,
            observations: &self.observations,
            whitened: &self.whitened,
            lit: &self.lit,
            missed: model.pose.missed,
        };
        let who = self.who;
        let signal_nats = |spot, marker| signal_nats(model, moment, who, spot, marker);
        self.branches.grow(&around, component, signal_nats);
        let log_weight = libm::log(component.weight);
        for index in 0..self.branches.grown().len() {
            let branch = &self.branches.grown()[index];
            let (pairs, promise) = (branch.pairs, log_weight + branch.gain);
            let start = if is_near(&branch.pose, &component.pose) { branch.pose } else { component.pose };
            self.add_candidate(pairs, start, promise);
        }
    }

    /// Adds a way from the prior that comes next.
    pub(super) fn add_candidate(&mut self, pairs: Pairs, start: Pose, promise: f64) {
        let from = Some(self.priors.len());
        let Some(spots) = self.spots_of(&pairs).filter(|&spots| spots != 0) else { return };
        self.candidates.push(Candidate { from, pairs, spots, start, promise });
    }

    /// The spots of a way; `None` where there are no bits left for them.
    pub(super) fn spots_of(&mut self, pairs: &Pairs) -> Option<Spots> {
        let mut spots = 0;
        for &(spot, _) in pairs.as_slice() {
            spots |= self.bit_of(usize::from(spot))?;
        }
        Some(spots)
    }

    pub(super) fn bit_of(&mut self, spot: usize) -> Option<Spots> {
        if self.bits[spot].is_none() && self.used_bits < Spots::BITS {
            self.bits[spot] = Some(self.used_bits);
            self.used_bits += 1;
        }
        self.bits[spot].map(|bit| 1 << bit)
    }
}

/// Whether a pose is a step of the first order away.
fn is_near(pose: &Pose, from: &Pose) -> bool {
    (pose.position_m - from.position_m).norm() < FAR_SHARE * from.position_m.norm()
}
