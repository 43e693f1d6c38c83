//! The light of parts -> spots.
//!
//! In: the parts of a frame. Out: for each a spot, or the reason that it is none after all. Its centre and light are those of a point of light
//! where it fits one (`fitting`); what is wider, or of another shape, is centred by its wings (`wings`) or a
//! balanced window (`centroid`).

use alloc::sync::Arc;
use alloc::vec::Vec;

use nalgebra::{Matrix2, Vector2};

use super::Spot;
use super::breadth::EffectiveArea;
use super::centroid::{self, PixelVariance};
use super::cut_off::CutOff;
use super::detection_limit::Step;
use super::fitting::{Fitter, Model, SATURATION_BLUR_PX, WHOLE, reach_px, surroundings};
use super::hot_pixel::Sides;
use super::lessons::LEAST_SPILT;
use super::neighbourhood::Neighbourhood;
use super::odds;
use super::part::Part;
use super::patch::{Patch, Surroundings};
use super::rejection::{Outline, Reason};
use super::ring::ring_pixels;
use super::settings::{Brightness, Settings};
use super::window::nearest_pixel;
use super::wings::{self, Fit};
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::optics::{LogLight, Measured, Optics};

/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = UNIFORM;
/// That of what may be anything from 0 to 1.
const UNIFORM: f64 = 0.288_675_134_594_812_9;
/// Error of the centre of what has no shape that is known, and is so narrow that the grid of pixels pulls its window, or
/// whose window is cut short by another spot, px.
const SHAPELESS_PX: f64 = 0.07;
const NARROW_PX: f64 = 0.7;
/// Wings that fit as well as this (squared misfit over degrees of freedom) are those of a Gaussian ...
const GAUSSIAN_MISFIT: f64 = 1.5;
/// ... unless their summit is farther than this from where the fit has it, sigmas of both.
const CONTRADICTS: f64 = 3.0;
/// Wings that fit no better than this are not those of a Gaussian: their summit says less than its formal covariance.
const LARGEST_MISFIT: f64 = 5.0;
/// Radius around the summit of a spot that the border cuts, or that stands in the light of another, in which its light tells, px.
const SUMMIT_PX: f64 = 1.8;

/// Logarithm of the light of a spot that is full over what its pixels show, where no point spread told it, and its error: several times as
/// much may be hidden.
pub(crate) const HIDDEN_LOG: f64 = 0.3;
pub(crate) const HIDDEN_SIGMA: f64 = 0.6;
/// The centre of a light of its own is no farther than this from its pixels, px.
const FARTHEST_ASIDE_PX: f64 = 1.0;

/// The pixels of a part that may be full: those that read as much as the lowest full one may.
#[derive(Clone, Copy)]
struct Full {
    from: u8,
    px: u32,
}

impl Full {
    fn of(frame: &FrameView<'_>, outline: &Outline, from: u8) -> Self {
        let columns = outline.extent.left as usize..=outline.extent.right as usize;
        let rows = outline.extent.top as usize..=outline.extent.bottom as usize;
        let in_row = |v| frame.row(v)[columns.clone()].iter().filter(|&&pixel| pixel >= from).count();
        let px = if outline.peak < from { 0 } else { rows.map(in_row).sum::<usize>() as u32 };
        Self { from, px }
    }

    /// Variance of the centre of what is full in the middle, px^2.
    fn blur_px2(self) -> f64 {
        SATURATION_BLUR_PX * SATURATION_BLUR_PX / (f64::from(self.px.max(5)) + 4.0)
    }

    /// Variance of where in a pixel the light fell of what is full in the middle, px^2: where all that is bright is full, no flank tells it; each
    /// pixel of a flank says on which side, and halves what is left.
    fn flankless_px2(self, outline: &Outline) -> f64 {
        let flank = outline.area_px.saturating_sub(self.px);
        let sigma_px = libm::scalbn(WITHIN_A_PIXEL, -(flank.min(100) as i32));
        sigma_px * sigma_px
    }
}

