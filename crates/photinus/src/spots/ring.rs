//! Sums over the dark pixels of a ring: how many, where they lie, how bright they are.
//!
//! In: the frame and a square window in it. Out: the sums over the pixels around the window that are not bright themselves,
//! of which a plane of background is made. They are whole numbers, the same in any order: sixteen pixels of a row are added up
//! lane by lane, and lanes only once, at the end.

use wide::{i16x8, i32x4, u8x16};

use crate::frame::FrameView;

/// Width of a ring, px.
const RING_PX: i32 = 2;
/// Pixels added at once at each end of a row.
const HALF: i32 = 8;
/// Sums of a lane over rings up to so far from the middle fit into sixteen bits, px.
const WIDEST_PX: i32 = 63;

/// Sums over pixels, x and y from the middle of the ring, i their value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    pub(super) count: i32,
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) xx: i32,
    pub(super) xy: i32,
    pub(super) yy: i32,
    pub(super) i: i32,
    pub(super) xi: i32,
    pub(super) yi: i32,
    pub(super) ii: i32,
}

/// Pixels of a whole ring around a window of this reach.
pub(super) fn ring_pixels(reach: i32) -> f64 {
    let side = |reach: i32| f64::from(2 * reach + 1);
    side(reach + RING_PX) * side(reach + RING_PX) - side(reach) * side(reach)
}

/// The sums over the pixels that are less than `below` and lie in the frame, just outside the window of `reach` around (`u`, `v`).
///
/// Beside the window only columns near the ends of a row count: eight at each end are looked at together, and what lies between them in the
/// rows above and below the window by itself.
pub(super) fn sums(frame: &FrameView<'_>, (u, v): (i32, i32), reach: i32, below: u8) -> Sums {
    let outer = reach + RING_PX;
    if outer > WIDEST_PX {
        return pixel_by_pixel(frame, (u, v), reach, below);
    }
    // Columns of the ring that lie in the frame.
    let (from, to) = ((-outer).max(-u), outer.min(frame.width() as i32 - 1 - u));
    let rows = (-outer).max(-v)..=outer.min(frame.height() as i32 - 1 - v);
    let mut sums = Sums::default();
    // A short row's ends overlap: the second begins where the first ends.
    let ends = [-outer, (outer - HALF + 1).max(-outer + HALF)];
    let (above, beside) =
        (mask(ends, |x| from <= x && x <= to), mask(ends, |x| from <= x && x <= to && x.abs() > reach));
    let middle = Middle { frame, u, v, below };
    middle.add(ends, rows.clone().map(|y| (y, if y.abs() > reach { above } else { beside })), &mut sums);
    for first in (ends[0] + HALF..ends[1]).step_by(2 * HALF as usize) {
        let halves = [first, first + HALF];
        let counts = mask(halves, |x| from <= x && x <= to && x < ends[1]);
        let rows = rows.clone().filter(|y| y.abs() > reach).map(|y| (y, counts));
        middle.add(halves, rows, &mut sums);
    }
    sums
}

/// Where a ring lies, and which of its pixels are dark.
struct Middle<'a> {
    frame: &'a FrameView<'a>,
    u: i32,
    v: i32,
    below: u8,
}

impl Middle<'_> {
    /// Adds the pixels of rows of eight columns from each of two on, as far as they count.
    #[inline(always)]
    fn add(&self, halves: [i32; 2], rows: impl Iterator<Item = (i32, u8x16)>, sums: &mut Sums) {
        let mut lanes = LaneSums::default();
        let columns = halves.map(|first| usize::try_from(self.u + first).ok());
        let (pixels, pitch) = self.frame.rows_from(0);
        match columns {
            [Some(left), Some(right)] if right + HALF as usize <= self.frame.width() => {
                for (y, counts) in rows {
                    let row = &pixels[(self.v + y) as usize * pitch..];
                    let eight = |first: usize| row[first..].first_chunk().copied().unwrap_or_default();
                    lanes.add([eight(left), eight(right)], counts, self.below, y as i16);
                }
            }
            _ => {
                for (y, counts) in rows {
                    let row = self.frame.row((self.v + y) as usize);
                    lanes.add(halves.map(|first| eight(row, self.u + first)), counts, self.below, y as i16);
                }
            }
        }
        lanes.add_up(halves, sums);
    }
}

/// Which of eight columns from each of two on count.
#[inline(always)]
fn mask(halves: [i32; 2], counts: impl Fn(i32) -> bool) -> u8x16 {
    u8x16::new(core::array::from_fn(|lane| {
        let x = halves[lane / HALF as usize] + lane as i32 % HALF;
        if counts(x) { u8::MAX } else { 0 }
    }))
}

