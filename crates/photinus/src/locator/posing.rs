//! The spots of one neighbour -> its pose, and what a user wants to know of it.
//!
//! In: the sightings of one group. Out: the neighbour and its modes. The bounds are strict and come from
//! [`crate::ranging::DistanceBounds`] and spot sizes alone; the posterior of [`crate::pose`] is cut off at them.

use nalgebra::{Matrix3, Unit, Vector3};

use super::grouping::CLEAR_SPOTS;
use super::matching::Matcher;
use super::pairs::Pairs;
use super::{Distance, Neighbour, Orientation, Position, Sighting};
use crate::airframe::Airframe;
use crate::camera::{Bearing, Watched};
use crate::pose::{
    self, Estimator, Hypotheses, Known, LogDistance, Observation, Pose, Posterior, SettingsError, Summary,
    Visible,
};
use crate::ranging::Interval;
use crate::spots::{self, Brightness};

/// A spot far from the pose, in sigma: the group is looked at without it.
const STRANGE_SIGMAS: f64 = 5.0;
/// Two markers so far apart are told apart half of the time, px (rendered frames).
const RESOLUTION_PX: f64 = 2.5;
/// Light of a spot that is found half of the time over the step that makes a pixel bright, px (rendered frames).
const FAINTEST_PX: f64 = 2.5;

/// Over so much of the field the error of a calibration changes by itself.
const CALIBRATION_LENGTH_RAD: f64 = 0.5;

/// Tells the neighbours behind groups of sightings.
#[derive(Debug)]
pub(super) struct Poser {
    airframe: Airframe,
    estimator: Estimator,
    hypotheses: Hypotheses,
    observations: Vec<Observation>,
    pairs: Pairs,
    visible: Visible<'static>,
    without: Vec<usize>,
}

impl Poser {
    pub(super) fn new(
        airframe: &Airframe,
        settings: pose::Settings,
        spots: &spots::Settings,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            airframe: airframe.clone(),
            estimator: Estimator::new(airframe, settings)?,
            hypotheses: Hypotheses::with_room(airframe.markers().len()),
            observations: Vec::with_capacity(airframe.markers().len()),
            pairs: Pairs::new(airframe),
            visible: visible(spots),
            without: Vec::with_capacity(airframe.markers().len()),
        })
    }

    /// The neighbour that a group is, with its modes; a spot that cannot be its marker leaves the group.
    pub(super) fn tell(
        &mut self,
        sightings: &[Sighting],
        group: &mut Vec<usize>,
        gravity: Option<&Unit<Vector3<f64>>>,
        watched: Watched<'_>,
        matcher: &mut Matcher,
    ) -> (Neighbour, &[pose::Mode]) {
        let mut bounds = self.estimate(sightings, group, gravity, watched, matcher);
        if group.len() > 2 && self.estimator.posterior().worst_sigma > STRANGE_SIGMAS {
            bounds = self.leave_out_a_stranger(sightings, group, gravity, watched, matcher);
        }
        self.describe(sightings, group, bounds)
    }

    /// Estimates the posterior of a group and returns its strict bounds.
    fn estimate(
        &mut self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
        watched: Watched<'_>,
        matcher: &mut Matcher,
    ) -> Interval {
        let any = Interval::new(matcher.near_m(), f64::INFINITY);
        let bounds = matcher.bounds(sightings, group, gravity).or(any);
        let bounds = bounds.expect("from the near limit to infinity is an interval");
        self.observations.clear();
        self.observations.extend(group.iter().map(|&index| observe(&sightings[index])));
        let up = gravity.map(|down| -*down);
        let mut size = None;
        if let [only] = group {
            let distance = matcher.lone_distance(&sightings[*only], &bounds);
            self.suppose_one_marker(&sightings[*only], up, distance);
            size = Some(distance);
        } else {
            matcher.hypotheses(sightings, group, gravity, &mut self.hypotheses);
        }
        // Who tells the light of the frame's LEDs is not told by it.
        let power = if group.len() < CLEAR_SPOTS { matcher.known_power() } else { None };
        let known =
            Known { up, bounds, size, power, visible: Visible { watched: Some(watched), ..self.visible } };
        self.estimator.estimate(&self.observations, &mut self.hypotheses, &known);
        bounds
    }

    /// Leaves out the spot without which the others are the likeliest, if that explains more than a stranger costs.
    fn leave_out_a_stranger(
        &mut self,
        sightings: &[Sighting],
        group: &mut Vec<usize>,
        gravity: Option<&Unit<Vector3<f64>>>,
        watched: Watched<'_>,
        matcher: &mut Matcher,
    ) -> Interval {
        let mut best = (self.estimator.posterior().log_evidence, None);
        let mut without = std::mem::take(&mut self.without);
        for stranger in 0..group.len() {
            without.clear();
            without.extend(
                group.iter().enumerate().filter(|(index, _)| *index != stranger).map(|(_, &spot)| spot),
            );
            self.estimate(sightings, &without, gravity, watched, matcher);
            let log_evidence = self.estimator.posterior().log_evidence + pose::STRANGER_LOG_DENSITY;
            if log_evidence > best.0 {
                best = (log_evidence, Some(stranger));
            }
        }
        self.without = without;
        if let Some(stranger) = best.1 {
            group.remove(stranger);
        }
        self.estimate(sightings, group, gravity, watched, matcher)
    }

    /// A lone spot is any of the markers, turned to the camera.
    fn suppose_one_marker(
        &mut self,
        sighting: &Sighting,
        up: Option<Unit<Vector3<f64>>>,
        distance: LogDistance,
    ) {
        self.hypotheses.begin(1);
        let ahead = *sighting.bearing.vector();
        let up = up.map_or(-Vector3::y(), Unit::into_inner);
        let position_m = ahead * libm::exp(distance.mean);
        let symmetry = self.estimator.symmetry();
        for marker in 0..self.airframe.markers().len() {
            let number = marker as u16;
            if symmetry.canonical_turn(&[number]) == 0 {
                self.hypotheses.offer(&[Some(number)], 0.0, 0, || Pose {
                    position_m,
                    camera_from_body: facing(&self.airframe, marker, &ahead, &up),
                });
            }
        }
    }

    fn describe(
        &self,
        sightings: &[Sighting],
        group: &[usize],
        bounds: Interval,
    ) -> (Neighbour, &[pose::Mode]) {
        let Posterior { summary, modes, markers, .. } = self.estimator.posterior();
        let mut neighbour = Neighbour {
            bearing: sightings[group[0]].bearing,
            distance: Distance { estimate: None, bounds, perpendicular_m: None, inline_m: None },
            position: None,
            orientation: None,
            first_member: 0,
            members: group.len(),
            first_mode: 0,
            modes: 0,
        };
        let Some(Summary { pose, mut position_covariance_m2, orientation_covariance_rad2, mut distance }) =
            *summary
        else {
            return (neighbour, &[]);
        };
        let length_m = pose.position_m.norm();
        let (of_position_m2, of_distance_m2) = of_calibration(sightings, group, &pose.position_m);
        position_covariance_m2 += of_position_m2;
        distance.sigma_m = (distance.sigma_m * distance.sigma_m + of_distance_m2).sqrt();
        if let Some(bearing) = Bearing::new(pose.position_m) {
            neighbour.bearing = bearing;
        }
        distance.distance_m = distance.distance_m.clamp(bounds.min_m(), bounds.max_m());
        let within_m = length_m.clamp(bounds.min_m(), bounds.max_m());
        neighbour.distance.estimate = Some(distance);
        neighbour.position = Some(Position {
            mean_m: pose.position_m * (within_m / length_m),
            covariance_m2: position_covariance_m2,
        });
        neighbour.orientation = Some(Orientation {
            camera_from_body: pose.camera_from_body,
            covariance_rad2: orientation_covariance_rad2,
        });
        [neighbour.distance.perpendicular_m, neighbour.distance.inline_m] =
            self.pairs.distances_m(sightings, group, markers);
        (neighbour, modes)
    }
}

