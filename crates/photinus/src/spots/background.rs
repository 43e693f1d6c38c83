//! What is bright: a threshold for every tile of the frame.
//!
//! In: the frame. Out: for every tile of 16 x 16 pixels the lowest value that counts as bright, and whether any pixel of
//! the tile reaches it, so that dark tiles, nearly all of them, are never looked at again.
//!
//! With a contrast the level of a tile's surroundings is the median over 5 x 5 tiles (rows of columns) of each tile's
//! darkest pixel. A marker raises the darkest pixel of no tile, so dense markers leave it alone; the sun covers less
//! than half of 80 x 80 pixels, so it stays the bright thing there. What noise adds is measured from the spread that
//! three quarters of all tiles exceed, which markers cannot reach either.

use super::settings::Brightness;
use crate::frame::FrameView;

/// Side of a tile, px.
pub(super) const TILE_PX: usize = 16;

/// Rows of a tile that its darkest pixel is taken from: every fourth is enough for a level, at a quarter of the cost.
const ROWS_PER_DARKEST: usize = 4;

/// Thresholds of one frame, tile by tile, and the room to compute them in.
#[derive(Debug, Default)]
pub(super) struct Background {
    columns: usize,
    rows: usize,
    brightest: Vec<u8>,
    darkest: Vec<u8>,
    level: Vec<u8>,
    scratch: Vec<u8>,
    threshold: Vec<u16>,
}

impl Background {
    /// Measures `frame` and sets the thresholds.
    pub(super) fn measure(&mut self, frame: &FrameView<'_>, brightness: Brightness) {
        self.columns = frame.width().div_ceil(TILE_PX);
        self.rows = frame.height().div_ceil(TILE_PX);
        let tiles = self.columns * self.rows;
        for room in [&mut self.brightest, &mut self.darkest, &mut self.level, &mut self.scratch] {
            room.resize(tiles, 0);
        }
        self.threshold.resize(tiles, 0);
        match brightness {
            Brightness::Threshold(level) => {
                self.summarise::<false>(frame);
                self.threshold.fill(u16::from(level));
            }
            Brightness::Contrast(step) => {
                self.summarise::<true>(frame);
                let step = self.step_above_noise(step);
                self.level_of_surroundings();
                for (threshold, level) in self.threshold.iter_mut().zip(&self.level) {
                    *threshold = u16::from(*level) + u16::from(step);
                }
            }
        }
    }

    /// Tiles per row.
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of tiles.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// The lowest bright value of each tile in a row of tiles (past 255 nothing is), and the tile's brightest pixel.
    pub(super) fn row(&self, row: usize) -> (&[u16], &[u8]) {
        let tiles = row * self.columns..(row + 1) * self.columns;
        (&self.threshold[tiles.clone()], &self.brightest[tiles])
    }

    /// The brightest pixel of every tile and, if asked for, the darkest.
    fn summarise<const DARKEST: bool>(&mut self, frame: &FrameView<'_>) {
        let tile_rows = self.brightest.chunks_exact_mut(self.columns);
        for ((row, brightest), darkest) in
            tile_rows.enumerate().zip(self.darkest.chunks_exact_mut(self.columns))
        {
            let top = row * TILE_PX;
            let bottom = (top + TILE_PX).min(frame.height());
            let whole = frame.width() / TILE_PX;
            let band: [&[u8]; TILE_PX] = std::array::from_fn(|v| frame.row((top + v).min(bottom - 1)));
            for column in 0..whole {
                let mut high = [0u8; TILE_PX];
                let mut low = [u8::MAX; TILE_PX];
                for (v, pixels) in band.iter().enumerate() {
                    let pixels = &pixels[column * TILE_PX..][..TILE_PX];
                    for (high, &pixel) in high.iter_mut().zip(pixels) {
                        *high = (*high).max(pixel);
                    }
                    if DARKEST && v % ROWS_PER_DARKEST == 0 {
                        for (low, &pixel) in low.iter_mut().zip(pixels) {
                            *low = (*low).min(pixel);
                        }
                    }
                }
                brightest[column] = high.into_iter().fold(0, u8::max);
                if DARKEST {
                    darkest[column] = low.into_iter().fold(u8::MAX, u8::min);
                }
            }
            if whole < self.columns {
                let rest = || band.iter().flat_map(|pixels| &pixels[whole * TILE_PX..]).copied();
                brightest[whole] = rest().fold(0, u8::max);
                darkest[whole] = rest().fold(u8::MAX, u8::min);
            }
        }
    }

