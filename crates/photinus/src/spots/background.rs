//! What is bright: a threshold for every tile of the frame.
//!
//! In: what the tiles of a frame hold. Out: for every tile the lowest value that counts as bright, and which tiles hold such a
//! pixel, so that dark tiles, nearly all of them, are never looked at again.
//!
//! With a contrast the level of a tile's surroundings is the median over 5 x 5 tiles (rows of columns) of each tile's
//! darkest pixel. A marker raises the darkest pixel of no tile, so dense markers leave it alone; the sun covers less
//! than half of 80 x 80 pixels, so it stays the bright thing there. What noise adds is measured from the spread that
//! three quarters of all tiles exceed, each without its brightest columns, so that even a marker in every tile does not
//! count as noise. Where darkness at 0 cuts half of the noise off, that spread tells neither how wide it is nor from where: there the pixels
//! themselves are asked, so that no more than about one of them is bright by noise.

use alloc::vec::Vec;

use wide::u8x16;

use super::cut_off::CutOff;
use super::detection_limit::Step;
use super::settings::Brightness;
use super::tiles::{Block, TILE_PX, Tiles};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::normal::ROOT_OF_TAU;

/// The spread that a quarter of the tiles of Gaussian noise do not exceed, in its sigmas; the same where half of it is cut off at 0.
const SIGMAS: f64 = 3.1;
const SIGMAS_CUT_OFF: f64 = 1.25;
/// How far above the darkest pixel of a tile its mean is, sigmas of Gaussian noise.
const DARKEST_SIGMAS: f64 = 2.4;

/// Thresholds of one frame, tile by tile, and the room to compute them in.
#[derive(Debug, Default)]
pub(super) struct Background {
    tiles: Tiles,
    /// The level around each tile; 0 where the threshold is a fixed one.
    level: Vec<Block>,
    scratch: Vec<Block>,
    /// What is bright stands at least this far above the level.
    step: u8,
    /// How far noise spreads in a tile; 0 where the threshold is a fixed one.
    spread: u8,
    cut_off: CutOff,
    /// Mean and noise of dark pixels, grey levels, where that is cut off at 0 and reaches the contrast.
    cut_off_dark: Option<[f64; 2]>,
}

impl Background {
    /// Measures `frame` and sets the thresholds.
    pub(super) fn measure(&mut self, frame: &FrameView<'_>, brightness: Brightness) {
        self.cut_off_dark = None;
        match brightness {
            Brightness::Threshold(level) => {
                self.tiles.summarise::<false>(frame);
                self.level.clear();
                self.level.resize(self.tiles.brightest.len(), Block::default());
                (self.step, self.spread) = (level, 0);
            }
            Brightness::Contrast(step) => {
                self.tiles.summarise::<true>(frame);
                for room in [&mut self.level, &mut self.scratch] {
                    room.resize(self.tiles.brightest.len(), Block::default());
                }
                self.spread = self.spread_of_a_quarter();
                self.step = self.step_above_noise(step);
                self.level_of_surroundings();
                self.rise_above_what_is_cut_off(frame);
            }
        }
    }

    /// Rows of tiles.
    pub(super) fn rows(&self) -> usize {
        self.tiles.rows
    }

    /// The level around the tile that pixel (`u`, `v`) lies in; 0 where the threshold is a fixed one.
    pub(super) fn level(&self, u: usize, v: usize) -> u8 {
        self.level.as_flattened()[v / TILE_PX * self.pitch() + u / TILE_PX]
    }

    /// The lowest bright value of the tile that pixel (`u`, `v`) lies in; past 255 nothing is.
    pub(super) fn threshold(&self, u: usize, v: usize) -> u16 {
        u16::from(self.level(u, v)) + u16::from(self.step)
    }

    /// The columns of the tiles that hold a bright pixel in a row of tiles, from left to right.
    pub(super) fn bright_tiles(&self, row: usize) -> impl Iterator<Item = usize> {
        let blocks = row * self.tiles.blocks..(row + 1) * self.tiles.blocks;
        let step = u8x16::splat(self.step);
        self.tiles.brightest[blocks.clone()].iter().zip(&self.level[blocks]).enumerate().flat_map(
            move |(block, (&brightest, &level))| {
                let above = u8x16::new(brightest).saturating_sub(u8x16::new(level));
                let bright = above.max(step).simd_eq(above).to_bitmask();
                set_bits(bright).map(move |tile| block * TILE_PX + tile)
            },
        )
    }

