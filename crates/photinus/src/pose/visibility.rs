//! What should shine and is not seen tells against a pose, and so does what is seen and should not shine.

use nalgebra::Vector3;

use super::known::{Known, Visible};
use super::merging::{FAR, one_spot};
use super::problem::{Merging, Pose, Problem};
use crate::airframe::{Airframe, Marker};
use crate::camera::Bearing;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::LogLight;
use crate::spots::ANY_LIMIT_SIGMA;

/// Light at which a marker is found half of the time when nothing tells what is faintest, 1 being one LED straight ahead.
const FAINTEST_SHARE: f64 = 0.15;
/// A marker that gives less than this share of the light at which half are found is not expected, and where its absence costs less than so much, nats, it costs nothing:
/// most markers of an airframe shine away.
const NEGLIGIBLE_SHARE: f64 = 0.02;
const NEGLIGIBLE: f64 = 1e-4;
/// A marker that would be found as likely as this were it alone must show: it is merged or dark if it does not.
const MUST_SHOW: f64 = 0.5;
/// A logistic distribution is nearest to a normal one whose sigma is so many times its scale (J. Aldrich, F. Nelson, Linear Probability, Logit, and Probit
/// Models, 1984: 1.6 to 1.8).
const SIGMAS_PER_SCALE: f64 = 1.7;
/// However alike the LEDs are said to be, which of two is brighter is no surer than with this spread.
const LEAST_UNIT_SIGMA: f64 = 0.05;

/// How the odds of being found rise with light: with a power of it that is a whole number of halves.
#[derive(Clone, Copy, Debug)]
struct Rise {
    halves: u32,
}

impl Rise {
    /// Where the light at which a marker is found has this spread, as a logarithm.
    fn of(sigma: f64) -> Self {
        Self { halves: (2.0 * SIGMAS_PER_SCALE / sigma).round().clamp(1.0, 64.0) as u32 }
    }

    /// Of markers that a detector finds from so much light on, whose power is that of the airframe's file but for a spread, where that of all is known to a variance.
    fn of_markers(limit: Option<LogLight>, unit_sigma: f64, power_variance: f64) -> Self {
        let sigma = limit.map_or(ANY_LIMIT_SIGMA, |limit| limit.sigma);
        Self::of((sigma * sigma + unit_sigma * unit_sigma + power_variance).sqrt())
    }

    /// Of two markers' light over each other's.
    fn of_two(unit_sigma: f64) -> Self {
        Self::of(core::f64::consts::SQRT_2 * unit_sigma.max(LEAST_UNIT_SIGMA))
    }

    /// The odds of a marker whose light is this many times that at which they are even.
    fn odds(self, times: f64) -> f64 {
        let mut odds = if self.halves % 2 == 1 { times.sqrt() } else { 1.0 };
        let (mut square, mut left) = (times, self.halves / 2);
        while left > 0 {
            if left % 2 == 1 {
                odds *= square;
            }
            square *= square;
            left /= 2;
        }
        odds
    }
}

/// The probability of these odds, which may be infinite.
fn probability(odds: f64) -> f64 {
    1.0 - 1.0 / (1.0 + odds)
}

/// Where a marker of an airframe at a pose is seen from the camera.
fn direction(pose: &Pose, marker: &Marker) -> Vector3<f64> {
    (pose.camera_from_body * marker.position_m + pose.position_m).normalize()
}

/// A marker that may be part of a spot that is not its own.
pub(crate) struct Part {
    /// How likely it is: that it shines, and that it is so near.
    pub(crate) probability: f64,
    /// Its light, 1 being one LED straight ahead.
    pub(crate) intensity: f64,
    /// From the camera, m^2.
    pub(crate) range2_m2: f64,
}

