//! What is believed before a frame, and the frame -> what is believed after it.
//!
//! ```text
//! predicted   every normal distribution, carried on to the frame       motion, splitting
//! lasting     lights that were nobody's, where they must be            clutter
//! ways        which spots may be which of its markers, each updated    ways (branches, update)
//! joint       how likely each is, no spot being two vehicles'          joint
//! concluded   vehicles as sums of those, few; whether they exist       reduction, existence
//!             those that frames contradict begin anew                  doubting
//! appeared    located neighbours whose spots nobody claims             appearing
//! ```

use alloc::vec::Vec;

use nalgebra::Matrix3;

use super::Settings;
use super::appearing::{self, LOST_S};
use super::clutter::PersistentClutter;
use super::component::Component;
use super::doubting;
use super::existence::Existence;
use super::joint::Joint;
use super::look::Moment;
use super::motion::Motion;
use super::power::Fleet;
use super::reduction::reduce;
use super::splitting::{split, straight_rad};
use super::state::{MOST_TARGETS, State, Target};
use super::ways::{Scene, Way, Ways};
use crate::airframe::Airframe;
use crate::camera::Rig;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::{self, LogLight, Observation, Symmetry};

/// Clutter is counted over this many frames, and is at least this many points.
const CLUTTER_FRAMES: f64 = 32.0;
const LEAST_CLUTTER: f64 = 0.05;
/// A vehicle less likely than this is forgotten.
const GONE: f64 = 0.02;
/// So many standard deviations off, a vehicle is not.
const SURELY_SIGMA: f64 = 5.0;
/// Frames are no nearer in time than this, s, for what they repeat: the first ones of two cameras may be of one time.
const LEAST_INTERVAL_S: f64 = 1e-4;

/// What does not change from frame to frame.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub(super) rig: Rig,
    pub(super) airframe: Airframe,
    pub(super) symmetry: Symmetry,
    pub(super) pose: pose::Settings,
    pub(super) settings: Settings,
}

impl Model {
    /// How far vehicles tilt, rad, where frames tell this much.
    pub(super) fn tilt_sigma_rad(&self, told_rad: Option<f64>) -> f64 {
        told_rad.unwrap_or(self.pose.tilt_sigma_rad)
    }

    /// In so many frames errors of a vehicle's markers, lobes and powers are the same as in this one, whose camera had its frame before `own_interval_s` ago.
    /// Frames in which nothing of it shines repeat nothing, and of LEDs that blink words of their own each is dark in some; but what another camera saw since
    /// that frame is the same once more.
    pub(super) fn repeats_of(&self, target: &Target, moment: &Moment, own_interval_s: f64) -> f64 {
        let since_s = (moment.time_s - target.seen_s).max(own_interval_s);
        let is_since = |seen_s: &&f64| moment.time_s - **seen_s < own_interval_s;
        let others = target.seen_by_each_s.iter().filter(is_since).count() as f64;
        self.repeats(since_s / moment.share_lit) * (1.0 + others)
    }

    /// In so many frames at such intervals errors of markers, lobes and powers are the same: one that lasts for a time is as white noise of the density
    /// 2 time sigma^2.
    fn repeats(&self, interval_s: f64) -> f64 {
        (2.0 * self.settings.correlation_s / interval_s.max(LEAST_INTERVAL_S)).max(1.0)
    }

    /// Over so wide a yaw, one standard deviation, rad, a frame after such an interval takes the vehicle's distance for a straight line.
    fn straight_rad(&self, interval_s: f64) -> f64 {
        let sigma_m = self.repeats(interval_s).sqrt() * self.pose.marker_sigma_m;
        straight_rad(self.airframe.max_radius_m(), sigma_m)
    }

    /// By how much a camera may see a vehicle elsewhere than the one that showed it last: about each axis, rad^2, and along each, m^2.
    fn apart(&self, target: &Target, moment: &Moment) -> (f64, f64) {
        let [last, now] = [target.seen_by, moment.camera].map(|camera| self.rig.mounting(camera));
        let of_mountings = last.rotation_covariance_rad2 + now.rotation_covariance_rad2;
        let of_places = last.position_covariance_m2 + now.position_covariance_m2;
        // A calibration errs across the line of sight only, along two axes.
        let here = moment.calibrations.iter().map(Matrix3::trace).sum::<f64>();
        let here = here / moment.calibrations.len().max(1) as f64;
        let of_calibrations = 0.5 * (target.calibration_rad2.trace() + here);
        (of_mountings.trace() / 3.0 + of_calibrations, of_places.trace() / 3.0)
    }