    /// Mean of dark pixels of the frame where the surroundings have this level, and their noise, grey levels, about; more rather than less
    /// where darkness is cut off at 0 (`level` 0).
    pub(super) fn dark(&self, level: u8) -> [f64; 2] {
        match self.cut_off_dark.filter(|_| level == 0) {
            Some(dark) => dark,
            None if level == 0 => [0.0, f64::from(self.spread) / SIGMAS_CUT_OFF],
            None => {
                let noise_dn = f64::from(self.spread) / SIGMAS;
                [f64::from(level) + DARKEST_SIGMAS * noise_dn, noise_dn]
            }
        }
    }

    /// How far above the mean of dark pixels a pixel is bright at a place, and their noise, grey levels; of a frame that was measured.
    pub(super) fn step_above_dark(&self, [u, v]: [usize; 2]) -> Step {
        let level = self.level(u, v);
        let [dark_dn, noise_dn] = self.dark(level);
        Step { step_dn: (f64::from(level) + f64::from(self.step) - dark_dn).max(1.0), noise_dn }
    }

    /// Tiles from the start of a row of them to the start of the next.
    fn pitch(&self) -> usize {
        self.tiles.blocks * TILE_PX
    }

    /// The contrast, or more where the frame's own noise would reach it.
    ///
    /// The spread of a tile of Gaussian noise is about 3.6 sigma, 2.4 of it below the mean.
    fn step_above_noise(&self, step: u8) -> u8 {
        let spread = usize::from(self.spread);
        (usize::from(step) + spread * 3 / 4).max(spread * 5 / 2).min(255) as u8
    }

    /// Where tiles are dark down to 0 and noise may reach the contrast: a step that about one pixel of the frame's noise does.
    fn rise_above_what_is_cut_off(&mut self, frame: &FrameView<'_>) {
        let sigmas = sigmas_of_one_in(frame.width() * frame.height());
        if sigmas * f64::from(self.spread) <= SIGMAS_CUT_OFF * f64::from(self.step) {
            return;
        }
        let (mean, square) = self.dark_moments(frame);
        let Some((level, variance)) = self.cut_off.darkness(mean, square) else { return };
        let (level, sigma) = (f64::from(level), f64::from(variance).sqrt());
        self.cut_off_dark = Some([level, sigma]);
        self.step = self.step.max((level + sigmas * sigma).ceil() as u8);
    }

    /// Mean and mean square of the pixels that are not bright, in a row of each tile whose surroundings are at 0.
    fn dark_moments(&self, frame: &FrameView<'_>) -> (f64, f64) {
        let (mut count, mut sum, mut squares) = (0_u32, 0_u32, 0_u64);
        for (row, levels) in self.level.as_flattened().chunks_exact(self.pitch()).enumerate() {
            let pixels = frame.row((row * TILE_PX + TILE_PX / 2).min(frame.height() - 1));
            for (tile, _) in pixels.chunks(TILE_PX).zip(levels).filter(|&(_, &level)| level == 0) {
                for &pixel in tile.iter().filter(|&&pixel| pixel < self.step) {
                    count += 1;
                    sum += u32::from(pixel);
                    squares += u64::from(u32::from(pixel) * u32::from(pixel));
                }
            }
        }
        (f64::from(sum) / f64::from(count), squares as f64 / f64::from(count))
    }

    /// The least spread that more than a quarter of the tiles do not exceed; 0 where none tells of noise.
    fn spread_of_a_quarter(&self) -> u8 {
        let spreads = &self.tiles.spread;
        let telling = self.tiles.telling as u32;
        if telling == 0 {
            return 0;
        }
        // From the highest bit down: the greatest number that is more than what no more than a quarter exceeds.
        let mut spread = 0;
        for bit in (0..8).rev() {
            let below = spread | ((1 << bit) - 1);
            if count_up_to(spreads, below) <= telling / 4 {
                spread |= 1 << bit;
            }
        }
        spread
    }