/// Which marker of an airframe at a pose is the likeliest to be part of a spot in this direction, which is not its own.
pub(crate) fn merged_into(
    airframe: &Airframe,
    pose: &Pose,
    spot: &Vector3<f64>,
    resolution_rad: f64,
    unit_sigma: f64,
) -> Option<Part> {
    // No marker is seen further from the origin than sqrt(2) radii over its distance, as a chord.
    let distance_m = pose.position_m.norm();
    let near = core::f64::consts::SQRT_2 * airframe.max_radius_m() / distance_m + FAR * resolution_rad;
    if (pose.position_m / distance_m - spot).norm_squared() > near * near * (1.0 + 1e-9) {
        return None;
    }
    let camera_m = pose.camera_in_body_m();
    let rise = Rise::of_markers(None, unit_sigma, 0.0);
    let each = airframe.markers().iter().enumerate().filter_map(|(marker, own)| {
        let gap_rad2 = (direction(pose, own) - spot).norm_squared();
        let merged = one_spot(gap_rad2 / (resolution_rad * resolution_rad));
        if merged == 0.0 {
            return None;
        }
        let intensity = airframe.intensity(marker, &camera_m);
        let probability = merged * probability(rise.odds(intensity / FAINTEST_SHARE));
        Some(Part { probability, intensity, range2_m2: (camera_m - own.position_m).norm_squared() })
    });
    each.max_by(|a, b| a.probability.total_cmp(&b.probability))
}

/// Markers that must show, and those of them that do not, as far as a pose tells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missed {
    /// How many must show.
    pub expected: f64,
    /// How many of these do not.
    pub missed: f64,
}

