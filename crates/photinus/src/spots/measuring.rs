//! The light of parts -> spots.
//!
//! In: the parts of a frame. Out: for each a spot, or the reason that it is none after all. Its centre and light are those of a point of light
//! where it fits one (`fitting`); what is wider, or of another shape, is centred by a balanced window (`centroid`).

use std::sync::Arc;

use nalgebra::Matrix2;

use super::Spot;
use super::centroid::{self, PixelVariance};
use super::fitting::{Fitter, SATURATION_BLUR_PX, reach_px, surroundings};
use super::neighbourhood::Neighbourhood;
use super::part::Part;
use super::patch::{Patch, Surroundings};
use super::rejection::Reason;
use super::settings::{Brightness, Settings};
use super::window::nearest_pixel;
use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::optics::Optics;

/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = 0.288_675_134_594_812_9;
/// Error of the centre of what has no shape that is known, px.
const SHAPELESS_PX: f64 = 0.07;

/// Measures the light of the parts of one frame after the other.
#[derive(Debug)]
pub(super) struct Meter {
    fitter: Fitter,
    patch: Patch,
}

impl Meter {
    pub(super) fn new(settings: &Settings, optics: Option<Arc<Optics>>) -> Self {
        Self { fitter: Fitter::new(settings, optics), patch: Patch::default() }
    }

    /// Whether frames still tell something of the camera.
    pub(super) fn learns(&self) -> bool {
        self.fitter.learns()
    }

    /// Fits all parts of a frame, before they are measured one by one.
    pub(super) fn fit(&mut self, frame: &FrameView<'_>, parts: &[Part], near: &Neighbourhood) {
        self.fitter.fit(frame, parts, near);
    }

    /// Measures part `index`, whose light is its own as far as `room_px`.
    pub(super) fn measure(
        &mut self,
        frame: &FrameView<'_>,
        index: usize,
        part: &Part,
        room_px: f64,
        settings: &Settings,
    ) -> Result<Spot, Reason> {
        let outline = &part.outline;
        let window_px = (part.radius_px + 2.5).min(room_px.max(part.radius_px + 0.8).max(1.9));
        let around = surroundings(frame, part, window_px);
        let height = f64::from(outline.peak) - f64::from(around.level);
        if let Brightness::Contrast(step) = settings.brightness
            && 2.0 * height < f64::from(step)
        {
            return Err(Reason::Background);
        }
        self.patch.read(frame, nearest_pixel(part.guess), reach_px(window_px), &around);
        let flux = self.patch.flux(part.guess, window_px as f32);
        let model = self.fitter.fitted(index).copied();
        let (centre, covariance_px2) = match model {
            Some(model) => (model.centre, model.covariance_px2),
            None => self.balanced(part, window_px, around),
        };
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        Ok(Spot {
            centre,
            covariance_px2: if outline.cut { covariance_px2 + anywhere } else { covariance_px2 },
            area_px: outline.area_px,
            peak: outline.peak,
            saturated_px: outline.saturated_px,
            flux,
            light: model.map(|model| model.light),
            background: f64::from(around.level),
            middle: part.middle,
            extent: outline.extent,
        })
    }

    /// By a balanced window: what is no point's light.
    fn balanced(&self, part: &Part, window_px: f64, around: Surroundings) -> (Pixel, Matrix2<f64>) {
        let noise = self.fitter.pixel_noise(around);
        let variance = PixelVariance { dark: noise.dark, shot: noise.shot };
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        // What the border cuts has no balance.
        let balanced = || centroid::balance(&self.patch, part.guess, window_px as f32, variance);
        let balanced = if part.outline.cut { None } else { balanced() };
        let (centre, covariance) = balanced.unwrap_or((part.guess, anywhere));
        let saturated_px = f64::from(part.outline.saturated_px.max(5));
        let missing_px2 = match (part.outline.cut, part.outline.saturated_px > 0) {
            (true, _) => part.radius_px * part.radius_px / 4.0,
            (false, true) => SATURATION_BLUR_PX * SATURATION_BLUR_PX / (saturated_px + 4.0),
            (false, false) => SHAPELESS_PX * SHAPELESS_PX,
        };
        (centre, covariance + Matrix2::from_diagonal_element(missing_px2))
    }
}
