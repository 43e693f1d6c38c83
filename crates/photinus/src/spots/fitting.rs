//! Parts -> points of light: each fitted with the camera's point spread, those beside each other in turn.
//!
//! In: the parts of a frame. Out: for each that may be a point's light its centre and light with covariances ([`Model`]); nothing for what is
//! too wide for a window or fits no point spread. Point spread, noise and full level are those of the camera where they were measured, else
//! what frames have told (`lessons`).

use alloc::sync::Arc;
use alloc::vec::Vec;

use nalgebra::Matrix2;

use super::album::Album;
use super::centroid::PixelVariance;
use super::cut_off::CutOff;
use super::detection_limit::{self, Step};
use super::fit::{self, Fitted, PixelNoise, PointSource};
use super::full_level::FullLevel;
use super::hot_pixel::{self, Lone, LonePixels};
use super::learning::{Beginning, Belief, UNKNOWNS};
use super::lessons::LEARNT_FRAMES;
use super::limits;
use super::neighbourhood::Neighbourhood;
use super::noise_bins::NoiseBins;
use super::part::Part;
use super::patch::{self, Dark, Surroundings};
use super::settings::{Brightness, Noise, Settings};
use super::smear::{Motion, Smeared, bend_px};
use super::telling::Telling;
use super::window::{Spill, WIDEST_PX, Window, nearest_pixel};
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::optics::{LogLight, Measured, Optics, PointSpread, Sensor, SourceSize};

/// Error of charge that spills into a pixel, over that, where it is known how much does: no sensor keeps to the law.
pub(super) const SPILL_ERROR: f64 = 0.1;
/// A part whose disc is wider than this is no point's light, px.
pub(super) const WIDEST_POINT_PX: f64 = 6.5;
/// Room around a part that a window takes in, px.
const MARGIN_PX: f64 = 2.2;
/// Light of another spot further away than this does not matter, px from the middle of one to the edge of the window.
const OTHERS_PX: f64 = 5.0;
/// How far the light of another spot is known, as a share of it.
const OTHERS_KNOWN: f64 = 0.05;
/// Pixels by whose number the scatter of a spot's own residuals counts against the noise that all tell.
const PIXELS_OF_ALL: f64 = 30.0;
/// A misfit (squared residuals over degrees of freedom) from which a spot is no point's light.
pub(super) const NO_POINT: f64 = 25.0;
/// Error of the centre of a saturated core of no pixels at all, px; it falls with the root of their number.
pub(super) const SATURATION_BLUR_PX: f64 = 0.13;
/// Error of light over that of the shape: of a spot that is seen whole, of one of which only the wings are.
pub(super) const WHOLE: f64 = 0.4;
const WINGS: f64 = 1.0;
/// Error of a centre that a wrong shape makes, px; it grows with the square of the shape's error.
const MISSHAPEN_PX: f64 = 1.0;
/// Error of a centre that a share that was learnt makes, px, over how much of what is seen has spilled and the error of charge that spills.
const SPILT_PX: f64 = 0.7;
/// How often the light of others is taken away: their places are better known the second time.
const PASSES_BESIDE: usize = 2;

/// So many spots that are not full tell the core of the point spread.
const FEWEST_UNSATURATED: usize = 4;

/// Where the point spread is wrong by more of the light than this, it is none of the shapes that are known.
const SHAPELESS: f32 = 0.15;
/// A point is no further from the centroid of its part, px and radii of the part: what is has taken the light of another for its own.
const OFF_PX: f64 = 0.3;
const OFF_RADII: f64 = 0.1;
/// The centroid of few pixels does not tell where in them light fell: that of one is its middle. Over how many there are, px.
const OFF_IN_PIXELS_PX: f64 = 0.5;

/// A part as fitted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    pub(super) centre: Pixel,
    pub(super) covariance_px2: Matrix2<f64>,
    /// Light that windows see, and all of it.
    pub(super) light: Measured,
    pub(super) all_light: f64,
    /// How far it moved while the shutter was open, px.
    pub(super) moved_px: [f64; 2],
    /// Whether what it leaves is about noise.
    pub(super) fits: bool,
    /// Whether it was fitted together with a twin.
    pub(super) is_of_pair: bool,
    /// How much of what is seen has spilled over from full pixels by a law that nobody measured, 0 to 1.
    pub(super) spilt: f64,
}

