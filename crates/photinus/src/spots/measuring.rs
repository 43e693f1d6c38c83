//! The light of parts -> spots: background, window, centre and light with their covariances.
//!
//! In: the parts of a frame. Out: for each a spot, or the reason that it is none after all. A part that is no wider than a window is
//! fitted with the camera's point spread (`fit`), those beside each other in turn, each less the light of the others; what is wider, or
//! fits no point spread, is centred by a balanced window (`centroid`).

use std::sync::Arc;

use nalgebra::{Matrix2, SVector};

use super::Spot;
use super::centroid::{self, PixelVariance};
use super::fit::{self, Fitted, PixelNoise, PointSource, WIDTH};
use super::full_level::FullLevel;
use super::learning::{Belief, NUMBERS, Told};
use super::neighbourhood::Neighbourhood;
use super::part::Part;
use super::patch::{self, Patch, Surroundings};
use super::rejection::Reason;
use super::settings::{Brightness, Noise, Settings};
use super::window::{Spill, WIDEST_PX, Window, nearest_pixel};
use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::optics::{Measured, Optics, PointSpread, Sensor};

/// Error of measured charge that spills into a pixel, over that.
const SPILL_ERROR: f64 = 0.1;
/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = 0.288_675_134_594_812_9;
/// A part whose disc is wider than this is no point's light, px.
const WIDEST_POINT_PX: f64 = 7.5;
/// Room around a part that a window takes in, px.
const MARGIN_PX: f64 = 2.2;
/// Light of another spot further away than this does not matter, px from the middle of one to the edge of the window.
const OTHERS_PX: f64 = 5.0;
/// How far the light of another spot is known, as a share of it.
const OTHERS_KNOWN: f64 = 0.05;
/// A source's own variance is believed to be about this, px^2.
const SIZE_PX2: f64 = 0.05;
/// Pixels by whose number the scatter of a spot's own residuals counts against the noise that all tell.
const PIXELS_OF_ALL: f64 = 30.0;
/// A misfit (squared residuals over degrees of freedom) from which a spot is no point's light.
const NO_POINT: f64 = 25.0;
/// Error of the centre of a saturated core of no pixels at all, px; it falls with the root of their number.
const SATURATION_BLUR_PX: f64 = 0.13;
/// Levels of full pixels that differ by no more are one, grey levels.
const SAME_LEVEL_DN: u8 = 4;
/// Error of light over that of the shape: of a spot that is seen whole, of one of which only the wings are.
const WHOLE: f64 = 0.5;
const WINGS: f64 = 1.0;
/// Error of a centre that a wrong shape makes, px; it grows with the square of the shape's error.
const MISSHAPEN_PX: f64 = 1.0;
/// Share of the light of its brightest pixel that the eight around it get of a point, at least.
const LEAST_AROUND: f32 = 0.12;
/// Error of the light of a spot whose charge spills, over the light and the share that spills.
const SPILT_LIGHT: f64 = 0.3;
/// Share of spilled charge in a spot from which its residuals say nothing of noise.
const LEAST_SPILT: f64 = 0.02;
/// Spots of a frame that are learnt from, at most.
const MOST_TELLING: usize = 40;
/// Whether the light of others is taken away, pass by pass: their places are better known the second time.
const PASSES: [bool; 3] = [false, true, true];
/// Rounds in which a frame's spots and the point spread are fitted to each other.
const ROUNDS: usize = 5;
/// Frames after which a belief that is sure of itself learns no more of the spread.
const LEARNT_FRAMES: u32 = 32;
/// A spot with less contrast than this says little of the spread, grey levels.
const TELLING_DN: f64 = 30.0;

/// A part as fitted.
#[derive(Clone, Copy, Debug)]
struct Model {
    centre: Pixel,
    covariance_px2: Matrix2<f64>,
    /// Light that windows see, and all of it.
    light: Measured,
    all_light: f64,
}

/// Measures the light of the parts of one frame.
#[derive(Debug)]
pub(super) struct Meter {
    optics: Option<Arc<Optics>>,
    noise: Noise,
    belief: Belief,
    full_level: FullLevel,
    /// Whether spots are fitted at all: it takes time.
    fits: bool,
    frames: u32,
    window: Window,
    patch: Patch,
    models: Vec<Option<Model>>,
    widths: Vec<f64>,
}

