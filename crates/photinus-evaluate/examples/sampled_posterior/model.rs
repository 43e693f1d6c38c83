//! The posterior of a neighbour's pose as it is documented, written down once more: what the estimator's mixture is held
//! against.
//!
//! In: what two spots tell, an airframe, which way is up. Out: the logarithm of the density over position (m^3) and attitude
//! (Haar measure), up to a constant. Not modelled: the robust loss beyond 3.5 sigma, which a posterior does not reach.

use nalgebra::{Matrix2, Matrix2x3, Rotation3, Unit, Vector2, Vector3};
use photinus::airframe::Airframe;
use photinus::locator::Sighting;
use photinus::pose::LogLight;
use photinus::ranging::Interval;

/// The estimator's tolerances: of lobes (1 is one LED straight ahead), the intensity taken for none, how often a marker that
/// must show does not.
pub(crate) const LOBE_SIGMA: f64 = 0.02;
const DARK: f64 = 0.01;
pub(crate) const MISSED: f64 = 0.001;
/// Squared misfit of light beyond which it counts by its logarithm.
const AS_TOLD: f64 = 6.0;
/// Two markers so far apart are one spot half of the time, px; twice as far they never are.
const RESOLUTION_PX: f64 = 2.5;
/// The window of a spot, in resolutions.
const WINDOW: f64 = 1.32;

/// What one spot tells.
pub(crate) struct Seen {
    pub(crate) direction: Vector3<f64>,
    /// From a direction's error to one of unit covariance.
    whitening: Matrix2x3<f64>,
    log_light: f64,
    log_light_variance: f64,
    /// Variance of the direction, and what is nearer than so much is one spot, rad^2 and rad.
    variance_rad2: f64,
    resolution_rad: f64,
}

impl Seen {
    pub(crate) fn of(sighting: &Sighting) -> Self {
        let (direction, covariance_rad2) = (*sighting.bearing.vector(), sighting.covariance_rad2);
        let light = sighting.log_light.expect("spots with light");
        let aside = direction.cross(&Vector3::new(0.3, 1.0, 0.2)).normalize();
        let across = Matrix2x3::from_rows(&[aside.transpose(), direction.cross(&aside).transpose()]);
        let flat: Matrix2<f64> = across * covariance_rad2 * across.transpose();
        let root = flat.cholesky().expect("a covariance").l();
        Self {
            direction,
            whitening: root.try_inverse().expect("a covariance") * across,
            log_light: light.value,
            log_light_variance: light.sigma * light.sigma,
            variance_rad2: covariance_rad2.trace() / 2.0,
            resolution_rad: RESOLUTION_PX * sighting.rad_per_px,
        }
    }
}

/// All that is known of one neighbour.
pub(crate) struct Model<'a> {
    pub(crate) airframe: &'a Airframe,
    pub(crate) seen: [Seen; 2],
    pub(crate) up: Unit<Vector3<f64>>,
    pub(crate) bounds: Interval,
    pub(crate) tilt_sigma_rad: f64,
    /// Spread of power between LEDs, of its logarithm.
    pub(crate) unit_sigma: f64,
    /// Light at which half of the markers are found, grey levels, and how much that differs from marker to marker.
    pub(crate) detection_limit: LogLight,
}

