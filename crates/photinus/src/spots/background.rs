//! What is bright: a threshold for every tile of the frame.
//!
//! In: the frame. Out: for every tile of 16 x 16 pixels the lowest value that counts as bright, and whether any pixel of
//! the tile reaches it, so that dark tiles, nearly all of them, are never looked at again.
//!
//! With a contrast the level of a tile's surroundings is the median over 5 x 5 tiles (rows of columns) of each tile's
//! darkest pixel. A marker raises the darkest pixel of no tile, so dense markers leave it alone; the sun covers less
//! than half of 80 x 80 pixels, so it stays the bright thing there. What noise adds is measured from the spread that
//! three quarters of all tiles exceed, each without its brightest columns, so that even a marker in every tile does not
//! count as noise.

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
    tiles_by_spread: Vec<u32>,
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
        self.tiles_by_spread.clear();
        self.tiles_by_spread.resize(256, 0);
        match brightness {
            Brightness::Threshold(level) => {
                self.summarise::<false>(frame);
                self.threshold.fill(u16::from(level));
                self.level.fill(0);
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

    /// The level around the tile of column `u` and row `v`; 0 where the threshold is a fixed one.
    pub(super) fn level(&self, u: usize, v: usize) -> u8 {
        self.level[v / TILE_PX * self.columns + u / TILE_PX]
    }

    /// The lowest bright value of each tile in a row of tiles (past 255 nothing is), and the tile's brightest pixel.
    pub(super) fn row(&self, row: usize) -> (&[u16], &[u8]) {
        let tiles = row * self.columns..(row + 1) * self.columns;
        (&self.threshold[tiles.clone()], &self.brightest[tiles])
    }

    /// The brightest pixel of every tile and, if asked for, the darkest and the spread of the whole tiles.
    fn summarise<const DARKEST: bool>(&mut self, frame: &FrameView<'_>) {
        let tile_rows = self.brightest.chunks_exact_mut(self.columns);
        for ((row, brightest), darkest) in
            tile_rows.enumerate().zip(self.darkest.chunks_exact_mut(self.columns))
        {
            let top = row * TILE_PX;
            let bottom = (top + TILE_PX).min(frame.height());
            let whole = frame.width() / TILE_PX;
            let band: [&[u8]; TILE_PX] = std::array::from_fn(|v| frame.row((top + v).min(bottom - 1)));
            // A tile cut by the frame reaches back inside: a marker would fill a narrow one.
            let inside = bottom.saturating_sub(TILE_PX);
            let thin: [&[u8]; TILE_PX / ROWS_PER_DARKEST] =
                std::array::from_fn(|v| frame.row((inside + v * ROWS_PER_DARKEST).min(bottom - 1)));
            for column in 0..whole {
                let columns = column * TILE_PX..(column + 1) * TILE_PX;
                let mut high = [0u8; TILE_PX];
                for pixels in &band {
                    for (high, &pixel) in high.iter_mut().zip(&pixels[columns.clone()]) {
                        *high = (*high).max(pixel);
                    }
                }
                brightest[column] = high.into_iter().fold(0, u8::max);
                if DARKEST {
                    let mut low = [u8::MAX; TILE_PX];
                    for pixels in &thin {
                        for (low, &pixel) in low.iter_mut().zip(&pixels[columns.clone()]) {
                            *low = (*low).min(pixel);
                        }
                    }
                    darkest[column] = low.into_iter().fold(u8::MAX, u8::min);
                    let spread = spread(high, darkest[column]);
                    self.tiles_by_spread[usize::from(spread)] += 1;
                }
            }
            if whole < self.columns {
                let rest = |pixels: &[u8]| pixels[whole * TILE_PX..].iter().copied().fold(0, u8::max);
                brightest[whole] = band.iter().map(|pixels| rest(pixels)).fold(0, u8::max);
                let inside = frame.width().saturating_sub(TILE_PX);
                let last = thin.iter().flat_map(|pixels| &pixels[inside..]);
                darkest[whole] = last.copied().fold(u8::MAX, u8::min);
            }
        }
    }

    /// The contrast, or more where the frame's own noise would reach it.
    ///
    /// The spread of a tile of Gaussian noise is about 3.6 sigma, 2.4 of it below the mean.
    fn step_above_noise(&self, step: u8) -> u8 {
        let quarter = self.tiles_by_spread.iter().sum::<u32>() / 4;
        let mut below = 0;
        let spread = self.tiles_by_spread.iter().position(|&tiles| {
            below += tiles;
            below > quarter
        });
        let spread = spread.unwrap_or(0);
        (usize::from(step) + spread * 3 / 4).max(spread * 5 / 2).min(255) as u8
    }

    /// The median over five rows of the medians over five columns.
    fn level_of_surroundings(&mut self) {
        let (columns, rows) = (self.columns, self.rows);
        for row in 0..rows {
            let near = near(row, rows).map(|row| &self.darkest[row * columns..][..columns]);
            median_of_five(near, &mut self.scratch[row * columns..][..columns]);
        }
        for (medians, level) in self.scratch.chunks_exact(columns).zip(self.level.chunks_exact_mut(columns)) {
            let inner = columns.saturating_sub(4);
            if inner > 0 {
                let near: [&[u8]; 5] = std::array::from_fn(|offset| &medians[offset..][..inner]);
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
        let (right, bottom) = (self.columns - 1, self.rows - 1);
        let at = |column: usize, row: usize| row * self.columns + column;
        for (column, row) in [(0, 0), (right, 0), (0, bottom), (right, bottom)] {
            let beside = self.level[at(column.abs_diff(1).min(right), row)];
            let above = self.level[at(column, row.abs_diff(1).min(bottom))];
            let level = &mut self.level[at(column, row)];
            *level = beside.max(above).min(*level);
        }
    }
}

/// Five neighbours of `at` among `count`, itself in the middle; the last repeat past the ends.
fn near(at: usize, count: usize) -> [usize; 5] {
    std::array::from_fn(|offset| (at + offset).saturating_sub(2).min(count - 1))
}

/// How far a tile's noise spreads; more where the darkest pixel is at the sensor's floor, which hides the lower half.
#[inline]
fn spread(columns: [u8; TILE_PX], darkest: u8) -> u8 {
    let spread = brightest_without_markers(columns).saturating_sub(darkest);
    if darkest > 0 { spread } else { spread.saturating_add(spread / 3) }
}

/// From the highest pixel of each column: the lowest of every fourth column, and of those four the second lowest. One marker
/// up to 12 px wide, or narrow ones in every other column, leave it as it was.
#[inline]
fn brightest_without_markers(columns: [u8; TILE_PX]) -> u8 {
    let eight: [u8; 8] = std::array::from_fn(|i| columns[i].min(columns[i + 8]));
    let [a, b, c, d] = std::array::from_fn(|i| eight[i].min(eight[i + 4]));
    a.max(b).min(c.max(d)).min(a.min(b).max(c.min(d)))
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
    fn a_marker_in_every_tile_is_no_noise() {
        let pixels: Vec<u8> =
            (0..160 * 160).map(|i| if i % 16 < 5 && (i / 160) % 16 < 5 { 255 } else { 10 }).collect();
        let mut background = Background::default();
        background.measure(&FrameView::packed(&pixels, 160, 160).unwrap(), Brightness::Contrast(20));
        assert!(background.threshold.iter().all(|&threshold| threshold == 30));
    }

    #[test]
    fn what_fills_a_corner_is_not_its_own_surroundings() {
        for (width, height, side) in [(98, 66, 2), (96, 64, 20)] {
            let pixels: Vec<u8> = (0..width * height)
                .map(|i| if i % width >= width - side && i / width >= height - side { 255 } else { 10 })
                .collect();
            let mut background = Background::default();
            background.measure(&FrameView::packed(&pixels, width, height).unwrap(), Brightness::Contrast(20));
            assert!(background.threshold.iter().all(|&threshold| threshold == 30), "{side} px");
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
