//! Samples against the mixture that was reported: means, covariances, and how much weight lies where.
//!
//! Unlikely modes at quite another distance weigh a thousandth, and as much in a variance as all the rest: they are told
//! apart from the main part, within a quarter of the distance, and compared by their weight alone.

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix3, Vector3};
use photinus::pose::Mode;

/// What is farther from the mean distance than this share of it is not of the main part.
const MAIN: f64 = 0.25;
const BATCHES: usize = 40;

/// A part of a posterior: a sample, or a normal distribution.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) weight: f64,
    pub(crate) mean_m: Vector3<f64>,
    pub(crate) covariance_m2: Matrix3<f64>,
}

impl Part {
    pub(crate) fn of_mode(mode: &Mode) -> Self {
        let Mode { weight, pose, position_covariance_m2: covariance_m2, .. } = *mode;
        Self { weight, mean_m: pose.position_m, covariance_m2 }
    }

    pub(crate) fn of_sample(position_m: &Vector3<f64>) -> Self {
        Self { weight: 1.0, mean_m: *position_m, covariance_m2: Matrix3::zeros() }
    }

    pub(crate) fn is_main(&self, distance_m: f64) -> bool {
        (self.mean_m.norm() / distance_m - 1.0).abs() < MAIN
    }
}

/// Mean and covariance of a mixture.
#[derive(Clone, Copy)]
pub(crate) struct Moments {
    pub(crate) mean_m: Vector3<f64>,
    pub(crate) covariance_m2: Matrix3<f64>,
}

impl Moments {
    pub(crate) fn of(parts: &[Part]) -> Self {
        let total: f64 = parts.iter().map(|part| part.weight).sum();
        let mean_m = parts.iter().map(|part| part.mean_m * part.weight).sum::<Vector3<f64>>() / total;
        let about = |part: &Part| {
            let off_m = part.mean_m - mean_m;
            (part.covariance_m2 + off_m * off_m.transpose()) * part.weight
        };
        Self { mean_m, covariance_m2: parts.iter().map(about).sum::<Matrix3<f64>>() / total }
    }

    pub(crate) fn sigma_m(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&(self.covariance_m2 * direction)).sqrt()
    }
}

/// How samples and mixture differ along a direction.
pub(crate) struct Difference {
    /// Of the means, in standard deviations of the samples.
    pub(crate) mean_sigmas: f64,
    /// The standard error of the samples' mean, the same unit, by batches of the walk.
    pub(crate) standard_error_sigmas: f64,
    /// The mixture's standard deviation over the samples'.
    pub(crate) sigma_ratio: f64,
    /// The standard error of the samples' variance over itself, by batches of the walk.
    pub(crate) variance_error: f64,
    /// The largest difference of the weight below a cut.
    pub(crate) weight: f64,
}

impl Difference {
    /// Of the main part of samples, in the order of the walk, and of modes.
    pub(crate) fn along(direction: &Vector3<f64>, samples: &[Part], modes: &[Part]) -> Self {
        let (walked, told) = (Moments::of(samples), Moments::of(modes));
        let sigma_m = walked.sigma_m(direction);
        let batches = || samples.chunks_exact(samples.len() / BATCHES).map(Moments::of);
        let off = |batch: &Moments| (batch.mean_m - walked.mean_m).dot(direction) / sigma_m;
        let square =
            |batch: &Moments| (batch.sigma_m(direction) / sigma_m).powi(2) + off(batch).powi(2) - 1.0;
        let error = |squares: f64| (squares / (BATCHES * (BATCHES - 1)) as f64).sqrt();
        Self {
            mean_sigmas: (told.mean_m - walked.mean_m).dot(direction) / sigma_m,
            standard_error_sigmas: error(batches().map(|batch| off(&batch).powi(2)).sum()),
            sigma_ratio: told.sigma_m(direction) / sigma_m,
            variance_error: error(batches().map(|batch| square(&batch).powi(2)).sum()),
            weight: largest_gap(direction, samples, modes),
        }
    }
}

/// Over twenty cuts that part the samples evenly.
fn largest_gap(direction: &Vector3<f64>, samples: &[Part], modes: &[Part]) -> f64 {
    let mut places_m: Vec<f64> = samples.iter().map(|sample| sample.mean_m.dot(direction)).collect();
    places_m.sort_unstable_by(f64::total_cmp);
    let total: f64 = modes.iter().map(|mode| mode.weight).sum();
    let gap = |cut: usize| {
        let cut_m = places_m[places_m.len() * cut / 20];
        let below = |mode: &Part| {
            let sigma_m = direction.dot(&(mode.covariance_m2 * direction)).sqrt();
            mode.weight * 0.5 * libm::erfc((mode.mean_m.dot(direction) - cut_m) / (sigma_m * SQRT_2))
        };
        (modes.iter().map(below).sum::<f64>() / total - cut as f64 / 20.0).abs()
    };
    (1..20).map(gap).fold(0.0, f64::max)
}