/// Fits the parts of frames.
#[derive(Debug)]
pub(super) struct Fitter {
    pub(super) optics: Option<Arc<Optics>>,
    pub(super) noise: Noise,
    pub(super) belief: Belief,
    pub(super) full_level: FullLevel,
    pub(super) lone_pixels: LonePixels,
    /// Whether parts are fitted at all: it takes time.
    pub(super) fits: bool,
    /// Spots that tell something of the camera, and what they leave.
    pub(super) album: Album,
    pub(super) noise_bins: NoiseBins,
    /// Frames with spots that stand alone, and such that told something of it by spots beside each other; those of either kind that told nothing
    /// (frames in vain); spots that told something and were not full.
    pub(super) frames: u32,
    pub(super) frames_beside: u32,
    pub(super) frames_in_vain: u32,
    pub(super) frames_beside_in_vain: u32,
    /// Whether usual spots leave more of their light than points do.
    pub(super) is_odd: bool,
    /// Whether charge that spills hides that, and they leave far more than noise.
    pub(super) is_unexplained: bool,
    pub(super) unsaturated: usize,
    pub(super) window: Window,
    pub(super) widths: Vec<f64>,
    /// Where the point spread was looked for at first.
    pub(super) as_wide: Beginning,
    pub(super) telling: Vec<Telling>,
    models: Vec<Option<Model>>,
    /// Whether light moved in this frame while the shutter was open.
    pub(super) is_smeared: bool,
    /// How it moved.
    pub(super) motion: Option<Motion>,
    /// How far apart two points must be to be told apart, px.
    pub(super) resolution_px: f64,
    /// Components that are one streak though they were split: room to work in.
    pub(super) joined: Vec<usize>,
}

impl Fitter {
    pub(super) fn new(settings: &Settings, optics: Option<Arc<Optics>>) -> Self {
        let fits = matches!(settings.brightness, Brightness::Contrast(_));
        Self {
            album: if fits && optics.is_none() { Album::roomy() } else { Album::default() },
            optics,
            noise: settings.noise,
            belief: Belief::new(NoiseBins::new(settings.noise).noise, u8::MAX),
            full_level: FullLevel::default(),
            lone_pixels: LonePixels::default(),
            fits,
            noise_bins: NoiseBins::new(settings.noise),
            frames: 0,
            frames_beside: 0,
            frames_in_vain: 0,
            frames_beside_in_vain: 0,
            is_odd: false,
            is_unexplained: false,
            unsaturated: 0,
            window: Window::default(),
            widths: Vec::new(),
            as_wide: Belief::believed(),
            telling: Vec::new(),
            models: Vec::new(),
            is_smeared: false,
            motion: None,
            resolution_px: 0.0,
            joined: Vec::new(),
        }
    }

    /// Whether the point spread is known as well as it will be.
    pub(super) fn is_sure(&self) -> bool {
        self.optics.is_some() || self.frames >= LEARNT_FRAMES || self.belief.is_sure()
    }

    /// Whether the point spread is known so well that fits need not look for it.
    pub(super) fn is_sharp(&self) -> bool {
        self.optics.is_some() || self.belief.is_sure()
    }

    /// Whether a part may be a point's light, as far as that can be told: where nobody measured the point spread, not what the border cuts,
    /// nothing that is full where spots are odd, and nothing at all where points are of no shape that is known.
    pub(super) fn may_be_point(&self, part: &Part) -> bool {
        let tells_shape = || !self.is_odd || part.outline.peak < self.lowest_full(part.noise_dn);
        let knows_shape = || !part.outline.cut && !self.is_spread_unknown() && tells_shape();
        part.reason.is_none() && part.radius_px <= WIDEST_POINT_PX && (self.optics.is_some() || knows_shape())
    }

    /// Part `index` as fitted, if it was.
    pub(super) fn fitted(&self, index: usize) -> Option<&Model> {
        self.models.get(index)?.as_ref()
    }

