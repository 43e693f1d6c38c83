//! The stages in order: read this first.

use nalgebra::Matrix2;

use super::background::{Background, TILE_PX};
use super::centroid::{self, PixelVariance};
use super::grouping::Components;
use super::patch::{self, Patch, Surroundings};
use super::rejection::{Outline, Reason};
use super::runs::{self, Run};
use super::settings::{Brightness, Settings, SettingsError};
use super::skirt;
use super::splitting::Splitter;
use super::{Detections, Extent, Rejected, Spot};
use crate::camera::Pixel;
use crate::frame::{FrameError, FrameView, Mask};

/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = 0.288_675_134_594_812_9;

/// Finds spots in frames. Keeps its room from frame to frame, so that a warm detector allocates nothing.
#[derive(Debug)]
pub struct Detector {
    settings: Settings,
    background: Background,
    bright_tiles: Vec<u16>,
    runs: Vec<Run>,
    components: Components,
    splitter: Splitter,
    part_runs: Vec<Run>,
    parts: Vec<Part>,
    patch: Patch,
    detections: Detections,
}

/// Bright pixels that belong together, before their light is measured.
#[derive(Clone, Copy, Debug)]
struct Part {
    outline: Outline,
    radius_px: f64,
    guess: Pixel,
    middle: (u32, u32),
    bright: u8,
    reason: Option<Reason>,
}

impl Part {
    /// Width (sigma) of the Gaussian spot that shows this area above this threshold, px: area = 2 pi sigma^2 ln(peak /
    /// threshold), both above the background.
    fn width_px(&self, level: f32) -> f64 {
        let above = |value: u8| (f64::from(value) - f64::from(level)).max(1.0);
        let over = libm::log(above(self.outline.peak) / above(self.bright)).max(0.2);
        self.radius_px / (2.0 * over).sqrt()
    }
}