    /// Whether a frame shows anything where a vehicle may be.
    fn shows_any(&self, component: &Component, moment: &Moment) -> bool {
        let may_be_there = self.may_be_at(component);
        moment.observations.iter().any(may_be_there)
    }

    /// Whether a spot is where a vehicle may be.
    pub(super) fn may_be_at(&self, component: &Component) -> impl Fn(&Observation) -> bool {
        let distance_m = component.pose.position_m.norm();
        let ahead = component.pose.position_m / distance_m;
        let reach_m = self.airframe.max_radius_m() + SURELY_SIGMA * component.aside_m2(&ahead).sqrt();
        move |seen| (seen.bearing.vector() - ahead).norm() * distance_m < reach_m
    }

    /// Whether a marker blinks a signal: LEDs without one blink the first.
    pub(super) fn blinks(&self, marker: u16, signal: u32) -> bool {
        let leds = &self.airframe.markers()[usize::from(marker)].leds;
        leds.iter().any(|&led| self.airframe.leds()[led].signal.unwrap_or(0) == signal)
    }
}

/// Carries what is believed from frame to frame. Keeps its room.
#[derive(Debug)]
pub(super) struct Stepper {
    /// By vehicle, one after the other.
    predicted: Vec<Component>,
    first_predicted: Vec<usize>,
    pub(super) ways: Ways,
    joint: Joint,
    /// How likely each sighting is a vehicle's.
    claimed: Vec<f64>,
    reduced: Vec<Component>,
    fleet: Fleet,
    persistent: PersistentClutter,
}

impl Stepper {
    pub(super) fn new(airframe: &Airframe) -> Self {
        Self {
            predicted: Vec::with_capacity(1024),
            first_predicted: Vec::with_capacity(MOST_TARGETS + 1),
            ways: Ways::with_room(airframe),
            joint: Joint::default(),
            claimed: Vec::new(),
            reduced: Vec::with_capacity(512),
            fleet: Fleet::with_room(MOST_TARGETS),
            persistent: PersistentClutter::with_room(),
        }
    }

    /// The light of an LED of intensity 1 at 1 m in a camera, as far as the vehicles of a state tell it.
    pub(super) fn power(&mut self, camera: usize, state: &State) -> Option<LogLight> {
        self.fleet.listen(state, camera);
        self.fleet.but_for(None)
    }