    /// Fits all parts that may be points.
    pub(super) fn fit(&mut self, frame: &FrameView<'_>, parts: &[Part], near: &Neighbourhood) {
        self.models.clear();
        self.models.resize(parts.len(), None);
        if !self.fits {
            return;
        }
        let full_from = self.full_from(frame, parts);
        // A point spread that is known tells by itself, by what it does not fit, whether it is worth while to look for motion.
        self.motion = None;
        let knows = self.is_sharp() && self.unknown_shape() == 0.0;
        // While frames still teach, streaks must not be taken for points.
        if !knows || self.learns() {
            self.motion = self.motion(frame, parts, near, full_from);
        }
        self.learn(frame, parts, near, full_from);
        let is_sure = self.is_sure();
        if is_sure {
            let middle = Pixel::new(0.5 * frame.width() as f64, 0.5 * frame.height() as f64);
            self.resolution_px = spread(self.optics.as_deref(), &self.belief, middle).resolution_px();
        }
        let (alone, misfits) = self.pass(frame, parts, near, full_from, false);
        if knows && (self.is_smeared || 3 * misfits > alone) {
            self.motion = self.motion(frame, parts, near, full_from);
            if self.motion.is_some() {
                self.pass(frame, parts, near, full_from, false);
            }
        }
        let passes = if is_sure { PASSES_BESIDE } else { 0 };
        for _ in 0..passes {
            self.pass(frame, parts, near, full_from, true);
        }
    }

    /// Fits all parts as if nothing shone beside them, or those beside which something does with its light taken away. Says how many stand
    /// alone, and how many of these fit no point.
    fn pass(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        near: &Neighbourhood,
        full_from: u8,
        others: bool,
    ) -> (usize, usize) {
        let (is_sure, is_sharp) = (self.is_sure(), self.is_sharp());
        let (mut alone, mut misfits) = (0, 0);
        for (index, part) in parts.iter().enumerate() {
            if !self.may_be_point(part) {
                continue;
            }
            let room_px = near.room_px(index, part.most_room_px());
            let alone_px = radius_px(part) + OTHERS_PX - part.radius_px;
            let is_alone = near.room_px(index, alone_px) >= alone_px;
            // Light beside it and a point spread that is not known yet are not told apart.
            let is_unclear = !is_alone && !is_sure;
            if is_unclear || (others && is_alone) {
                continue;
            }
            if others
                && self.motion.is_none()
                && let Some(twin) = self.twin(parts, index, near)
            {
                if twin < index && self.models[twin].is_some_and(|model| model.is_of_pair) {
                    continue;
                }
                if let Some(models) = self.pair(frame, parts, [index, twin], near, full_from) {
                    [self.models[index], self.models[twin]] = models.map(Some);
                    continue;
                }
            }
            let (window_px, around) =
                self.open(frame, part, if others { f64::INFINITY } else { room_px }, full_from);
            if others {
                self.add_others(index, None, window_px, near);
            }
            let model = self.model(part, around, is_sharp);
            if is_alone {
                alone += 1;
                misfits += usize::from(model.is_none_or(|model| !model.fits));
            }
            if model.is_some() || !others {
                self.models[index] = model;
            }
        }
        (alone, misfits)
    }

    /// Tells the window what light of others falls into it, that of part `index` and its twin left out.
    pub(super) fn add_others(
        &mut self,
        index: usize,
        twin: Option<usize>,
        window_px: f64,
        near: &Neighbourhood,
    ) {
        let middle = self.window.place(0.0, 0.0);
        near.each_near(index, window_px + OTHERS_PX, |other, _| {
            if let Some(model) = self.models[other].filter(|_| twin != Some(other)) {
                let spread = spread(self.optics.as_deref(), &self.belief, middle);
                // As many places along its way as that has pixels.
                let [along_u, along_v] = model.moved_px;
                let places = libm::hypot(along_u, along_v) as usize + 1;
                let light = model.all_light / places as f64;
                for place in 0..places {
                    let time = (place as f64 + 0.5) / places as f64 - 0.5;
                    let centre = Pixel::new(model.centre.u + time * along_u, model.centre.v + time * along_v);
                    self.window.add_other(spread, centre, light, OTHERS_KNOWN);
                }
            }
        });
    }

    /// Opens the window on a part.
    pub(super) fn open(
        &mut self,
        frame: &FrameView<'_>,
        part: &Part,
        room_px: f64,
        full_from: u8,
    ) -> (f64, Surroundings) {
        let window_px = radius_px(part).min(room_px.max(part.radius_px + 0.8).max(1.9));
        let around = surroundings(frame, part, window_px, &self.window.cut_off);
        self.read(frame, part.guess, window_px, &around, full_from);
        (window_px, around)
    }

    /// Reads the window at a place, with what was measured of its pixels.
    pub(super) fn read(
        &mut self,
        frame: &FrameView<'_>,
        place: Pixel,
        window_px: f64,
        around: &Surroundings,
        full_from: u8,
    ) {
        self.window.read(frame, place, window_px, around, full_from);
        if let Some(optics) = &self.optics {
            self.window.leave_out(&optics.hot_pixels);
            if let Some(response) = optics.sensor.bent() {
                let read_dn = optics.sensor.read_noise_dn.value;
                self.window.straighten(response, (read_dn * read_dn + 1.0 / 12.0) as f32);
            }
        }
    }