/// What the camera's calibration leaves of a neighbour's position, m^2, and the part of it along the line of sight.
///
/// Its error is much the same for all spots of a neighbour, which it moves together: no spots average it away, and none of
/// it looks like a distance. How it changes over the field is the error of distance: by itself over
/// [`CALIBRATION_LENGTH_RAD`].
fn of_calibration(sightings: &[Sighting], group: &[usize], position_m: &Vector3<f64>) -> (Matrix3<f64>, f64) {
    let of_one = |&spot: &usize| sightings[spot].covariance_rad2 - sightings[spot].spot_covariance_rad2;
    let mean_rad2 = group.iter().map(of_one).sum::<Matrix3<f64>>() / group.len() as f64;
    let scale = 0.5 * mean_rad2.trace() / (CALIBRATION_LENGTH_RAD * CALIBRATION_LENGTH_RAD);
    (
        mean_rad2 * position_m.norm_squared() + position_m * position_m.transpose() * scale,
        scale * position_m.norm_squared(),
    )
}

/// Which markers a detector with these settings finds.
fn visible(settings: &spots::Settings) -> Visible<'static> {
    let (Brightness::Threshold(step) | Brightness::Contrast(step)) = settings.brightness;
    Visible { faintest_light: FAINTEST_PX * f64::from(step), outshone: 0.0, certain: 0.0, watched: None }
}

fn observe(sighting: &Sighting) -> Observation {
    Observation {
        bearing: sighting.bearing,
        covariance_rad2: sighting.spot_covariance_rad2,
        log_light: sighting.log_light,
        resolution_rad: RESOLUTION_PX * sighting.rad_per_px,
        signal: sighting.signal,
    }
}

/// The upright attitude in which a marker shines at the camera.
fn facing(
    airframe: &Airframe,
    marker: usize,
    ahead: &Vector3<f64>,
    up: &Vector3<f64>,
) -> nalgebra::Rotation3<f64> {
    let marker = &airframe.markers()[marker];
    let axes: Vector3<f64> = marker.leds.iter().map(|&led| airframe.leds()[led].axis.into_inner()).sum();
    let shines = if axes.xy().norm() > 0.1 { axes } else { marker.position_m };
    let yaw_rad = libm::atan2(shines.y, shines.x);
    // Body x towards the camera, as far as that is level.
    let level = |towards: Vector3<f64>| towards - up * towards.dot(up);
    let towards = level(-ahead).try_normalize(1e-3).or_else(|| level(Vector3::z()).try_normalize(1e-3));
    let towards = towards.unwrap_or_else(|| level(Vector3::x()).normalize());
    let upright = nalgebra::Rotation3::from_basis_unchecked(&[towards, up.cross(&towards), *up]);
    upright * nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -yaw_rad)
}
