//! The spots of what may be one neighbour -> its pose, what a user wants to know of it, and how well it explains them.
//!
//! In: the sightings of one group. Out: a candidate with its modes. The bounds are strict and come from
//! [`crate::ranging::DistanceBounds`] and spot sizes alone; the posterior of [`crate::pose`] is cut off at them.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};

use super::Sighting;
use super::blinking::lit;
use super::candidates::{Candidates, MergingLight, Told};
use super::context::Context;
use super::grouping::CLEAR_SPOTS;
use super::matching::Matcher;
use super::neighbour::{Distance, Orientation, Position};
use super::pairs::Pairs;
use crate::airframe::Airframe;
use crate::camera::Bearing;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::{
    self, Estimator, Hypotheses, Known, Mode, Observation, POWER_RANGE, Part, Posterior, SettingsError,
    Summary, Visible, merged_into,
};
use crate::ranging::Interval;

/// Logarithm of the farthest over the nearest distance of a neighbour: they are even over it.
pub(crate) const LOG_RANGE: f64 = 4.6;
/// Light of the wrong power does not rule out what geometry is sure of, nats.
const MOST_POWER_NATS: f64 = 12.0;

/// A marker that is less likely than this part of a spot is not.
const LEAST_MERGED: f64 = 0.02;

/// Over this much of the field the error of a calibration changes by itself.
const CALIBRATION_LENGTH_RAD: f64 = 0.5;

/// Tells the neighbours behind groups of sightings.
#[derive(Debug)]
pub(super) struct Poser {
    /// Which of the kinds that are looked for, and the logarithm of how likely it is beforehand.
    kind: usize,
    log_share: f64,
    airframe: Airframe,
    estimator: Estimator,
    hypotheses: Hypotheses,
    observations: Vec<Observation>,
    pairs: Pairs,
    scale_sigma: f64,
    unit_sigma: f64,
    lobe_sigma: f64,
    lit: Vec<f64>,
    within: Vec<usize>,
    others: Vec<Bearing>,
    /// Which observations these are.
    beside: Vec<usize>,
    with_light: bool,
}