    /// Fills `after` with what is believed after a frame.
    pub(super) fn step(&mut self, model: &Model, before: &State, moment: &Moment, after: &mut State) {
        let interval_s = moment.time_s - before.time_s;
        let watched = model.rig.watched(moment.camera);
        let motion = Motion {
            interval_s,
            turn: moment.turn(&model.rig, before.camera, interval_s, model.settings.turn_sigma_rad_s),
            faster: moment.faster(&model.rig, before.moving.as_ref()),
            up: moment.up,
            tilt_sigma_rad: model.tilt_sigma_rad(moment.tilt_sigma_rad),
        };
        // What two cameras see at nearly one time is no more alike for that: a frame is compared with its own camera's.
        let last_s = before.frames_s[moment.camera];
        let own_interval_s = if last_s.is_finite() { moment.time_s - last_s } else { interval_s };
        let straight_rad = model.straight_rad(own_interval_s);
        self.predicted.clear();
        self.first_predicted.clear();
        for target in &before.targets {
            self.first_predicted.push(self.predicted.len());
            let apart = (target.seen_by != moment.camera).then(|| model.apart(target, moment));
            for component in before.components(target) {
                let mut here = motion.predict(component, &model.settings);
                if let Some((rotation_rad2, position_m2)) = apart {
                    let mut loose = here;
                    Motion::loosen(&mut loose, rotation_rad2, position_m2);
                    // Where this camera shows nothing, nothing compares the two.
                    if model.shows_any(&loose, moment) {
                        here = loose;
                    }
                }
                split(&here, straight_rad, &mut self.predicted);
            }
        }
        self.first_predicted.push(self.predicted.len());
        let scene = Scene { model, watched, moment, interval_s, own_interval_s };
        let clutter = before.clutter[moment.camera];
        self.fleet.listen(before, moment.camera);
        let powers = (0..before.targets.len()).map(|vehicle| self.fleet.but_for(Some(vehicle)));
        let marker_m2 = model.repeats(own_interval_s) * model.pose.marker_sigma_m * model.pose.marker_sigma_m;
        let lasting = self.persistent.expect(&before.persistent, moment, &motion, &model.settings, marker_m2);
        self.ways.begin(&scene, clutter, lasting, powers);
        for (vehicle, range) in self.first_predicted.windows(2).enumerate() {
            self.ways.may_screen(vehicle, &self.predicted[range[0]..range[1]]);
        }
        let Self { predicted, first_predicted, ways, .. } = self;
        let vehicle_at = |vehicle: usize| {
            let range = first_predicted[vehicle]..first_predicted[vehicle + 1];
            (&before.targets[vehicle], &predicted[range])
        };
        for vehicle in 0..before.targets.len() {
            let (target, components) = vehicle_at(vehicle);
            ways.add_vehicle(&scene, vehicle, target, components);
        }
        ways.try_vehicles(&scene, vehicle_at);
        self.joint.explain(&self.ways.choices, &self.ways.log_unseen, model.settings.association);
        after.clear(moment.camera, moment.time_s, before.next_id);
        (after.up, after.tilt_sigma_rad) = (moment.up, moment.tilt_sigma_rad);
        (after.moving, after.clutter) = (moment.moving, before.clutter);
        after.frames_s = before.frames_s;
        after.frames_s[moment.camera] = moment.time_s;
        self.claimed.clear();
        self.claimed.resize(moment.observations.len(), 0.0);
        for (vehicle, target) in before.targets.iter().enumerate() {
            self.conclude(vehicle, target, &scene, straight_rad, after);
        }
        let unexplained =
            appearing::appear(&scene, &mut self.ways, straight_rad, &self.claimed, &mut self.reduced, after);
        self.persistent.remember(model, moment, &self.claimed, after);
        after.end_doubles(model.airframe.max_radius_m());
        let clutter = clutter + (unexplained - clutter) / CLUTTER_FRAMES;
        after.clutter[moment.camera] = clutter.max(LEAST_CLUTTER);
    }

