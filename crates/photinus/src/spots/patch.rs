//! The pixels around a spot, less their background.
//!
//! In: the frame, a place and a reach. Out: the signal in a square window, in rows of whole lanes so that the sums over it
//! vectorise alike on every machine, and the background with its noise from a frame of pixels around the window.

use alloc::vec::Vec;
use core::ops::Range;

use super::cut_off::CutOff;
use super::hot_pixel::{Lone, Sides};
use super::ring::{self, Sums};
use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::lanes::{self, LANES, Lanes};

/// Fewer background pixels tell no level.
const FEWEST_PX: i32 = 8;

/// A background that spreads by no more than this, or by this many sigmas of the frame's noise, is noise, grey levels.
const CALM_DN: f32 = 3.0;
const CALM_SIGMAS: f32 = 1.25;
/// Noise from which on it matters that darkness is cut off at 0: less hides in the rounding to whole levels.
pub(super) const NOISY_DN: f32 = 2.0;

/// What is known of darkness before a ring is looked at.
pub(super) struct Dark<'a> {
    /// The lowest value that is bright.
    pub(super) bright: u8,
    /// Noise of a dark pixel of the frame, about, grey levels.
    pub(super) noise_dn: f64,
    pub(super) cut_off: &'a CutOff,
}

/// The background around a spot: a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surroundings {
    /// Level in the middle, grey levels.
    pub(super) level: f32,
    /// How it rises along columns and rows, grey levels per px.
    pub(super) slope: [f32; 2],
    /// Variance of a background pixel, grey levels^2.
    pub(super) variance: f32,
    /// Whether noise reaches below 0, where it is cut off.
    pub(super) is_cut_off: bool,
}

/// Signal above the background in a square window; zero outside the frame.
#[derive(Debug, Default)]
pub(super) struct Patch {
    /// First column and row.
    left: i32,
    top: i32,
    rows: usize,
    /// Four columns beside each other from the first row to the last, then the next four.
    signal: Vec<Lanes>,
}

