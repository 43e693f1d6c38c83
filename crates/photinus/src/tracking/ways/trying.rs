//! Ways that are worth a try -> each with the state that follows and its weight, but those that are certain to count for nothing.
//!
//! A way counts for nothing where another one of the same vehicle is far likelier and needs no spot that another vehicle might need: in whatever way the
//! others are seen, that one fits where this one does. And it does where it takes the spots by which one other vehicle is seen: where not seeing the first
//! and seeing the second is far likelier.

use super::super::component::Component;
use super::super::joint::{Choice, Spots};
use super::super::update::{Prior, Updated};
use super::blinking::show;
use super::candidates::Candidate;
use super::{Scene, Way, Ways, signal_nats};

/// What is this much less likely, nats, goes: vehicles are concluded without it, too (`reduction`).
pub(super) const NOTHING_NATS: f64 = 9.3;

impl Ways {
    /// Tries what was gathered for a vehicle, the most promising first.
    pub(super) fn try_gathered(&mut self, scene: &Scene<'_>, vehicle: usize) {
        let own = self.gathered(vehicle);
        let Self { candidates, order, .. } = self;
        let promise = |index: usize| candidates[index].promise;
        order.clear();
        order.extend(own);
        order.sort_unstable_by(|&a, &b| promise(b).total_cmp(&promise(a)).then(a.cmp(&b)));
        for place in 0..self.order.len() {
            let candidate = self.candidates[self.order[place]];
            let Some(prior) = candidate.from.map(|from| self.priors[from]) else { continue };
            let log_weight = self.log_shown[vehicle] + libm::log(prior.component.weight);
            self.try_way(scene, vehicle, log_weight, &prior, &candidate);
        }
    }

    /// Updates a vehicle of this weight with a way, and keeps it.
    pub(super) fn try_way(
        &mut self,
        scene: &Scene<'_>,
        vehicle: usize,
        log_weight: f64,
        prior: &Prior,
        candidate: &Candidate,
    ) {
        let Scene { model, moment, .. } = *scene;
        let Candidate { from, pairs, spots, ref start, .. } = *candidate;
        self.assign(&pairs);
        let of_pair = |&(spot, marker): &(u16, u16)| {
            signal_nats(model, moment, self.who, usize::from(spot), usize::from(marker))
        };
        let signals: f64 = pairs.as_slice().iter().map(of_pair).sum();
        self.gather_others(scene, start);
        let alike = self.light(scene, vehicle, &prior.component, start);
        let lit_nats = if moment.blinks_alike { -libm::log(show(alike)) } else { 0.0 };
        let log_weight = log_weight + self.clutter_nats - signals - lit_nats;
        let instead = self.likeliest_instead(vehicle, spots).max(self.worth_to_others(vehicle, spots));
        let least = instead - self.nothing_nats - log_weight;
        // Beside those with the same spots a way counts for more where its prediction is wide.
        let counts = 1.0 / self.repeats;
        let beside = self.best_beside(vehicle, spots).map(|(all, once)| {
            let together = (all - instead).min(0.0);
            once - together - self.nothing_nats - log_weight
        });
        let is_nothing = |spread: f64, rest: f64| {
            spread + rest < least && beside.is_none_or(|least| counts * spread + rest < least)
        };
        let updated = self.measured(scene, start, |measurement| prior.update(measurement, start, is_nothing));
        let Some(updated) = updated else { return };
        if self.own(vehicle).any(|(choice, way)| {
            (choice.spots, way.from) == (spots, from) && is_same(&way.component, &updated.component)
        }) {
            return;
        }
        let log_weight = log_weight + updated.log_evidence;
        let repeated_nats = (1.0 - counts) * updated.log_spread;
        let Updated { mut component, log_power, .. } = updated;
        // Whose spots these are is in doubt where others are near.
        component.silent.blame(&prior.component.silent, &self.screened, self.others.is_empty());
        component.power.learn(moment.camera, log_power);
        self.all.push(Way { component, pairs, repeated_nats, from });
        self.choices.push(Choice { vehicle, spots, log_weight, way: self.all.len() - 1 });
    }

    /// Logarithm of the weight of not seeing a vehicle, with what it is worth to another one that it leaves these spots to that.
    fn worth_to_others(&self, vehicle: usize, spots: Spots) -> f64 {
        let worth = |&other: &usize| {
            let third = |own: usize| own != vehicle && own != other;
            let wanted =
                (0..self.reach.len()).filter(|&own| third(own)).fold(0, |all, own| all | self.reach[own]);
            let (mut best, mut without) = (self.log_unseen[other], self.log_unseen[other]);
            for choice in self.choices.iter().filter(|choice| choice.vehicle == other) {
                if choice.spots & spots == 0 {
                    without = without.max(choice.log_weight);
                }
                if choice.spots & wanted == 0 {
                    best = best.max(choice.log_weight);
                }
            }
            best - without
        };
        self.log_unseen[vehicle] + self.tried.iter().map(worth).fold(0.0, f64::max)
    }

    /// Logarithm of the weight of the likeliest way to see a vehicle, or not to see it, that fits wherever one with these spots does.
    fn likeliest_instead(&self, vehicle: usize, spots: Spots) -> f64 {
        let others = self.reach.iter().enumerate().filter(|&(other, _)| other != vehicle);
        let free = spots | !others.fold(0, |all, (_, reach)| all | reach);
        let instead = self.own(vehicle).filter(|(choice, _)| choice.spots & !free == 0);
        instead.map(|(choice, _)| choice.log_weight).fold(self.log_unseen[vehicle], f64::max)
    }

    /// Logarithm of the largest weight of the ways so far with these spots, and of the largest with what frames repeat counted once.
    fn best_beside(&self, vehicle: usize, spots: Spots) -> Option<(f64, f64)> {
        let beside = self.own(vehicle).filter(|(choice, _)| choice.spots == spots);
        let weights = beside.map(|(choice, way)| (choice.log_weight, choice.log_weight - way.repeated_nats));
        weights.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
    }

    /// The ways so far of the vehicle that is tried.
    fn own(&self, vehicle: usize) -> impl Iterator<Item = (&Choice, &Way)> {
        let all = self.choices.iter().zip(&self.all).rev();
        all.take_while(move |(choice, _)| choice.vehicle == vehicle)
    }
}

/// Whether two searches ended at one summit.
fn is_same(a: &Component, b: &Component) -> bool {
    let moved = (a.pose.position_m - b.pose.position_m).norm() / a.pose.position_m.norm();
    let turn = (a.pose.camera_from_body.matrix() - b.pose.camera_from_body.matrix()).norm();
    moved < 1e-2 && turn < 3e-2
}
