//! Bright pixels -> runs: stretches of a row in which every pixel reaches its tile's threshold.
//!
//! In: the frame and the thresholds of its tiles. Out: the runs in raster order. Only tiles that hold a bright pixel are
//! looked at, and of those only the rows that do.

use super::background::{Background, TILE_PX};
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

/// Appends the runs of `frame` in raster order; `bright_tiles` is room for the columns of one row of tiles.
pub(super) fn find(
    frame: &FrameView<'_>,
    background: &Background,
    bright_tiles: &mut Vec<u16>,
    runs: &mut Vec<Run>,
) {
    runs.clear();
    for row in 0..background.rows() {
        let (thresholds, brightest) = background.row(row);
        bright_tiles.clear();
        let is_bright = |&column: &usize| u16::from(brightest[column]) >= thresholds[column];
        bright_tiles.extend((0..background.columns()).filter(is_bright).map(|column| column as u16));
        if bright_tiles.is_empty() {
            continue;
        }
        let top = row * TILE_PX;
        for v in top..(top + TILE_PX).min(frame.height()) {
            let pixels = frame.row(v);
            for &column in bright_tiles.iter() {
                let column = usize::from(column);
                let start = column * TILE_PX;
                let tile = &pixels[start..(start + TILE_PX).min(pixels.len())];
                find_in_tile(tile, thresholds[column] as u8, v as u16, start as u16, runs);
            }
        }
    }
}

/// Appends the runs of one row of one tile; the first joins the run before it where the two touch.
#[inline]
fn find_in_tile(tile: &[u8], threshold: u8, v: u16, start: u16, runs: &mut Vec<Run>) {
    let mut bright = bright_pixels(tile, threshold);
    let mut column = start;
    while bright != 0 {
        let skipped = bright.trailing_zeros() as u16;
        bright >>= skipped;
        let length = bright.trailing_ones() as u16;
        bright >>= length;
        column += skipped;
        match runs.last_mut() {
            Some(last) if last.v == v && last.end == column => last.end += length,
            _ => runs.push(Run { v, start: column, end: column + length }),
        }
        column += length;
    }
}

/// One bit per pixel of a tile's row, the first in the lowest: set where the pixel reaches the threshold.
#[inline]
fn bright_pixels(tile: &[u8], threshold: u8) -> u32 {
    let Ok(tile) = <[u8; TILE_PX]>::try_from(tile) else {
        return tile
            .iter()
            .enumerate()
            .fold(0, |bits, (i, &pixel)| bits | u32::from(pixel >= threshold) << i);
    };
    let (low, high) = tile.split_at(TILE_PX / 2);
    let eight = |pixels: &[u8]| pixels.try_into().map_or(0, |pixels| bright_of_eight(pixels, threshold));
    eight(low) | eight(high) << 8
}

/// The same for eight pixels at once, in one word: a byte's top bit tells whether its subtraction borrowed.
#[inline]
fn bright_of_eight(pixels: [u8; 8], threshold: u8) -> u32 {
    const TOP: u64 = 0x8080_8080_8080_8080;
    let pixels = u64::from_le_bytes(pixels);
    let threshold = u64::from_le_bytes([threshold; 8]);
    let lower_bits_reach = (pixels | TOP) - (threshold & !TOP);
    let reach = (pixels & !threshold) | (!(pixels ^ threshold) & lower_bits_reach);
    (((reach & TOP) >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spots::settings::Brightness;
    use proptest::prelude::*;

    #[test]
    fn eight_pixels_at_once_are_as_one_by_one() {
        for threshold in 0..=255 {
            for value in 0..=255u8 {
                let pixels = std::array::from_fn(|i| value.wrapping_add((i as u8).wrapping_mul(97)));
                let expected = pixels.iter().enumerate().map(|(i, &p)| u32::from(p >= threshold) << i).sum();
                assert_eq!(bright_of_eight(pixels, threshold), expected);
            }
        }
    }

    proptest! {
        #[test]
        fn runs_hold_exactly_the_bright_pixels(
            width in 1usize..60, height in 1usize..40, threshold in 1u8..,
            pixels in prop::collection::vec(any::<u8>(), 60 * 40),
        ) {
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            let mut background = Background::default();
            background.measure(&frame, Brightness::Threshold(threshold));
            let (mut tiles, mut runs) = (Vec::new(), Vec::new());
            find(&frame, &background, &mut tiles, &mut runs);
            let mut covered = vec![0u8; width * height];
            for run in &runs {
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
