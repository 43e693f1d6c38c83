//! What stands in for frames when there are too many of them: who is in view is told with errors drawn from a table.
//!
//! For each neighbour in view: whether it is followed is a chain of two states whose shares and lengths are those of the table; its errors are processes of
//! Ornstein and Uhlenbeck with the table's sigmas, so that they last as long as those of tracks do. docs/swarm.md compares it with rendered frames that it was not
//! fitted to.

mod fit;
mod sampling;
pub(crate) mod table;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use nalgebra::{Matrix3, Unit, Vector3};
use photinus::locator::Distance;
use photinus::ranging::{Estimate, Interval};
use photinus_control::{Normal, Seen};

use super::perfect::exact;
use super::sight::{InView, in_view};
use super::{Looking, Moment};
use crate::chance::{Chance, Use};
use crate::scenario::Scenario;
pub use sampling::Sampling;
use table::{Cell, StandInTable, between};

/// Eyes that a table stands in for.
#[derive(Debug)]
pub struct StandIn {
    table: Arc<StandInTable>,
    chance: Chance,
    blinks: bool,
    period_s: f64,
    followed: Vec<Option<Followed>>,
    views: Vec<InView>,
    phantoms: Vec<Phantom>,
    next: u64,
}

/// A neighbour that is followed; errors in units of their sigmas.
#[derive(Clone, Copy, Debug)]
struct Followed {
    track: u64,
    since_s: f64,
    fresh_s: f64,
    place: Vector3<f64>,
    velocity: Vector3<f64>,
    /// How loose its bounds are.
    bounds: Vector3<f64>,
    /// Of the frame that showed it last: whether its bounds are broken, and the error of the size of its spot.
    is_broken: bool,
    spot: f64,
}

/// A phantom: a neighbour where no vehicle is.
#[derive(Clone, Copy, Debug)]
struct Phantom {
    track: u64,
    place_m: Vector3<f64>,
    until_s: f64,
}

/// Velocity errors last about as long as the tracker's memory, s.
const VELOCITY_LASTS_S: f64 = 0.5;
/// Phantoms are told at distances between these, m.
const PHANTOM_M: (f64, f64) = (3.0, 15.0);

impl StandIn {
    pub(super) fn new(scenario: &Scenario, index: usize, table: &Arc<StandInTable>) -> Self {
        Self {
            table: Arc::clone(table),
            chance: Chance::new(scenario.seed, Use::Seeing, index as u64),
            blinks: scenario.codes.is_some(),
            period_s: scenario.period_s(),
            followed: vec![None; scenario.vehicles.len()],
            views: Vec::new(),
            phantoms: Vec::new(),
            next: 0,
        }
    }

