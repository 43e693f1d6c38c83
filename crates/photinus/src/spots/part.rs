//! Bright pixels that belong together, before their light is measured.
//!
//! In: the runs of a part, in raster order. Out: its outline, a first guess of its centre, the paper's middle pixel.

use super::Extent;
use super::background::Background;
use super::ledge;
use super::rejection::{Outline, Reason};
use super::runs::Run;
use crate::camera::Pixel;
use crate::frame::{FrameView, Mask};

/// Bright pixels that belong together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Row and column of its first pixel.
    pub(super) first: (u16, u16),
    pub(super) outline: Outline,
    /// Radius of the disc of the same area, px.
    pub(super) radius_px: f64,
    pub(super) guess: Pixel,
    pub(super) middle: (u32, u32),
    /// The lowest value that is bright here.
    pub(super) bright: u8,
    /// The level of the surroundings as the tile has it.
    pub(super) level: u8,
    /// Why it is no marker, once that is known.
    pub(super) reason: Option<Reason>,
}

impl Part {
    /// Width (sigma) of the Gaussian spot that shows this area above this threshold, px: area = 2 pi sigma^2 ln(peak /
    /// threshold), both above the background.
    pub(super) fn width_px(&self, level: f32) -> f64 {
        let above = |value: u8| (f64::from(value) - f64::from(level)).max(1.0);
        let over = libm::log(above(self.outline.peak) / above(self.bright)).max(0.2);
        self.radius_px / (2.0 * over).sqrt()
    }

    /// How far light is looked for when nothing else is near, px.
    pub(super) fn most_room_px(&self) -> f64 {
        2.0 * self.radius_px + 4.0
    }
}

/// Size, shape, first guess of the centre and the paper's middle pixel of a part, whose runs are in raster order.
pub(super) fn outline(
    frame: &FrameView<'_>,
    background: &Background,
    runs: &[Run],
    mask: Option<&Mask>,
) -> Part {
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
    let (u, v) = (usize::from(first.start), usize::from(first.v));
    let bright = background.threshold(u, v) as u8;
    let cut = touches_border(&extent, frame);
    let goes_on = ledge::goes_on(frame, background, runs, &extent, peak.midpoint(bright));
    let outline = Outline { extent, area_px, peak, saturated_px, masked_px, cut, goes_on, moments };
    Part {
        first: (first.v, first.start),
        outline,
        radius_px: outline.radius_px(),
        guess: Pixel::new(light_u as f64 / light, light_v as f64 / light),
        middle: middle_pixel(runs, area_px),
        bright,
        level: background.level(u, v),
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

fn touches_border(extent: &Extent, frame: &FrameView<'_>) -> bool {
    extent.left == 0
        || extent.top == 0
        || extent.right as usize + 1 == frame.width()
        || extent.bottom as usize + 1 == frame.height()
}