impl Meter {
    pub(super) fn new(settings: &Settings, optics: Option<Arc<Optics>>) -> Self {
        Self {
            optics,
            noise: settings.noise,
            belief: Belief::new(settings.noise, u8::MAX),
            full_level: FullLevel::default(),
            fits: matches!(settings.brightness, Brightness::Contrast(_)),
            frames: 0,
            window: Window::default(),
            patch: Patch::default(),
            models: Vec::new(),
            widths: Vec::new(),
        }
    }

    /// Fits all parts that may be points.
    pub(super) fn fit(&mut self, frame: &FrameView<'_>, parts: &[Part], near: &Neighbourhood) {
        self.models.clear();
        self.models.resize(parts.len(), None);
        if !self.fits {
            return;
        }
        let full_from = self.full_from(frame, parts);
        self.learn(frame, parts, near, full_from);
        for others in PASSES {
            for (index, part) in parts.iter().enumerate() {
                if part.reason.is_some() || part.radius_px > WIDEST_POINT_PX {
                    continue;
                }
                let room_px = near.room_px(index, part.most_room_px());
                let is_alone = room_px >= radius_px(part) + OTHERS_PX - part.radius_px;
                if others && is_alone {
                    continue;
                }
                let (window_px, around) =
                    self.open(frame, part, if others { f64::INFINITY } else { room_px }, full_from);
                if others {
                    let middle = self.window.place(0.0, 0.0);
                    near.each_near(index, window_px + OTHERS_PX, |other, _| {
                        if let Some(model) = self.models[other] {
                            let spread = spread(self.optics.as_deref(), &self.belief, middle);
                            self.window.add_other(spread, model.centre, model.all_light, OTHERS_KNOWN);
                        }
                    });
                }
                let model = self.model(part, around);
                if model.is_some() || !others {
                    self.models[index] = model;
                }
            }
        }
    }

    /// Whether frames still tell something of the camera.
    pub(super) fn learns(&self) -> bool {
        self.fits && self.optics.is_none() && self.frames < LEARNT_FRAMES
    }