/// As much of four columns of a patch as lies near a place.
pub(super) struct NearColumns<'a> {
    /// Columns and rows from the place to the first pixel.
    pub(super) dx: f32,
    pub(super) dy: f32,
    /// Row by row.
    pub(super) signal: &'a [Lanes],
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
        let side = 2 * reach + 1;
        (self.left, self.top, self.rows) = (u - reach, v - reach, side as usize);
        self.signal.resize(self.rows * self.rows.div_ceil(LANES), Lanes::ZERO);
        let inside = |first: i32, length: usize| first.max(0)..(first + side).min(length as i32);
        let (columns, rows) = (inside(self.left, frame.width()), inside(self.top, frame.height()));
        if columns.is_empty() || rows.is_empty() {
            self.signal.fill(Lanes::ZERO);
            return;
        }
        let (pixels, pitch) = frame.rows_from(rows.start as usize);
        let [above, below] = [rows.start, rows.end].map(|v| (v - self.top) as usize);
        let [rise_u, rise_v] = around.slope;
        for (signal, first) in self.signal.chunks_exact_mut(self.rows).zip((self.left..).step_by(LANES)) {
            signal[..above].fill(Lanes::ZERO);
            signal[below..].fill(Lanes::ZERO);
            let tilt = Lanes::splat(rise_u) * lanes::counting_from((first - u) as f32);
            let level = |dv: i32| Lanes::splat(around.level + rise_v * dv as f32) + tilt;
            let signal = signal[above..below].iter_mut().zip(rows.start - v..);
            if first >= columns.start && first + LANES as i32 <= columns.end {
                let mut rest = &pixels[first as usize..];
                for (signal, dv) in signal {
                    *signal =
                        rest.first_chunk().map_or(Lanes::ZERO, |&four| lanes::of_bytes(four)) - level(dv);
                    rest = rest.get(pitch..).unwrap_or_default();
                }
            } else {
                for ((signal, dv), line) in signal.zip(pixels.chunks(pitch)) {
                    *signal = some_of_four(line, first, &columns, level(dv));
                }
            }
        }
    }

    /// The signal in the square within `radius_px` of a place, as seen from the patch's first pixel, and in what completes four columns.
    pub(super) fn near(&self, (x, y): (f32, f32), radius_px: f32) -> impl Iterator<Item = NearColumns<'_>> {
        // Casts end at 0, where the patch does.
        let within = |at: f32| {
            let end = ((at + radius_px + 1.0) as usize).min(self.rows);
            (((at - radius_px) as usize).min(end), end)
        };
        let ((left, right), (first, end)) = (within(x), within(y));
        (left / LANES..right.div_ceil(LANES)).map(move |four| NearColumns {
            dx: (four * LANES) as f32 - x,
            dy: first as f32 - y,
            signal: &self.signal[four * self.rows..][first..end],
        })
    }

    /// A place in the image as seen from the patch's first pixel.
    pub(super) fn local(&self, place: Pixel) -> (f32, f32) {
        ((place.u - f64::from(self.left)) as f32, (place.v - f64::from(self.top)) as f32)
    }

    /// The signal in a pixel of the image, and that around it; what lies outside the patch has none.
    pub(super) fn lone(&self, (u, v): (u32, u32), sides: Sides) -> Lone {
        let at = |[du, dv]: [i32; 2]| {
            let (column, row) = (u as i32 + du - self.left, v as i32 + dv - self.top);
            let inside = |at: i32| (0..self.rows as i32).contains(&at);
            if inside(column) && inside(row) {
                let (column, row) = (column as usize, row as usize);
                self.signal[column / LANES * self.rows + row].to_array()[column % LANES]
            } else {
                0.0
            }
        };
        Lone { own: at([0, 0]), around: sides.each().map(at).sum(), sides }
    }

    /// Signal within `radius_px` of `centre`, and within a pixel less, grey levels.
    pub(super) fn flux(&self, centre: Pixel, radius_px: f32) -> [f64; 2] {
        let rooms = [radius_px, radius_px - 1.0].map(|radius_px| Lanes::splat(radius_px * radius_px));
        let mut fluxes = [Lanes::default(); 2];
        for near in self.near(self.local(centre), radius_px) {
            let dx = lanes::counting_from(near.dx);
            let across = dx * dx;
            let mut dy = near.dy;
            for &signal in near.signal {
                let away = across + Lanes::splat(dy * dy);
                for (flux, room) in fluxes.iter_mut().zip(rooms) {
                    *flux += signal & away.simd_lt(room);
                }
                dy += 1.0;
            }
        }
        fluxes.map(|flux| f64::from(lanes::sum(flux)))
    }
}

/// Those of four pixels from column `first` of a row on that lie in `columns`, less their level.
fn some_of_four(line: &[u8], first: i32, columns: &Range<i32>, level: Lanes) -> Lanes {
    let level = level.to_array();
    Lanes::new(core::array::from_fn(|lane| {
        let column = first + lane as i32;
        if columns.contains(&column) { f32::from(line[column as usize]) - level[lane] } else { 0.0 }
    }))
}

/// The background from a ring of pixels just outside the window of `reach` around (`u`, `v`).
///
/// Pixels that are bright themselves (another spot) are left out, and where the rest still spreads (its wings, a streak)
/// those above the mean are left out as well. What the frame's noise explains is no wing.
pub(super) fn surroundings(
    frame: &FrameView<'_>,
    (u, v): (i32, i32),
    reach: i32,
    dark: &Dark<'_>,
) -> Option<Surroundings> {
    let noise_dn = dark.noise_dn as f32;
    let is_noisy = noise_dn >= NOISY_DN;
    let calm_dn = if is_noisy { CALM_DN.max(CALM_SIGMAS * noise_dn) } else { CALM_DN };
    let all = ring_sums(frame, (u, v), reach, dark.bright)?;
    if is_noisy
        && let Some((level, variance)) = dark.cut_off.darkness(all.level(), all.square())
        && variance <= calm_dn * calm_dn
    {
        return Some(Surroundings { level, slope: [0.0; 2], variance, is_cut_off: true });
    }
    let plane = all.plane();
    if plane.variance <= calm_dn * calm_dn {
        return Some(plane);
    }
    let darker = (all.level().min(254.0) as u8) + 1;
    let even = ring_sums(frame, (u, v), reach, darker).unwrap_or(all).even();
    let least = if is_noisy { noise_dn * noise_dn } else { 0.0 };
    Some(Surroundings { variance: even.variance.max(least), ..even })
}