impl Poser {
    /// Of a kind, by its number among so many.
    pub(super) fn new(
        airframe: &Airframe,
        settings: pose::Settings,
        (kind, kinds): (usize, usize),
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            kind,
            log_share: -libm::log(kinds as f64),
            airframe: airframe.clone(),
            estimator: Estimator::new(airframe, settings)?,
            hypotheses: Hypotheses::with_room(airframe.markers().len()),
            observations: Vec::with_capacity(airframe.markers().len()),
            pairs: Pairs::new(airframe),
            scale_sigma: settings.scale_sigma,
            unit_sigma: settings.unit_sigma,
            lobe_sigma: settings.lobe_sigma,
            lit: lit(airframe),
            within: Vec::with_capacity(airframe.markers().len()),
            others: Vec::with_capacity(512),
            beside: Vec::with_capacity(512),
            with_light: settings.use_brightness,
        })
    }

    /// Adds the candidate that a group, ascending, is; an observation that cannot be its marker is left out. Nothing is added where the group
    /// cannot be one neighbour.
    pub(super) fn weigh(
        &mut self,
        context: &Context<'_>,
        group: &[usize],
        matcher: &mut Matcher,
        candidates: &mut Candidates,
    ) {
        if group.is_empty() || candidates.has_as(self.kind, group) {
            return;
        }
        let Some(bounds) = self.estimate(context, group, matcher) else { return };
        let markers = &self.estimator.posterior().markers;
        if markers.contains(&None) {
            let mut within = core::mem::take(&mut self.within);
            within.clear();
            within.extend(
                group.iter().zip(markers).filter(|(_, marker)| marker.is_some()).map(|(&spot, _)| spot),
            );
            self.weigh(context, &within, matcher, candidates);
            self.within = within;
            return;
        }
        self.describe(context, group, (bounds, matcher.reach_m()), candidates);
    }

    /// Estimates the posterior of a group and returns its strict bounds; `None` where it cannot be one neighbour.
    fn estimate(
        &mut self,
        context: &Context<'_>,
        group: &[usize],
        matcher: &mut Matcher,
    ) -> Option<Interval> {
        let sightings = context.sightings;
        let bounds = matcher.bounds(context, group)?;
        self.observations.clear();
        self.observations
            .extend(group.iter().map(|&index| observe(&sightings[index], context.clutter[index])));
        let up = context.gravity.map(|down| -*down);
        let mut size = None;
        if let [only] = group {
            let distance = matcher.lone_distance(&sightings[*only], &bounds);
            let airframe = (&self.airframe, self.estimator.symmetry());
            let seen = (&sightings[*only].bearing, distance);
            self.hypotheses.suppose_one_marker(airframe, seen, up, |_| true);
            size = Some(distance);
        } else {
            matcher.hypotheses(context, group, &mut self.hypotheses);
        }
        self.gather_others(context, group, matcher);
        // A group that sets the prior of the LED power does not get it as its prior.
        let power = if group.len() < CLEAR_SPOTS { context.power } else { None };
        let visible = Visible {
            detection_limit: context.detection_limit,
            miss_rate: Some(context.miss_rate),
            watched: Some(context.watched),
            others: &self.others,
            lit: &self.lit,
        };
        let believed = told_apart(sightings, group, matcher.reach_m(), &bounds);
        let known = Known {
            up,
            bounds: believed,
            size,
            power,
            tilt_sigma_rad: Some(context.tilt_sigma_rad),
            unit_sigma: Some(context.light_times * self.unit_sigma),
            visible,
        };
        let posterior = self.estimator.estimate(&self.observations, &mut self.hypotheses, &known);
        posterior.summary.is_some().then_some(bounds)
    }

    /// The directions of observations that are not of a group but near it.
    fn gather_others(&mut self, context: &Context<'_>, group: &[usize], matcher: &Matcher) {
        let sightings = context.sightings;
        let middle = sightings[group[0]].bearing.vector();
        let widest = |&spot: &usize| matcher.widest_rad(&sightings[spot]);
        let reach_rad = group.iter().map(widest).fold(f64::INFINITY, f64::min);
        self.others.clear();
        self.beside.clear();
        context.near.each_within(middle, reach_rad, |_, index| {
            if !group.contains(&index) {
                self.others.push(sightings[index].bearing);
                self.beside.push(index);
            }
        });
    }

    /// Adds the candidate whose posterior was estimated last.
    fn describe(
        &self,
        context: &Context<'_>,
        group: &[usize],
        (bounds, reach_m): (Interval, f64),
        candidates: &mut Candidates,
    ) {
        let Posterior {
            summary,
            modes,
            markers,
            log_evidence,
            misfit,
            worst_sigma,
            missed,
            tilting,
            light_spread,
            log_power,
        } = self.estimator.posterior();
        let Some(summary) = *summary else { return };
        let Summary { pose, mut position_covariance_m2, mut distance, .. } = summary;
        let length_m = pose.position_m.norm();
        let (of_position_m2, of_distance_m2) = of_calibration(context.sightings, group, &pose.position_m);
        let of_scale = self.scale_sigma * self.scale_sigma;
        position_covariance_m2 += of_position_m2 + pose.position_m * pose.position_m.transpose() * of_scale;
        let of_scale_m2 = of_scale * length_m * length_m;
        distance.sigma_m = (distance.sigma_m * distance.sigma_m + of_distance_m2 + of_scale_m2).sqrt();
        distance.distance_m = distance.distance_m.clamp(bounds.min_m(), bounds.max_m());
        let [perpendicular_m, inline_m] = self.pairs.distances_m(context.sightings, group, markers);
        let told = Told {
            kind: self.kind,
            bearing: Bearing::new(pose.position_m).unwrap_or(context.sightings[group[0]].bearing),
            distance: Distance { estimate: Some(distance), bounds, perpendicular_m, inline_m },
            position: Some(Position {
                // As far away as the distance says, which is not quite the length of a mean of places.
                mean_m: pose.position_m * (distance.distance_m / length_m),
                covariance_m2: position_covariance_m2,
            }),
            orientation: Some(Orientation {
                camera_from_body: pose.camera_from_body,
                covariance_rad2: summary.orientation_covariance_rad2,
                position_covariance_m_rad: summary.position_orientation_covariance_m_rad,
            }),
            misfit: *misfit,
            missed: *missed,
            tilting: *tilting,
            light_spread: *light_spread,
            worst_sigma: *worst_sigma,
            log_density: log_evidence - log_range(group.len())
                + power_agreement(context, group, *log_power)
                + context.log_likelier(group[0], distance.distance_m)
                + self.log_share,
            reach_m,
        };
        candidates.push(group, modes, told);
        self.tell_merging(context, modes, *log_power, candidates);
    }

    /// Tells which of the observations beside the candidate that was added last a marker of it may be part of, and with how much light.
    fn tell_merging(
        &self,
        context: &Context<'_>,
        modes: &[Mode],
        log_power: Option<f64>,
        candidates: &mut Candidates,
    ) {
        let Some(best) = modes.first() else { return };
        let unit_sigma = context.light_times * self.unit_sigma;
        for (bearing, &spot) in self.others.iter().zip(&self.beside) {
            let resolution_rad = context.sightings[spot].resolution_rad;
            let mut part_light = PartLight::default();
            for mode in modes {
                let part =
                    merged_into(&self.airframe, &mode.pose, bearing.vector(), resolution_rad, unit_sigma);
                let Some(Part { probability, intensity, range2_m2 }) = part else { continue };
                // The farther away the more powerful are the LEDs whose light is seen.
                let times = mode.pose.position_m.norm_squared() / best.pose.position_m.norm_squared();
                let lobe = self.lobe_sigma / intensity.max(1e-3);
                part_light.add(mode.weight * probability, times * intensity / range2_m2, lobe);
            }
            let probability = part_light.probability;
            if probability > LEAST_MERGED {
                let adds = log_power
                    .filter(|_| self.with_light)
                    .and_then(|log_power| part_light.told(log_power, unit_sigma));
                let lights = context.sightings[spot].log_light.zip(adds);
                let place_log_density = -libm::log(PI * resolution_rad * resolution_rad);
                candidates.merge(spot, probability, place_log_density, lights);
            }
        }
    }
}