    pub(super) fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        let mut views = std::mem::take(&mut self.views);
        in_view(moment, looking.vehicle, &mut views);
        let mut in_turn = views.iter().peekable();
        for target in 0..self.followed.len() {
            // views come by number of the vehicle
            let view = in_turn.next_if(|view| view.target == target);
            let Some(view) = view else {
                self.followed[target] = None;
                continue;
            };
            self.follow(view, moment.time_s);
            let told = self.followed[target].as_ref().and_then(|followed| {
                exact(looking.vehicle, target, moment)
                    .map(|truth| self.blur(&truth, followed, view, moment.time_s))
            });
            seen.extend(told);
        }
        self.views = views;
        self.imagine(looking, moment, seen);
    }

    /// Whether one who is in view is followed in this frame, and how its errors go on.
    fn follow(&mut self, view: &InView, now_s: f64) {
        let Self { table, chance, period_s, .. } = self;
        let sight = table.of(self.blinks);
        let following = sight.follows(view.light, view.markers);
        let cell = sight.errors(view.distance_m, view.markers);
        let within = |time_s: f64| 1.0 - libm::exp(-*period_s / time_s);
        let draw = chance.uniform();
        let place = &mut self.followed[view.target];
        match place {
            Some(_) if draw < within(following.lasts_s) => *place = None,
            Some(followed) => {
                let renew = |state: &mut Vector3<f64>, lasts_s: f64, draw: Vector3<f64>| {
                    let keeps = 1.0 - within(lasts_s);
                    *state = *state * keeps + draw * (1.0 - keeps * keeps).sqrt();
                };
                renew(&mut followed.place, cell.range_lasts_s, chance.normals());
                renew(&mut followed.velocity, VELOCITY_LASTS_S, chance.normals());
                renew(&mut followed.bounds, cell.bounds_last_s, chance.normals());
                if chance.uniform() < cell.fresh {
                    followed.fresh_s = now_s;
                    followed.is_broken = chance.uniform() < cell.broken;
                    followed.spot = chance.normal();
                }
            }
            None if draw < within(following.found_s) => {
                self.next += 1;
                *place = Some(Followed {
                    track: self.next,
                    since_s: now_s,
                    fresh_s: now_s,
                    place: chance.normals(),
                    velocity: chance.normals(),
                    bounds: chance.normals(),
                    is_broken: chance.uniform() < cell.broken,
                    spot: chance.normal(),
                });
            }
            None => {}
        }
    }

    /// The truth with the errors of one who is followed.
    fn blur(&self, truth: &Seen, followed: &Followed, view: &InView, now_s: f64) -> Seen {
        let cell = self.table.of(self.blinks).errors(view.distance_m, view.markers);
        // from the vehicle's origin, as bounds are told, and not from the camera's
        let true_m = truth.distance.bounds.min_m();
        let [along, left, up] = axes(&truth.bearing);
        let ratio = libm::exp(cell.range_bias + cell.range_sigma * followed.place.x);
        let off = (left * followed.place.y + up * followed.place.z) * cell.across_sigma_rad;
        let direction = Unit::new_normalize(along + off);
        let mean = direction.into_inner() * (true_m * ratio);
        let covariance = told_covariance(cell, &mean);
        let [unit_px, power, spot_sigma] = self.table.spot_px;
        let spot_px = unit_px * libm::pow(view.light, power) * libm::exp(spot_sigma * followed.spot);
        let velocity = truth.velocity_m_s.map(|velocity| Normal {
            mean: velocity.mean + followed.velocity * cell.velocity_sigma_m_s,
            covariance: Matrix3::identity() * cell.velocity_sigma_told_m_s * cell.velocity_sigma_told_m_s,
        });
        let named = self.blinks && now_s - followed.since_s >= self.table.name_s;
        Seen {
            track: followed.track,
            identity: truth.identity.filter(|_| named),
            bearing: direction,
            bearing_bound_rad: cell.bearing_bound_rad,
            distance: Distance {
                estimate: Some(Estimate {
                    distance_m: mean.norm(),
                    sigma_m: cell.range_sigma_told * mean.norm(),
                }),
                bounds: bounds(cell, followed, true_m),
                perpendicular_m: Some(true_m * libm::exp(cell.estimates[0])),
                inline_m: Some(true_m * libm::exp(cell.estimates[1])),
            },
            position_m: Some(Normal { mean, covariance }),
            velocity_m_s: velocity,
            heading: None,
            probability: 0.99,
            spot_px: Some(spot_px.round().max(1.0)),
            age_s: now_s - followed.fresh_s,
        }
    }

    /// Phantoms, as rendered frames have them now and then.
    fn imagine(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        let Self { table, chance, period_s, .. } = self;
        let sight = table.of(self.blinks);
        self.phantoms.retain(|phantom| phantom.until_s > moment.time_s);
        let cameras = moment.vehicles[looking.vehicle].cameras_work.iter().filter(|works| **works).count();
        if chance.uniform() < sight.phantoms_per_s * *period_s * cameras as f64 {
            let direction = Vector3::new(chance.normal(), chance.normal(), 0.3 * chance.normal());
            let (nearest_m, farthest_m) = PHANTOM_M;
            let distance_m = nearest_m + (farthest_m - nearest_m) * chance.uniform();
            self.next += 1;
            self.phantoms.push(Phantom {
                track: self.next,
                place_m: direction.normalize() * distance_m,
                until_s: moment.time_s - sight.phantom_lasts_s * libm::log(1.0 - chance.uniform()),
            });
        }
        let two_markers = 2;
        seen.extend(self.phantoms.iter().filter_map(|phantom| {
            let distance_m = phantom.place_m.norm();
            let cell = sight.errors(distance_m, two_markers);
            Some(Seen {
                track: phantom.track,
                identity: None,
                bearing: Unit::try_new(phantom.place_m, 1e-9)?,
                bearing_bound_rad: cell.bearing_bound_rad,
                distance: Distance {
                    estimate: Some(Estimate { distance_m, sigma_m: cell.range_sigma_told * distance_m }),
                    bounds: Interval::new(distance_m * libm::exp(cell.lower[2]), f64::INFINITY)?,
                    perpendicular_m: None,
                    inline_m: None,
                },
                position_m: Some(Normal {
                    mean: phantom.place_m,
                    covariance: told_covariance(cell, &phantom.place_m),
                }),
                velocity_m_s: None,
                heading: None,
                probability: 0.6,
                spot_px: None,
                age_s: 0.0,
            })
        }));
    }
}

/// Along a direction, to its left and up: a right-handed triad.
pub(super) fn axes(direction: &Unit<Vector3<f64>>) -> [Vector3<f64>; 3] {
    let along = direction.into_inner();
    let aside = if along.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let left = aside.cross(&along).normalize();
    [along, left, along.cross(&left)]
}

/// The covariance that is told of a place.
fn told_covariance(cell: &Cell, mean: &Vector3<f64>) -> Matrix3<f64> {
    let distance_m = mean.norm();
    let [along, left, up] = axes(&Unit::new_normalize(*mean));
    let range_m = cell.range_sigma_told * distance_m;
    let across_m = cell.across_sigma_told_rad * distance_m;
    let part = |axis: Vector3<f64>, sigma_m: f64| axis * axis.transpose() * (sigma_m * sigma_m).max(1e-8);
    part(along, range_m) + part(left, across_m) + part(up, across_m)
}

/// Bounds about the true distance: they hold except where this frame's are broken.
fn bounds(cell: &Cell, followed: &Followed, distance_m: f64) -> Interval {
    // a standard normal number as a number from 0 to 1, so that looseness lasts
    let share = |normal: f64| 0.5 * libm::erfc(-normal / core::f64::consts::SQRT_2);
    let [lower, upper] = [followed.bounds.x, followed.bounds.y].map(share);
    if followed.is_broken {
        return Interval::new(1.05 * distance_m, 1.1 * distance_m).expect("in order");
    }
    let lower_m = distance_m * libm::exp(between(&cell.lower, lower));
    let bounded = 1.0 - cell.unbounded;
    let upper_m = if upper < bounded {
        distance_m * libm::exp(between(&cell.upper, upper / bounded))
    } else {
        f64::INFINITY
    };
    Interval::new(lower_m, upper_m).expect("in order")
}
