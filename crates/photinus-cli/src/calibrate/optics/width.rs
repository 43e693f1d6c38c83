//! How wide a point spread is.

use std::fmt;

use photinus::optics::PointSpread;

/// Widths of a point spread, the integration over a pixel included.
pub(crate) struct Width {
    /// Root mean square distance from the point along an axis, px, of the light within 5 px.
    pub(crate) rms_px: f64,
    /// Full width at half the summit, px: the diameter of a disc as large as what is brighter.
    pub(crate) half_px: f64,
}

impl Width {
    /// Those of a point spread.
    pub(crate) fn of(spread: &PointSpread) -> Self {
        const LIGHT_PX: f64 = 5.0;
        const STEP_PX: f64 = 1.0 / PointSpread::SAMPLES_PER_PX as f64;
        let place = |at: usize| at as f64 * STEP_PX - PointSpread::REACH_PX as f64;
        let summit = spread.samples().iter().copied().fold(0.0, f64::max);
        let (mut light, mut square, mut bright) = (0.0, 0.0, 0.0);
        for (index, &share) in spread.samples().iter().enumerate() {
            let (x, y) = (place(index % PointSpread::SIDE), place(index / PointSpread::SIDE));
            if x * x + y * y <= LIGHT_PX * LIGHT_PX {
                light += share;
                square += share * (x * x + y * y);
            }
            bright += if share >= 0.5 * summit { STEP_PX * STEP_PX } else { 0.0 };
        }
        let rms_px = (0.5 * square / light).max(0.0).sqrt();
        Self { rms_px, half_px: 2.0 * (bright / std::f64::consts::PI).sqrt() }
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} px rms, {:.2} px at half the summit", self.rms_px, self.half_px)
    }
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;

    use super::*;

    #[test]
    fn a_gaussian_is_as_wide_as_its_sigma_and_a_pixel() {
        for sigma_px in [0.6_f64, 1.2] {
            let width = Width::of(&PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap());
            let rms_px = (sigma_px * sigma_px + 1.0 / 12.0).sqrt();
            assert!((width.rms_px / rms_px - 1.0).abs() < 0.01, "{width}");
            assert!((width.half_px / (2.355 * rms_px) - 1.0).abs() < 0.1, "{width}");
        }
    }
}
