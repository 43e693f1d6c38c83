//! A frame -> what each of its tiles holds: the brightest pixel, the darkest one, how far its noise spreads.
//!
//! In: the frame. Out: bytes, one per tile of 16 x 16 pixels. Every pixel is read once: of the sixteen rows of a band the
//! extremes are taken side by side, so that sixteen columns stay sixteen lanes of a register, and only then are the lanes of
//! sixteen tiles folded, all at once. That costs what reading the frame costs.

use alloc::vec::Vec;

use wide::u8x16;

use crate::frame::FrameView;

/// Side of a tile, px, and tiles in a block: a row of a tile fills a register, and so does a byte for each tile of a block.
pub(super) const TILE_PX: usize = 16;

/// Rows of a tile that its darkest pixel is taken from: every fourth is enough for a level.
const ROWS_PER_DARKEST: usize = 4;

/// A byte for each of sixteen tiles beside each other.
pub(super) type Block = [u8; TILE_PX];

/// What the tiles of one frame hold, and the room to find it in. Rows of tiles end with a whole block; where that reaches
/// past the frame its tiles are dark.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Blocks per row of tiles.
    pub(super) blocks: usize,
    pub(super) brightest: Vec<Block>,
    /// From every fourth row. A tile cut by the frame reaches back inside: a marker would fill a narrow one.
    pub(super) darkest: Vec<Block>,
    /// How far the noise of a tile spreads; 255 where the frame cuts its columns: too few tell of no noise.
    pub(super) spread: Vec<Block>,
    /// How many tiles tell of noise: those whose columns the frame does not cut.
    pub(super) telling: usize,
    /// The extremes of each column of a band of tiles.
    high: Vec<u8x16>,
    low: Vec<u8x16>,
}

impl Tiles {
    /// Goes through `frame`; the darkest pixels and the spreads are left as they were unless asked for.
    pub(super) fn summarise<const DARKEST: bool>(&mut self, frame: &FrameView<'_>) {
        self.make_room(frame);
        let whole = frame.width() / TILE_PX;
        for row in 0..self.rows {
            let (top, bottom) = (row * TILE_PX, ((row + 1) * TILE_PX).min(frame.height()));
            let (high, low) = (&mut self.high[..self.columns], &mut self.low[..self.columns]);
            if bottom - top == TILE_PX {
                band_extremes::<DARKEST>(frame, top, high, low);
            } else {
                let inside = bottom.saturating_sub(TILE_PX);
                let thin = (0..TILE_PX).step_by(ROWS_PER_DARKEST).map(|v| (inside + v).min(bottom - 1));
                row_by_row(thin.map(|v| frame.row(v)), low, u8x16::min);
                row_by_row((top..bottom).map(|v| frame.row(v)), high, u8x16::max);
            }
            if let Some(cut) = high.get_mut(whole) {
                *cut &= last_of_tile(frame.width());
            }
            let blocks = row * self.blocks..(row + 1) * self.blocks;
            for (block, high) in blocks.clone().zip(self.high.as_chunks::<TILE_PX>().0) {
                self.brightest[block] = fold(*high, u8x16::max).to_array();
            }
            if DARKEST {
                let columns =
                    self.high.as_chunks::<TILE_PX>().0.iter().zip(self.low.as_chunks::<TILE_PX>().0);
                for (block, (high, low)) in blocks.clone().zip(columns) {
                    let darkest = fold(*low, u8x16::min);
                    self.darkest[block] = darkest.to_array();
                    self.spread[block] = spread(*high, darkest);
                }
                self.spread[blocks].as_flattened_mut()[whole..].fill(u8::MAX);
            }
        }
    }

    fn make_room(&mut self, frame: &FrameView<'_>) {
        self.columns = frame.width().div_ceil(TILE_PX);
        self.rows = frame.height().div_ceil(TILE_PX);
        self.blocks = self.columns.div_ceil(TILE_PX);
        self.telling = frame.width() / TILE_PX * self.rows;
        for room in [&mut self.brightest, &mut self.darkest, &mut self.spread] {
            room.resize(self.blocks * self.rows, Block::default());
        }
        for room in [&mut self.high, &mut self.low] {
            room.clear();
            room.resize(self.blocks * TILE_PX, u8x16::ZERO);
        }
    }
}

