//! The pixels around a spot, less their background.
//!
//! In: the frame, a place and a reach. Out: the signal in a square window, in rows of whole lanes so that the sums over it
//! vectorise alike on every machine, and the background with its noise from a frame of pixels around the window.

use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::lanes::{self, LANES, Lanes};

/// Width of the ring of background pixels, px.
const RING_PX: i32 = 2;

/// Fewer background pixels tell no level.
const FEWEST_PX: u32 = 8;

/// The level around a spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surroundings {
    /// Mean level, grey levels.
    pub(super) level: f32,
    /// Variance of a background pixel, grey levels^2.
    pub(super) variance: f32,
}

/// Signal above the background in a square window; zero outside the frame.
#[derive(Debug, Default)]
pub(super) struct Patch {
    /// First column and row.
    left: i32,
    top: i32,
    rows: usize,
    stride: usize,
    signal: Vec<f32>,
}

impl Patch {
    /// Reads the window of pixels within `reach` of (`u`, `v`).
    pub(super) fn read(&mut self, frame: &FrameView<'_>, (u, v): (i32, i32), reach: i32, level: f32) {
        (self.left, self.top) = (u - reach, v - reach);
        self.rows = (2 * reach + 1) as usize;
        self.stride = self.rows.next_multiple_of(LANES);
        self.signal.clear();
        self.signal.resize(self.rows * self.stride, 0.0);
        let first = self.left.max(0);
        let end = (self.left + self.rows as i32).min(frame.width() as i32);
        for (signal, v) in self.signal.chunks_exact_mut(self.stride).zip(self.top..) {
            if v < 0 || v >= frame.height() as i32 || first >= end {
                continue;
            }
            let pixels = &frame.row(v as usize)[first as usize..end as usize];
            for (signal, &pixel) in signal[(first - self.left) as usize..].iter_mut().zip(pixels) {
                *signal = f32::from(pixel) - level;
            }
        }
    }

    /// The signal in columns `column` to `column` + 3, from the first row to the last.
    pub(super) fn columns(&self, column: usize) -> impl Iterator<Item = Lanes> {
        self.signal.chunks_exact(self.stride).map(move |row| {
            let four = row[column..].first_chunk::<LANES>();
            four.map_or(Lanes::default(), |&four| Lanes::new(four))
        })
    }

    /// Where the first of each four columns lies.
    pub(super) fn column_starts(&self) -> impl Iterator<Item = usize> {
        (0..self.stride).step_by(LANES)
    }

    /// A place in the image as seen from the patch's first pixel.
    pub(super) fn local(&self, place: Pixel) -> (f32, f32) {
        ((place.u - f64::from(self.left)) as f32, (place.v - f64::from(self.top)) as f32)
    }

    /// Signal within `radius_px` of `centre`, grey levels.
    pub(super) fn flux(&self, centre: Pixel, radius_px: f32) -> f64 {
        let (x, y) = self.local(centre);
        let room = Lanes::splat(radius_px * radius_px);
        let mut flux = Lanes::default();
        for column in self.column_starts() {
            let dx = lanes::counting_from(column as f32 - x);
            let across = dx * dx;
            let mut dy = -y;
            for signal in self.columns(column) {
                flux += signal * lanes::less(across + Lanes::splat(dy * dy), room);
                dy += 1.0;
            }
        }
        f64::from(lanes::sum(flux))
    }
}

/// The background from a ring of pixels just outside the window of `reach` around (`u`, `v`).
///
/// Pixels that are bright themselves (another spot) are left out, and where the rest still spreads (its skirt, a streak)
/// those above the mean are left out as well.
pub(super) fn surroundings(
    frame: &FrameView<'_>,
    (u, v): (i32, i32),
    reach: i32,
    bright: u8,
) -> Option<Surroundings> {
    let calm = 3.0;
    let all = ring_sums(frame, (u, v), reach, bright);
    let ring = all.filter(|ring| ring.variance() <= calm * calm);
    let ring = ring.or_else(|| ring_sums(frame, (u, v), reach, all?.mean().min(254.0) as u8 + 1))?;
    Some(Surroundings { level: ring.mean(), variance: ring.variance() })
}

#[derive(Clone, Copy, Default)]
struct Sums {
    count: u32,
    sum: u32,
    squares: u32,
}

impl Sums {
    fn mean(&self) -> f32 {
        self.sum as f32 / self.count as f32
    }

    fn variance(&self) -> f32 {
        let mean = f64::from(self.sum) / f64::from(self.count);
        (f64::from(self.squares) / f64::from(self.count) - mean * mean).max(0.0) as f32
    }

    fn add(&mut self, pixels: &[u8], below: u8) {
        for &pixel in pixels {
            let dark = u32::from(pixel < below);
            let pixel = u32::from(pixel) * dark;
            self.count += dark;
            self.sum += pixel;
            self.squares += pixel * pixel;
        }
    }
}

fn ring_sums(frame: &FrameView<'_>, (u, v): (i32, i32), reach: i32, below: u8) -> Option<Sums> {
    let (width, height) = (frame.width() as i32, frame.height() as i32);
    let outer = reach + RING_PX;
    let columns = |from: i32, to: i32| from.clamp(0, width) as usize..(to + 1).clamp(0, width) as usize;
    let mut sums = Sums::default();
    for row in (v - outer).max(0)..=(v + outer).min(height - 1) {
        let pixels = frame.row(row as usize);
        if (row - v).abs() > reach {
            sums.add(&pixels[columns(u - outer, u + outer)], below);
        } else {
            sums.add(&pixels[columns(u - outer, u - reach - 1)], below);
            sums.add(&pixels[columns(u + reach + 1, u + outer)], below);
        }
    }
    (sums.count >= FEWEST_PX).then_some(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_background_is_that_of_the_dark_pixels_around() {
        let mut pixels = vec![20u8; 40 * 40];
        pixels[20 * 40 + 20] = 250;
        pixels[12 * 40 + 20] = 250;
        let frame = FrameView::packed(&pixels, 40, 40).unwrap();
        let found = surroundings(&frame, (20, 20), 6, 60).unwrap();
        assert_eq!(found, Surroundings { level: 20.0, variance: 0.0 });
    }

    #[test]
    fn a_window_over_the_corner_is_dark_outside_the_frame() {
        let pixels = vec![30u8; 20 * 20];
        let frame = FrameView::packed(&pixels, 20, 20).unwrap();
        let mut patch = Patch::default();
        patch.read(&frame, (0, 0), 3, 10.0);
        let total: f32 = patch.signal.iter().sum();
        assert_eq!((patch.left, patch.top, total), (-3, -3, 20.0 * 16.0));
        assert!(surroundings(&frame, (0, 0), 3, 60).is_some());
        assert_eq!(surroundings(&frame, (0, 0), 40, 60), None);
    }
}