    /// Noise of a pixel for what has no shape that is known: as the settings tell it, for what fits leave says nothing of such pixels; the
    /// frame's own where that is more.
    pub(super) fn told_noise(&self, around: Surroundings) -> PixelVariance {
        let Noise { read_dn, shot } = self.noise;
        let dark = (read_dn * read_dn + 1.0 / 12.0) as f32;
        PixelVariance { dark: dark.max(around.variance), shot: shot as f32, shape: self.unknown_shape() }
    }

    /// How wrong any point spread is, as a share of the light in a pixel, where points are of no shape that is known; 0 where they are.
    pub(super) fn unknown_shape(&self) -> f32 {
        let is_unknown = self.optics.is_none() && (self.is_odd || self.is_spread_unknown());
        if is_unknown { self.belief.noise().shape.max(SHAPELESS) } else { 0.0 }
    }

    /// Whether what frames told of the point spread is wrong: not even how high its summit is.
    fn is_spread_unknown(&self) -> bool {
        let is_in_vain = 2 * self.frames_in_vain > self.frames;
        let explains_nothing = is_in_vain || self.is_unexplained;
        self.belief.noise().shape >= SHAPELESS || explains_nothing || self.belief.is_too_sharp()
    }

    /// How wrong the point spread is, as a share of the light in a pixel.
    pub(super) fn shape_error(&self) -> f64 {
        self.optics
            .as_ref()
            .map_or_else(|| f64::from(self.belief.noise().shape), |optics| optics.spread.shape_error())
    }

    /// Noise of a pixel, the frame's own where that is more.
    pub(super) fn pixel_noise(&self, around: Surroundings) -> PixelNoise {
        let noise = match &self.optics {
            None => self.belief.noise(),
            Some(optics) => {
                let read_dn = optics.sensor.read_noise_dn.value;
                PixelNoise {
                    dark: (read_dn * read_dn + 1.0 / 12.0) as f32,
                    shot: optics.sensor.shot.value as f32,
                    shape: optics.spread.shape_error() as f32,
                    faint: 0.0,
                }
            }
        };
        PixelNoise { dark: noise.dark.max(around.variance), ..noise }
    }

    /// Noise of the pixels of the window: where its brightest are full, the others are of the wings.
    pub(super) fn window_noise(&self, around: Surroundings) -> PixelNoise {
        let noise = self.pixel_noise(around);
        match &self.optics {
            Some(optics) if self.window.full_px > 0 => {
                let (shape, faint) =
                    (optics.spread.wings_error() as f32, optics.spread.unknown_below() as f32);
                PixelNoise { shape, faint, ..noise }
            }
            _ => noise,
        }
    }

    /// Odds that a single bright pixel, in a column and row, is a hot one.
    pub(super) fn hot_pixel_odds(&self, (u, v): (u32, u32), pixel: Lone) -> f64 {
        let place = Pixel::new(f64::from(u), f64::from(v));
        let dark = Surroundings { level: 0.0, slope: [0.0; 2], variance: 0.0, is_cut_off: false };
        let by_look = |spread: &PointSpread| hot_pixel::odds(pixel, spread, self.pixel_noise(dark));
        match self.optics.as_deref() {
            Some(optics) => {
                let is_known = optics.hot_pixels.at(u, v).is_some();
                let beforehand = if is_known { hot_pixel::KNOWN } else { hot_pixel::BEFOREHAND };
                beforehand * by_look(optics.spread.at(place))
            }
            None if self.is_sharp() && self.unknown_shape() == 0.0 => {
                self.lone_pixels.odds((u, v)).max(hot_pixel::BEFOREHAND * by_look(self.belief.spread()))
            }
            None => self.lone_pixels.odds((u, v)),
        }
    }

    /// Light at which a point is found half of the time at a place with this step. Full spots tell nothing of the core of a point spread.
    pub(super) fn detection_limit(&self, step: Step, place: Pixel) -> LogLight {
        match &self.optics {
            Some(optics) => detection_limit::of_spread(optics.spread.at(place), 1.0, 0.0, step),
            None if self.unsaturated < FEWEST_UNSATURATED || self.is_spread_unknown() => {
                detection_limit::of_any_lens(step)
            }
            None => {
                let (spread, seen) = (self.belief.spread(), self.belief.seen_share());
                detection_limit::of_spread(spread, seen, self.belief.summit_sigma(), step)
            }
        }
    }