impl Problem<'_> {
    /// How often a marker that must show does not.
    fn miss_rate(&self) -> f64 {
        self.known.visible.miss_rate.unwrap_or(self.settings.missed)
    }

    /// Whether a marker that must show if it is lit does not, beside a spot anywhere near a pose.
    pub(super) fn misses_beside(&self, pose: &Pose, log_power: Option<f64>) -> bool {
        let known = Known { visible: Visible { lit: &[], ..self.known.visible }, ..*self.known };
        let dark = Problem { merging: Merging::Dark, known: &known, ..*self };
        let mut misses = false;
        dark.visibility(pose, log_power, |marker, unseen| {
            let must_show = unseen.is_some_and(|unseen| unseen < 1.0 - MUST_SHOW);
            misses |= must_show && self.may_merge(pose, marker);
        });
        misses
    }

    /// The markers that must show at a pose and do not, as likely as that rate, what is too faint, and what merges make it.
    pub(super) fn missed(&self, pose: &Pose, log_power: Option<f64>) -> Missed {
        let odds = self.miss_rate() / (1.0 - self.miss_rate());
        let mut all = Missed::default();
        self.visibility(pose, log_power, |_, unseen| {
            let missed = unseen.map_or(0.0, |unseen| odds * (1.0 - unseen) / unseen);
            all.missed += missed;
            all.expected += if unseen.is_some() { missed } else { 1.0 };
        });
        all
    }

    /// What it costs, nats, that these markers are seen and the others are not, if an LED of intensity 1 at 1 m gives a light
    /// of this logarithm.
    pub(super) fn visibility_nats(&self, pose: &Pose, log_power: Option<f64>) -> f64 {
        self.visibility(pose, log_power, |_, _| ())
    }

    /// The same. `tell` is told of each marker that is looked for how likely it was not to be seen, `None` where it is.
    pub(super) fn visibility(
        &self,
        pose: &Pose,
        log_power: Option<f64>,
        mut tell: impl FnMut(usize, Option<f64>),
    ) -> f64 {
        let camera_m = pose.camera_in_body_m();
        let limit = self.known.visible.detection_limit;
        let rise = Rise::of_markers(limit, self.unit_sigma(), self.power_variance());
        let rise_of_two = Rise::of_two(self.unit_sigma());
        let half = match log_power.zip(limit) {
            // The intensity at which a marker at the origin's distance gives as much light.
            Some((power, limit)) => (libm::exp(limit.value - power) * camera_m.norm_squared())
                .clamp(self.settings.lobe_sigma.max(1e-4), 1.0),
            None => FAINTEST_SHARE,
        };
        let intensity = |marker: usize| self.airframe.intensity(marker, &camera_m);
        let miss_rate = self.miss_rate();
        let mut nats = |marker: usize| {
            let shines = intensity(marker).max(1e-4);
            if shines < NEGLIGIBLE_SHARE * half && !self.is_used(marker) {
                return 0.0;
            }
            let lit = self.known.visible.lit.get(marker).copied().unwrap_or(1.0);
            let found = lit * (1.0 - miss_rate) * probability(rise.odds(shines / half));
            if self.is_used(marker) {
                tell(marker, None);
                // How rarely a marker that is too faint is found all the same was never measured: it is taken to be no rarer than that a bright one is missed.
                return -libm::log(found.max(miss_rate.max(1e-9)));
            }
            if found < NEGLIGIBLE || !self.is_watched(pose, marker) {
                return 0.0;
            }
            // Of two markers that merge the spot is said to be the brighter one.
            let into = |(spot, seen): (usize, usize)| match self.merged(spot, seen, marker, &camera_m) {
                0.0 => 0.0,
                merged => merged * probability(rise_of_two.odds(intensity(seen).max(1e-3) / shines)),
            };
            let merged =
                if self.merging == Merging::Near { self.used().map(into).fold(0.0, f64::max) } else { 0.0 };
            let unseen = 1.0 - found * (1.0 - merged) * (1.0 - self.merged_with_others(pose, marker));
            tell(marker, Some(unseen));
            -libm::log(unseen)
        };
        (0..self.airframe.markers().len()).map(&mut nats).sum::<f64>() + self.told_apart_nats(&camera_m)
    }

    /// How well the spots in use and what is known beforehand tell the power of the LEDs, as a logarithm.
    fn power_variance(&self) -> f64 {
        let unit = self.unit_sigma();
        let weight = |variance: f64| 1.0 / (variance + 1e-6);
        let seen = self.used().filter_map(|(spot, _)| self.observations[spot].log_light);
        let told: f64 = seen.map(|light| weight(light.sigma * light.sigma + unit * unit)).sum();
        let told = told + self.known.power.map_or(0.0, |power| weight(power.sigma * power.sigma));
        if told > 0.0 { 1.0 / told } else { 0.0 }
    }

    /// What it costs that markers beside each other are seen as two spots.
    fn told_apart_nats(&self, camera_m: &Vector3<f64>) -> f64 {
        if self.merging == Merging::Far {
            return 0.0;
        }
        let pairs = self.used().flat_map(|first| {
            let later = self.used().filter(move |second| second.0 > first.0);
            later.map(move |second| (first, second))
        });
        pairs
            .map(|((spot, seen), (_, other))| {
                -libm::log((1.0 - self.merged(spot, seen, other, camera_m)).max(1e-9))
            })
            .sum()
    }

    /// How likely a marker is part of a spot that is not this neighbour's.
    fn merged_with_others(&self, pose: &Pose, marker: usize) -> f64 {
        let others = self.known.visible.others;
        let Some(resolution_rad) =
            self.observations.first().map(|seen| seen.resolution_rad).filter(|_| !others.is_empty())
        else {
            return 0.0;
        };
        let direction = direction(pose, &self.airframe.markers()[marker]);
        let gaps = others.iter().map(|other| (other.vector() - direction).norm_squared());
        one_spot(gaps.fold(f64::INFINITY, f64::min) / (resolution_rad * resolution_rad))
    }

    /// Whether anybody looks where a marker is at this pose.
    pub(super) fn is_watched(&self, pose: &Pose, marker: usize) -> bool {
        let Some(watched) = &self.known.visible.watched else { return true };
        let place_m = pose.camera_from_body * self.airframe.markers()[marker].position_m + pose.position_m;
        Bearing::new(place_m).is_some_and(|bearing| watched.sees(&bearing))
    }
}