/// The highest pixel of each column of sixteen rows and, if asked for, the lowest of every fourth row; a register per tile.
fn band_extremes<const LOW: bool>(frame: &FrameView<'_>, top: usize, high: &mut [u8x16], low: &mut [u8x16]) {
    let whole = frame.width() / TILE_PX;
    let (pixels, stride) = frame.rows_from(top);
    whole_tiles::<LOW>(pixels, stride, &mut high[..whole], &mut low[..whole]);
    if whole < high.len() {
        high[whole] = highest(|v| last_columns(frame.row(top + v)));
        low[whole] = lowest(|v| last_columns(frame.row(top + v)));
    }
}

/// The same for as many tiles as there is room for. Nothing but the walk: the rows as multiples of one stride from one place
/// take few registers, so that a row costs two instructions.
#[inline(never)]
fn whole_tiles<const LOW: bool>(pixels: &[u8], stride: usize, high: &mut [u8x16], low: &mut [u8x16]) {
    let tiles = high.len();
    let rows: [&[Block]; TILE_PX] =
        core::array::from_fn(|v| &pixels[v * stride..][..tiles * TILE_PX].as_chunks().0[..tiles]);
    for (tile, (high, low)) in high.iter_mut().zip(&mut low[..tiles]).enumerate() {
        *high = highest(|v| u8x16::new(rows[v][tile]));
        if LOW {
            *low = lowest(|v| u8x16::new(rows[v][tile]));
        }
    }
}

#[inline(always)]
fn highest(row: impl Fn(usize) -> u8x16) -> u8x16 {
    (1..TILE_PX).fold(row(0), |high, v| high.max(row(v)))
}

#[inline(always)]
fn lowest(row: impl Fn(usize) -> u8x16) -> u8x16 {
    (ROWS_PER_DARKEST..TILE_PX).step_by(ROWS_PER_DARKEST).fold(row(0), |low, v| low.min(row(v)))
}

/// The extremes of the columns of any rows, for a band that the frame cuts.
fn row_by_row<'a>(
    rows: impl Iterator<Item = &'a [u8]>,
    extremes: &mut [u8x16],
    with: impl Fn(u8x16, u8x16) -> u8x16,
) {
    for (v, row) in rows.enumerate() {
        let tiles = row.as_chunks().0.iter().map(|&tile| u8x16::new(tile));
        for (extreme, tile) in extremes.iter_mut().zip(tiles.chain([last_columns(row)])) {
            *extreme = if v == 0 { tile } else { with(*extreme, tile) };
        }
    }
}

/// The last sixteen pixels of a row, the last one repeated where there are fewer.
#[inline(always)]
fn last_columns(row: &[u8]) -> u8x16 {
    let last = row.last_chunk().copied();
    u8x16::new(last.unwrap_or_else(|| core::array::from_fn(|i| row[i.min(row.len() - 1)])))
}

/// Which of the last sixteen pixels of rows this long belong to the tile that the end of the row cuts.
fn last_of_tile(width: usize) -> u8x16 {
    let is_own = |i: usize| width < TILE_PX || i + width % TILE_PX >= TILE_PX;
    u8x16::new(core::array::from_fn(|i| if is_own(i) { u8::MAX } else { 0 }))
}

/// Folds the sixteen columns of each of sixteen tiles: to a byte per tile, in their order.
#[inline(always)]
fn fold(mut tiles: [u8x16; TILE_PX], with: impl Fn(u8x16, u8x16) -> u8x16) -> u8x16 {
    fold_once::<8>(&mut tiles, &with);
    fold_once::<4>(&mut tiles, &with);
    fold_once::<2>(&mut tiles, &with);
    fold_once::<1>(&mut tiles, &with);
    tiles[0]
}

/// Folds the second half of the columns onto the first and halves the registers: twice as many tiles in each, whose columns
/// lie beside each other.
#[inline(always)]
fn fold_once<const HALF: usize>(tiles: &mut [u8x16; TILE_PX], with: impl Fn(u8x16, u8x16) -> u8x16) {
    for i in 0..HALF {
        let (a, b) = (tiles[i], tiles[i + HALF]);
        tiles[i] = with(u8x16::unpack_low(a, b), u8x16::unpack_high(a, b));
    }
}

