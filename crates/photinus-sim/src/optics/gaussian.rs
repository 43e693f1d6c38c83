//! A round Gaussian, integrated over square pixels: a product of two differences of the error function.

use crate::sensor::Charge;

/// A part of a point spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Share of the light.
    pub share: f64,
    /// Sigma along u and v on the axis, px.
    pub sigma_px: f64,
}

/// A Gaussian as it falls on the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blob {
    pub(super) u_px: f64,
    pub(super) v_px: f64,
    pub(super) sigma_px: f64,
    pub(super) electrons: f64,
}

impl Blob {
    /// Adds it to the charge, as far out as a pixel gets more than `faintest_e`.
    pub(super) fn draw(&self, faintest_e: f64, onto: &mut Charge) {
        let summit = self.electrons / (core::f64::consts::TAU * self.sigma_px * self.sigma_px);
        if summit.min(self.electrons) <= faintest_e {
            return;
        }
        let reach_px = self.sigma_px * (2.0 * libm::log(summit / faintest_e)).max(0.0).sqrt() + 1.0;
        let columns = Shares::new(self.u_px, self.sigma_px, reach_px, onto.width());
        let rows = Shares::new(self.v_px, self.sigma_px, reach_px, onto.height());
        for (v, row_share) in rows.iter() {
            onto.add_row(v, columns.first, &columns.shares, (self.electrons * row_share) as f32);
        }
    }
}

/// Which share of a Gaussian falls on each pixel of a line of the image.
struct Shares {
    first: usize,
    shares: Vec<f32>,
}

impl Shares {
    fn new(centre_px: f64, sigma_px: f64, reach_px: f64, length: usize) -> Self {
        let last = length as f64 - 1.0;
        let first = (centre_px - reach_px).floor().clamp(0.0, last);
        let end = (centre_px + reach_px).ceil().clamp(-1.0, last);
        let scale = 1.0 / (core::f64::consts::SQRT_2 * sigma_px);
        let below = |edge_px: f64| 0.5 * libm::erf((edge_px - centre_px) * scale);
        let count = (end - first + 1.0).max(0.0) as usize;
        let mut shares = Vec::with_capacity(count);
        let mut left = below(first - 0.5);
        for index in 0..count {
            let right = below(first + index as f64 + 0.5);
            shares.push((right - left) as f32);
            left = right;
        }
        Self { first: first as usize, shares }
    }

    fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.shares.iter().enumerate().map(|(index, &share)| (self.first + index, f64::from(share)))
    }
}
