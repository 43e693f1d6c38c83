//! Hot pixels: those that stand out of the pixels around them whatever passes, and give the eight around them nothing.
//!
//! An LED that stands still stands out as well, but its light spreads: the point spread says how much of it the eight around get at least.
//! What is too faint for that difference to show is not listed.

use photinus::frame::Mask;
use photinus::optics::{HotPixel, Measured};

use super::dark_frame::DarkFrame;

/// A pixel is looked at from so many sigmas of all pixels on, and so many grey levels.
const STANDS_OUT_SIGMAS: f64 = 6.0;
const LEAST_DN: f64 = 3.0;
/// The sum of the eight around differs from that beside an LED by so many sigmas.
const TELLS_SIGMAS: f64 = 5.0;
/// A value farther off the median than so many sigmas is light that passes.
const PASSING_SIGMAS: f64 = 4.0;
/// Share of its light that the eight around an LED's brightest pixel get through any lens: less is none.
const LEAST_AROUND: f64 = 0.02;

/// A pixel that stands out in the median of frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) pixel: HotPixel,
    /// What the eight around have more than those farther off, together, grey levels, and its sigma.
    around: Measured,
}

impl Candidate {
    /// Whether it is no LED behind a lens that gives the eight around at least this share of the light in the middle one.
    pub(super) fn is_hot(&self, around_over_own: f64) -> bool {
        let expected = around_over_own.max(LEAST_AROUND) * self.pixel.level_dn.value;
        let Measured { value, sigma } = self.around;
        expected - value > TELLS_SIGMAS * sigma && value < 0.5 * expected
    }
}

/// Pixels that stand out in the median; none where the mask ignores them or one beside.
pub(super) fn candidates(dark: &DarkFrame<'_>, mask: Option<&Mask>) -> Vec<Candidate> {
    let scatter_dn = scatter(dark);
    let least_dn = (STANDS_OUT_SIGMAS * scatter_dn).max(LEAST_DN);
    let mut found = Vec::new();
    for row in 2..dark.height.saturating_sub(2) {
        for column in 2..dark.width.saturating_sub(2) {
            let own = f64::from(dark.levels[row * dark.width + column]);
            let is_seen = || {
                let near = (0..9).map(|at| (column + at % 3 - 1, row + at / 3 - 1));
                mask.is_none_or(|mask| near.into_iter().all(|(column, row)| !mask.ignores(column, row)))
            };
            // the ring is dear, and no pixel that is not above its neighbours by that much stands out of it
            let index = row * dark.width + column;
            let beside = f64::from(dark.levels[index - 2].min(dark.levels[index + 2]));
            if own - beside >= 0.5 * least_dn && own - ring(dark, column, row) >= least_dn && is_seen() {
                found.push(measure(dark, column, row, scatter_dn));
            }
        }
    }
    found
}

/// The sixteen pixels two columns or rows away, of the twenty-five around a pixel.
fn far() -> impl Iterator<Item = usize> {
    (0..25_usize).filter(|at| (at % 5).abs_diff(2).max((at / 5).abs_diff(2)) == 2)
}

/// Median of the sixteen pixels two columns or rows away.
fn ring(dark: &DarkFrame<'_>, column: usize, row: usize) -> f64 {
    let mut values: Vec<u8> =
        far().map(|at| dark.levels[(row + at / 5 - 2) * dark.width + column + at % 5 - 2]).collect();
    values.sort_unstable();
    0.5 * (f64::from(values[7]) + f64::from(values[8]))
}

/// Level of a pixel, and what is around it, with how far both scatter from frame to frame and from pixel to pixel.
fn measure(dark: &DarkFrame<'_>, column: usize, row: usize, scatter_dn: f64) -> Candidate {
    let near = |at: usize| (column + at % 3 - 1, row + at / 3 - 1);
    let ground = far().map(|at| mean(dark, column + at % 5 - 2, row + at / 5 - 2).value);
    let ground = ground.sum::<f64>() / 16.0;
    let (mut around, mut variance) = (0.0, 0.0);
    for (column, row) in (0..9).filter(|at| *at != 4).map(near) {
        let pixel = mean(dark, column, row);
        around += pixel.value - ground;
        variance += pixel.sigma * pixel.sigma + scatter_dn * scatter_dn;
    }
    let own = mean(dark, column, row);
    // the ring differs from what the pixel would read as pixels do
    let unlike = scatter_dn * (1.0 + 1.0 / 16.0_f64).sqrt();
    Candidate {
        pixel: HotPixel {
            column: column as u32,
            row: row as u32,
            level_dn: Measured {
                value: (own.value - ground).clamp(0.0, 255.0),
                sigma: libm::hypot(own.sigma, unlike),
            },
        },
        around: Measured { value: around, sigma: (variance + 4.0 * scatter_dn * scatter_dn).sqrt() },
    }
}

/// Mean of a pixel over the frames in which no light passes it.
fn mean(dark: &DarkFrame<'_>, column: usize, row: usize) -> Measured {
    let off: Vec<f64> = dark.frames.iter().map(|frame| dark.excess(frame, column, row)).collect();
    let mut far: Vec<f64> = off.iter().map(|off| off.abs()).collect();
    far.sort_by(f64::total_cmp);
    let most = PASSING_SIGMAS * (1.5 * far[far.len() / 2]).max(1.0);
    let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
    for off in off.iter().filter(|off| off.abs() <= most) {
        (count, sum, square) = (count + 1.0, sum + off, square + off * off);
    }
    let mean = sum / count;
    // what is rounded to one level all the time is somewhere within it
    let variance = f64::max(square / count - mean * mean, 1.0 / 12.0);
    let level = f64::from(dark.levels[row * dark.width + column]);
    Measured { value: level + mean, sigma: (variance / (count - 1.0)).sqrt() }
}

/// How far pixels differ from the median of their rings, as the middle two thirds have it, by more than rounding.
fn scatter(dark: &DarkFrame<'_>) -> f64 {
    let mut off = Vec::new();
    let step = (dark.width * dark.height / 4000).max(1);
    for index in (0..dark.width * dark.height).step_by(step) {
        let (column, row) = (index % dark.width, index / dark.width);
        let inside = |at: usize, length: usize| at >= 2 && at + 2 < length;
        if inside(column, dark.width) && inside(row, dark.height) {
            off.push(mean(dark, column, row).value - ring(dark, column, row));
        }
    }
    off.sort_by(f64::total_cmp);
    let quantile = |share: f64| off.get((off.len() as f64 * share) as usize).copied().unwrap_or(0.0);
    0.5 * (quantile(0.84) - quantile(0.16))
}
