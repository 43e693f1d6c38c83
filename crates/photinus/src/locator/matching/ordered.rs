//! A handful of spots against the arrangements of a handful of markers, spot by spot.

use alloc::vec::Vec;

use nalgebra::{Vector2, Vector3};

use super::image::{Image, turned};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{self, Lanes};
use crate::locator::Sighting;
use crate::locator::views::{Arrangement, Arrangements, Band, MOST_ORDERED, Quad};
use crate::pose::LogLight;

/// How far the grid of views leaves a true shape from the nearest one, as a share of its size.
pub(super) const GRID_ERROR: f64 = 0.04;

/// A group to be put in order.
pub(super) struct Ordered {
    count: usize,
    shape: [Vector2<f64>; MOST_ORDERED],
    log_flux: [f64; MOST_ORDERED],
    log_flux_sigma: f64,
    shape_sigma: f64,
}

impl Ordered {
    pub(super) fn of(
        image: &Image<'_>,
        sightings: &[Sighting],
        group: &[usize],
        log_flux_sigma: f64,
    ) -> Self {
        let mut ordered = Self {
            count: group.len(),
            shape: [Vector2::zeros(); MOST_ORDERED],
            log_flux: [0.0; MOST_ORDERED],
            log_flux_sigma,
            shape_sigma: libm::hypot(GRID_ERROR, image.sigma / image.size),
        };
        let mut sum = 0.0;
        for (index, (&member, place)) in group.iter().zip(image.places).enumerate() {
            ordered.shape[index] = place / image.size;
            // A detector that measures no light says nothing by it.
            let LogLight { value, sigma } =
                sightings[member].log_light.unwrap_or(LogLight { value: 0.0, sigma: f64::INFINITY });
            ordered.log_flux[index] = value;
            sum += value;
            ordered.log_flux_sigma = ordered.log_flux_sigma.max(libm::hypot(log_flux_sigma, sigma));
        }
        for log_flux in &mut ordered.log_flux[..group.len()] {
            *log_flux -= sum / group.len() as f64;
        }
        ordered
    }