/// A part with what is around it.
struct Look<'a> {
    part: &'a Part,
    full: Full,
    /// Its light is its own as far as this.
    room_px: f64,
    /// How far it is measured.
    window_px: f64,
    around: Surroundings,
}

impl Look<'_> {
    fn width_px(&self) -> f64 {
        self.part.width_px(self.around.level)
    }

    /// Whether another spot cuts its light short.
    fn is_crowded(&self) -> bool {
        self.room_px < self.part.most_room_px().min(3.5 * self.width_px())
    }
}

/// Measures the light of the parts of one frame after the other.
#[derive(Debug)]
pub(super) struct Meter {
    fitter: Fitter,
    patch: Patch,
    /// Whether the part measured last is a step on a slope: the light around it is balanced elsewhere.
    is_step: bool,
    /// The area of the part measured last, where all of its light shows.
    area: Option<EffectiveArea>,
}

impl Meter {
    pub(super) fn new(settings: &Settings, optics: Option<Arc<Optics>>) -> Self {
        Self { fitter: Fitter::new(settings, optics), patch: Patch::default(), is_step: false, area: None }
    }

    /// Whether frames still tell something of the camera.
    pub(super) fn learns(&self) -> bool {
        self.fitter.learns()
    }

    /// Light at which a point is found half of the time at a place with this step.
    pub(super) fn detection_limit(&self, step: Step, [u, v]: [usize; 2]) -> LogLight {
        self.fitter.detection_limit(step, Pixel::new(u as f64, v as f64))
    }

    /// Whether light moved in the frame: then markers are long, too.
    pub(super) fn is_smeared(&self) -> bool {
        self.fitter.is_smeared
    }

    /// Takes components that were split for one part each where that is the light of a point that moved.
    pub(super) fn join_smeared(&mut self, frame: &FrameView<'_>, parts: &mut Vec<Part>, split: &[Part]) {
        self.fitter.join_smeared(frame, parts, split);
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
        let full = Full::of(frame, outline, self.fitter.lowest_full(part.noise_dn));
        let (window_px, around) = open_window(frame, part, full, room_px, &self.fitter.window.cut_off);
        let height = f64::from(outline.peak) - f64::from(around.level);
        if let Brightness::Contrast(step) = settings.brightness
            && 2.0 * height < f64::from(step)
        {
            return Err(Reason::Background);
        }
        self.patch.read(frame, nearest_pixel(part.guess), reach_px(window_px), &around);
        let (flux, flux_sigma) = self.flux(part, window_px, around);
        let shows_all = !outline.cut && full.px == 0 && !self.fitter.is_smeared;
        self.area = EffectiveArea::new(flux, flux_sigma, height).filter(|_| shows_all);
        let model = self.fitter.fitted(index).copied();
        let look = Look { part, full, room_px, window_px, around };
        let (centre, covariance_px2) = match model {
            Some(model) => self.surer(&look, &model),
            None => self.shapeless(&look),
        };
        self.is_step = model.is_none()
            && !outline.cut
            && full.px == 0
            && outline.extent.gap_px(centre) > FARTHEST_ASIDE_PX;
        let (centre, covariance_px2) = match self.is_step {
            true => (part.guess, Matrix2::from_diagonal_element(part.radius_px * part.radius_px)),
            false => (centre, covariance_px2),
        };
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        Ok(Spot {
            centre,
            covariance_px2: if outline.cut { covariance_px2 + anywhere } else { covariance_px2 },
            area_px: outline.area_px,
            peak: outline.peak,
            saturated_px: outline.saturated_px,
            flux,
            light: match model {
                Some(model) => Some(model.light),
                None if !self.fitter.fits || outline.saturated_px > 0 => None,
                None if full.px > 0 => Some(hidden(flux)),
                // There is no less light than its brightest pixel shows.
                None => Some(Measured { value: flux.max(height).max(1.0), sigma: flux_sigma }),
            },
            background: f64::from(around.level.max(0.0)),
            marker_log_odds: 0.0,
            middle: part.middle,
            extent: outline.extent,
        })
    }

