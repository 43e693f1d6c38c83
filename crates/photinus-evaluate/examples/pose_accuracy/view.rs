//! Random views of a neighbour: its spots in pure geometry, and the information bound of its distance.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix6, Rotation3, Unit, Vector3, Vector6};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Located, Sighting};
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

/// Tilt of a target and error of gravity, one sigma per axis, rad.
pub(crate) const TILT_RAD: f64 = 4.0 * TAU / 360.0;
pub(crate) const GRAVITY_RAD: f64 = 0.3 * TAU / 360.0;
/// Spread of LEDs in pure geometry: sigma of the logarithm of their power.
pub(crate) const UNIT_SIGMA: f64 = 0.1;
/// Error of the logarithm of light in pure geometry, of all and times the root of the light, as rendered frames have it.
const LOG_LIGHT_SIGMA: f64 = 0.03;
const LIGHT_NOISE: f64 = 0.75;
/// Area of a spot times the square of the distance: 2.6 times as far as the paper's (13) has it, as rendered frames are.
const AREA_PX_M2: f64 = 31.5 * 2.6 * 2.6;
/// Light of an LED straight ahead at 1 m in pure geometry, grey levels, and that at which a marker is found half of the time.
const POWER: f64 = 40_000.0;
const FAINTEST: f64 = 75.0;

/// A spot's marker, and how sure its direction and the logarithm of its light are.
#[derive(Clone, Copy)]
pub(crate) struct Matched {
    pub(crate) marker: usize,
    sigma_rad: f64,
    log_light_sigma: f64,
}

/// A neighbour, and what is known of the vertical.
pub(crate) struct View {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) camera_from_body: Rotation3<f64>,
    pub(crate) gravity: Unit<Vector3<f64>>,
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

fn uniform(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(rng)
}

/// Error of the logarithm of a light in pure geometry.
fn log_light_sigma(light: f64) -> f64 {
    libm::hypot(LOG_LIGHT_SIGMA, LIGHT_NOISE / light.sqrt())
}

/// The probability that a marker of this light is found.
fn is_found(light: f64) -> f64 {
    1.0 - 1.0 / (1.0 + (light / FAINTEST).powi(7))
}

