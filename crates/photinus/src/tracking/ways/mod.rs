//! A predicted vehicle and a frame -> the ways in which the frame may show it, each with the state that follows and its weight.
//!
//! Ways come from the prediction ([`super::branches`]) and, where none of those takes all spots of a neighbour that the locator found near it, from that
//! neighbour: its poses say which spots are which markers and where to begin. Either way the weight is the density of the frame's spots under the vehicle's own
//! prediction, so that a neighbour located again is a way to look at the same spots and no second sight of them.
//!
//! ```text
//! screening    which vehicles may hide others
//! candidates   which ways are worth a try, of all vehicles          branches, located
//! trying       each with its Kalman update and its weight, but      update
//!              those that are certain to count for nothing
//! blinking     which markers are lit at a pose, for both
//! repeated     what frames repeat, counted once
//! beginning    what a frame says of the markers of one that it begins
//! ```

mod beginning;
mod blinking;
mod candidates;
mod located;
mod repeated;
mod screening;
mod trying;

use alloc::vec::Vec;

use super::branches::{Branches, Pairs};
use super::component::Component;
use super::existence::Existence;
use super::joint::{Choice, Spots};
use super::look::Moment;
use super::state::Target;
use super::step::Model;
use super::update::Prior;
use crate::airframe::Airframe;
use crate::camera::{Bearing, Watched};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::{
    self, Assignment, Known, LogLight, Measurement, Observation, Pose, Seen, Visible, Whitened,
};
use crate::ranging::Interval;
use blinking::Blinking;
use candidates::Candidate;
use screening::Screens;
use trying::NOTHING_NATS;

/// Neighbours at half of the sphere.
const FIELD_SR: f64 = core::f64::consts::TAU;
/// A wrong signal costs no more than this, nats: one in a hundred and fifty is wrong.
const WRONG_SIGNAL_NATS: f64 = 5.0;
/// Of the markers of a fleet that blink differently one that was not heard is a given one so likely: those of a vehicle that is followed mostly were.
const ANY_MARKER: f64 = 1e-3;
/// What was followed and heard is another light so seldom.
const WRONG_MARKER: f64 = 1e-4;
/// LEDs are odd whose power is so far from what others say, standard deviations.
const ODD_SIGMA: f64 = 3.0;
/// Spots within so many radii of a vehicle may hide its markers.
const NEAR_RADII: f64 = 3.0;

/// One frame, and what it is looked at with.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) model: &'a Model,
    pub(super) watched: Watched<'a>,
    pub(super) moment: &'a Moment,
    /// Since the frame before, s.
    pub(super) interval_s: f64,
    /// Since the frame before of its own camera, s.
    pub(super) own_interval_s: f64,
}

impl Scene<'_> {
    /// Whether a vehicle exists, and is shown, before the frame is looked at.
    fn existence(&self, target: &Target) -> Existence {
        Existence::new(target.existence, target.hidden).after(self.interval_s, &self.model.settings)
    }
}

/// One way in which a frame may show a vehicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The state with its spots.
    pub(super) component: Component,
    pub(super) pairs: Pairs,
    /// What of its weight other frames repeat, nats.
    repeated_nats: f64,
    /// Which of the priors it comes from; `None` for none of them.
    from: Option<usize>,
}