    /// Adds a vehicle as it is with the frame, unless it is gone.
    fn conclude(
        &mut self,
        vehicle: usize,
        before: &Target,
        scene: &Scene<'_>,
        straight_rad: f64,
        after: &mut State,
    ) {
        let Scene { model, moment, interval_s, .. } = *scene;
        let Self { predicted, first_predicted, ways, joint, claimed, reduced, .. } = self;
        let unseen = joint.unseen[vehicle];
        let existence = Existence::new(before.existence, before.hidden).after(interval_s, &model.settings);
        let with = existence.with(unseen, ways.unseen_if_shown(vehicle));
        let first_member = after.members.len();
        reduced.clear();
        ways.count_once(vehicle, &mut joint.probability);
        for (index, way) in ways.of(vehicle) {
            let probability = joint.probability[index];
            reduced.push(Component { weight: probability, ..way.component });
            for &(spot, _) in way.pairs.as_slice() {
                claimed[usize::from(spot)] += probability;
            }
        }
        let own = &predicted[first_predicted[vehicle]..first_predicted[vehicle + 1]];
        let all = existence.unseen(ways.unseen_if_shown(vehicle)).max(f64::MIN_POSITIVE);
        for (component, unseen_if_shown) in own.iter().zip(ways.unseen_of(vehicle)) {
            // One that must have shown is the less likely for it, unless it is hidden.
            let there = existence.hidden + existence.shown * unseen_if_shown;
            reduced.push(Component { weight: unseen * component.weight * there / all, ..*component });
        }
        reduce(reduced, straight_rad);
        let is_seen = unseen < 0.5;
        let (seen_s, seen_by) =
            if is_seen { (moment.time_s, moment.camera) } else { (before.seen_s, before.seen_by) };
        let mut seen_by_each_s = before.seen_by_each_s;
        seen_by_each_s[seen_by] = seen_s;
        // What another camera shows is not missed until that one misses it.
        let is_missed =
            before.is_predicted || moment.camera == before.seen_by || moment.time_s - seen_s > LOST_S;
        let is_lost = moment.time_s - seen_s > model.settings.coast_s;
        if with.total() < GONE || is_lost || reduced.is_empty() {
            return;
        }
        let mut calibration_rad2 = Matrix3::zeros();
        for spot in 0..moment.observations.len() {
            let claims = |(index, way): (usize, &Way)| {
                if way.pairs.has_spot(spot) { joint.probability[index] } else { 0.0 }
            };
            if ways.of(vehicle).map(claims).sum::<f64>() > 0.5 {
                after.members.push(spot);
                after.markers.push(marker_of(spot, ways.of(vehicle), &joint.probability));
                calibration_rad2 += moment.calibrations[spot];
            }
        }
        let members = after.members.len() - first_member;
        let calibration_rad2 =
            if members > 0 { calibration_rad2 / members as f64 } else { before.calibration_rad2 };
        let first_component = after.components.len();
        after.components.extend_from_slice(reduced);
        after.targets.push(Target {
            id: before.id,
            vehicle: before.vehicle,
            existence: with.total().min(1.0),
            hidden: with.hidden / with.total(),
            seen_s,
            seen_by,
            seen_by_each_s,
            is_predicted: !is_seen && is_missed,
            is_odd: ways.is_odd(vehicle, &reduced[0], moment.camera).unwrap_or(before.is_odd),
            calibration_rad2,
            first_component,
            components: reduced.len(),
            first_member,
            members,
            log_wrong: before.log_wrong,
        });
        let repeats = model.repeats_of(before, moment, scene.own_interval_s);
        doubting::doubt(scene, ways, vehicle, repeats, straight_rad, reduced, after);
    }
}

/// The marker that a spot is in most of the ways that have it.
fn marker_of<'a>(
    spot: usize,
    ways: impl Iterator<Item = (usize, &'a Way)> + Clone,
    probability: &[f64],
) -> Option<u16> {
    let claims = ways.filter_map(|(index, way)| Some((way.pairs.marker_of(spot)?, probability[index])));
    let all: f64 = claims.clone().map(|(_, share)| share).sum();
    let share_of =
        |marker: u16| claims.clone().filter(|claim| claim.0 == marker).map(|claim| claim.1).sum::<f64>();
    claims.clone().map(|(marker, _)| marker).find(|&marker| share_of(marker) > 0.5 * all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::tests::simulator::model;

    #[test]
    fn what_cameras_see_at_nearly_one_time_repeats_once_each() {
        let model = model();
        let mut moment = Moment::default();
        (moment.time_s, moment.share_lit) = (7.0, 1.0);
        let period_s = 0.0625;
        let repeats = |seen_s: &[f64]| {
            let mut seen_by_each_s = [f64::NEG_INFINITY; Rig::MOST];
            seen_by_each_s[..seen_s.len()].copy_from_slice(seen_s);
            let seen_s = seen_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            model.repeats_of(&target(seen_s, seen_by_each_s), &moment, period_s)
        };
        let alone = repeats(&[7.0 - period_s]);
        assert!((alone / (2.0 * model.settings.correlation_s / period_s) - 1.0).abs() < 1e-9);
        for own_s in [7.0 - period_s, f64::NEG_INFINITY] {
            for other_s in [7.0, 7.0 - 1e-3, 7.0 - 0.9 * period_s] {
                assert!((repeats(&[own_s, other_s]) / alone - 2.0).abs() < 1e-9, "{own_s} {other_s}");
                assert!((repeats(&[own_s, other_s, other_s]) / alone - 3.0).abs() < 1e-9);
            }
        }
        // Whom nobody saw for a while is news.
        assert!(repeats(&[5.0, 6.0]) < 0.1 * alone);
    }

    fn target(seen_s: f64, seen_by_each_s: [f64; Rig::MOST]) -> Target {
        Target { seen_by_each_s, ..Target::somebody(seen_s) }
    }
}