    /// How wide sources are, beyond those that the point spread was learnt from.
    pub(super) fn source_size(&self) -> SourceSize {
        self.optics.as_ref().map_or(SourceSize::UNKNOWN, |optics| *optics.spread.source_size())
    }

    /// Width (sigma) of the core of the point spread as frames told it, px.
    pub(super) fn core_px(&self) -> f64 {
        self.belief.core_px()
    }

    /// What becomes of charge above a full well.
    pub(super) fn spill(&self) -> Spill {
        self.optics.as_ref().map_or_else(|| self.belief.spill(), |optics| measured_spill(&optics.sensor))
    }

    pub(super) fn guess(&self, part: &Part) -> (f64, f64, f64) {
        let (u, v) = self.window.local(part.guess);
        (u, v, self.window.flux().max(1.0))
    }

    fn model(&mut self, part: &Part, around: Surroundings, is_sharp: bool) -> Option<Model> {
        let noise = self.window_noise(around);
        let guess = self.guess(part);
        if is_sharp {
            let spread = spread(self.optics.as_deref(), &self.belief, part.guess);
            let mut point = PointSource::new(spread, self.source_size(), self.spill());
            if let Some(motion) = self.motion {
                let streak: Option<Fitted<7>> =
                    limits::fit(&mut self.window, &mut Smeared::new(point, motion), guess, noise);
                if let Some(streak) = streak.filter(Fitted::fits) {
                    return self.told_streak(&streak, noise, part);
                }
                let still = limits::fit(&mut self.window, &mut point, guess, noise);
                return match (streak, still) {
                    (Some(streak), still) if still.is_none_or(|still| still.chi2 > streak.chi2) => {
                        self.told_streak(&streak, noise, part)
                    }
                    (_, still) => self.told(&still?, noise, part),
                };
            }
            let mut fitted = limits::fit(&mut self.window, &mut point, guess, noise)?;
            // What full pixels hide the others tell by the point spread.
            if self.optics.is_none() && self.window.full_px > 0 {
                let (mut free, covariance) = (self.belief.free(), self.belief.covariance());
                fitted = fit::considered(&mut self.window, &mut free, fitted, noise, covariance);
            }
            self.told(&fitted, noise, part)
        } else if let Some(motion) = self.motion {
            let mut streak = Smeared::new(self.belief.free(), motion);
            let fitted: Option<Fitted<{ UNKNOWNS + 2 }>> =
                limits::fit(&mut self.window, &mut streak, guess, noise);
            self.told_streak(&fitted?, noise, part)
        } else {
            let fitted = limits::fit(&mut self.window, &mut self.belief.free(), guess, noise)?;
            self.told(&fitted, noise, part)
        }
    }

    /// What a fit says of a spot that moved: its last two numbers are how far.
    fn told_streak<const N: usize>(
        &self,
        fitted: &Fitted<N>,
        noise: PixelNoise,
        part: &Part,
    ) -> Option<Model> {
        let moved_px = [fitted.numbers[N - 2], fitted.numbers[N - 1]];
        let bend_px = bend_px(moved_px);
        // What a wrong shape leaves averages out along a streak, and what is learnt of it from streaks is as much less; the error of all light is not.
        let pixels = 1.0 + libm::hypot(moved_px[0], moved_px[1]);
        let noise = PixelNoise { shape: noise.shape * pixels.sqrt() as f32, ..noise };
        let model = self.told(fitted, noise, part)?;
        let bent = Matrix2::from_diagonal_element(bend_px * bend_px);
        Some(Model { covariance_px2: model.covariance_px2 + bent, moved_px, ..model })
    }

    /// What a fit says of a spot.
    fn told<const N: usize>(&self, fitted: &Fitted<N>, noise: PixelNoise, part: &Part) -> Option<Model> {
        let point = Point {
            centre: self.window.place(fitted.numbers[0], fitted.numbers[1]),
            covariance_px2: fitted.centre_covariance_px2(),
            light: fitted.light(),
            light_variance: fitted.light_variance(),
        };
        let off_px = libm::hypot(point.centre.u - part.guess.u, point.centre.v - part.guess.v);
        // A streak of which one pixel shows is no point, and none that is fitted to it says where in that pixel.
        let pixels = f64::from(part.outline.area_px.max(1));
        let in_pixels_px = if fitted.fits() { OFF_IN_PIXELS_PX / pixels } else { 0.0 };
        let most_px = OFF_PX + OFF_RADII * part.radius_px + in_pixels_px;
        let is_off = !part.outline.cut && off_px > most_px;
        if is_off { None } else { self.point(&point, fitted, noise) }
    }

