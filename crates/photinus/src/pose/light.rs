//! What brightness says: two markers' ratio tells yaw.

use core::f64::consts::TAU;

use nalgebra::Vector6;

use super::merging::Shining;
use super::problem::{Normal, Pose, Problem};
use crate::optics::LogLight;

/// Light tells no more than that of this many spots: lobes that are no cosines and lenses that darken towards their edge err alike
/// for spots that are near each other.
const INDEPENDENT: f64 = 4.0;
/// Squared misfit of all lights of a neighbour together, in units of its variance, beyond which lobes or powers are not as they are told: it counts by
/// its logarithm from there on.
pub(super) const AS_TOLD: f64 = 6.0;
/// A marker that shines with less than this towards the camera shines away.
const DARK: f64 = 0.01;
/// Where nothing tells the power of the LEDs it may be anything over this many units of its logarithm: a factor of 20,000.
pub(crate) const POWER_RANGE: f64 = 10.0;

/// The light of the spots in use against that of their markers.
pub(super) struct Light {
    scale: Scale,
    /// The same if lobes were as sure from every side as from straight ahead, where errors repeat.
    even: Scale,
    first: f64,
    second: f64,
    slope: Vector6<f64>,
    /// Sums of w r a and of w a a', before the power of the LEDs is solved for.
    normal: Normal,
    /// By how much each tells less for not being independent of the others.
    shared: f64,
    repeats: f64,
}

/// What lights are measured by: sums of inverse variances, and of the logarithms of sigmas.
#[derive(Clone, Copy)]
struct Scale {
    weight: f64,
    log_sigmas: f64,
}

impl Scale {
    /// Where nothing tells the power of the LEDs.
    fn any_power() -> Self {
        Self { weight: 0.0, log_sigmas: libm::log(POWER_RANGE) }
    }

    fn of(variance: f64) -> Self {
        Self { weight: 1.0 / variance, log_sigmas: 0.5 * libm::log(TAU * variance) }
    }

    fn add(&mut self, variance: f64) {
        let Self { weight, log_sigmas } = Self::of(variance);
        self.weight += weight;
        self.log_sigmas += log_sigmas;
    }

    /// The negative logarithm of the density of lights that are as expected, the power solved for.
    fn nats(&self) -> f64 {
        self.log_sigmas + 0.5 * libm::log(self.weight / TAU)
    }
}

impl Light {
    /// The light of all spots in use.
    pub(super) fn of(problem: &Problem<'_>, pose: &Pose) -> Self {
        let mut light = Self::beforehand(problem);
        let camera_in_body_m = pose.camera_in_body_m();
        let unseen = problem.unseen(&camera_in_body_m);
        for (spot, marker) in problem.used() {
            let shining = problem.shining_among(&unseen, spot, marker, &camera_in_body_m);
            light.see(problem, pose, &shining);
        }
        light
    }

    /// What is known of the power of the LEDs before any spot.
    pub(super) fn beforehand(problem: &Problem<'_>) -> Self {
        let mut light = Self {
            scale: Scale::any_power(),
            even: Scale::any_power(),
            first: 0.0,
            second: 0.0,
            slope: Vector6::zeros(),
            normal: Normal::zero(),
            shared: (problem.used().count() as f64 / INDEPENDENT).max(1.0),
            repeats: problem.repeats,
        };
        if let Some(LogLight { value, sigma }) = problem.known.power {
            light.scale = Scale::of(sigma * sigma);
            light.even = light.scale;
            light.add(1.0 / (sigma * sigma), value, &Vector6::zeros());
        }
        light
    }

    /// Adds a spot and its marker, with what they show at a pose.
    pub(super) fn see(&mut self, problem: &Problem<'_>, pose: &Pose, shining: &Shining) {
        let Some(seen) = problem.observations[shining.spot].log_light else { return };
        let shines = shining.intensity.max(DARK);
        let from_marker_m = shining.camera_m - problem.airframe.markers()[shining.marker].position_m;
        let range2_m2 = from_marker_m.norm_squared();
        // By the camera's place in the body frame, of ln I - 2 ln range.
        let mut by_camera = from_marker_m * (-2.0 / range2_m2);
        if shining.intensity > DARK {
            by_camera += shining.intensity_gradient / shining.intensity;
        }
        let unit = problem.unit_sigma();
        let variance = |lobe: f64| (seen.sigma * seen.sigma + unit * unit + lobe * lobe) * self.shared;
        if self.repeats > 1.0 {
            self.even.add(variance(problem.settings.lobe_sigma));
        }
        let variance = variance(problem.settings.lobe_sigma / shines);
        self.scale.add(variance);
        // The camera in the body frame moves by -R' distance delta, and by c x omega.
        let by_delta = pose.camera_from_body.matrix() * by_camera * -pose.position_m.norm();
        let by_omega = by_camera.cross(&shining.camera_m);
        let row = Vector6::new(-by_delta.x, -by_delta.y, -by_delta.z, -by_omega.x, -by_omega.y, -by_omega.z);
        self.add(1.0 / variance, seen.value - libm::log(shines / range2_m2), &row);
    }

    fn add(&mut self, weight: f64, residual: f64, row: &Vector6<f64>) {
        self.first += weight * residual;
        self.second += weight * residual * residual;
        self.slope += weight * row;
        self.normal.add_weighted(weight, residual, row);
    }

    /// Logarithm of the light of an LED of intensity 1 at 1 m that fits best; `None` where no spot has a light.
    pub(super) fn log_power(&self) -> Option<f64> {
        (self.scale.weight > 0.0).then(|| self.first / self.scale.weight)
    }

    /// As many independent ones tell what so many lights do.
    pub(super) fn independent(&self, lights: usize) -> f64 {
        lights as f64 / self.shared
    }

    /// Squares of what is left when the power of the LEDs is solved for.
    pub(super) fn misfit(&self) -> f64 {
        self.log_power().map_or(0.0, |power| (self.second - self.first * power).max(0.0))
    }

    /// What it costs that lights are told so surely. How much less sure they are for the side of a lobe that is seen is the same in all frames that err
    /// alike, and is told once.
    fn scale_nats(&self) -> f64 {
        let own = self.scale.nats();
        if self.repeats > 1.0 {
            let even = self.even.nats();
            even + (own - even) / self.repeats
        } else {
            own
        }
    }

    /// Adds what is left when the power of the LEDs is solved for.
    pub(super) fn add_to(&self, normal: &mut Normal) {
        let Some(power) = self.log_power() else { return };
        let misfit = self.misfit();
        let (half, share) = if misfit < AS_TOLD {
            (0.5 * misfit, 1.0)
        } else {
            (0.5 * AS_TOLD * (1.0 + libm::log(misfit / AS_TOLD)), AS_TOLD / misfit)
        };
        normal.nats += half + self.scale_nats();
        normal.gradient += (self.normal.gradient - self.slope * power) * share;
        for column in 0..6 {
            for line in 0..=column {
                normal.information[(line, column)] += share
                    * (self.normal.information[(line, column)]
                        - self.slope[line] * self.slope[column] / self.scale.weight);
            }
        }
    }
}

impl Problem<'_> {
    /// Spread of power between LEDs: sigma of its natural logarithm.
    pub(super) fn unit_sigma(&self) -> f64 {
        self.known.unit_sigma.unwrap_or(self.settings.unit_sigma)
    }

    /// How many of the spots in use have a light.
    pub(super) fn lit(&self) -> usize {
        self.used().filter(|&(spot, _)| self.observations[spot].log_light.is_some()).count()
    }
}