    /// The lowest level that may be that of a full pixel.
    fn full_from(&mut self, frame: &FrameView<'_>, parts: &[Part]) -> u8 {
        if let Some(optics) = &self.optics {
            return optics.sensor.full_from_dn();
        }
        if self.frames < LEARNT_FRAMES {
            for part in parts.iter().filter(|part| part.reason.is_none() && part.outline.area_px > 2) {
                self.full_level.add(frame, &part.outline.extent, part.outline.peak);
            }
            let before = self.full_level.lowest();
            self.full_level.settle();
            // What was learnt of spots whose tops were cut off unnoticed was wrong.
            if self.full_level.lowest().abs_diff(before) > SAME_LEVEL_DN {
                self.belief = Belief::new(self.noise, self.full_level.lowest());
                self.frames = 0;
            }
        }
        self.full_level.lowest()
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
        let model = self.models[index];
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
        let noise = self.pixel_noise(around);
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
            (false, false) => 0.07 * 0.07,
        };
        (centre, covariance + Matrix2::from_diagonal_element(missing_px2))
    }

    /// Opens the window on a part.
    fn open(
        &mut self,
        frame: &FrameView<'_>,
        part: &Part,
        room_px: f64,
        full_from: u8,
    ) -> (f64, Surroundings) {
        let window_px = radius_px(part).min(room_px.max(part.radius_px + 0.8).max(1.9));
        let around = surroundings(frame, part, window_px);
        self.window.read(frame, part.guess, window_px, &around, full_from);
        (window_px, around)
    }

    /// Noise of a pixel, the frame's own where that is more.
    fn pixel_noise(&self, around: Surroundings) -> PixelNoise {
        let noise = match &self.optics {
            None => self.belief.noise(),
            Some(optics) => {
                let read_dn = optics.sensor.read_noise_dn.value;
                PixelNoise {
                    dark: (read_dn * read_dn + 1.0 / 12.0) as f32,
                    shot: optics.sensor.shot.value as f32,
                    shape: optics.spread.shape_error() as f32,
                }
            }
        };
        PixelNoise { dark: noise.dark.max(around.variance), ..noise }
    }

    /// What becomes of charge above a full well.
    fn spill(&self) -> Spill {
        self.optics.as_ref().map_or_else(|| self.belief.spill(), |optics| measured_spill(&optics.sensor))
    }

    fn guess(&self, part: &Part) -> (f64, f64, f64) {
        let (u, v) = self.window.local(part.guess);
        (u, v, self.window.flux().max(1.0))
    }

    fn model(&mut self, part: &Part, around: Surroundings) -> Option<Model> {
        let noise = self.pixel_noise(around);
        let guess = self.guess(part);
        let is_sure = self.optics.is_some() || self.belief.is_sure() || self.frames >= LEARNT_FRAMES;
        if is_sure {
            let spread = spread(self.optics.as_deref(), &self.belief, part.guess);
            let spill = self.spill();
            let fitted =
                fit::fit(&mut self.window, &mut PointSource::new(spread, SIZE_PX2, spill), guess, noise)?;
            self.told(&fitted, noise)
        } else {
            let fitted = fit::fit(&mut self.window, &mut self.belief.free(), guess, noise)?;
            self.told(&fitted, noise)
        }
    }

    /// Whether light fell on the window: no lens is so sharp that, wherever in a pixel a point's light falls, the eight pixels around the
    /// brightest get less than [`LEAST_AROUND`] of what it gets. What is sharper is a hot pixel.
    fn is_light(&self, noise: PixelNoise) -> bool {
        let (peak, around) = self.window.peak_and_around();
        around > LEAST_AROUND * peak + 3.0 * (8.0 * noise.dark).sqrt()
    }

    /// What a fit says of a spot.
    fn told<const N: usize>(&self, fitted: &Fitted<N>, noise: PixelNoise) -> Option<Model> {
        let misfit = fitted.chi2 / fitted.freedom;
        if misfit > NO_POINT {
            return None;
        }
        let noisier = (fitted.chi2 + PIXELS_OF_ALL) / (fitted.freedom + PIXELS_OF_ALL);
        let noisier = if misfit > 2.0 { misfit } else { noisier };
        // How much of its light falls where it is seen is as unsure as the shape is, more so where only its wings are.
        let shape = f64::from(noise.shape);
        let is_full = self.window.full_px > 0;
        let spills = if is_full { self.window.spilled_share() } else { 0.0 };
        let unsure = fitted.light() * (shape * if is_full { WINGS } else { WHOLE } + SPILT_LIGHT * spills);
        let seen = if self.optics.is_some() { 1.0 } else { self.belief.seen_share() };
        let full_px = f64::from(self.window.full_px);
        let blur_px2 = spills * SATURATION_BLUR_PX * SATURATION_BLUR_PX / (full_px + 4.0)
            + (MISSHAPEN_PX * shape * shape) * (MISSHAPEN_PX * shape * shape);
        Some(Model {
            centre: self.window.place(fitted.numbers[0], fitted.numbers[1]),
            covariance_px2: fitted.centre_covariance_px2() * noisier
                + Matrix2::from_diagonal_element(blur_px2),
            light: Measured {
                value: seen * fitted.light(),
                sigma: seen * (fitted.light_variance() * noisier + unsure * unsure).sqrt(),
            },
            all_light: fitted.light(),
        })
    }

    /// Takes in what the frame's spots say of the point spread and of noise.
    fn learn(&mut self, frame: &FrameView<'_>, parts: &[Part], near: &Neighbourhood, full_from: u8) {
        if !self.learns() {
            return;
        }
        let tells = |index: usize, part: &Part| {
            let height = f64::from(part.outline.peak) - f64::from(part.level);
            let is_plain = part.reason.is_none() && !part.outline.cut && part.radius_px < 6.5;
            is_plain && height > TELLING_DN && near.room_px(index, 9.0) >= 9.0
        };
        if self.frames == 0 {
            let widths = parts.iter().enumerate().filter(|(index, part)| tells(*index, part));
            self.widths.clear();
            self.widths.extend(widths.map(|(_, part)| part.width_px(f32::from(part.level))));
            self.widths.sort_unstable_by(f64::total_cmp);
            if let Some(&width_px) = self.widths.get(self.widths.len() / 2) {
                self.belief.begin(width_px);
            }
        }
        let mut any = false;
        for round in 0..ROUNDS {
            let mut told = Told::default();
            let numbers = self.belief.numbers();
            let is_last = round + 1 == ROUNDS;
            let mut telling = MOST_TELLING;
            for (index, part) in parts.iter().enumerate() {
                if telling == 0 || !tells(index, part) {
                    continue;
                }
                telling -= 1;
                let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
                let (noise, guess) = (self.pixel_noise(around), self.guess(part));
                if !self.is_light(noise) {
                    continue;
                }
                let mut shape = self.belief.free();
                let weights = shape.weights;
                let Some(fitted) = fit::fit(&mut self.window, &mut shape, guess, noise) else { continue };
                let misfit = fitted.chi2 / fitted.freedom;
                if misfit < NO_POINT {
                    let widths = fitted.covariance.fixed_view::<NUMBERS, NUMBERS>(WIDTH, WIDTH).into_owned();
                    told.add(&fitted.numbers, &widths, weights, 1.0 / misfit.max(1.0));
                    any = true;
                }
            }
            if !any {
                return;
            }
            let moved = self.belief.take(&told);
            if !moved || is_last {
                self.belief.keep(&told, numbers);
                break;
            }
        }
        self.learn_noise(frame, parts, &tells, full_from);
        self.frames += 1;
    }

    fn learn_noise(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        tells: &dyn Fn(usize, &Part) -> bool,
        full_from: u8,
    ) {
        let mut telling = MOST_TELLING;
        for (index, part) in parts.iter().enumerate() {
            if telling == 0 || !tells(index, part) {
                continue;
            }
            telling -= 1;
            let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
            if !self.is_light(self.pixel_noise(around)) {
                continue;
            }
            let (noise, guess) = (self.belief.noise(), self.guess(part));
            let mut bins = *self.belief.noise_bins();
            let mut shape = PointSource::new(self.belief.spread(), SIZE_PX2, self.belief.spill());
            if let Some(fitted) = fit::fit(&mut self.window, &mut shape, guess, noise) {
                let spills = self.window.full_px > 0 && self.window.spilled_share() > LEAST_SPILT;
                if fitted.chi2 / fitted.freedom < NO_POINT && !spills {
                    fit::residuals(&self.window, &mut shape, &fitted, noise, |light, square| {
                        bins.add(light, square)
                    });
                }
            }
            *self.belief.noise_bins() = bins;
        }
        self.belief.noise_bins().solve();
    }
}