    /// A point as it is known, from what its fit left over; nothing of what is no point's light.
    pub(super) fn point<const N: usize>(
        &self,
        point: &Point,
        fitted: &Fitted<N>,
        noise: PixelNoise,
    ) -> Option<Model> {
        let Fitted { chi2, freedom, .. } = *fitted;
        let misfit = chi2 / freedom;
        if misfit > NO_POINT {
            return None;
        }
        let noisier = (chi2 + PIXELS_OF_ALL) / (freedom + PIXELS_OF_ALL);
        let noisier = if misfit > 2.0 { misfit } else { noisier };
        // How much of its light falls where it is seen is as unsure as the shape is, more so where only its wings are.
        let shape = if self.optics.is_some() { self.shape_error() } else { f64::from(noise.shape) };
        // What it leaves itself is of pixels all around, seen whole; that its place is less sure the misfit says.
        let strange2 = (WHOLE * WHOLE) * fitted.strange_share2();
        let is_full = self.window.full_px > 0;
        let spills = if is_full { self.window.spilled_share() } else { 0.0 };
        let (spilt, spill_error, seen) = match self.optics {
            Some(_) => (0.0, SPILL_ERROR, 1.0),
            None => (spills, self.belief.spill().relative_error, self.belief.seen_share()),
        };
        let place_px = self.optics.as_ref().map_or(0.0, |optics| optics.spread.place_error_px());
        let unsure = point.light * (shape * if is_full { WINGS } else { WHOLE } + spill_error * spills);
        let full_px = f64::from(self.window.full_px);
        let blur_px2 = 0.25 * spills * SATURATION_BLUR_PX * SATURATION_BLUR_PX / (full_px + 4.0)
            + (MISSHAPEN_PX * shape * shape) * (MISSHAPEN_PX * shape * shape)
            + place_px * place_px
            + (SPILT_PX * spill_error * spilt) * (SPILT_PX * spill_error * spilt);
        Some(Model {
            centre: point.centre,
            covariance_px2: point.covariance_px2 * noisier + Matrix2::from_diagonal_element(blur_px2),
            light: Measured {
                value: seen * point.light,
                sigma: seen
                    * (point.light_variance * noisier
                        + unsure * unsure
                        + strange2 * point.light * point.light)
                        .sqrt(),
            },
            all_light: point.light,
            moved_px: [0.0; 2],
            fits: misfit < fit::GOOD_FIT,
            is_of_pair: false,
            spilt,
        })
    }
}

/// A point's light as a fit has it, with its covariance where pixels are as noisy as they were taken to be.
pub(super) struct Point {
    pub(super) centre: Pixel,
    pub(super) covariance_px2: Matrix2<f64>,
    pub(super) light: f64,
    pub(super) light_variance: f64,
}

/// The point spread at a place.
pub(super) fn spread<'a>(optics: Option<&'a Optics>, belief: &'a Belief, place: Pixel) -> &'a PointSpread {
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
pub(super) fn radius_px(part: &Part) -> f64 {
    (part.radius_px + MARGIN_PX).clamp(3.2, WIDEST_PX as f64)
}

/// The background around a window on a part.
pub(super) fn surroundings(
    frame: &FrameView<'_>,
    part: &Part,
    window_px: f64,
    cut_off: &CutOff,
) -> Surroundings {
    surroundings_at(frame, part, part.guess, window_px, cut_off)
}

/// The background around a window at a place beside a part.
pub(super) fn surroundings_at(
    frame: &FrameView<'_>,
    part: &Part,
    place: Pixel,
    window_px: f64,
    cut_off: &CutOff,
) -> Surroundings {
    let variance = (part.noise_dn * part.noise_dn) as f32;
    let level = Surroundings { level: f32::from(part.level), slope: [0.0; 2], variance, is_cut_off: false };
    let dark = Dark { bright: part.bright, noise_dn: part.noise_dn, cut_off };
    patch::surroundings(frame, nearest_pixel(place), reach_px(window_px), &dark).unwrap_or(level)
}

/// Pixels from the middle of a patch to its edge that hold a window of this radius, wherever in a pixel it settles.
pub(super) fn reach_px(window_px: f64) -> i32 {
    window_px as i32 + 2
}