impl View {
    pub(crate) fn draw(distance_m: f64, rng: &mut Pcg64) -> Self {
        let (azimuth, elevation) = (uniform(rng, -1.0, 1.0), uniform(rng, -0.35, 0.35));
        let ahead = Vector3::new(
            libm::cos(elevation) * libm::sin(azimuth),
            -libm::sin(elevation),
            libm::cos(elevation) * libm::cos(azimuth),
        );
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), uniform(rng, 0.0, TAU));
        let tilt = Rotation3::new(Vector3::new(normal(rng), 0.0, normal(rng)) * TILT_RAD);
        let off = Rotation3::new(Vector3::new(normal(rng), 0.0, normal(rng)) * GRAVITY_RAD);
        Self {
            position_m: ahead * distance_m,
            camera_from_body: tilt * upright * yaw,
            gravity: Unit::new_normalize(off * Vector3::y()),
        }
    }

    /// The spots that show, each with an error of `sigma_px`.
    pub(crate) fn spots(
        &self,
        airframe: &Airframe,
        camera: &Camera,
        sigma_px: f64,
        rng: &mut Pcg64,
    ) -> Vec<Spot> {
        let camera_m = -(self.camera_from_body.inverse() * self.position_m);
        let mut spots = Vec::new();
        for marker in 0..airframe.markers().len() {
            let arm_m = airframe.markers()[marker].position_m;
            let intensity = airframe.intensity(marker, &camera_m);
            let light = POWER * intensity / (camera_m - arm_m).norm_squared();
            if uniform(rng, 0.0, 1.0) > is_found(light) {
                continue;
            }
            let flux = light * libm::exp(libm::hypot(UNIT_SIGMA, log_light_sigma(light)) * normal(rng));
            let place = self.camera_from_body * arm_m + self.position_m;
            let Some(pixel) = Bearing::new(place).and_then(|bearing| camera.pixel(&bearing)) else {
                continue;
            };
            let centre = Pixel::new(pixel.u + sigma_px * normal(rng), pixel.v + sigma_px * normal(rng));
            let (u, v) = (pixel.u.round() as u32, pixel.v.round() as u32);
            let extent = Extent { left: u.max(1) - 1, top: v.max(1) - 1, right: u + 1, bottom: v + 1 };
            spots.push(Spot {
                centre,
                covariance_px2: Matrix2::identity() * (sigma_px * sigma_px),
                area_px: (AREA_PX_M2 / self.position_m.norm_squared()).max(1.0) as u32,
                peak: 200,
                saturated_px: 0,
                flux,
                light: None,
                background: 5.0,
                marker_log_odds: 3.0,
                middle: (u, v),
                extent,
            });
        }
        spots
    }

    /// The markers behind the spots.
    pub(crate) fn matched(&self, airframe: &Airframe, located: &Located) -> Vec<Matched> {
        let nearest = |sighting: &Sighting| {
            let gap = |marker: &usize| {
                let place = self.camera_from_body * airframe.markers()[*marker].position_m + self.position_m;
                sighting.bearing.angle_to(&Bearing::new(place).expect("a direction"))
            };
            (0..airframe.markers().len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("a marker")
        };
        let matched = |sighting: &Sighting| Matched {
            marker: nearest(sighting),
            sigma_rad: (sighting.covariance_rad2.trace() / 2.0).sqrt(),
            log_light_sigma: sighting.log_light.expect("a spot with light").sigma,
        };
        located.sightings.iter().map(matched).collect()
    }

    /// The Cramer-Rao bound of the variance of distance, by numeric derivatives of all that is measured or believed.
    pub(crate) fn bound_m2(&self, airframe: &Airframe, markers: &[Matched], unit_sigma: f64) -> f64 {
        let measured = |step: &Vector6<f64>| -> Vec<f64> {
            let position_m = self.position_m + step.fixed_rows::<3>(0);
            let turn = Rotation3::new(step.fixed_rows::<3>(3).into_owned());
            let camera_from_body = self.camera_from_body * turn;
            let camera_m = -(camera_from_body.inverse() * position_m);
            let mut numbers = Vec::new();
            let mut lights = Vec::new();
            let (mut light_sum, mut weight_sum) = (0.0, 0.0);
            for &Matched { marker, sigma_rad, log_light_sigma } in markers {
                let arm_m = airframe.markers()[marker].position_m;
                let seen = (camera_from_body * arm_m + position_m).normalize();
                numbers.extend(seen.iter().map(|number| number / sigma_rad));
                let intensity = airframe.intensity(marker, &camera_m).max(1e-6);
                let light = libm::log(intensity) - libm::log((camera_m - arm_m).norm_squared());
                let variance = unit_sigma * unit_sigma + log_light_sigma * log_light_sigma;
                lights.push((light, variance.sqrt()));
                light_sum += light / variance;
                weight_sum += 1.0 / variance;
            }
            // The power of the LEDs is not known.
            numbers.extend(lights.iter().map(|(light, sigma)| (light - light_sum / weight_sum) / sigma));
            let up = camera_from_body.inverse() * -Vector3::y();
            let tilt = libm::hypot(TILT_RAD, GRAVITY_RAD);
            numbers.extend([up.x / tilt, up.y / tilt]);
            numbers
        };
        let columns: Vec<Vec<f64>> = (0..6)
            .map(|axis| {
                let mut step = Vector6::zeros();
                step[axis] = 1e-6;
                let (ahead, behind) = (measured(&step), measured(&-step));
                ahead.iter().zip(&behind).map(|(a, b)| (a - b) / 2e-6).collect()
            })
            .collect();
        let mut information = Matrix6::from_fn(|row, column| {
            columns[row].iter().zip(&columns[column]).map(|(a, b)| a * b).sum::<f64>()
        });
        // The prior on distance of a lone spot: something has to be believed.
        let ahead = self.position_m.normalize();
        let mut along = Vector6::zeros();
        along.fixed_rows_mut::<3>(0).copy_from(&(ahead / self.position_m.norm() / 0.6));
        if markers.len() == 1 {
            information += along * along.transpose();
            information[(5, 5)] += 1.0;
        }
        let covariance = information.try_inverse().expect("an invertible information");
        let position = covariance.fixed_view::<3, 3>(0, 0);
        ahead.dot(&(position * ahead))
    }
}