/// The point spread at a place.
fn spread<'a>(optics: Option<&'a Optics>, belief: &'a Belief, place: Pixel) -> &'a PointSpread {
    optics.map_or_else(|| belief.spread(), |optics| optics.spread.at(place))
}

/// What spills, as measured.
fn measured_spill(sensor: &Sensor) -> Spill {
    let over = sensor.full_well_dn.map_or(1.0, |well| well.value / sensor.saturation.level_dn);
    let ln_well = libm::log(over.max(1.0));
    // What may spill widens, even where nothing is believed to.
    let share = sensor.spill.value.max(0.5 * sensor.spill.sigma).min(1.0);
    let relative_error = SPILL_ERROR.max(sensor.spill.sigma / share.max(1e-3));
    Spill { share, ln_well, relative_error, numbers: None }
}

/// How far the window on a part reaches, px.
fn radius_px(part: &Part) -> f64 {
    (part.radius_px + MARGIN_PX).clamp(3.2, WIDEST_PX as f64)
}

fn surroundings(frame: &FrameView<'_>, part: &Part, window_px: f64) -> Surroundings {
    let level = Surroundings { level: f32::from(part.level), slope: [0.0; 2], variance: 0.0 };
    patch::surroundings(frame, nearest_pixel(part.guess), reach_px(window_px), part.bright).unwrap_or(level)
}

/// Pixels from the middle of a patch to its edge that hold a window of this radius, wherever in a pixel it settles.
fn reach_px(window_px: f64) -> i32 {
    window_px as i32 + 2
}

#[allow(unused)]
fn unused(_: SVector<f64, 1>) {}
