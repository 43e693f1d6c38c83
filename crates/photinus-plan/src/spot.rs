//! What the light of one marker tells: enters a number of photo-electrons, leaves how likely the detector finds a spot there, and how
//! exactly its centre and its light can be known at best.
//!
//! The mean of every pixel is that of the simulator: point spread, overflow, response, converter. Its derivatives by place and light,
//! over the noise, are Fisher's information,
//!
//! ```text
//! F = sum over pixels of d mean / d theta (d mean / d theta)' / variance,   theta = (u, v, ln electrons),
//! ```
//!
//! and one over it bounds every estimate (Cramer-Rao). A spot lies somewhere in its brightest pixel: 12 per px^2 are added for each
//! axis, the information of an even prior over a pixel (as van Trees' inequality takes it). All of it is averaged over places in a pixel.

use nalgebra::{Matrix3, Vector3};
use photinus_sim::optics::PointLight;
use photinus_sim::sensor::{Charge, Response, Sensor};

use crate::setup::Setup;

/// Side of the patch that is drawn, px.
const PATCH_PX: usize = 40;
/// Steps from the middle of a pixel to its border; the other octants of a pixel are mirror images of one.
const STEPS: u32 = 4;
/// Least and most photo-electrons of the table, and entries for each factor of e.
const LEAST_E: f64 = 20.0;
const MOST_E: f64 = 1e7;
const PER_NAT: f64 = 5.0;
/// The detector's level lies so many sigma of the noise below the mean of the background, and its step grows by so many (see
/// `photinus::spots`: three quarters of a spread of 3.6 sigma, 2.4 of it below the mean); in noise the step is 9 sigma at least.
const LEVEL_BELOW: f64 = 2.4;
const STEP_GROWS: f64 = 2.7;
const LEAST_STEP: f64 = 9.0;
/// Full pixels tell nothing.
const FULL_DN: f64 = 254.5;

/// What the light of one marker tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// How likely it is found, 0 to 1.
    pub found: f64,
    /// Variance of its centre along each axis, px^2.
    pub variance_px2: f64,
    /// Standard deviation of the logarithm of its light.
    pub log_light_sigma: f64,
}

/// Spots by their light, for one camera, exposure and background.
#[derive(Clone, Debug)]
pub struct SpotTable {
    entries: Vec<Spot>,
}

impl SpotTable {
    /// Works out every entry: a second or so.
    pub fn new(setup: &Setup) -> Self {
        let pixels = Pixels::new(setup);
        let count = (libm::log(MOST_E / LEAST_E) * PER_NAT).ceil() as usize + 1;
        let electrons = |index: usize| LEAST_E * libm::exp(index as f64 / PER_NAT);
        Self { entries: (0..count).map(|index| pixels.spot(setup, electrons(index))).collect() }
    }

    /// Photo-electrons at which a spot is found this often.
    pub fn found_e(&self, share: f64) -> f64 {
        let index = self.entries.iter().position(|spot| spot.found >= share).unwrap_or(self.entries.len());
        LEAST_E * libm::exp((index as f64 - 0.5) / PER_NAT)
    }

    /// What so many photo-electrons tell, linear between entries.
    pub fn at(&self, electrons: f64) -> Spot {
        let at = libm::log((electrons / LEAST_E).max(1.0)) * PER_NAT;
        let last = self.entries.len() - 1;
        let index = (at as usize).min(last - 1);
        let share = (at - index as f64).min(1.0);
        let [a, b] = [&self.entries[index], &self.entries[index + 1]];
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Spot {
            found: mix(a.found, b.found),
            variance_px2: mix(a.variance_px2, b.variance_px2),
            log_light_sigma: mix(a.log_light_sigma, b.log_light_sigma),
        }
    }
}

/// How the sensor turns charge into grey levels, and with how much noise.
struct Pixels<'a> {
    sensor: &'a Sensor,
    background_e: f64,
    /// Grey level from which a pixel is bright.
    bright_dn: f64,
}

impl<'a> Pixels<'a> {
    fn new(setup: &'a Setup) -> Self {
        let background_e = setup.background_e();
        let mut pixels = Self { sensor: &setup.sensor, background_e, bright_dn: f64::INFINITY };
        let (mean_dn, noise_dn) = (pixels.mean_dn(0.0), pixels.variance_dn2(0.0).sqrt());
        pixels.bright_dn = match setup.brightness {
            photinus::spots::Brightness::Threshold(level) => f64::from(level),
            photinus::spots::Brightness::Contrast(step) => {
                let step_dn = (f64::from(step) + STEP_GROWS * noise_dn).max(LEAST_STEP * noise_dn);
                (mean_dn - LEVEL_BELOW * noise_dn).max(0.0) + step_dn
            }
        };
        pixels
    }