/// The ways of all vehicles.
#[derive(Debug)]
pub(super) struct Ways {
    all: Vec<Way>,
    /// The same for the joint explanation.
    pub(super) choices: Vec<Choice>,
    /// Logarithm of the weight that nothing of a vehicle is seen, and of that of being shown, by vehicle.
    pub(super) log_unseen: Vec<f64>,
    log_shown: Vec<f64>,
    /// How likely it is hidden before the frame, by vehicle.
    hidden: Vec<f64>,
    /// How likely none of its markers is seen if nothing hides it: by vehicle, and by its distributions.
    unseen_if_shown: Vec<f64>,
    unseen_of: Vec<f64>,
    first_unseen: Vec<usize>,
    /// The bit of each spot that may be a vehicle's.
    bits: Vec<Option<u32>>,
    used_bits: u32,
    observations: Vec<Observation>,
    clutter_nats: f64,
    /// Priors as they are told and as frames tell them, and the same as one frame may count them.
    believed: pose::Settings,
    per_frame: pose::Settings,
    /// The light of an LED of intensity 1 at 1 m by what other vehicles say: by vehicle, and as one frame may count it.
    powers: Vec<Option<LogLight>>,
    power: Option<LogLight>,
    repeats: f64,
    whitened: Vec<Whitened>,
    /// Who the vehicle is, where it was heard, and how long ago it was seen, s.
    who: Option<u32>,
    unseen_s: f64,
    /// How likely each marker of a vehicle is lit as told, and as a pose has it.
    told_lit: Vec<f64>,
    lit: Vec<f64>,
    /// Which markers another vehicle may hide.
    screened: Vec<bool>,
    blinking: Blinking,
    screens: Screens,
    branches: Branches,
    /// What is tried, by vehicle, and from where.
    priors: Vec<Prior>,
    candidates: Vec<Candidate>,
    first_candidate: Vec<usize>,
    /// The spots that a vehicle may be seen by.
    reach: Vec<Spots>,
    /// The best promise of each vehicle that is still to be tried, and those that were.
    promises: Vec<Option<f64>>,
    tried: Vec<usize>,
    /// A way that is this much less likely than one in its place, nats, counts for nothing.
    pub(in crate::tracking) nothing_nats: f64,
    /// The candidates of a vehicle, the most promising first.
    order: Vec<usize>,
    markers: Vec<Option<u16>>,
    others: Vec<Bearing>,
    own: Vec<Observation>,
    own_markers: Vec<Option<u16>>,
    assignment: Assignment,
}

impl Ways {
    pub(super) fn with_room(airframe: &Airframe) -> Self {
        let markers = airframe.markers().len();
        Self {
            all: Vec::with_capacity(256),
            choices: Vec::with_capacity(256),
            log_unseen: Vec::new(),
            log_shown: Vec::new(),
            hidden: Vec::new(),
            unseen_if_shown: Vec::new(),
            unseen_of: Vec::new(),
            first_unseen: Vec::new(),
            bits: Vec::new(),
            used_bits: 0,
            observations: Vec::new(),
            clutter_nats: 0.0,
            believed: pose::Settings::default(),
            per_frame: pose::Settings::default(),
            powers: Vec::new(),
            power: None,
            repeats: 1.0,
            whitened: Vec::new(),
            who: None,
            unseen_s: 0.0,
            told_lit: Vec::with_capacity(markers),
            lit: Vec::with_capacity(markers),
            screened: Vec::with_capacity(markers),
            blinking: Blinking::default(),
            screens: Screens::default(),
            branches: Branches::with_room(markers),
            priors: Vec::with_capacity(32),
            candidates: Vec::with_capacity(128),
            first_candidate: Vec::new(),
            reach: Vec::new(),
            promises: Vec::new(),
            tried: Vec::new(),
            nothing_nats: NOTHING_NATS,
            order: Vec::with_capacity(128),
            markers: Vec::new(),
            others: Vec::new(),
            own: Vec::new(),
            own_markers: Vec::new(),
            assignment: Assignment::with_room(markers),
        }
    }

    /// The ways of a vehicle with their places among the choices.
    pub(super) fn of(&self, vehicle: usize) -> impl Iterator<Item = (usize, &Way)> + Clone {
        let own = self.choices.iter().enumerate().filter(move |(_, choice)| choice.vehicle == vehicle);
        own.map(|(index, choice)| (index, &self.all[choice.way]))
    }

    /// How likely none of a vehicle's markers is seen if nothing hides it.
    pub(super) fn unseen_if_shown(&self, vehicle: usize) -> f64 {
        self.unseen_if_shown[vehicle]
    }

    /// The same by its distributions.
    pub(super) fn unseen_of(&self, vehicle: usize) -> impl Iterator<Item = f64> {
        self.unseen_of[self.first_unseen[vehicle]..].iter().copied()
    }

    /// How likely a vehicle is hidden before the frame that may be seen by one of these spots and was likelier hidden, or not there, than shown.
    pub(super) fn hidden(&self, spots: &[usize]) -> f64 {
        let may_be_seen = self.choices.iter().filter(|choice| {
            let pairs = &self.all[choice.way].pairs;
            self.log_shown[choice.vehicle] < -core::f64::consts::LN_2
                && spots.iter().any(|&spot| pairs.has_spot(spot))
        });
        may_be_seen.map(|choice| self.hidden[choice.vehicle]).fold(0.0, f64::max)
    }

    /// Whether LEDs of a vehicle would be of another power than others say, if it is there; `None` where that is not known.
    pub(super) fn is_odd(&self, vehicle: usize, there: &Component, camera: usize) -> Option<bool> {
        let (others, own) = (self.powers[vehicle]?, there.power.log_power(camera)?);
        Some((own - others.value).abs() > ODD_SIGMA * others.sigma)
    }