impl Sums {
    fn level(&self) -> f64 {
        f64::from(self.i) / f64::from(self.count)
    }

    /// The mean square.
    fn square(&self) -> f64 {
        f64::from(self.ii) / f64::from(self.count)
    }

    /// The same level everywhere.
    fn even(&self) -> Surroundings {
        let level = self.level();
        let variance = (self.square() - level * level).max(0.0);
        Surroundings { level: level as f32, slope: [0.0; 2], variance: variance as f32, is_cut_off: false }
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
            is_cut_off: false,
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

    fn quiet(bright: u8, cut_off: &CutOff) -> Dark<'_> {
        Dark { bright, noise_dn: 0.5, cut_off }
    }

    #[test]
    fn the_background_is_that_of_the_dark_pixels_around() {
        let mut pixels = vec![20u8; 40 * 40];
        pixels[20 * 40 + 20] = 250;
        pixels[12 * 40 + 20] = 250;
        let frame = FrameView::packed(&pixels, 40, 40).unwrap();
        let found = surroundings(&frame, (20, 20), 6, &quiet(60, &CutOff::default())).unwrap();
        assert!((found.level - 20.0).abs() < 1e-6 && found.variance < 1e-6, "{found:?}");
        assert!(found.slope.iter().all(|rise| rise.abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn a_window_over_the_corner_is_dark_outside_the_frame() {
        let pixels = vec![30u8; 20 * 20];
        let frame = FrameView::packed(&pixels, 20, 20).unwrap();
        let mut patch = Patch::default();
        let around = Surroundings { level: 10.0, slope: [0.0; 2], variance: 0.0, is_cut_off: false };
        patch.read(&frame, (0, 0), 3, &around);
        let total: f32 = patch.signal.iter().flat_map(|four| four.to_array()).sum();
        assert_eq!((patch.left, patch.top, total), (-3, -3, 20.0 * 16.0));
        let cut_off = CutOff::default();
        assert!(surroundings(&frame, (0, 0), 3, &quiet(60, &cut_off)).is_some());
        assert_eq!(surroundings(&frame, (0, 0), 40, &quiet(60, &cut_off)), None);
    }

    #[test]
    fn a_slope_is_a_slope_also_beside_the_border() {
        let value = |u: usize, v: usize| (30 + 2 * u + v) as u8;
        let pixels: Vec<u8> = (0..40 * 40).map(|i| value(i % 40, i / 40)).collect();
        let frame = FrameView::packed(&pixels, 40, 40).unwrap();
        for (u, v) in [(20, 20), (5, 20), (20, 35)] {
            let found = surroundings(&frame, (u, v), 5, &quiet(255, &CutOff::default())).unwrap();
            assert!((found.level - f32::from(value(u as usize, v as usize))).abs() < 1e-3, "{found:?}");
            assert!((found.slope[0] - 2.0).abs() < 1e-4 && (found.slope[1] - 1.0).abs() < 1e-4, "{found:?}");
            assert!(found.variance < 1e-3);
            let mut patch = Patch::default();
            patch.read(&frame, (u, v), 5, &found);
            assert!(patch.signal.iter().flat_map(|four| four.to_array()).all(|signal| signal.abs() < 1e-2));
        }
    }
}