    /// The contrast, or more where the frame's own noise would reach it.
    ///
    /// The spread of 256 pixels of Gaussian noise is about 5.2 sigma, 2.4 of it below the mean.
    fn step_above_noise(&self, step: u8) -> u8 {
        let mut tiles_by_spread = [0u32; 256];
        for (&high, &low) in self.brightest.iter().zip(&self.darkest) {
            tiles_by_spread[usize::from(high.saturating_sub(low))] += 1;
        }
        let quarter = (self.brightest.len() / 4) as u32;
        let mut below = 0;
        let spread = tiles_by_spread.iter().position(|&tiles| {
            below += tiles;
            below > quarter
        });
        let spread = spread.unwrap_or(0);
        (usize::from(step) + spread / 2).max(spread * 8 / 5).min(255) as u8
    }

    /// The median over five rows of the medians over five columns.
    fn level_of_surroundings(&mut self) {
        let (columns, rows) = (self.columns, self.rows);
        for row in 0..rows {
            let at = |offset: usize| (row + offset).saturating_sub(2).min(rows - 1) * columns;
            let near: [&[u8]; 5] = std::array::from_fn(|offset| &self.darkest[at(offset)..][..columns]);
            median_of_five(near, &mut self.scratch[row * columns..][..columns]);
        }
        for (medians, level) in self.scratch.chunks_exact(columns).zip(self.level.chunks_exact_mut(columns)) {
            if columns < 5 {
                for (column, level) in level.iter_mut().enumerate() {
                    let at = |offset: usize| medians[(column + offset).saturating_sub(2).min(columns - 1)];
                    *level = middle(at(0), at(1), at(2), at(3), at(4));
                }
                continue;
            }
            let inner = columns - 4;
            let near: [&[u8]; 5] = std::array::from_fn(|offset| &medians[offset..][..inner]);
            median_of_five(near, &mut level[2..columns - 2]);
            for column in [0, 1, columns - 2, columns - 1] {
                let at = |offset: usize| medians[(column + offset).saturating_sub(2).min(columns - 1)];
                level[column] = middle(at(0), at(1), at(2), at(3), at(4));
            }
        }
    }
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
        fn a_tile_knows_its_brightest_pixel(width in 1usize..70, height in 1usize..70, seed in 0u64..) {
            let pixels: Vec<u8> = (0..width * height)
                .map(|i| (seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(i as u64 * i as u64 * 97) >> 7) as u8)
                .collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            for brightness in [Brightness::Threshold(9), Brightness::Contrast(20)] {
                let mut background = Background::default();
                background.measure(&frame, brightness);
                for row in 0..background.rows() {
                    for (column, &brightest) in background.row(row).1.iter().enumerate() {
                        let rows = row * TILE_PX..((row + 1) * TILE_PX).min(height);
                        let columns = column * TILE_PX..((column + 1) * TILE_PX).min(width);
                        let expected = rows.flat_map(|v| frame.row(v)[columns.clone()].to_vec()).max().unwrap();
                        prop_assert_eq!(brightest, expected);
                    }
                }
            }
        }
    }

    #[test]
    fn a_flat_frame_has_its_own_level_whatever_that_is() {
        for level in [0, 3, 23, 180, 240] {
            let pixels = vec![level; 100 * 60];
            let mut background = Background::default();
            background.measure(&FrameView::packed(&pixels, 100, 60).unwrap(), Brightness::Contrast(20));
            assert!(background.threshold.iter().all(|&t| t == u16::from(level) + 20));
        }
    }

    #[test]
    fn a_dense_grid_of_markers_does_not_raise_the_level() {
        let pixels: Vec<u8> =
            (0..160 * 160).map(|i| if i % 8 == 0 && (i / 160) % 8 == 0 { 255 } else { 10 }).collect();
        let mut background = Background::default();
        background.measure(&FrameView::packed(&pixels, 160, 160).unwrap(), Brightness::Contrast(20));
        assert!(background.level.iter().all(|&level| level == 10));
    }
}