impl Model<'_> {
    /// Logarithm of the density of a pose in which the two spots are these markers.
    pub(crate) fn log_density(
        &self,
        position_m: &Vector3<f64>,
        turn: &Rotation3<f64>,
        markers: [usize; 2],
    ) -> f64 {
        let distance_m = position_m.norm();
        if !self.bounds.contains(distance_m) {
            return f64::NEG_INFINITY;
        }
        let camera_m = -(turn.inverse() * position_m);
        let up = turn.inverse() * self.up.into_inner();
        let tilt: Vector2<f64> = up.xy() / self.tilt_sigma_rad;
        if up.z < 0.0 {
            return f64::NEG_INFINITY;
        }
        let bearings: f64 =
            [0, 1].map(|spot| self.bearing(spot, markers, &camera_m, position_m, turn)).iter().sum();
        let (light, power) = self.light(&camera_m, markers);
        // Flat over directions and over the logarithm of distance.
        let prior = -3.0 * libm::log(distance_m) - 0.5 * tilt.norm_squared();
        prior + bearings + light + self.visibility(&camera_m, markers, power)
    }

    /// Of the direction of a spot.
    fn bearing(
        &self,
        spot: usize,
        markers: [usize; 2],
        camera_m: &Vector3<f64>,
        position_m: &Vector3<f64>,
        turn: &Rotation3<f64>,
    ) -> f64 {
        let seen = &self.seen[spot];
        let own_m = self.airframe.markers()[markers[spot]].position_m;
        let (mut pull_m, mut total, mut unsure_m2) =
            (Vector3::zeros(), self.airframe.intensity(markers[spot], camera_m).max(1e-3), 0.0);
        for (other, gap) in self.beside(spot, markers, camera_m) {
            let weight = (1.0 - gap * gap / (WINDOW * WINDOW)).max(0.0).powi(2);
            let light = weight * self.airframe.intensity(other, camera_m);
            let off_m = self.airframe.markers()[other].position_m - own_m;
            total += light;
            pull_m += off_m * light;
            unsure_m2 +=
                ((1.0 - weight).powi(2) + 2.0 * self.unit_sigma.powi(2)) * (off_m * light).norm_squared();
        }
        let place_m = own_m + pull_m / total;
        let off_rad = unsure_m2.sqrt() / total / camera_m.norm();
        let share = seen.variance_rad2 / (seen.variance_rad2 + off_rad * off_rad);
        let off = (turn * place_m + position_m).normalize() - seen.direction;
        if off.norm_squared() > 1.0 {
            // The opposite direction is on the same line.
            return f64::NEG_INFINITY;
        }
        libm::log(share) - 0.5 * share * (seen.whitening * off).norm_squared()
    }

    /// The markers without a spot that are near one in the image, each with its gap in resolutions.
    fn beside<'b>(
        &'b self,
        spot: usize,
        markers: [usize; 2],
        camera_m: &'b Vector3<f64>,
    ) -> impl Iterator<Item = (usize, f64)> + 'b {
        let gap = move |other: usize| (other, self.gap(spot, markers[spot], other, camera_m));
        (0..self.airframe.markers().len())
            .filter(move |other| !markers.contains(other))
            .map(gap)
            .filter(|(_, gap)| *gap < 2.0)
    }

    fn gap(&self, spot: usize, marker: usize, other: usize, camera_m: &Vector3<f64>) -> f64 {
        let [own_m, other_m] = [marker, other].map(|marker| self.airframe.markers()[marker].position_m);
        let ray_m = camera_m - own_m;
        (other_m - own_m).cross(&ray_m).norm() / ray_m.norm_squared() / self.seen[spot].resolution_rad
    }

    /// How likely two markers are one spot.
    fn one_spot(gap: f64) -> f64 {
        ((1.0 / (1.0 + gap.powi(6)) - 1.0 / 65.0) / (1.0 - 1.0 / 65.0)).max(0.0)
    }

    /// Of the light of both spots with the power that fits them best, and that power: light at 1 m of an LED straight ahead.
    fn light(&self, camera_m: &Vector3<f64>, markers: [usize; 2]) -> (f64, f64) {
        let terms = [0, 1].map(|spot| {
            let marker_m = self.airframe.markers()[markers[spot]].position_m;
            let beside = self.beside(spot, markers, camera_m).map(|(other, gap)| {
                (1.0 - gap * gap / (WINDOW * WINDOW)).max(0.0) * self.airframe.intensity(other, camera_m)
            });
            let shines = (self.airframe.intensity(markers[spot], camera_m) + beside.sum::<f64>()).max(DARK);
            let expected = libm::log(shines) - libm::log((camera_m - marker_m).norm_squared());
            let variance =
                self.seen[spot].log_light_variance + self.unit_sigma.powi(2) + (LOBE_SIGMA / shines).powi(2);
            (self.seen[spot].log_light - expected, variance)
        });
        let [(a, of_a), (b, of_b)] = terms;
        let log_power = (a * of_b + b * of_a) / (of_a + of_b);
        let misfit = (a - b).powi(2) / (of_a + of_b);
        let tail = 1.0 + libm::log((misfit / AS_TOLD).max(1.0));
        (-0.5 * misfit.min(AS_TOLD) * tail - 0.5 * libm::log(of_a + of_b), libm::exp(log_power))
    }

    /// The power of light by which the odds of a logistic distribution rise that is nearest to a normal one with this sigma, to a half.
    fn rise(sigma: f64) -> f64 {
        (2.0 * 1.7 / sigma).round() / 2.0
    }

    /// Of seeing these markers and no others.
    fn visibility(&self, camera_m: &Vector3<f64>, markers: [usize; 2], power: f64) -> f64 {
        let intensity = |marker| self.airframe.intensity(marker, camera_m);
        let LogLight { value, sigma } = self.detection_limit;
        let half = (libm::exp(value) * camera_m.norm_squared() / power).clamp(LOBE_SIGMA, 1.0);
        let told: f64 =
            self.seen.iter().map(|seen| 1.0 / (seen.log_light_variance + self.unit_sigma.powi(2))).sum();
        let rise = Self::rise((sigma.powi(2) + self.unit_sigma.powi(2) + 1.0 / told).sqrt());
        let rise_of_two = Self::rise(std::f64::consts::SQRT_2 * self.unit_sigma);
        let chance = |odds: f64| 1.0 - 1.0 / (1.0 + odds);
        let log_chance = |marker: usize| {
            let shines = intensity(marker).max(1e-4);
            let found = (1.0 - MISSED) * chance(libm::pow(shines / half, rise));
            if markers.contains(&marker) {
                return libm::log(found.max(MISSED));
            }
            let into = |spot: usize| {
                let outshines = chance(libm::pow(intensity(markers[spot]).max(1e-4) / shines, rise_of_two));
                Self::one_spot(self.gap(spot, markers[spot], marker, camera_m)) * outshines
            };
            libm::log(1.0 - found * (1.0 - into(0).max(into(1))))
        };
        let apart = 1.0 - Self::one_spot(self.gap(0, markers[0], markers[1], camera_m));
        (0..self.airframe.markers().len()).map(log_chance).sum::<f64>() + libm::log(apart.max(1e-9))
    }
}