    /// A vehicle that may stand before others: all of them, before the first is added.
    pub(super) fn may_screen(&mut self, vehicle: usize, components: &[Component]) {
        self.screens.add(vehicle, components);
    }

    /// Begins a frame with so many points of clutter, spots that are so dense beyond that for lights that last (a spot per sr and unit of the logarithm of its
    /// light), and LEDs of this power, vehicle by vehicle, where that is known.
    pub(super) fn begin(
        &mut self,
        scene: &Scene<'_>,
        clutter: f64,
        lasting: &[f64],
        powers: impl Iterator<Item = Option<LogLight>>,
    ) {
        let Scene { moment, .. } = *scene;
        self.all.clear();
        self.screens.clear();
        self.choices.clear();
        self.log_unseen.clear();
        self.log_shown.clear();
        self.hidden.clear();
        self.priors.clear();
        self.candidates.clear();
        self.first_candidate.clear();
        self.reach.clear();
        self.promises.clear();
        self.tried.clear();
        self.unseen_if_shown.clear();
        self.unseen_of.clear();
        self.first_unseen.clear();
        self.powers.clear();
        self.powers.extend(powers);
        self.bits.clear();
        self.bits.resize(moment.observations.len(), None);
        self.used_bits = 0;
        let log_per_sr = libm::log(clutter / FIELD_SR);
        self.observations.clear();
        self.observations.extend(moment.observations.iter().zip(lasting).map(|(seen, lasting)| {
            let new = seen.clutter_log_density + log_per_sr;
            let clutter_log_density = if *lasting > 0.0 { libm::log(libm::exp(new) + lasting) } else { new };
            Observation { clutter_log_density, ..*seen }
        }));
        self.clutter_nats = -self.observations.iter().map(|seen| seen.clutter_log_density).sum::<f64>();
    }

    /// Gathers what is worth a try for the next vehicle, whose distributions are predicted.
    pub(super) fn add_vehicle(
        &mut self,
        scene: &Scene<'_>,
        vehicle: usize,
        target: &Target,
        components: &[Component],
    ) {
        self.prepare(scene, vehicle, target, components);
        self.first_unseen.push(self.unseen_of.len());
        self.first_candidate.push(self.candidates.len());
        self.reach.push(0);
        let mut unseen_if_shown = 0.0;
        for component in components {
            let unseen = self.unseen(scene, vehicle, component);
            self.unseen_of.push(unseen);
            unseen_if_shown += component.weight * unseen;
            self.gather(scene, vehicle, component);
        }
        let existence = scene.existence(target);
        self.unseen_if_shown.push(unseen_if_shown);
        self.log_unseen.push(libm::log(existence.unseen(unseen_if_shown)));
        self.log_shown.push(libm::log(existence.shown.max(f64::MIN_POSITIVE)));
        self.hidden.push(existence.hidden);
        self.reach_neighbours(scene, vehicle);
        let own = self.candidates[self.gathered(vehicle)].iter().map(|candidate| candidate.promise);
        self.promises.push(own.reduce(f64::max));
    }

