//! Bright pixels that belong together, before their light is measured.
//!
//! In: the runs of a part, in raster order. Out: its outline, a first guess of its centre, the paper's middle pixel.

use super::Extent;
use super::background::Background;
use super::ledge;
use super::rejection::{Outline, Reason};
use super::runs::Run;
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
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
    /// Mean of dark pixels around, and their noise, about, grey levels.
    pub(super) dark_dn: f64,
    pub(super) noise_dn: f64,
    /// Why it is not a marker, once that is known.
    pub(super) reason: Option<Reason>,
    /// Which of the frame's components that were split it is of, if any.
    pub(super) split_from: Option<usize>,
    /// Odds for clutter by its outline and what lies beside it, against an even prior.
    pub(super) clutter_odds: f64,
}

impl Part {
    /// Width (sigma) of the Gaussian spot that shows this area above this threshold, px: area = 2 pi sigma^2 ln(peak /
    /// threshold), both above the background.
    pub(super) fn width_px(&self, level: f32) -> f64 {
        let above = |value: u8| (f64::from(value) - f64::from(level)).max(1.0);
        let over = libm::log(above(self.outline.peak) / above(self.bright)).max(0.2);
        self.radius_px / (2.0 * over).sqrt()
    }

    /// About how bright a point is beside others of the same point spread: as its summit is high, or, where these are cut off, as far as it reaches.
    pub(super) fn seeming_light(&self, level: f32, is_full: bool) -> f64 {
        let height = (f64::from(self.outline.peak) - f64::from(level)).max(1.0);
        if is_full { height * self.radius_px * self.radius_px } else { height }
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
        // From the last pixel: each sum so far, added up, counts a pixel once for every column that it lies right of the first.
        let mut value_u = 0;
        for &pixel in run.pixels(frame).iter().rev() {
            peak = pixel.max(peak);
            saturated_px += u32::from(pixel == u8::MAX);
            value_u += value;
            value += u64::from(pixel);
        }
        light += value;
        light_u += value_u + value * u64::from(run.start);
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
    let level = background.level(u, v);
    let [dark_dn, noise_dn] = background.dark(level);
    let outline = Outline { extent, area_px, peak, saturated_px, masked_px, cut, goes_on, moments };
    Part {
        first: (first.v, first.start),
        outline,
        radius_px: outline.radius_px(),
        guess: Pixel::new(light_u as f64 / light, light_v as f64 / light),
        middle: middle_pixel(runs, area_px),
        bright,
        level,
        dark_dn,
        noise_dn,
        reason: None,
        split_from: None,
        clutter_odds: 0.0,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spots::settings::Brightness;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_outline_tells_of_each_pixel_once(
            left in 1u16..9, lengths in prop::collection::vec(1u16..40, 1..9), pixels in prop::collection::vec(1u8.., 50 * 9),
        ) {
            let frame = FrameView::packed(&pixels, 50, 9).unwrap();
            let runs: Vec<Run> =
                (0u16..).zip(&lengths).map(|(v, length)| Run { v, start: left, end: left + length }).collect();
            let mut background = Background::default();
            background.measure(&frame, Brightness::Threshold(1));
            let part = outline(&frame, &background, &runs, None);
            let places = runs.iter().flat_map(|run| (run.start..run.end).map(|u| (usize::from(u), usize::from(run.v))));
            let values: Vec<(f64, f64, u8)> =
                places.map(|(u, v)| (u as f64, v as f64, frame.row(v)[u])).collect();
            let light: f64 = values.iter().map(|value| f64::from(value.2)).sum();
            let centre = |of: fn(&(f64, f64, u8)) -> f64| {
                values.iter().map(|value| of(value) * f64::from(value.2)).sum::<f64>() / light
            };
            prop_assert_eq!(part.outline.area_px as usize, values.len());
            prop_assert_eq!(part.outline.peak, values.iter().map(|value| value.2).max().unwrap());
            prop_assert_eq!(part.outline.saturated_px as usize, values.iter().filter(|value| value.2 == 255).count());
            prop_assert!((part.guess.u - centre(|value| value.0)).abs() < 1e-9);
            prop_assert!((part.guess.v - centre(|value| value.1)).abs() < 1e-9);
        }
    }
}
