//! Which pixels are higher than those around them: sixteen of a row at once.

use wide::u8x16;

use crate::frame::FrameView;

/// Pixels looked at together.
pub(super) const LANES: usize = 16;

/// Of sixteen pixels of row `v` from column `u` on, a bit for each that is as high as its neighbours and higher than those
/// before it in raster order: a single summit, also a plateau without dents, has one such pixel.
pub(super) fn find(frame: &FrameView<'_>, u: usize, v: usize) -> u32 {
    let row = |v: usize| if v < frame.height() { beside(frame.row(v), u) } else { [u8x16::ZERO; 3] };
    let [left, here, right] = row(v);
    let [above, below] =
        [v.wrapping_sub(1), v + 1].map(row).map(|[left, here, right]| left.max(here).max(right));
    let (before, after) = (above.max(left), below.max(right));
    (!before.max(here).simd_eq(before) & after.max(here).simd_eq(here)).to_bitmask()
}

/// Sixteen pixels of a row from the one left of column `u` on, from `u` on, and from the one right of it on; 0 outside.
#[inline(always)]
fn beside(row: &[u8], u: usize) -> [u8x16; 3] {
    let sixteen = |pixels: &[u8]| pixels.first_chunk().map_or(u8x16::ZERO, |&pixels| u8x16::new(pixels));
    if let Some(pixels) = u.checked_sub(1).and_then(|left| row[left..].first_chunk::<{ LANES + 2 }>()) {
        return [sixteen(pixels), sixteen(&pixels[1..]), sixteen(&pixels[2..])];
    }
    let pixel = |u: usize| u.checked_sub(1).and_then(|u| row.get(u)).copied().unwrap_or(0);
    [0, 1, 2].map(|from| u8x16::new(core::array::from_fn(|i| pixel(u + from + i))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The obviously right version: a pixel beside those before and after it in raster order.
    fn is_summit(frame: &FrameView<'_>, u: usize, v: usize) -> bool {
        let value = |du: i32, dv: i32| {
            let (u, v) = (u as i32 + du, v as i32 + dv);
            let inside = u >= 0 && v >= 0 && u < frame.width() as i32 && v < frame.height() as i32;
            if inside { frame.row(v as usize)[u as usize] } else { 0 }
        };
        let own = value(0, 0);
        let is_before = |&(du, dv): &(i32, i32)| dv < 0 || (dv == 0 && du < 0);
        let around = (-1..=1).flat_map(|dv| (-1..=1).map(move |du| (du, dv))).filter(|&off| off != (0, 0));
        let (before, after): (Vec<_>, Vec<_>) = around.partition(is_before);
        before.iter().all(|off| own > value(off.0, off.1))
            && after.iter().all(|off| own >= value(off.0, off.1))
    }

    proptest! {
        #[test]
        fn summits_are_those_found_pixel_by_pixel(
            width in 1usize..60, height in 1usize..12, levels in 1u8..6, step in 1u8..40,
            pixels in prop::collection::vec(any::<u8>(), 60 * 12),
        ) {
            let pixels: Vec<u8> = pixels[..width * height].iter().map(|p| 1 + p % levels * step).collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            for v in 0..height {
                for u in 0..width {
                    let own = u - u % 7;
                    let found = find(&frame, own, v) >> (u - own) & 1 == 1;
                    prop_assert_eq!(found, is_summit(&frame, u, v), "{} {}", u, v);
                }
            }
        }
    }
}