    /// Tries what was gathered for all vehicles, the most promising first: what that one is seen by spares the others most of it.
    pub(super) fn try_vehicles<'a>(
        &mut self,
        scene: &Scene<'_>,
        vehicles: impl Fn(usize) -> (&'a Target, &'a [Component]),
    ) {
        while let Some(vehicle) = self.most_promising() {
            self.promises[vehicle] = None;
            let (target, components) = vehicles(vehicle);
            self.prepare(scene, vehicle, target, components);
            self.try_gathered(scene, vehicle);
            let who = self.who;
            for appearance in scene.moment.appearances.iter().filter(|own| own.may_be(who)) {
                self.begin_anew(scene, vehicle, appearance);
            }
            self.tried.push(vehicle);
        }
        self.choices.sort_unstable_by_key(|choice| (choice.vehicle, choice.way));
    }

    fn most_promising(&self) -> Option<usize> {
        let promises = self.promises.iter().enumerate();
        let left = promises.filter_map(|(vehicle, promise)| Some((vehicle, (*promise)?)));
        left.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(vehicle, _)| vehicle)
    }

    /// What spots are against this vehicle, whose markers are where the airframe says but for the prior's sigma.
    fn prepare(&mut self, scene: &Scene<'_>, vehicle: usize, target: &Target, components: &[Component]) {
        let Scene { model, moment, .. } = *scene;
        self.repeats = model.repeats_of(target, moment, scene.own_interval_s);
        let widening = self.repeats.sqrt();
        self.power = self.powers[vehicle].map(|own| LogLight { sigma: own.sigma * widening, ..own });
        let unit_sigma = model.pose.unit_sigma * moment.light_times.unwrap_or(1.0);
        self.believed = pose::Settings { unit_sigma, ..model.pose };
        self.per_frame = pose::Settings {
            unit_sigma: unit_sigma * widening,
            lobe_sigma: model.pose.lobe_sigma * widening,
            ..model.pose
        };
        let distance_m = components.first().map_or(1.0, |first| first.pose.position_m.norm()).max(1e-3);
        let angle_rad = model.pose.marker_sigma_m / distance_m;
        let extra_rad2 = self.repeats * angle_rad * angle_rad;
        self.whiten(extra_rad2);
        self.who = moment.who(target.id, target.vehicle);
        self.unseen_s = moment.time_s - target.seen_s;
        self.told_lit.clear();
        self.told_lit.resize(model.airframe.markers().len(), 1.0);
        for told in moment.lit.iter().filter(|told| told.track == target.id) {
            if let Some(place) = self.told_lit.get_mut(usize::from(told.marker)) {
                *place = told.probability.clamp(0.0, 1.0);
            }
        }
        if let Some(first) = components.first() {
            let reach_rad = NEAR_RADII * model.airframe.max_radius_m() / distance_m;
            let ahead = first.pose.position_m / distance_m;
            self.blinking
                .begin(target.id, moment.followed.iter().filter(|own| own.is_near(&ahead, reach_rad)));
        }
    }

    /// Prepares the spots, whose directions are less sure by this variance.
    fn whiten(&mut self, extra_rad2: f64) {
        self.whitened.clear();
        self.whitened.extend(self.observations.iter().map(|seen| Whitened::of(seen, extra_rad2)));
    }

    /// How likely each marker of a vehicle is lit at a pose while those that blink alike are, not silent, and not behind another vehicle; returns how likely those
    /// that blink alike are lit.
    fn light(&mut self, scene: &Scene<'_>, vehicle: usize, from: &Component, pose: &Pose) -> f64 {
        self.lit.clone_from(&self.told_lit);
        let mut alike = 1.0;
        match scene.moment.others_lit {
            Some(others_lit) if scene.moment.blinks_alike => {
                // Who was dark for as long as anybody is shines now.
                let others_lit = if self.unseen_s > scene.moment.longest_dark_s { 1.0 } else { others_lit };
                alike = self.blinking.alike(scene.model, pose, others_lit);
            }
            Some(others_lit) => self.blinking.light(scene.model, pose, others_lit, &mut self.lit),
            None => {}
        }
        self.dim(scene, vehicle, from, pose);
        alike
    }

    /// Lowers how likely each marker is lit by how likely it is silent, or behind another vehicle.
    fn dim(&mut self, scene: &Scene<'_>, vehicle: usize, from: &Component, pose: &Pose) {
        self.screened.clear();
        self.screened.resize(self.lit.len(), false);
        if is_known_aside(from, scene.model.airframe.max_radius_m()) {
            self.screens.screen(vehicle, &scene.model.airframe, pose, &mut self.screened);
        }
        from.silent.dim(&mut self.lit, &self.screened);
    }

    /// How likely no marker of a vehicle is seen that nothing hides.
    fn unseen(&mut self, scene: &Scene<'_>, vehicle: usize, component: &Component) -> f64 {
        let alike = self.light(scene, vehicle, component, &component.pose);
        self.assign(&Pairs::default());
        self.gather_others(scene, &component.pose);
        let nats = self.measured(scene, &component.pose, |measurement| {
            measurement.visibility(&component.pose, component.power.log_power(scene.moment.camera), |_, _| ())
        });
        1.0 - alike + alike * libm::exp(-nats)
    }

    /// Does something with what the spots say under the assignment in `markers`.
    fn measured<T>(&self, scene: &Scene<'_>, near: &Pose, with: impl FnOnce(&Measurement<'_>) -> T) -> T {
        let Scene { model, watched, moment, .. } = *scene;
        let visible = Visible {
            detection_limit: moment.detection_limit,
            miss_rate: moment.miss_rate,
            watched: Some(watched),
            others: &self.others,
            lit: &self.lit,
        };
        let known = Known {
            up: None,
            bounds: Interval::ANY,
            size: None,
            power: self.power,
            tilt_sigma_rad: None,
            unit_sigma: None,
            visible,
        };
        let seen = Seen {
            airframe: &model.airframe,
            settings: &self.believed,
            per_frame: &self.per_frame,
            observations: &self.observations,
            whitened: &self.whitened,
            repeats: self.repeats,
            known: &known,
        };
        with(&Measurement::new(&seen, &self.markers, near))
    }

    /// Takes spots for the markers that a way has them for, all others for none.
    fn assign(&mut self, pairs: &Pairs) {
        self.markers.clear();
        self.markers.resize(self.observations.len(), None);
        for &(spot, marker) in pairs.as_slice() {
            self.markers[usize::from(spot)] = Some(marker);
        }
    }

    /// The directions of spots near a vehicle that are not its own.
    fn gather_others(&mut self, scene: &Scene<'_>, near: &Pose) {
        let distance_m = near.position_m.norm();
        let ahead = near.position_m / distance_m;
        let reach_rad = NEAR_RADII * scene.model.airframe.max_radius_m() / distance_m;
        self.others.clear();
        for (spot, marker) in self.markers.iter().enumerate() {
            let bearing = scene.moment.bearing(spot);
            if marker.is_none() && (bearing.vector() - ahead).norm() < reach_rad {
                self.others.push(*bearing);
            }
        }
    }
}