    /// What each arrangement that may show costs: its misfit in shape and in light, its attitude, and what it costs in itself. Returns
    /// the least of them.
    pub(super) fn costs<'a>(
        &self,
        arrangements: &'a Arrangements,
        image: &Image<'_>,
        tilt_sigma_rad: f64,
        costs: &mut Vec<Lanes>,
    ) -> Best<'a> {
        let Band { all, quads } = arrangements.within(image.elevation_rad, tilt_sigma_rad);
        // The number of spots is known when the loop over the views is compiled.
        match self.count {
            2 => self.add_costs::<2>(quads, image, tilt_sigma_rad, costs),
            3 => self.add_costs::<3>(quads, image, tilt_sigma_rad, costs),
            _ => self.add_costs::<MOST_ORDERED>(quads, image, tilt_sigma_rad, costs),
        }
        let least = costs.iter().fold(Lanes::splat(f32::INFINITY), |least, &four| least.fast_min(four));
        let nats = least.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let of_best = costs.iter().flat_map(|four| four.to_array()).position(|cost| cost <= nats);
        Best { nats, arrangement: &all[of_best.unwrap_or(0)], among: all, quads }
    }

    fn add_costs<const N: usize>(
        &self,
        quads: &[Quad],
        image: &Image<'_>,
        tilt_sigma_rad: f64,
        costs: &mut Vec<Lanes>,
    ) {
        let splat = |number: f64| Lanes::splat(number as f32);
        let x: [Lanes; N] = core::array::from_fn(|spot| splat(self.shape[spot].x));
        let y: [Lanes; N] = core::array::from_fn(|spot| splat(self.shape[spot].y));
        let log_flux: [Lanes; N] = core::array::from_fn(|spot| splat(self.log_flux[spot]));
        let per_shape = splat(0.5 / (self.shape_sigma * self.shape_sigma));
        let per_light = splat(0.5 / (self.log_flux_sigma * self.log_flux_sigma));
        let tilt = 1.0 / (tilt_sigma_rad * tilt_sigma_rad);
        let (per_turn, per_elevation) = image.elevation_rad.map_or((0.0, 0.0), |_| (tilt, 0.5 * tilt));
        let (per_turn, per_elevation) = (splat(per_turn), splat(per_elevation));
        let elevation_rad = splat(image.elevation_rad.unwrap_or(0.0));
        costs.clear();
        costs.extend(quads.iter().map(|quad| {
            // Places as complex numbers: the best turn and scale is the sum of conj(w) z, its size tells how much they agree.
            let [mut dot, mut cross, mut light] = [Lanes::ZERO; 3];
            for spot in 0..N {
                dot += quad.x[spot] * x[spot] + quad.y[spot] * y[spot];
                cross += quad.x[spot] * y[spot] - quad.y[spot] * x[spot];
                let off = log_flux[spot] - quad.log_intensity[spot];
                light += off * off;
            }
            let agreement = dot * dot + cross * cross;
            let cos_turn = dot / (agreement + Lanes::splat(1e-12)).sqrt();
            let off = quad.elevation_rad - elevation_rad;
            lanes::positive(Lanes::ONE - agreement) * per_shape
                + light * per_light
                + (Lanes::ONE - cos_turn) * quad.firmness * per_turn
                + off * off * per_elevation
                + quad.nats
        }));
    }

    /// Variance of a place per axis, in the image, with the error of the grid of views.
    pub(super) fn variance(&self, image: &Image<'_>) -> f64 {
        let sigma = self.shape_sigma * image.size;
        sigma * sigma
    }

    /// Logarithm of the width of the distribution of a light against the others': of its standard deviation times sqrt(2 pi).
    pub(super) fn log_light_width(&self) -> f64 {
        libm::log(self.log_flux_sigma) + 0.5 * libm::log(core::f64::consts::TAU)
    }

    /// The place of the airframe if the spots are these markers, each as much larger in the image as it is nearer, and the
    /// turn of the image (cosine, sine) against the view.
    pub(super) fn place(&self, arrangement: &Arrangement, image: &Image<'_>) -> (Vector3<f64>, Vector2<f64>) {
        let Arrangement { shape, size_m, middle_m, ahead_m, .. } = arrangement;
        let per_spot = 1.0 / self.count as f64;
        // How much nearer each marker is matters in the second order only: a distance as from afar will do for that.
        let far_m = size_m / image.size + ahead_m.iter().take(self.count).sum::<f64>() * per_spot;
        // Within a few radii perspective is more than a correction, and such a match does not count.
        let larger: [f64; MOST_ORDERED] = ahead_m.map(|ahead_m| far_m / (far_m - ahead_m).max(0.3 * far_m));
        let place_m: [Vector2<f64>; MOST_ORDERED] =
            core::array::from_fn(|spot| shape[spot] * (size_m * larger[spot]));
        let middle = place_m.iter().take(self.count).sum::<Vector2<f64>>() * per_spot;
        let (mut dot, mut cross, mut square) = (0.0, 0.0, 0.0);
        for (place, z) in place_m.iter().zip(&self.shape).take(self.count) {
            let w = place - middle;
            dot += w.x * z.x + w.y * z.y;
            cross += w.x * z.y - w.y * z.x;
            square += w.norm_squared();
        }
        // A match that is hardly one still gives a place, at most a thousand times as far as it looks.
        let agreement = f64::sqrt(dot * dot + cross * cross).max(1e-3 * square.sqrt());
        let turn = Vector2::new(dot, cross).try_normalize(1e-12).unwrap_or_else(Vector2::x);
        let depth_m = square / (agreement * image.size);
        let mean_larger = larger.iter().take(self.count).sum::<f64>() * per_spot;
        let beside_m =
            (image.middle * depth_m - turned(middle, turn)) / mean_larger - turned(*middle_m, turn);
        (Vector3::new(beside_m.x, beside_m.y, depth_m), turn)
    }
}

/// The arrangement that costs least.
pub(super) struct Best<'a> {
    pub(super) nats: f32,
    pub(super) arrangement: &'a Arrangement,
    /// All that were compared, in the order of the costs.
    pub(super) among: &'a [Arrangement],
    /// The same, four by four.
    pub(super) quads: &'a [Quad],
}