    /// The median over five rows of the medians over five columns.
    fn level_of_surroundings(&mut self) {
        let (columns, rows, pitch) = (self.tiles.columns, self.tiles.rows, self.pitch());
        let darkest = self.tiles.darkest.as_flattened();
        let medians = self.scratch.as_flattened_mut().chunks_exact_mut(pitch);
        for (row, medians) in medians.enumerate() {
            median_of_five(near(row, rows).map(|row| &darkest[row * pitch..][..pitch]), medians);
        }
        let levels = self.level.as_flattened_mut().chunks_exact_mut(pitch);
        for (medians, level) in self.scratch.as_flattened().chunks_exact(pitch).zip(levels) {
            let inner = columns.saturating_sub(4);
            if inner > 0 {
                let near: [&[u8]; 5] = core::array::from_fn(|offset| &medians[offset..][..inner]);
                median_of_five(near, &mut level[2..columns - 2]);
            }
            for column in (0..columns.min(2)).chain((inner + 2).min(columns)..columns) {
                let [a, b, c, d, e] = near(column, columns).map(|column| medians[column]);
                level[column] = middle(a, b, c, d, e);
            }
        }
        self.lower_corners();
    }

    /// A tile in a corner outvotes its surroundings, also when the sun fills it: its neighbours along the sides limit it.
    fn lower_corners(&mut self) {
        let (right, bottom, pitch) = (self.tiles.columns - 1, self.tiles.rows - 1, self.pitch());
        let level = self.level.as_flattened_mut();
        let at = |column: usize, row: usize| row * pitch + column;
        for (column, row) in [(0, 0), (right, 0), (0, bottom), (right, bottom)] {
            let beside = level[at(column.abs_diff(1).min(right), row)];
            let above = level[at(column, row.abs_diff(1).min(bottom))];
            let level = &mut level[at(column, row)];
            *level = beside.max(above).min(*level);
        }
    }
}

/// Sigmas that one of so many normal numbers exceeds, by the asymptote of their tail.
fn sigmas_of_one_in(numbers: usize) -> f64 {
    (0..3).fold(4.0, |sigmas, _| (2.0 * libm::log(numbers as f64 / (sigmas * ROOT_OF_TAU)).max(0.5)).sqrt())
}

/// Where the bits of a number are set, from the lowest.
fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lowest = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        lowest
    })
}

/// How many bytes are no more than `most`.
fn count_up_to(blocks: &[Block], most: u8) -> u32 {
    let most = u8x16::splat(most);
    // A lane of a byte counts that far.
    let parts = blocks.chunks(usize::from(u8::MAX)).map(|blocks| {
        let count = blocks.iter().fold(u8x16::ZERO, |count, &block| {
            let block = u8x16::new(block);
            count - block.min(most).simd_eq(block)
        });
        count.to_array().into_iter().map(u32::from).sum::<u32>()
    });
    parts.sum()
}

/// Five neighbours of `at` among `count`, itself in the middle; the last repeat past the ends.
fn near(at: usize, count: usize) -> [usize; 5] {
    core::array::from_fn(|offset| (at + offset).saturating_sub(2).min(count - 1))
}

fn median_of_five([a, b, c, d, e]: [&[u8]; 5], out: &mut [u8]) {
    for (((((out, &a), &b), &c), &d), &e) in out.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
        *out = middle(a, b, c, d, e);
    }
}