/// Whether a vehicle is known across the line of sight to less than its radius: else it may be beside what stands before it as well as behind, and a
/// marker alone would be any.
fn is_known_aside(component: &Component, radius_m: f64) -> bool {
    component.aside_m2(&component.pose.position_m.normalize()) < radius_m * radius_m
}

/// What it costs that a spot is a marker of `who`, for what it blinks.
fn signal_nats(model: &Model, moment: &Moment, who: Option<u32>, spot: usize, marker: usize) -> f64 {
    let told = moment.signals[spot];
    if moment.blinks_alike {
        // Of a track that nobody named any spot may be a marker but those that are heard to be a named one's: two tracks of one vehicle would share its frames. Where
        // two cross, words are heard from the wrong one for a while.
        let of_another = told.filter(|told| match who {
            Some(_) => told.vehicle != who,
            None => told.vehicle.is_some_and(|vehicle| moment.is_named(vehicle)),
        });
        return of_another.map_or(0.0, |told| -libm::log((1.0 - told.probability).max(WRONG_MARKER)));
    }
    let carries =
        |signal: Option<u32>| signal.is_none_or(|signal| model.symmetry.carries(marker as u16, signal));
    if who.is_some() || told.is_some_and(|told| told.vehicle.is_some()) {
        let heard = told.map_or(0.0, |told| told.probability);
        let own = told.map_or(0.0, |told| {
            if told.vehicle == who && carries(told.signal) { told.probability } else { 0.0 }
        });
        // Where vehicles blink different words, a spot that was not heard is any marker of any of them.
        let unheard = (1.0 - heard) * if who.is_some() { ANY_MARKER } else { 1.0 };
        return -libm::log((own + unheard).max(WRONG_MARKER));
    }
    let Some(told) = told else { return 0.0 };
    let probability = if carries(told.signal) { told.probability } else { 1.0 - told.probability };
    (-libm::log(probability.max(1e-9))).clamp(0.0, WRONG_SIGNAL_NATS)
}

#[cfg(test)]
mod tests {
    use super::super::look::Signalled;
    use super::super::tests::simulator::model;
    use super::*;

    #[test]
    fn what_is_heard_to_be_another_tracks_is_hardly_a_marker() {
        let heard = Signalled { signal: None, probability: 0.999, vehicle: Some(7) };
        let mut moment = Moment::default();
        (moment.blinks_alike, moment.signals) = (true, vec![Some(heard)]);
        let surely = -libm::log(0.001);
        let costs = |moment: &Moment, who, expected: f64| {
            let nats = signal_nats(&model(), moment, who, 0, 0);
            assert!((nats - expected).abs() < 1e-9, "{who:?}: {nats}");
        };
        // Anybody's, or its own.
        costs(&moment, None, 0.0);
        costs(&moment, Some(7), 0.0);
        moment.named = vec![(3, 8)];
        costs(&moment, None, 0.0);
        moment.named = vec![(3, 7)];
        costs(&moment, None, surely);
        costs(&moment, Some(8), surely);
        costs(&moment, Some(7), 0.0);
    }
}
