//! Bright pixels -> runs: stretches of a row in which every pixel reaches its tile's threshold.
//!
//! In: the frame and the thresholds of its tiles. Out: the runs in raster order. Only tiles that hold a bright pixel are
//! looked at, tile by tile, and of those only the rows that do are gone through pixel by pixel.

use alloc::vec::Vec;

use wide::u8x16;

use super::background::Background;
use super::tiles::TILE_PX;
use crate::frame::FrameView;

/// Bright pixels of row `v` from column `start` up to, not including, column `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) v: u16,
    pub(super) start: u16,
    pub(super) end: u16,
}

impl Run {
    /// How many pixels.
    pub(super) fn len(&self) -> u32 {
        u32::from(self.end - self.start)
    }

    /// Its pixels.
    pub(super) fn pixels<'a>(&self, frame: &FrameView<'a>) -> &'a [u8] {
        &frame.row(usize::from(self.v))[usize::from(self.start)..usize::from(self.end)]
    }
}

/// One row of one tile.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Its first column.
    start: u16,
    /// A bit per pixel, the first in the lowest: set where it is bright.
    bright: u16,
}

/// The runs of one frame, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Runs {
    /// The bright pieces of each row of a band of tiles, from left to right.
    rows: [Vec<Piece>; TILE_PX],
    runs: Vec<Run>,
}

impl Runs {
    /// Finds the runs of `frame`, in raster order.
    pub(super) fn find(&mut self, frame: &FrameView<'_>, background: &Background) -> &[Run] {
        self.runs.clear();
        for band in 0..background.rows() {
            let top = band * TILE_PX;
            let mut is_bright = false;
            for tile in background.bright_tiles(band) {
                self.look_into(frame, background, tile * TILE_PX, top);
                is_bright = true;
            }
            if is_bright {
                self.join(top);
            }
        }
        &self.runs
    }

    /// Takes in the bright rows of the tile whose first pixel is (`left`, `top`).
    fn look_into(&mut self, frame: &FrameView<'_>, background: &Background, left: usize, top: usize) {
        let threshold = u8x16::splat(background.threshold(left, top) as u8);
        let (pixels, stride) = frame.rows_from(top);
        // Past the end of a row lie other pixels, or none.
        let own = u32::MAX >> (32 - (frame.width() - left).min(TILE_PX));
        let lines = pixels[left..].chunks(stride).take(frame.height() - top);
        for (row, line) in self.rows.iter_mut().zip(lines) {
            let tile = line.first_chunk().copied().unwrap_or_else(|| {
                let pixel = |i: usize| line.get(i).copied().unwrap_or(0);
                core::array::from_fn(pixel)
            });
            let tile = u8x16::new(tile);
            let bright = tile.max(threshold).simd_eq(tile).to_bitmask() & own;
            if bright != 0 {
                row.push(Piece { start: left as u16, bright: bright as u16 });
            }
        }
    }

    /// Appends the runs of a band; two that touch across the border of tiles are one.
    fn join(&mut self, top: usize) {
        for (row, v) in self.rows.iter_mut().zip(top as u16..) {
            for Piece { start, bright } in row.drain(..) {
                let (mut column, mut bright) = (start, u32::from(bright));
                while bright != 0 {
                    let skipped = bright.trailing_zeros() as u16;
                    bright >>= skipped;
                    let length = bright.trailing_ones() as u16;
                    bright >>= length;
                    column += skipped;
                    match self.runs.last_mut() {
                        Some(last) if last.v == v && last.end == column => last.end += length,
                        _ => self.runs.push(Run { v, start: column, end: column + length }),
                    }
                    column += length;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spots::settings::Brightness;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_hold_exactly_the_bright_pixels(
            width in 1usize..60, height in 1usize..40, threshold in 1u8..,
            pixels in prop::collection::vec(any::<u8>(), 60 * 40),
        ) {
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            let mut background = Background::default();
            background.measure(&frame, Brightness::Threshold(threshold));
            let mut runs = Runs::default();
            let runs = runs.find(&frame, &background);
            let mut covered = vec![0u8; width * height];
            for run in runs {
                for u in run.start..run.end {
                    covered[usize::from(run.v) * width + usize::from(u)] += 1;
                }
            }
            for (i, &times) in covered.iter().enumerate() {
                prop_assert_eq!(times, u8::from(pixels[i] >= threshold));
            }
            prop_assert!(runs.is_sorted_by_key(|run| (run.v, run.start)));
            prop_assert!(runs.windows(2).all(|two| two[0].v != two[1].v || two[0].end < two[1].start));
        }
    }
}
