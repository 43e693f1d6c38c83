//! The posterior of a neighbour's pose as it is documented, written down once more: what the estimator's mixture is held
//! against.
//!
//! In: what two spots tell, an airframe, which way is up. Out: the logarithm of the density over position (m^3) and attitude
//! (Haar measure), up to a constant. Not modelled: the robust loss beyond 3.5 sigma, which a posterior does not reach.

use nalgebra::{Matrix2, Matrix2x3, Rotation3, Unit, Vector2, Vector3};
use photinus::airframe::Airframe;
use photinus::locator::Sighting;
use photinus::ranging::Interval;

/// The estimator's tolerances: of lobes (1 is one LED straight ahead), the intensity taken for none, the error of the logarithm
/// of light per pixel of error of the centre, how often a marker that must show does not.
const LOBE_ERROR: f64 = 0.02;
const DARK: f64 = 0.01;
const LOG_LIGHT_PER_PX: f64 = 1.5;
pub(crate) const MISSED: f64 = 0.001;
/// A marker outshone by more than this is taken for a reflection, where the faintest light does not rule that out.
const OUTSHONE: f64 = 0.22;
/// The place of melted light is known to this share of how far it is from the spot's own marker.
const MELTED_SHARE: f64 = 0.1;
const CERTAIN: f64 = 0.4;
/// Markers nearer to each other than this are one spot, px.
const RESOLUTION_PX: f64 = 2.5;

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
        let aside = direction.cross(&Vector3::new(0.3, 1.0, 0.2)).normalize();
        let across = Matrix2x3::from_rows(&[aside.transpose(), direction.cross(&aside).transpose()]);
        let flat: Matrix2<f64> = across * covariance_rad2 * across.transpose();
        let root = flat.cholesky().expect("a covariance").l();
        Self {
            direction,
            whitening: root.try_inverse().expect("a covariance") * across,
            log_light: libm::log(sighting.spot.flux),
            log_light_variance: (LOG_LIGHT_PER_PX * sighting.spot.sigma_px()).powi(2),
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
    /// Light below which a marker is not found, grey levels.
    pub(crate) faintest: f64,
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
        let (mut place_m, mut light) = (own_m, self.airframe.intensity(markers[spot], camera_m).max(1e-3));
        for melted in self.melted(spot, markers, camera_m) {
            let more = self.airframe.intensity(melted, camera_m);
            light += more;
            place_m += (self.airframe.markers()[melted].position_m - place_m) * (more / light);
        }
        let off_rad = MELTED_SHARE * (place_m - own_m).norm() / camera_m.norm();
        let share = seen.variance_rad2 / (seen.variance_rad2 + off_rad * off_rad);
        let off = (turn * place_m + position_m).normalize() - seen.direction;
        if off.norm_squared() > 1.0 {
            // The opposite direction is on the same line.
            return f64::NEG_INFINITY;
        }
        libm::log(share) - 0.5 * share * (seen.whitening * off).norm_squared()
    }

    /// The markers without a spot that melt into one.
    fn melted<'b>(
        &'b self,
        spot: usize,
        markers: [usize; 2],
        camera_m: &'b Vector3<f64>,
    ) -> impl Iterator<Item = usize> + 'b {
        let own_m = self.airframe.markers()[markers[spot]].position_m;
        let ray_m = camera_m - own_m;
        let nearest_m = self.seen[spot].resolution_rad * ray_m.norm();
        let apart_m = move |other: usize| {
            (self.airframe.markers()[other].position_m - own_m).cross(&ray_m).norm() / ray_m.norm()
        };
        (0..self.airframe.markers().len())
            .filter(move |other| !markers.contains(other) && apart_m(*other) < nearest_m)
    }

    /// Of the light of both spots with the power that fits them best, and that power: light at 1 m of an LED straight ahead.
    fn light(&self, camera_m: &Vector3<f64>, markers: [usize; 2]) -> (f64, f64) {
        let terms = [0, 1].map(|spot| {
            let marker_m = self.airframe.markers()[markers[spot]].position_m;
            let shines = self.airframe.intensity(markers[spot], camera_m).max(DARK);
            let expected = libm::log(shines) - libm::log((camera_m - marker_m).norm_squared());
            let variance =
                self.seen[spot].log_light_variance + self.unit_sigma.powi(2) + (LOBE_ERROR / shines).powi(2);
            (self.seen[spot].log_light - expected, variance)
        });
        let [(a, of_a), (b, of_b)] = terms;
        let log_power = (a * of_b + b * of_a) / (of_a + of_b);
        // With the best power the two share what is between them.
        (-0.5 * (a - b).powi(2) / (of_a + of_b) - 0.5 * libm::log(of_a * of_b), libm::exp(log_power))
    }

    /// Of seeing these markers and no others.
    fn visibility(&self, camera_m: &Vector3<f64>, markers: [usize; 2], power: f64) -> f64 {
        let intensity = |marker| self.airframe.intensity(marker, camera_m);
        let faintest = (self.faintest * camera_m.norm_squared() / power).clamp(0.02, 1.0);
        let outshone = OUTSHONE * intensity(markers[0]).max(intensity(markers[1]));
        let half = if faintest > CERTAIN * outshone { faintest.max(outshone) } else { faintest };
        let log_chance = |marker: usize| {
            let is_melted = |spot| self.melted(spot, markers, camera_m).any(|melted| melted == marker);
            if is_melted(0) || is_melted(1) {
                return 0.0;
            }
            let odds = (intensity(marker).max(1e-3) / half).powi(8);
            let found = (1.0 - MISSED) * odds / (1.0 + odds);
            libm::log(if markers.contains(&marker) { found.max(1e-9) } else { 1.0 - found })
        };
        (0..self.airframe.markers().len()).map(log_chance).sum()
    }
}
