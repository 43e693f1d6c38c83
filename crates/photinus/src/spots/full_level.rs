//! The grey level at which pixels are full, where nobody measured it.
//!
//! In: the brightest pixels of spots, frame after frame. Out: the lowest level that may be that of a full pixel. 255 is full on every
//! camera. Others are full before that: the tops of their bright spots are flat, and all at one level, while the tops of spots that
//! are not full are as different as their light.

use super::Extent;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;

/// Pixels within this share of a spot's brightest are its top; from there to the next its shoulder. A summit has more of a shoulder than
/// of a top, by about ln(1 - 0.2) / ln(1 - 0.03) to 1; what is cut off has hardly any.
const TOP: f64 = 0.03;
const SHOULDER: f64 = 0.2;
/// Flat tops that must lie within [`PILE`] of the highest, how many times more than lie further below, down to half of it, and the share
/// of the spots that reach as high.
const FEWEST: u32 = 5;
const TIMES_MORE: u32 = 2;
const PILE: f64 = 0.05;
const SHARE_OF_SPOTS: f64 = 0.4;

/// Flat tops of spots by their level.
#[derive(Clone, Debug)]
pub(super) struct FullLevel {
    /// Spots by their brightest pixel: all, and those with a flat top.
    spots: [u32; 256],
    tops: [u32; 256],
    /// Pixels of the shoulders of those by the brightest pixel, pixels of the tops by themselves.
    shoulders: [u32; 256],
    pixels: [u32; 256],
    lowest: u8,
}

impl Default for FullLevel {
    fn default() -> Self {
        Self { spots: [0; 256], tops: [0; 256], shoulders: [0; 256], pixels: [0; 256], lowest: u8::MAX }
    }
}

impl FullLevel {
    /// The lowest level that may be that of a full pixel.
    pub(super) fn lowest(&self) -> u8 {
        self.lowest
    }

    /// Takes in a spot by the box that it spans and its brightest pixel.
    pub(super) fn add(&mut self, frame: &FrameView<'_>, extent: &Extent, peak: u8) {
        let floor = |share: f64| (f64::from(peak) * (1.0 - share)) as u8;
        let (top_from, shoulder_from) = (floor(TOP), floor(SHOULDER));
        let columns = extent.left as usize..=extent.right as usize;
        let pixels = (extent.top..=extent.bottom).flat_map(|v| &frame.row(v as usize)[columns.clone()]);
        let top = pixels.clone().filter(|&&pixel| pixel >= top_from);
        self.spots[usize::from(peak)] += 1;
        if top.clone().count() < 2 {
            return;
        }
        self.tops[usize::from(peak)] += 1;
        let shoulder = pixels.filter(|&&pixel| (shoulder_from..top_from).contains(&pixel)).count();
        self.shoulders[usize::from(peak)] += shoulder as u32;
        for &pixel in top {
            self.pixels[usize::from(pixel)] += 1;
        }
    }

    /// Works out the level from what was taken in.
    pub(super) fn settle(&mut self) {
        self.lowest = self.found().unwrap_or(u8::MAX);
    }

    fn found(&self) -> Option<u8> {
        let highest = self.tops.iter().rposition(|&tops| tops > 0)?;
        let pile = (highest as f64 * (1.0 - PILE)) as usize;
        let count = |of: &[u32; 256], levels: core::ops::Range<usize>| of[levels].iter().sum::<u32>();
        let (piled, below) = (count(&self.tops, pile..highest + 1), count(&self.tops, highest / 2..pile));
        let as_high = count(&self.spots, pile..256);
        if piled < FEWEST
            || piled < TIMES_MORE * below
            || f64::from(piled) < SHARE_OF_SPOTS * f64::from(as_high)
        {
            return None;
        }
        let total = f64::from(count(&self.pixels, pile..highest + 1));
        if f64::from(count(&self.shoulders, pile..highest + 1)) > total {
            return None;
        }
        // Pixels that 255 cuts off say nothing of a spread.
        if f64::from(self.pixels[255]) > 0.8 * total {
            return None;
        }
        let moment = |about: f64, power: i32| {
            let levels = (pile..).zip(&self.pixels[pile..=highest]);
            levels.map(|(level, &count)| f64::from(count) * (level as f64 - about).powi(power)).sum::<f64>()
                / total
        };
        let mean = moment(0.0, 1);
        let spread = moment(mean, 2).sqrt();
        Some((mean - 2.5 * spread - 1.0).max(pile as f64) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of spots of this sigma on a grid of phases, as bright as told, cut off at a level.
    fn level(sigma_px: f64, heights: &[f64], cut: f64) -> u8 {
        let (mut full, side) = (FullLevel::default(), 17);
        for (number, height) in heights.iter().cycle().take(60).enumerate() {
            let phase = |step: f64| (number as f64 * step).fract() - 0.5;
            let (u, v) = (8.0 + phase(0.618_034), 8.0 + phase(0.414_214));
            let value = |i: usize| {
                let (du, dv) = ((i % side) as f64 - u, (i / side) as f64 - v);
                let light = height * libm::exp(-(du * du + dv * dv) / (2.0 * sigma_px * sigma_px));
                (5.0 + light).min(cut).round() as u8
            };
            let pixels: Vec<u8> = (0..side * side).map(value).collect();
            let frame = FrameView::packed(&pixels, side, side).unwrap();
            let peak = pixels.iter().copied().fold(0, u8::max);
            full.add(&frame, &Extent { left: 0, top: 0, right: 16, bottom: 16 }, peak);
        }
        full.settle();
        full.lowest()
    }

    #[test]
    fn tops_that_are_cut_off_are_full() {
        for sigma_px in [0.5, 0.8, 1.5] {
            let found = level(sigma_px, &[100.0, 700.0, 300.0, 1500.0, 3000.0], 231.0);
            assert!((220..=231).contains(&found), "{found} of {sigma_px} px");
        }
    }

    #[test]
    fn summits_are_not_full_though_all_are_as_bright() {
        for sigma_px in [0.5, 0.8, 1.0, 1.5, 2.1, 2.5] {
            for heights in [&[150.0][..], &[60.0, 90.0, 130.0, 180.0, 240.0]] {
                assert_eq!(level(sigma_px, heights, 255.0), 255, "{sigma_px} px");
            }
        }
    }

    #[test]
    fn the_end_of_the_converter_is_full_by_itself() {
        assert_eq!(level(0.8, &[400.0, 1000.0, 4000.0], 255.0), 255);
    }
}