/// Light that a candidate adds to a spot, over its modes.
#[derive(Clone, Copy, Debug, Default)]
struct PartLight {
    /// How likely it adds any.
    probability: f64,
    /// Sums over the modes that do, each by its share: light of LEDs of power 1, its square, and the variance of its lobe.
    first: f64,
    second: f64,
    lobes: f64,
}

impl PartLight {
    /// A mode of this share adds light that its lobe knows to a relative sigma.
    fn add(&mut self, share: f64, light: f64, lobe_sigma: f64) {
        self.probability += share;
        self.first += share * light;
        self.second += share * light * light;
        self.lobes += share * lobe_sigma * lobe_sigma;
    }

    /// What is added by LEDs of this power; `None` where no light is.
    fn told(&self, log_power: f64, unit_sigma: f64) -> Option<MergingLight> {
        let mean = self.first / self.probability;
        let over_modes = (self.second / self.probability / (mean * mean) - 1.0).max(0.0);
        // Units of LEDs differ, its own and those that tell their power.
        let units = 2.0 * unit_sigma * unit_sigma;
        (mean > 0.0).then(|| MergingLight {
            light: libm::exp(log_power) * mean,
            variance: units + self.lobes / self.probability + over_modes,
        })
    }
}

/// Logarithm of the range of the logarithm of distance over which neighbours are even, where spot size does not tell it.
fn log_range(spots: usize) -> f64 {
    if spots == 1 { 0.0 } else { libm::log(LOG_RANGE) }
}