/// Eight pixels of a row from a column on, 0 outside the row.
fn eight(row: &[u8], first: i32) -> [u8; HALF as usize] {
    let pixel = |i: usize| usize::try_from(first + i as i32).ok().and_then(|u| row.get(u));
    core::array::from_fn(|i| pixel(i).copied().unwrap_or(0))
}

/// Sums of each of sixteen columns, in two halves, and of what needs no column.
#[derive(Default)]
struct LaneSums {
    count: [i16x8; 2],
    y: [i16x8; 2],
    i: [i16x8; 2],
    yy: i32x4,
    yi: i32x4,
    ii: i32x4,
}

impl LaneSums {
    /// Adds those of two times eight pixels of row `y` that count and are less than `below`.
    #[inline(always)]
    fn add(&mut self, [low, high]: [[u8; HALF as usize]; 2], counts: u8x16, below: u8, y: i16) {
        let mut pixels = [0; 2 * HALF as usize];
        pixels[..HALF as usize].copy_from_slice(&low);
        pixels[HALF as usize..].copy_from_slice(&high);
        let pixels = u8x16::new(pixels);
        let dark = counts & !pixels.max(u8x16::splat(below)).simd_eq(pixels);
        let (one, value) = (dark & u8x16::ONE, dark & pixels);
        let ones = [i16x8::from_u8x16_low(one), i16x8::from_u8x16_high(one)];
        let values = [i16x8::from_u8x16_low(value), i16x8::from_u8x16_high(value)];
        let (y, square) = (i16x8::splat(y), i16x8::splat(y * y));
        for half in 0..2 {
            self.count[half] += ones[half];
            self.y[half] += ones[half] * y;
            self.i[half] += values[half];
            self.ii += values[half].dot(values[half]);
        }
        self.yy += (ones[0] + ones[1]).dot(square);
        self.yi += (values[0] + values[1]).dot(y);
    }

    /// Adds the lanes, whose halves begin in these columns, to `sums`.
    fn add_up(&self, first: [i32; 2], sums: &mut Sums) {
        let columns = first.map(|x| i16x8::new(core::array::from_fn(|lane| x as i16 + lane as i16)));
        let times = |lanes: &[i16x8; 2], by: &[i16x8; 2]| total(lanes[0].dot(by[0]) + lanes[1].dot(by[1]));
        let ones = [i16x8::ONE; 2];
        let by_column = [self.count[0] * columns[0], self.count[1] * columns[1]];
        sums.count += times(&self.count, &ones);
        sums.x += times(&by_column, &ones);
        sums.xx += times(&by_column, &columns);
        sums.y += times(&self.y, &ones);
        sums.xy += times(&self.y, &columns);
        sums.i += times(&self.i, &ones);
        sums.xi += times(&self.i, &columns);
        sums.yy += total(self.yy);
        sums.yi += total(self.yi);
        sums.ii += total(self.ii);
    }
}

fn total(lanes: i32x4) -> i32 {
    lanes.to_array().into_iter().sum()
}

/// The same, pixel by pixel.
fn pixel_by_pixel(frame: &FrameView<'_>, (u, v): (i32, i32), reach: i32, below: u8) -> Sums {
    let outer = reach + RING_PX;
    let mut sums = Sums::default();
    for y in (-outer).max(-v)..=outer.min(frame.height() as i32 - 1 - v) {
        let row = frame.row((v + y) as usize);
        for x in (-outer).max(-u)..=outer.min(frame.width() as i32 - 1 - u) {
            let i = row[(u + x) as usize];
            if i < below && x.abs().max(y.abs()) > reach {
                let i = i32::from(i);
                sums.count += 1;
                sums.x += x;
                sums.y += y;
                sums.xx += x * x;
                sums.xy += x * y;
                sums.yy += y * y;
                sums.i += i;
                sums.xi += x * i;
                sums.yi += y * i;
                sums.ii += i * i;
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sums_are_those_pixel_by_pixel(
            width in 1usize..150, height in 1usize..150, places in prop::collection::vec((0.0..1.0, 0.0..1.0), 1..4),
            reach in 0..WIDEST_PX + 5, seed in 0u64.., below in 0u8.., calm in 0u32..8,
        ) {
            let value = |i: u64| (seed.wrapping_add(i).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56) as u8 >> calm;
            let pixels: Vec<u8> = (0..(width * height) as u64).map(value).collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            for (u, v) in places {
                let middle = ((u * width as f64) as i32, (v * height as f64) as i32);
                for below in [below, u8::MAX] {
                    prop_assert_eq!(sums(&frame, middle, reach, below), pixel_by_pixel(&frame, middle, reach, below));
                }
            }
        }
    }
}