/// How far the noise of sixteen tiles spreads; more where the darkest pixel is at the sensor's floor, which hides the lower
/// half.
#[inline(always)]
fn spread(columns: [u8x16; TILE_PX], darkest: u8x16) -> Block {
    let spread = brightest_without_markers(columns).saturating_sub(darkest).to_array();
    let darkest = darkest.to_array();
    core::array::from_fn(|i| spread[i].saturating_add(if darkest[i] > 0 { 0 } else { spread[i] / 3 }))
}

/// From the highest pixel of each column: the lowest of every fourth column, and of those four the second lowest. One marker
/// up to 12 px wide, or narrow ones in every other column, leave it as it was.
#[inline(always)]
fn brightest_without_markers(mut tiles: [u8x16; TILE_PX]) -> u8x16 {
    fold_once::<8>(&mut tiles, u8x16::min);
    fold_once::<4>(&mut tiles, u8x16::min);
    // Each register holds four tiles by four columns: to a register per column.
    let [even, odd] = [(tiles[0], tiles[2]), (tiles[1], tiles[3])];
    let [ab, cd] =
        [u8x16::unpack_low, u8x16::unpack_high].map(|half| (half(even.0, even.1), half(odd.0, odd.1)));
    let [a, c] = [ab, cd].map(|(even, odd)| u8x16::unpack_low(even, odd));
    let [b, d] = [ab, cd].map(|(even, odd)| u8x16::unpack_high(even, odd));
    a.max(b).min(c.max(d)).min(a.min(b).max(c.min(d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What a tile holds, pixel by pixel.
    fn plainly(frame: &FrameView<'_>, column: usize, row: usize) -> (u8, u8, u8) {
        let ([left, top], [width, height]) =
            ([column, row].map(|i| i * TILE_PX), [frame.width(), frame.height()]);
        let [right, bottom] = [(left, width), (top, height)].map(|(at, end)| (at + TILE_PX).min(end));
        let value = |u: usize, v: usize| frame.row(v)[u];
        let brightest = (top..bottom).flat_map(|v| (left..right).map(move |u| value(u, v))).max().unwrap();
        let [left_inside, top_inside] = [right, bottom].map(|end| end.saturating_sub(TILE_PX));
        let thin = (0..4).map(|fourth| (top_inside + 4 * fourth).min(bottom - 1));
        let darkest = thin.flat_map(|v| (left_inside..right).map(move |u| value(u, v))).min().unwrap();
        if right - left < TILE_PX {
            return (brightest, darkest, u8::MAX);
        }
        let high = |u: usize| (top..bottom).map(|v| value(left + u, v)).max().unwrap();
        let mut fourths: Vec<u8> = (0..4).map(|u| (u..16).step_by(4).map(high).min().unwrap()).collect();
        fourths.sort_unstable();
        let spread = fourths[1].saturating_sub(darkest);
        (brightest, darkest, if darkest > 0 { spread } else { spread.saturating_add(spread / 3) })
    }

    proptest! {
        #[test]
        fn tiles_hold_what_is_found_pixel_by_pixel(
            width in 1usize..300, height in 1usize..50, seed in 0u64.., calm in 0u32..4, floor in 0u8..40,
        ) {
            let value = |i: usize| {
                let dice = seed.wrapping_add(i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                ((dice ^ dice >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 56 >> calm) as u8
            };
            let pixels: Vec<u8> = (0..width * height).map(|i| value(i).saturating_sub(floor)).collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            let mut tiles = Tiles::default();
            tiles.summarise::<true>(&frame);
            let mut bright = Tiles::default();
            bright.summarise::<false>(&frame);
            prop_assert_eq!(&bright.brightest, &tiles.brightest);
            for row in 0..tiles.rows {
                for column in 0..tiles.blocks * TILE_PX {
                    let at = row * tiles.blocks * TILE_PX + column;
                    let [brightest, darkest, spread] =
                        [&tiles.brightest, &tiles.darkest, &tiles.spread].map(|room| room.as_flattened()[at]);
                    if column < tiles.columns {
                        prop_assert_eq!((brightest, darkest, spread), plainly(&frame, column, row));
                    } else {
                        prop_assert_eq!((brightest, spread), (0, u8::MAX));
                    }
                }
            }
        }
    }
}