    /// Signal above the background in the window, and how far that may be from all light of its spot: by noise of its pixels and of the ring that
    /// tells the background, and by what the edge of the window still holds: up to as much may lie beyond, or be another's. Of what the
    /// border cuts, as much as shows may be hidden.
    fn flux(&self, part: &Part, window_px: f64, around: Surroundings) -> (f64, f64) {
        let [flux, inner] = self.patch.flux(part.guess, window_px as f32);
        let within = |flux: f64, radius_px: f64| {
            let pixels = core::f64::consts::PI * radius_px * radius_px;
            if !around.is_cut_off {
                return (flux, pixels);
            }
            // Dark pixels read more than their mean where noise is cut off.
            let dark = (pixels - f64::from(part.outline.area_px)).max(0.0);
            (flux - dark * self.fitter.window.cut_off.excess(around.level, around.variance), pixels)
        };
        let ((flux, pixels), (inner, _)) = (within(flux, window_px), within(inner, window_px - 1.0));
        let PixelVariance { dark, shot, .. } = self.fitter.told_noise(around);
        let [dark, shot] = [dark, shot].map(f64::from);
        let signal = flux.max(0.0);
        let noise = dark * (pixels + pixels * pixels / ring_pixels(reach_px(window_px))) + shot * signal;
        let beyond = UNIFORM * (flux - inner);
        let hidden = signal * if part.outline.cut { 1.0 } else { WHOLE * self.fitter.shape_error() };
        (flux, (noise + beyond * beyond + hidden * hidden).sqrt())
    }

    /// Whether the point spread told the light of part `index`.
    pub(super) fn is_point(&self, index: usize) -> bool {
        self.fitter.fitted(index).is_some()
    }

    /// The area of the part measured last, where all of its light shows.
    pub(super) fn effective_area(&self) -> Option<EffectiveArea> {
        self.area
    }

    /// Odds that the part measured last, in an image of `size` (width, height) px, is clutter by what is around it: a hot pixel, or a step on a slope of
    /// light.
    pub(super) fn clutter_odds(&self, part: &Part, size: [usize; 2]) -> f64 {
        if self.is_step {
            return odds::STEP;
        }
        if part.outline.area_px > 1 {
            return 0.0;
        }
        self.fitter.hot_pixel_odds(part.middle, self.patch.lone(part.middle, Sides::of(part.middle, size)))
    }

    /// A point's light by its fit, or by its wings where those are surer and do not contradict it: of a Gaussian that is full in the middle they tell all
    /// that there is, whatever spills there. Where much spills, nobody knows how, and neither is as sure, by its window.
    fn surer(&self, look: &Look<'_>, model: &Model) -> (Pixel, Matrix2<f64>) {
        let by_fit = (model.centre, model.covariance_px2);
        let is_alone = !look.part.outline.cut && look.room_px >= look.part.most_room_px();
        let has_wings = is_alone && look.full.px > 0;
        let by_wings = if has_wings { self.wings(look) } else { None };
        let is_surer = |fit: &Fit| {
            let off = Vector2::new(fit.centre.u - model.centre.u, fit.centre.v - model.centre.v);
            let both = (fit.covariance_px2 + model.covariance_px2).try_inverse();
            fit.misfit < GAUSSIAN_MISFIT
                && fit.covariance_px2.trace() < model.covariance_px2.trace()
                && both.is_some_and(|inverse| off.dot(&(inverse * off)) < CONTRADICTS * CONTRADICTS)
        };
        if let Some(fit) = by_wings.filter(is_surer) {
            return (fit.centre, fit.covariance_px2);
        }
        if !is_alone || model.spilt < LEAST_SPILT || self.fitter.motion.is_some() {
            return by_fit;
        }
        // Of a core narrower than this pixels show no parabola.
        let is_narrow = self.fitter.core_px() < NARROW_PX;
        let by_window = if is_narrow { self.balanced(look) } else { self.shapeless(look) };
        if by_window.1.trace() < by_fit.1.trace() { by_window } else { by_fit }
    }