    /// Mean grey level of a pixel with so much light of a marker, neither rounded nor cut off.
    fn mean_dn(&self, marker_e: f64) -> f64 {
        let linear_dn =
            (self.background_e + marker_e).min(self.sensor.full_well_e) / self.sensor.electrons_per_dn;
        let above_dn = match self.sensor.response {
            Response::Linear => linear_dn,
            Response::Soft { ceiling_dn } => ceiling_dn * -libm::expm1(-linear_dn / ceiling_dn),
        };
        self.sensor.dark_offset_dn + above_dn
    }

    /// Its variance, with that of rounding to whole grey levels.
    fn variance_dn2(&self, marker_e: f64) -> f64 {
        let charge_e = (self.background_e + marker_e).min(self.sensor.full_well_e);
        let read_e = self.sensor.read_noise_e;
        let slope = match self.sensor.response {
            Response::Linear => 1.0,
            Response::Soft { ceiling_dn } => libm::exp(-charge_e / self.sensor.electrons_per_dn / ceiling_dn),
        };
        let per_e = slope / self.sensor.electrons_per_dn;
        (charge_e + read_e * read_e) * per_e * per_e + 1.0 / 12.0
    }

    /// The patch with a point of light so far from the middle of its middle pixel.
    fn patch(&self, setup: &Setup, electrons: f64, offset_px: [f64; 2]) -> Charge {
        let mut charge = Charge::new(PATCH_PX, PATCH_PX);
        let middle = (PATCH_PX / 2) as f64;
        let (u_px, v_px) = (middle + offset_px[0], middle + offset_px[1]);
        setup
            .lens
            .spread
            .draw(&PointLight { u_px, v_px, electrons, among: 1.0, ..Default::default() }, &mut charge);
        self.sensor.overflow.settle(&mut charge, self.sensor.full_well_e);
        charge
    }

    /// The mean over places in a pixel.
    fn spot(&self, setup: &Setup, electrons: f64) -> Spot {
        let place = |step: u32| 0.5 * f64::from(step) / f64::from(STEPS);
        let mut sum = Spot { found: 0.0, variance_px2: 0.0, log_light_sigma: 0.0 };
        let mut weights = 0.0;
        for (i, j) in (0..=STEPS).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            // places on the borders of the octant belong to fewer of its mirror images
            let edge = |on: bool| if on { 0.5 } else { 1.0 };
            let weight = edge(j == 0) * edge(i == j) * edge(i == STEPS);
            let spot = self.spot_at(setup, electrons, [place(i), place(j)]);
            sum.found += weight * spot.found;
            sum.variance_px2 += weight * spot.variance_px2;
            sum.log_light_sigma += weight * spot.log_light_sigma;
            weights += weight;
        }
        Spot {
            found: sum.found / weights,
            variance_px2: sum.variance_px2 / weights,
            log_light_sigma: sum.log_light_sigma / weights,
        }
    }

    fn spot_at(&self, setup: &Setup, electrons: f64, place_px: [f64; 2]) -> Spot {
        const PLACE_STEP_PX: f64 = 0.02;
        const LIGHT_STEP: f64 = 0.02;
        let here = self.patch(setup, electrons, place_px);
        let [u, v] = place_px;
        let beside = [
            [[u - PLACE_STEP_PX, v], [u + PLACE_STEP_PX, v]],
            [[u, v - PLACE_STEP_PX], [u, v + PLACE_STEP_PX]],
        ]
        .map(|pair| pair.map(|place| self.patch(setup, electrons, place)));
        let brighter =
            [-LIGHT_STEP, LIGHT_STEP].map(|step| self.patch(setup, electrons * libm::exp(step), place_px));
        let mut information = Matrix3::from_diagonal(&Vector3::new(12.0, 12.0, 1e-2));
        let mut missed = 1.0;
        for (column, row) in (0..PATCH_PX).flat_map(|v| (0..PATCH_PX).map(move |u| (u, v))) {
            let at = |charge: &Charge| f64::from(charge.at(column, row));
            let (mean_dn, variance_dn2) = (self.mean_dn(at(&here)), self.variance_dn2(at(&here)));
            let too_low = (self.bright_dn - 0.5 - mean_dn) / variance_dn2.sqrt();
            missed *= 0.5 * libm::erfc(-too_low / core::f64::consts::SQRT_2);
            if mean_dn >= FULL_DN {
                continue;
            }
            let slope = |[less, more]: &[Charge; 2], step: f64| {
                (self.mean_dn(at(more)) - self.mean_dn(at(less))) / (2.0 * step)
            };
            let by = Vector3::new(
                slope(&beside[0], PLACE_STEP_PX),
                slope(&beside[1], PLACE_STEP_PX),
                slope(&brighter, LIGHT_STEP),
            );
            information += by * by.transpose() / variance_dn2;
        }
        let covariance = information.try_inverse().unwrap_or_else(Matrix3::identity);
        Spot {
            found: 1.0 - missed,
            variance_px2: 0.5 * (covariance[(0, 0)] + covariance[(1, 1)]),
            log_light_sigma: covariance[(2, 2)].max(0.0).sqrt(),
        }
    }
}