/// The median of five by comparisons without branches: of two pairs, the lowest and the highest cannot be it.
#[inline]
fn middle(a: u8, b: u8, c: u8, d: u8, e: u8) -> u8 {
    let low = a.min(b).max(c.min(d));
    let high = a.max(b).min(c.max(d));
    low.min(high).max(low.max(high).min(e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_network_finds_the_median_of_five(values in prop::array::uniform5(0u8..)) {
            let [a, b, c, d, e] = values;
            let mut sorted = values;
            sorted.sort_unstable();
            prop_assert_eq!(middle(a, b, c, d, e), sorted[2]);
        }

        #[test]
        fn the_spread_of_a_quarter_is_that_of_the_sorted_ones(
            spreads in prop::collection::vec(0u8.., 1..700), narrow in 0u32..8,
        ) {
            let spreads: Vec<u8> = spreads.into_iter().map(|spread| spread >> narrow).collect();
            let mut background = Background::default();
            background.tiles.telling = spreads.len();
            background.tiles.spread.resize(spreads.len().div_ceil(TILE_PX), [u8::MAX; TILE_PX]);
            background.tiles.spread.as_flattened_mut()[..spreads.len()].copy_from_slice(&spreads);
            let mut sorted = spreads;
            sorted.sort_unstable();
            prop_assert_eq!(background.spread_of_a_quarter(), sorted[sorted.len() / 4]);
        }

        #[test]
        fn bright_tiles_are_those_with_a_pixel_at_their_threshold(
            width in 1usize..300, height in 1usize..70, seed in 0u64.., contrast in 1u8..,
        ) {
            let value = |i: u64| ((seed.wrapping_add(i)).wrapping_mul(6_364_136_223_846_793_005) >> 57) as u8;
            let pixels: Vec<u8> = (0..(width * height) as u64).map(value).collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            for brightness in [Brightness::Threshold(contrast / 2 + 1), Brightness::Contrast(contrast)] {
                let mut background = Background::default();
                background.measure(&frame, brightness);
                let mut tiles = vec![Vec::new(); background.rows()];
                for (i, &pixel) in pixels.iter().enumerate() {
                    let (u, v) = (i % width, i / width);
                    if u16::from(pixel) >= background.threshold(u, v) {
                        tiles[v / TILE_PX].push(u / TILE_PX);
                    }
                }
                for (row, mut tiles) in tiles.into_iter().enumerate() {
                    tiles.sort_unstable();
                    tiles.dedup();
                    prop_assert_eq!(background.bright_tiles(row).collect::<Vec<_>>(), tiles);
                }
            }
        }
    }

    /// The threshold of every tile.
    fn thresholds(frame: &FrameView<'_>, contrast: u8) -> Vec<u16> {
        let mut background = Background::default();
        background.measure(frame, Brightness::Contrast(contrast));
        let at = |width: usize| (0..width).step_by(TILE_PX);
        at(frame.height())
            .flat_map(|v| at(frame.width()).map(move |u| (u, v)))
            .map(|(u, v)| background.threshold(u, v))
            .collect()
    }

    #[test]
    fn a_flat_frame_has_its_own_level_whatever_that_is() {
        for level in [0, 3, 23, 180, 240] {
            let pixels = vec![level; 100 * 60];
            let thresholds = thresholds(&FrameView::packed(&pixels, 100, 60).unwrap(), 20);
            assert!(thresholds.iter().all(|&threshold| threshold == u16::from(level) + 20));
        }
    }

    #[test]
    fn a_marker_in_every_tile_is_no_noise() {
        let pixels: Vec<u8> =
            (0..160 * 160).map(|i| if i % 16 < 5 && (i / 160) % 16 < 5 { 255 } else { 10 }).collect();
        let thresholds = thresholds(&FrameView::packed(&pixels, 160, 160).unwrap(), 20);
        assert!(thresholds.iter().all(|&threshold| threshold == 30));
    }

    #[test]
    fn what_fills_a_corner_is_not_its_own_surroundings() {
        for (width, height, side) in [(98, 66, 2), (96, 64, 20)] {
            let pixels: Vec<u8> = (0..width * height)
                .map(|i| if i % width >= width - side && i / width >= height - side { 255 } else { 10 })
                .collect();
            let thresholds = thresholds(&FrameView::packed(&pixels, width, height).unwrap(), 20);
            assert!(thresholds.iter().all(|&threshold| threshold == 30), "{side} px");
        }
    }

    #[test]
    fn a_dense_grid_of_markers_does_not_raise_the_level() {
        let pixels: Vec<u8> =
            (0..160 * 160).map(|i| if i % 8 == 0 && (i / 160) % 8 == 0 { 255 } else { 10 }).collect();
        let mut background = Background::default();
        background.measure(&FrameView::packed(&pixels, 160, 160).unwrap(), Brightness::Contrast(20));
        assert!((0..160).all(|at| background.level(at, 159 - at) == 10));
    }
}