/// What it is worth that the light of a group that tells the power of its own LEDs is that of the frame's others, as a logarithm.
fn power_agreement(context: &Context<'_>, group: &[usize], log_power: Option<f64>) -> f64 {
    let (Some(known), Some(own)) = (context.power.filter(|_| group.len() >= CLEAR_SPOTS), log_power) else {
        return 0.0;
    };
    let off = (own - known.value) / known.sigma;
    let log_density = -0.5 * off * off - 0.5 * libm::log(TAU * known.sigma * known.sigma);
    log_density.max(-MOST_POWER_NATS) + libm::log(POWER_RANGE)
}

/// The distances within strict bounds from which the two outermost markers of an airframe are further apart than half of what is one spot: beyond, they
/// would hardly be seen as two.
fn told_apart(sightings: &[Sighting], group: &[usize], reach_m: f64, bounds: &Interval) -> Interval {
    let finest_rad = group.iter().map(|&spot| sightings[spot].resolution_rad).fold(f64::INFINITY, f64::min);
    let farthest_m = 2.0 * reach_m / (0.5 * finest_rad);
    let believed = Interval::new(0.0, farthest_m).filter(|_| group.len() > 1);
    believed.and_then(|believed| bounds.intersect(&believed)).unwrap_or(*bounds)
}

/// What the camera's calibration leaves of a neighbour's position, m^2, and the part of it along the line of sight.
///
/// Its error is much the same for all spots of a neighbour, which it moves together: no spots average it away, and none of
/// it looks like a distance. How it changes over the field is the error of distance: by itself over
/// [`CALIBRATION_LENGTH_RAD`].
fn of_calibration(sightings: &[Sighting], group: &[usize], position_m: &Vector3<f64>) -> (Matrix3<f64>, f64) {
    let of_one = |&spot: &usize| sightings[spot].covariance_rad2 - sightings[spot].spot_covariance_rad2;
    let mean_rad2 = group.iter().map(of_one).sum::<Matrix3<f64>>() / group.len() as f64;
    of_mean_calibration(&mean_rad2, position_m)
}

/// The same from the mean of what it leaves of the spots' directions, rad^2.
pub(crate) fn of_mean_calibration(
    mean_rad2: &Matrix3<f64>,
    position_m: &Vector3<f64>,
) -> (Matrix3<f64>, f64) {
    let scale = 0.5 * mean_rad2.trace() / (CALIBRATION_LENGTH_RAD * CALIBRATION_LENGTH_RAD);
    (
        mean_rad2 * position_m.norm_squared() + position_m * position_m.transpose() * scale,
        scale * position_m.norm_squared(),
    )
}

fn observe(sighting: &Sighting, clutter_log_density: f64) -> Observation {
    Observation {
        bearing: sighting.bearing,
        covariance_rad2: sighting.spot_covariance_rad2,
        log_light: sighting.log_light,
        resolution_rad: sighting.resolution_rad,
        signal: sighting.signal,
        clutter_log_density,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three of four times light 1, else light 3: 1.5 on average, with a variance of a third of its square.
    #[test]
    fn light_that_is_added_varies_over_modes_lobes_and_units() {
        let mut part = PartLight::default();
        part.add(0.3, 1.0, 0.2);
        part.add(0.1, 3.0, 0.1);
        assert!((part.probability - 0.4).abs() < 1e-12);
        let told = part.told(libm::log(2.0), 0.1).unwrap();
        assert!((told.light - 3.0).abs() < 1e-12, "{told:?}");
        let expected = 2.0 * 0.01 + (0.75 * 0.04 + 0.25 * 0.01) + (3.0 / 2.25 - 1.0);
        assert!((told.variance - expected).abs() < 1e-12, "{told:?} not {expected}");
        let mut dark = PartLight::default();
        dark.add(0.3, 0.0, 0.2);
        assert!(dark.told(0.0, 0.1).is_none(), "an LED that shines away adds nothing");
    }
}