impl Detector {
    /// A detector with these settings.
    ///
    /// # Errors
    /// [`SettingsError`] when one of them has no meaning.
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            settings,
            background: Background::default(),
            bright_tiles: Vec::new(),
            runs: Vec::new(),
            components: Components::default(),
            splitter: Splitter::default(),
            part_runs: Vec::new(),
            parts: Vec::new(),
            patch: Patch::default(),
            detections: Detections::default(),
        })
    }

    /// The settings in use.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Finds the spots of `frame`; where `mask` says to ignore, what is bright is rejected.
    ///
    /// # Errors
    /// [`FrameError::MaskSize`] when the mask is of another size than the frame.
    pub fn detect(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>) -> Result<&Detections, FrameError> {
        if let Some(mask) = mask {
            mask.check_size(frame.width(), frame.height())?;
        }
        self.background.measure(frame, self.settings.brightness);
        runs::find(frame, &self.background, &mut self.bright_tiles, &mut self.runs);
        self.components.group(&self.runs);
        self.outline_parts(frame, mask);
        self.reject_by_outline();
        self.measure_parts(frame);
        self.reject_faint_reflections();
        Ok(&self.detections)
    }

    fn outline_parts(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>) {
        self.parts.clear();
        for component in 0..self.components.len() {
            let runs = self.components.runs(component);
            let Some(split) = self.splitter.split(frame, runs, self.settings.noise) else {
                self.parts.push(outline(frame, &self.background, runs, mask));
                continue;
            };
            for part in split.chunk_by(|a, b| a.0 == b.0) {
                self.part_runs.clear();
                self.part_runs.extend(part.iter().map(|&(_, run)| run));
                self.parts.push(outline(frame, &self.background, &self.part_runs, mask));
            }
        }
    }

    fn reject_by_outline(&mut self) {
        for part in &mut self.parts {
            part.reason = part.outline.reject(&self.settings.shape);
        }
        for i in 0..self.parts.len() {
            if self.parts[i].reason == Some(Reason::Sun) {
                let sun = self.parts[i].outline;
                for part in self.parts.iter_mut().filter(|part| part.reason.is_none()) {
                    part.reason = part.outline.is_in_glare_of(&sun).then_some(Reason::Glare);
                }
            }
        }
    }

    fn measure_parts(&mut self, frame: &FrameView<'_>) {
        self.detections.spots.clear();
        self.detections.rejected.clear();
        for i in 0..self.parts.len() {
            let part = self.parts[i];
            let measured = match part.reason {
                Some(reason) => Err(reason),
                None => self.measure(frame, &part, self.room_px(i)),
            };
            match measured {
                Ok(spot) => self.detections.spots.push(spot),
                Err(reason) => self.detections.rejected.push(Rejected {
                    centre: part.guess,
                    area_px: part.outline.area_px,
                    peak: part.outline.peak,
                    reason,
                    extent: part.outline.extent,
                }),
            }
        }
    }

    /// How far the light around part `i` is its own, px: up to the edge of the nearest other part.
    fn room_px(&self, i: usize) -> f64 {
        let own = &self.parts[i];
        let others = self.parts[..i].iter().chain(&self.parts[i + 1..]);
        others.fold(2.0 * own.radius_px + 4.0, |room, other| {
            let (du, dv) = (other.guess.u - own.guess.u, other.guess.v - own.guess.v);
            let near = room + other.radius_px + 0.5;
            if du.abs() > near || dv.abs() > near {
                return room;
            }
            room.min((du * du + dv * dv).sqrt() - other.radius_px - 0.5)
        })
    }

    fn measure(&mut self, frame: &FrameView<'_>, part: &Part, room_px: f64) -> Result<Spot, Reason> {
        let Outline { extent, area_px, peak, saturated_px, .. } = part.outline;
        let radius = part.radius_px;
        let room = room_px.max(radius + 0.8).max(1.9);
        let middle = (part.guess.u.round() as i32, part.guess.v.round() as i32);
        let around = |window: f64| {
            patch::surroundings(frame, middle, reach_px(window), part.bright)
                .unwrap_or(Surroundings { level: 0.0, variance: 0.0 })
        };
        let mut window = (radius + 2.5).min(room);
        let mut surroundings = around(window);
        if saturated_px == 0 {
            let whole = (3.5 * part.width_px(surroundings.level) + 1.0).min(room);
            if whole > window {
                surroundings = around(whole);
            }
            window = whole;
        }
        let around = surroundings;
        let reach = reach_px(window);
        let height = f64::from(peak) - f64::from(around.level);
        if let Brightness::Contrast(step) = self.settings.brightness
            && 2.0 * height < f64::from(step)
        {
            return Err(Reason::Background);
        }
        let noise = self.settings.noise;
        let dark = (noise.read_dn * noise.read_dn + 1.0 / 12.0) as f32;
        let variance = PixelVariance { dark: dark.max(around.variance), shot: noise.shot as f32 };
        self.patch.read(frame, middle, reach, around.level);
        let flux = self.patch.flux(part.guess, window as f32);
        let skirt = || {
            let radius = (radius + 2.5).min(window + 1.0) as f32;
            let saturation = f32::from(u8::MAX) - around.level;
            let (centre, covariance) = skirt::fit(&self.patch, part.guess, radius, saturation, variance)?;
            let good = covariance.trace() < 2.0 * blur_of_saturation(saturated_px);
            good.then_some((centre, covariance))
        };
        let window = || {
            let (centre, covariance) = centroid::balance(&self.patch, part.guess, window as f32, variance)?;
            let sampling = if saturated_px > 0 {
                blur_of_saturation(saturated_px)
            } else {
                blur_of_sampling(height / flux)
            };
            Some((centre, covariance + Matrix2::from_diagonal_element(sampling)))
        };
        let measured = if saturated_px > 0 { skirt().or_else(window) } else { window() };
        let (centre, mut covariance_px2) =
            measured.unwrap_or((part.guess, Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL)));
        if touches_border(&extent, frame) {
            covariance_px2 += Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        }
        Ok(Spot {
            centre,
            covariance_px2,
            area_px,
            peak,
            saturated_px,
            flux,
            background: f64::from(around.level),
            middle: part.middle,
            extent,
        })
    }

    /// A reflection of a marker is much fainter than the brightest marker of the frame.
    fn reject_faint_reflections(&mut self) {
        let Brightness::Contrast(_) = self.settings.brightness else { return };
        let Detections { spots, rejected } = &mut self.detections;
        let height = |spot: &Spot| f64::from(spot.peak) - spot.background;
        let faintest = self.settings.shape.faintest * spots.iter().map(height).fold(0.0, f64::max);
        spots.retain(|spot| {
            let keep = height(spot) >= faintest;
            if !keep {
                rejected.push(Rejected {
                    centre: spot.centre,
                    area_px: spot.area_px,
                    peak: spot.peak,
                    reason: Reason::Reflection,
                    extent: spot.extent,
                });
            }
            keep
        });
        rejected.sort_unstable_by_key(|rejected| (rejected.extent.top, rejected.extent.left));
    }
}

