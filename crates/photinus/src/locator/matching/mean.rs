//! The mean place over all views that match.

use nalgebra::{Matrix3, Vector3};

use super::image::Image;
use super::{Match, NEIGHBOUR_NATS};
use crate::locator::views::MOST_ORDERED;

/// What the grid of views leaves of a place, as a share of the airframe's radius, and of the distance, as a share of it:
/// chosen so that the covariance is a cautious one on rendered frames (`tests/rendered_neighbours.rs`).
const GRID_ACROSS: f64 = 0.008;
const GRID_ALONG: f64 = 0.004;

/// Weighted sums over views, of places in the axes of the image; weights are relative to the best view.
#[derive(Default)]
pub(super) struct Mean {
    weight: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    pub(super) least_nats: f64,
    pub(super) best: Option<[usize; MOST_ORDERED]>,
}

impl Mean {
    pub(super) fn add(&mut self, place: Vector3<f64>, weight: f64) {
        self.weight += weight;
        self.first += weight * place;
        self.second += weight * place * place.transpose();
    }

    pub(super) fn finish(
        self,
        image: &Image<'_>,
        radius_m: f64,
        size_nats: impl Fn(f64) -> f64,
    ) -> Option<Match> {
        if self.weight <= 0.0 {
            return None;
        }
        let mean = self.first / self.weight;
        let spread = self.second / self.weight - mean * mean.transpose();
        let (depth_m, count) = (mean.z, image.places.len() as f64);
        // The grid of views leaves a rest: of the markers' places, and of their size and so of the distance.
        let across_m = libm::hypot(depth_m * image.sigma / count.sqrt(), GRID_ACROSS * radius_m);
        let along_m = depth_m * libm::hypot(image.sigma / image.size, GRID_ALONG);
        let noise =
            Matrix3::from_diagonal(&Vector3::new(across_m, across_m, along_m).map(|sigma| sigma * sigma));
        Some(Match {
            nats: NEIGHBOUR_NATS + self.least_nats - libm::log(self.weight) + size_nats(mean.norm()),
            mean_m: image.axes * mean,
            covariance_m2: image.axes * (spread + noise) * image.axes.transpose(),
            markers: self.best,
        })
    }
}