    /// By the parabola through the logarithm of the light that shows, of a spot that is full in the middle or cut by the border.
    fn wings(&self, &Look { part, full, window_px, around, .. }: &Look<'_>) -> Option<Fit> {
        let variance = self.fitter.told_noise(around);
        // The lowest signal that a full pixel can have anywhere in the window.
        let tilt = around.slope[0].abs() + around.slope[1].abs();
        let full_dn = f32::from(full.from) - around.level - tilt * reach_px(window_px) as f32;
        let radius_px = match (part.outline.cut, full.px > 0) {
            (true, _) => SUMMIT_PX.max(part.radius_px),
            (false, true) => (part.radius_px + 2.5).min(window_px + 1.0),
            (false, false) => SUMMIT_PX,
        };
        wings::fit(&self.patch, part.guess, radius_px as f32, full_dn, variance)
    }

    /// What is no point's light: by the parabola through the logarithm of the light that shows, or by a balanced window.
    fn shapeless(&self, look: &Look<'_>) -> (Pixel, Matrix2<f64>) {
        let (outline, full) = (&look.part.outline, look.full);
        let is_crowded = look.is_crowded();
        let has_wings = outline.cut || full.px > 0 || is_crowded;
        let by_wings = has_wings.then(|| self.wings(look));
        let tells = |fit: &Fit| {
            outline.cut
                || full.px == 0
                || (fit.misfit < LARGEST_MISFIT && fit.covariance_px2.trace() < 2.0 * full.blur_px2())
        };
        let by_wings = by_wings.flatten().filter(tells);
        let shapeless = Matrix2::from_diagonal_element(SHAPELESS_PX * SHAPELESS_PX);
        if let Some(fit) = by_wings {
            let is_sure = outline.cut || full.px > 0;
            return (fit.centre, if is_sure { fit.covariance_px2 } else { fit.covariance_px2 + shapeless });
        }
        self.balanced(look)
    }

    /// By a balanced window: charge that spills keeps its middle, by whatever law.
    fn balanced(&self, look: &Look<'_>) -> (Pixel, Matrix2<f64>) {
        let &Look { part, full, window_px, around, .. } = look;
        let outline = &part.outline;
        let variance = self.fitter.told_noise(around);
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        let balanced = centroid::balance(&self.patch, part.guess, window_px as f32, variance);
        let (centre, covariance) = balanced.unwrap_or((part.guess, anywhere));
        let unclear = look.is_crowded() || look.width_px() < NARROW_PX;
        let missing_px2 = match (outline.cut, full.px > 0) {
            (true, _) => part.radius_px * part.radius_px / 4.0,
            (false, true) => full.blur_px2() + full.flankless_px2(outline),
            (false, false) if unclear => SHAPELESS_PX * SHAPELESS_PX,
            (false, false) => 0.0,
        };
        (centre, covariance + Matrix2::from_diagonal_element(missing_px2))
    }
}

/// All light of what is full, where no point spread tells it.
fn hidden(flux: f64) -> Measured {
    let value = flux.max(1.0) * libm::exp(HIDDEN_LOG);
    Measured { value, sigma: HIDDEN_SIGMA * value }
}

/// A window as wide as the spot is, or as its wings where it is saturated, with the background around it.
fn open_window(
    frame: &FrameView<'_>,
    part: &Part,
    full: Full,
    room_px: f64,
    cut_off: &CutOff,
) -> (f64, Surroundings) {
    let room_px = room_px.max(part.radius_px + 0.8).max(1.9);
    let narrow_px = (part.radius_px + 2.5).min(room_px);
    let around = surroundings(frame, part, narrow_px, cut_off);
    if full.px > 0 {
        return (narrow_px, around);
    }
    let whole_px = (3.5 * part.width_px(around.level) + 1.0).min(room_px);
    if whole_px <= narrow_px {
        return (narrow_px, around);
    }
    (whole_px, surroundings(frame, part, whole_px, cut_off))
}