/// Variance that the pixel grid adds to a centre when most light falls into one pixel, px^2. `share` is the summit's part
/// of the flux: 0.3 for a Gaussian of 0.7 px, where nothing is lost, 1 for a spot within one pixel.
fn blur_of_sampling(share: f64) -> f64 {
    let lost = ((share - 0.35) / 0.65).clamp(0.0, 1.0);
    let sigma = WITHIN_A_PIXEL * lost * lost * lost;
    sigma * sigma
}

/// Variance of the centre of a saturated core that shows no skirt, px^2: its outline is known to a pixel all around.
fn blur_of_saturation(saturated_px: u32) -> f64 {
    WITHIN_A_PIXEL * WITHIN_A_PIXEL / (f64::from(saturated_px) + 4.0)
}

/// Pixels from the middle of a patch to its edge that hold a window of this radius, wherever in a pixel it settles.
fn reach_px(window_px: f64) -> i32 {
    window_px as i32 + 2
}

fn touches_border(extent: &Extent, frame: &FrameView<'_>) -> bool {
    extent.left == 0
        || extent.top == 0
        || extent.right as usize + 1 == frame.width()
        || extent.bottom as usize + 1 == frame.height()
}

/// Size, shape, first guess of the centre and the paper's middle pixel of a part, whose runs are in raster order.
fn outline(frame: &FrameView<'_>, background: &Background, runs: &[Run], mask: Option<&Mask>) -> Part {
    let first = runs[0];
    let (u0, v0) = (f64::from(first.start), f64::from(first.v));
    let mut extent = Extent {
        left: u32::from(first.start),
        top: u32::from(first.v),
        right: u32::from(first.end) - 1,
        bottom: u32::from(runs[runs.len() - 1].v),
    };
    let (mut area_px, mut peak, mut saturated_px, mut masked_px) = (0, 0, 0, 0);
    let mut moments = [0.0; 5];
    let (mut light, mut light_u, mut light_v) = (0u64, 0u64, 0u64);
    for run in runs {
        extent.left = extent.left.min(u32::from(run.start));
        extent.right = extent.right.max(u32::from(run.end) - 1);
        let mut value = 0;
        for (&pixel, u) in run.pixels(frame).iter().zip(u64::from(run.start)..) {
            peak = pixel.max(peak);
            saturated_px += u32::from(pixel == u8::MAX);
            value += u64::from(pixel);
            light_u += u64::from(pixel) * u;
        }
        light += value;
        light_v += value * u64::from(run.v);
        add_moments(&mut moments, run, u0, v0);
        if let Some(mask) = mask {
            let ignored = |u: &u16| mask.ignores(usize::from(*u), usize::from(run.v));
            masked_px += (run.start..run.end).filter(ignored).count() as u32;
        }
        area_px += run.len();
    }
    let light = light.max(1) as f64;
    let thresholds = background.row(usize::from(first.v) / TILE_PX).0;
    let outline = Outline { extent, area_px, peak, saturated_px, masked_px, moments };
    Part {
        outline,
        radius_px: outline.radius_px(),
        guess: Pixel::new(light_u as f64 / light, light_v as f64 / light),
        middle: middle_pixel(runs, area_px),
        bright: thresholds[usize::from(first.start) / TILE_PX] as u8,
        reason: None,
    }
}

/// Adds a run's sums of du, dv, du^2, du dv, dv^2 from (`u0`, `v0`).
fn add_moments(moments: &mut [f64; 5], run: &Run, u0: f64, v0: f64) {
    let n = f64::from(run.len());
    let (middle, dv) = (f64::from(run.start) + (n - 1.0) / 2.0 - u0, f64::from(run.v) - v0);
    let spread = n * (n * n - 1.0) / 12.0;
    for (moment, sum) in moments.iter_mut().zip([
        n * middle,
        n * dv,
        n * middle * middle + spread,
        n * middle * dv,
        n * dv * dv,
    ]) {
        *moment += sum;
    }
}

/// The pixel at half the area in the order of a scan-line fill: the position of the paper.
fn middle_pixel(runs: &[Run], area_px: u32) -> (u32, u32) {
    let mut before = area_px / 2;
    for run in runs {
        if before < run.len() {
            return (u32::from(run.start) + before, u32::from(run.v));
        }
        before -= run.len();
    }
    unreachable!("half of the area lies within the runs that make it up")
}
