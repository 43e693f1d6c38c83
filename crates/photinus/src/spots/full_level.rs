//! The grey level at which pixels are full, where nobody measured it.
//!
//! In: the brightest pixels of spots, frame after frame. Out: the lowest level that may be that of a full pixel. 255 is full on every
//! camera. Others are full before that: the tops of their bright spots are flat, and all at one level, while the tops of spots that
//! are not full are as different as their light.

use super::Extent;
use crate::frame::FrameView;

/// Pixels within this share of a spot's brightest are its top.
const TOP: f64 = 0.03;
/// Flat tops that must lie within [`PILE`] of the highest, and how many times more than lie further below, down to half of it.
const FEWEST: u32 = 5;
const TIMES_MORE: u32 = 2;
const PILE: f64 = 0.05;

/// Flat tops of spots by their level.
#[derive(Clone, Debug)]
pub(super) struct FullLevel {
    tops: [u32; 256],
    pixels: [u32; 256],
    lowest: u8,
}

impl Default for FullLevel {
    fn default() -> Self {
        Self { tops: [0; 256], pixels: [0; 256], lowest: u8::MAX }
    }
}

impl FullLevel {
    /// The lowest level that may be that of a full pixel.
    pub(super) fn lowest(&self) -> u8 {
        self.lowest
    }

    /// Takes in a spot by the box that it spans and its brightest pixel.
    pub(super) fn add(&mut self, frame: &FrameView<'_>, extent: &Extent, peak: u8) {
        let floor = (f64::from(peak) * (1.0 - TOP)) as u8;
        let mut top = 0;
        let columns = extent.left as usize..=extent.right as usize;
        for v in extent.top..=extent.bottom {
            let row = &frame.row(v as usize)[columns.clone()];
            top += row.iter().filter(|&&pixel| pixel >= floor).count();
        }
        if top < 2 {
            return;
        }
        self.tops[usize::from(peak)] += 1;
        for v in extent.top..=extent.bottom {
            for &pixel in frame.row(v as usize)[columns.clone()].iter().filter(|&&pixel| pixel >= floor) {
                self.pixels[usize::from(pixel)] += 1;
            }
        }
    }

    /// Works out the level from what was taken in.
    pub(super) fn settle(&mut self) {
        self.lowest = self.found().unwrap_or(u8::MAX);
    }

    fn found(&self) -> Option<u8> {
        let highest = self.tops.iter().rposition(|&tops| tops > 0)?;
        let pile = (highest as f64 * (1.0 - PILE)) as usize;
        let count = |levels: std::ops::Range<usize>| self.tops[levels].iter().sum::<u32>();
        let (piled, below) = (count(pile..highest + 1), count(highest / 2..pile));
        if piled < FEWEST || piled < TIMES_MORE * below {
            return None;
        }
        let total: f64 = self.pixels[pile..=highest].iter().map(|&count| f64::from(count)).sum();
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
