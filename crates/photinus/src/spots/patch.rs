//! The pixels around a spot, less their background.
//!
//! In: the frame, a place and a reach. Out: the signal in a square window, in rows of whole lanes so that the sums over it
//! vectorise alike on every machine, and the background with its noise from a frame of pixels around the window.

use alloc::vec::Vec;

use super::ring::{self, Sums};
use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::lanes::{self, LANES, Lanes};

/// Fewer background pixels tell no level.
const FEWEST_PX: i32 = 8;

/// The background around a spot: a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surroundings {
    /// Level in the middle, grey levels.
    pub(super) level: f32,
    /// How it rises along columns and rows, grey levels per px.
    pub(super) slope: [f32; 2],
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
    /// Reads the window of pixels within `reach` of (`u`, `v`), less the background around it.
    pub(super) fn read(
        &mut self,
        frame: &FrameView<'_>,
        (u, v): (i32, i32),
        reach: i32,
        around: &Surroundings,
    ) {
        let middle_v = v;
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
            let [rise_u, rise_v] = around.slope;
            let level = around.level + rise_v * (v - middle_v) as f32;
            let columns = signal[(first - self.left) as usize..].iter_mut().zip(first - u..);
            for ((signal, du), &pixel) in columns.zip(pixels) {
                *signal = f32::from(pixel) - (level + rise_u * du as f32);
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

    /// The signal in a pixel of the image, and the sum of that in the eight around it; what lies outside the patch has none.
    pub(super) fn pixel_and_around(&self, (u, v): (u32, u32)) -> (f32, f32) {
        let at = |du: i32, dv: i32| {
            let (column, row) = (u as i32 + du - self.left, v as i32 + dv - self.top);
            let inside = |at: i32| (0..self.rows as i32).contains(&at);
            if inside(column) && inside(row) {
                self.signal[row as usize * self.stride + column as usize]
            } else {
                0.0
            }
        };
        let all: f32 = (0..9).map(|i| at(i % 3 - 1, i / 3 - 1)).sum();
        (at(0, 0), all - at(0, 0))
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
/// Pixels that are bright themselves (another spot) are left out, and where the rest still spreads (its wings, a streak)
/// those above the mean are left out as well.
pub(super) fn surroundings(
    frame: &FrameView<'_>,
    (u, v): (i32, i32),
    reach: i32,
    bright: u8,
) -> Option<Surroundings> {
    let calm = 3.0 * 3.0;
    let all = ring_sums(frame, (u, v), reach, bright)?;
    let plane = all.plane();
    if plane.variance <= calm {
        return Some(plane);
    }
    let darker = (all.level().min(254.0) as u8) + 1;
    Some(ring_sums(frame, (u, v), reach, darker).unwrap_or(all).even())
}

impl Sums {
    fn level(&self) -> f64 {
        f64::from(self.i) / f64::from(self.count)
    }

    /// The same level everywhere.
    fn even(&self) -> Surroundings {
        let level = self.level();
        let variance = (f64::from(self.ii) / f64::from(self.count) - level * level).max(0.0);
        Surroundings { level: level as f32, slope: [0.0; 2], variance: variance as f32 }
    }

    /// The plane of least squares.
    fn plane(&self) -> Surroundings {
        let n = f64::from(self.count);
        let [x, y, i] = [self.x, self.y, self.i].map(|sum| f64::from(sum) / n);
        let about = |sum: i32, mean: f64| f64::from(sum) / n - mean;
        let (xx, xy, yy) = (about(self.xx, x * x), about(self.xy, x * y), about(self.yy, y * y));
        let (xi, yi, ii) = (about(self.xi, x * i), about(self.yi, y * i), about(self.ii, i * i));
        let determinant = xx * yy - xy * xy;
        // Pixels all in a line, or all on one side, tell of no plane in the middle.
        if determinant <= 1e-3 * xx * yy || x * x > xx || y * y > yy {
            return self.even();
        }
        let (rise_u, rise_v) = ((yy * xi - xy * yi) / determinant, (xx * yi - xy * xi) / determinant);
        Surroundings {
            level: (i - rise_u * x - rise_v * y).clamp(0.0, 255.0) as f32,
            slope: [rise_u as f32, rise_v as f32],
            variance: (ii - rise_u * xi - rise_v * yi).max(0.0) as f32,
        }
    }
}

fn ring_sums(frame: &FrameView<'_>, middle: (i32, i32), reach: i32, below: u8) -> Option<Sums> {
    let sums = ring::sums(frame, middle, reach, below);
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
        assert!((found.level - 20.0).abs() < 1e-6 && found.variance < 1e-6, "{found:?}");
        assert!(found.slope.iter().all(|rise| rise.abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn a_window_over_the_corner_is_dark_outside_the_frame() {
        let pixels = vec![30u8; 20 * 20];
        let frame = FrameView::packed(&pixels, 20, 20).unwrap();
        let mut patch = Patch::default();
        let around = Surroundings { level: 10.0, slope: [0.0; 2], variance: 0.0 };
        patch.read(&frame, (0, 0), 3, &around);
        let total: f32 = patch.signal.iter().sum();
        assert_eq!((patch.left, patch.top, total), (-3, -3, 20.0 * 16.0));
        assert!(surroundings(&frame, (0, 0), 3, 60).is_some());
        assert_eq!(surroundings(&frame, (0, 0), 40, 60), None);
    }

    #[test]
    fn a_slope_is_a_slope_also_beside_the_border() {
        let value = |u: usize, v: usize| (30 + 2 * u + v) as u8;
        let pixels: Vec<u8> = (0..40 * 40).map(|i| value(i % 40, i / 40)).collect();
        let frame = FrameView::packed(&pixels, 40, 40).unwrap();
        for (u, v) in [(20, 20), (5, 20), (20, 35)] {
            let found = surroundings(&frame, (u, v), 5, 255).unwrap();
            assert!((found.level - f32::from(value(u as usize, v as usize))).abs() < 1e-3, "{found:?}");
            assert!((found.slope[0] - 2.0).abs() < 1e-4 && (found.slope[1] - 1.0).abs() < 1e-4, "{found:?}");
            assert!(found.variance < 1e-3);
            let mut patch = Patch::default();
            patch.read(&frame, (u, v), 5, &found);
            assert!(patch.signal.iter().all(|signal| signal.abs() < 1e-2));
        }
    }
}
