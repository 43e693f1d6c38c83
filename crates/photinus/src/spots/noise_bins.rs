//! The noise of pixels by their light, from what fits leave.
//!
//! In: squared residuals of pixels with the light of their spot. Out: the three parts of their variance: that of darkness, that which grows with
//! the light (shot noise), and that which grows with its square: the point spread is wrong by a share of the light.

use nalgebra::{Matrix3, Vector3};

use super::fit::{Left, PixelNoise};
use super::settings::Noise;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// What is believed of the variance of a pixel: the share of its light by which the point spread is wrong ...
const SHAPE: f64 = 0.08;
/// ... and the sigma of the logarithm of each of its parts.
const PARTS_KNOWN: [f64; 3] = [1.0, 1.0, 2.0];
/// Bins of pixels by their light: from 1 grey level on, an octave each.
const BINS: usize = 9;

/// Squared residuals of pixels by their light, and the noise that explains them.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseBins {
    pub(super) noise: PixelNoise,
    believed: [f64; 3],
    bins: [Bin; BINS],
}

#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    count: f64,
    squares: f64,
    /// What of noise of 1, of the light and of its square is left.
    of: [f64; 3],
    /// Variance that is known by itself.
    known: f64,
}

impl NoiseBins {
    pub(super) fn new(noise: Noise) -> Self {
        let dark = noise.read_dn * noise.read_dn + 1.0 / 12.0;
        let believed = [dark, noise.shot.max(1e-4), SHAPE * SHAPE];
        let noise =
            PixelNoise { dark: dark as f32, shot: noise.shot as f32, shape: SHAPE as f32, faint: 0.0 };
        Self { noise, believed, bins: [Bin::default(); BINS] }
    }

    /// Adds a pixel, in a frame that has so much noise beyond the camera's.
    pub(super) fn add(&mut self, left: &Left, known: f64) {
        let octave = (left.light as u32).saturating_add(1).ilog2() as usize;
        let bin = &mut self.bins[octave.min(BINS - 1)];
        bin.count += 1.0;
        bin.squares += left.square;
        for (sum, of) in bin.of.iter_mut().zip(left.of) {
            *sum += of;
        }
        bin.known += left.of[0] * known + left.known;
    }

    /// Whether any pixel was added.
    pub(super) fn are_told(&self) -> bool {
        self.bins.iter().any(|bin| bin.count > 0.0)
    }

    /// Solves for the three parts of the noise: Fisher's scoring on their logarithms.
    pub(super) fn solve(&mut self) {
        let believed = self.believed.map(libm::log);
        let mut logs = Vector3::new(f64::from(self.noise.dark), f64::from(self.noise.shot), {
            f64::from(self.noise.shape) * f64::from(self.noise.shape)
        })
        .map(libm::log);
        for _ in 0..6 {
            let parts = logs.map(libm::exp);
            let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
            for i in 0..3 {
                let weight = 1.0 / (PARTS_KNOWN[i] * PARTS_KNOWN[i]);
                matrix[(i, i)] += weight;
                right[i] += weight * (believed[i] - logs[i]);
            }
            for bin in self.bins.iter().filter(|bin| bin.count > 0.0) {
                let by = Vector3::from(bin.of).component_mul(&parts) / bin.count;
                let variance = by.sum() + bin.known / bin.count;
                let slope = by / variance;
                let ratio = bin.squares / (bin.count * variance);
                matrix += slope * slope.transpose() * (0.5 * bin.count);
                right += slope * (0.5 * bin.count * (ratio - 1.0));
            }
            let Some(factor) = matrix.cholesky() else { return };
            logs += factor.solve(&right).map(|step| step.clamp(-1.0, 1.0));
        }
        let parts = logs.map(libm::exp);
        self.noise = PixelNoise {
            dark: parts[0] as f32,
            shot: parts[1] as f32,
            shape: parts[2].sqrt().min(0.5) as f32,
            faint: 0.0,
        };
    }
}
