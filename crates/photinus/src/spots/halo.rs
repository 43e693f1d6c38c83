//! Where the light of a narrow core in a wide halo fell: a model of both, fitted to the pixels.
//!
//! In: the signal around a spot and a first guess of its centre. Out: the centre with its covariance. What a lens makes of
//! a far LED is a core narrower than a pixel or about as wide, in a halo of scattered light:
//!
//! ```text
//! I(u, v) = A X(u) Y(v) + B exp(-r^2 / 2 h^2) + C + D exp(-q^2 / 2 h^2),
//! X(u) = Phi((u + 1/2 - x) / s) - Phi((u - 1/2 - x) / s),   Y likewise,
//! ```
//!
//! with the core integrated over each pixel, so that the grid does not pull, r from the centre and q from that of a spot
//! beside, whose halo is as wide. Eight numbers (x, y, A, ln s, B, ln h, C, D) by least squares with weight 1 / var(I), in a
//! few steps of Gauss and Newton. Widths are known to a factor before a pixel is seen: where a faint spot tells nothing of
//! them, the covariance of the centre says what that costs. The residuals tell the noise of the pixels. Those at the
//! saturation say nothing and are left out.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use super::centroid::PixelVariance;
use super::patch::Patch;
use super::skirt::Fit;
use crate::camera::Pixel;
use crate::lanes::{self, LANES, Lanes};

/// Unknowns, in this order.
const UNKNOWNS: usize = 8;
const X: usize = 0;
const Y: usize = 1;
const CORE: usize = 2;
const LN_CORE: usize = 3;
const HALO: usize = 4;
const LN_HALO: usize = 5;
const LEVEL: usize = 6;
const BESIDE: usize = 7;
/// Widest window, columns and rows: a spot that needs more is no narrow one.
const MOST_PX: usize = 16;
/// Pixels needed: twice the unknowns.
const FEWEST_PX: f32 = 14.0;

/// Sigma of a core whose lens is as sharp as its pixels, and of the halo around it, px.
const CORE_PX: f64 = 0.35;
const HALO_PX: f64 = 2.3;
/// How far these are known before a pixel is seen: sigma of their logarithms.
const CORE_KNOWN: f64 = 0.4;
const HALO_KNOWN: f64 = 0.4;
/// How far the level of the background is known, grey levels.
const LEVEL_KNOWN_DN: f64 = 3.0;

/// Steps of Gauss and Newton: from a tenth of a pixel to less than a thousandth.
const STEPS: usize = 4;
/// Longest step of the centre, px, and of the logarithm of a width.
const LONGEST_STEP: f64 = 0.4;
/// A step shorter than this is the last, px: what is left is a tenth of it.
const DONE_PX: f64 = 0.02;
/// ... if it changes the light of the core by less than this share.
const DONE_SHARE: f64 = 0.02;
/// A last step longer than this has not settled, px.
const SETTLED_PX: f64 = 0.05;

/// Where to look.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess {
    pub(super) centre: Pixel,
    /// Light of core and halo, grey levels.
    pub(super) flux: f64,
    /// Centre of a spot beside, whose halo reaches into the window.
    pub(super) beside: Option<Pixel>,
}

/// Core and halo as fitted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    pub(super) fit: Fit,
    /// Light of the core, grey levels.
    pub(super) light: f64,
    /// Sigma of the core, px.
    pub(super) width_px: f64,
}

/// Fits core and halo within `radius_px` of the guess to the pixels below `saturation`; `None` where they do not settle on
/// an answer.
pub(super) fn fit(
    patch: &Patch,
    guess: &Guess,
    radius_px: f32,
    saturation: f32,
    variance: PixelVariance,
) -> Option<Core> {
    let &Guess { centre: guess, flux, beside } = guess;
    if !patch.fits_in(MOST_PX) {
        return None;
    }
    let (x, y) = patch.local(guess);
    let window =
        Window { x, y, radius_px, saturation, variance, beside: beside.map(|place| patch.local(place)) };
    let (ln_core, ln_halo) = (libm::log(CORE_PX), libm::log(HALO_PX));
    let halo = 0.5 * flux / (std::f64::consts::TAU * HALO_PX * HALO_PX);
    let mut shape = SVector::from([f64::from(x), f64::from(y), 0.5 * flux, ln_core, halo, ln_halo, 0.0, 0.0]);
    let known =
        [(LN_CORE, ln_core, CORE_KNOWN), (LN_HALO, ln_halo, HALO_KNOWN), (LEVEL, 0.0, LEVEL_KNOWN_DN)];
    let solve = |sums: &Sums, shape: &SVector<f64, UNKNOWNS>, noise: f64| {
        let (mut matrix, mut right) = sums.normal(noise);
        for (number, mean, sigma) in known {
            matrix[(number, number)] += 1.0 / (sigma * sigma);
            right[number] += (mean - shape[number]) / (sigma * sigma);
        }
        if beside.is_none() {
            matrix[(BESIDE, BESIDE)] = 1.0;
        }
        matrix.cholesky().map(|factor| (factor.solve(&right), factor))
    };
    let (mut step_px, mut last) = (f64::INFINITY, None);
    for _ in 0..STEPS {
        let sums = sums(patch, &shape, &window);
        let (mut step, _) = solve(&sums, &shape, 1.0)?;
        for number in [X, Y, LN_CORE, LN_HALO] {
            step[number] = step[number].clamp(-LONGEST_STEP, LONGEST_STEP);
        }
        let before = shape;
        shape += step;
        // No core: it would take light away.
        if shape[CORE] <= 0.0 {
            return None;
        }
        step_px = libm::hypot(step[X], step[Y]);
        last = Some((before, sums));
        let is_done = step_px < DONE_PX && step[CORE].abs() < DONE_SHARE * before[CORE];
        if is_done {
            break;
        }
    }
    let (before, sums) = last?;
    let off = Vector2::new(shape[X] - f64::from(x), shape[Y] - f64::from(y));
    let settled = step_px < SETTLED_PX && off.norm() < f64::from(radius_px) / 2.0;
    if !(settled && sums.pixels >= FEWEST_PX) {
        return None;
    }
    // What the residuals say of the noise widens what pixels tell, not what is known without them; two less for the mean of
    // Student's squares.
    let misfit = sums.squares() / f64::from(sums.pixels - UNKNOWNS as f32 - 2.0);
    let (_, factor) = solve(&sums, &before, misfit)?;
    let axes = SMatrix::<f64, UNKNOWNS, 2>::identity();
    let covariance_px2: Matrix2<f64> = factor.solve(&axes).fixed_view::<2, 2>(0, 0).into_owned();
    let centre = Pixel::new(guess.u + off.x, guess.v + off.y);
    Some(Core {
        fit: Fit { centre, covariance_px2, misfit },
        light: shape[CORE],
        width_px: libm::exp(shape[LN_CORE]),
    })
}

/// Which pixels count, and their noise.
struct Window {
    x: f32,
    y: f32,
    radius_px: f32,
    saturation: f32,
    variance: PixelVariance,
    beside: Option<(f32, f32)>,
}

/// Sums of the products of slopes and residual, the residual last.
struct Sums {
    products: [[f32; UNKNOWNS + 1]; UNKNOWNS + 1],
    pixels: f32,
}

impl Sums {
    /// The normal equations where the variance of pixels is `noise` times what was taken.
    fn normal(&self, noise: f64) -> (SMatrix<f64, UNKNOWNS, UNKNOWNS>, SVector<f64, UNKNOWNS>) {
        let product = |row: usize, column: usize| f64::from(self.products[row][column]) / noise;
        (SMatrix::from_fn(product), SVector::from_fn(|row, _| product(row, UNKNOWNS)))
    }

    fn squares(&self) -> f64 {
        f64::from(self.products[UNKNOWNS][UNKNOWNS])
    }
}

/// The profile of core and halo along a line of pixels.
#[derive(Default)]
struct Profile {
    /// Share of the core in each pixel, and how it changes with the centre and with the logarithm of the width.
    core: [f32; MOST_PX],
    by_place: [f32; MOST_PX],
    by_width: [f32; MOST_PX],
    /// The halo over its summit, and how far the pixel is from the centre in sigmas of the halo.
    halo: [f32; MOST_PX],
    off: [f32; MOST_PX],
    /// The halo of the spot beside over its summit.
    beside: [f32; MOST_PX],
}

impl Profile {
    fn new(centre: f32, core_px: f32, halo_px: f32, beside: Option<f32>) -> Self {
        const ROOT_TAU: f32 = 2.506_628_3;
        let mut profile = Self::default();
        // Of the edges between pixels: how much lies below, the density there, and that times the sigmas off.
        let [mut below, mut density, mut moment] = [[0.0; MOST_PX + LANES]; 3];
        for at in (0..=MOST_PX).step_by(LANES) {
            let t =
                (lanes::counting_from(at as f32 - 0.5) - Lanes::splat(centre)) * Lanes::splat(1.0 / core_px);
            let bell = bell(t) * Lanes::splat(1.0 / ROOT_TAU);
            below[at..at + LANES].copy_from_slice(&lanes::normal_below(t, bell).to_array());
            density[at..at + LANES].copy_from_slice(&bell.to_array());
            moment[at..at + LANES].copy_from_slice(&(bell * t).to_array());
        }
        for i in 0..MOST_PX {
            profile.core[i] = below[i + 1] - below[i];
            profile.by_place[i] = (density[i] - density[i + 1]) / core_px;
            profile.by_width[i] = moment[i] - moment[i + 1];
        }
        for at in (0..MOST_PX).step_by(LANES) {
            let off = (lanes::counting_from(at as f32) - Lanes::splat(centre)) * Lanes::splat(1.0 / halo_px);
            let halo = bell(off);
            profile.halo[at..at + LANES].copy_from_slice(&halo.to_array());
            profile.off[at..at + LANES].copy_from_slice(&off.to_array());
            if let Some(beside) = beside {
                let off =
                    (lanes::counting_from(at as f32) - Lanes::splat(beside)) * Lanes::splat(1.0 / halo_px);
                profile.beside[at..at + LANES].copy_from_slice(&bell(off).to_array());
            }
        }
        profile
    }
}

/// exp(-t^2 / 2), zero past six sigma: products of numbers that small leave the normal range, where arithmetic is slow.
fn bell(t: Lanes) -> Lanes {
    let square = t * t;
    lanes::exp(square * Lanes::splat(-0.5)) * lanes::less(square, Lanes::splat(36.0))
}

fn four(line: &[f32; MOST_PX], at: usize) -> Lanes {
    line[at..].first_chunk::<LANES>().map_or(Lanes::default(), |&four| Lanes::new(four))
}

fn sums(patch: &Patch, shape: &SVector<f64, UNKNOWNS>, window: &Window) -> Sums {
    let (core_px, halo_px) = (libm::exp(shape[LN_CORE]) as f32, libm::exp(shape[LN_HALO]) as f32);
    let across = Profile::new(shape[X] as f32, core_px, halo_px, window.beside.map(|place| place.0));
    let down = Profile::new(shape[Y] as f32, core_px, halo_px, window.beside.map(|place| place.1));
    let [core, halo, level, beside, inverse_px] =
        [shape[CORE], shape[HALO], shape[LEVEL], shape[BESIDE], 1.0 / f64::from(halo_px)]
            .map(|number| Lanes::splat(number as f32));
    let (dark, shot) = (Lanes::splat(window.variance.dark), Lanes::splat(window.variance.shot));
    let saturation = Lanes::splat(window.saturation);
    let mut pixels = Lanes::default();
    // Slopes and residual of every four pixels, times the root of their weight.
    let mut rows = [[[Lanes::default(); 3]; 3]; MOST_PX * MOST_PX / LANES];
    let mut count = 0;
    let reach = window.radius_px as usize + 1;
    let (first, last) = ((window.y as usize).saturating_sub(reach), window.y as usize + reach + 1);
    for column in patch.column_starts() {
        let dx = lanes::counting_from(column as f32 - window.x);
        let near = dx * dx;
        let (core_x, place_x) = (four(&across.core, column), four(&across.by_place, column));
        let (width_x, halo_x) = (four(&across.by_width, column), four(&across.halo, column));
        let (off_x, beside_x) = (four(&across.off, column), four(&across.beside, column));
        for (row, signal) in patch.columns(column).enumerate().take(last + 1).skip(first) {
            let dy = row as f32 - window.y;
            let room = Lanes::splat(window.radius_px * window.radius_px - dy * dy);
            let shows = lanes::less(near, room) * lanes::less(signal, saturation);
            if shows == Lanes::ZERO {
                continue;
            }
            let line = |line: &[f32; MOST_PX]| Lanes::splat(line[row]);
            let (core_y, place_y, width_y) = (line(&down.core), line(&down.by_place), line(&down.by_width));
            let (unit_core, unit_halo) = (core_x * core_y, halo_x * line(&down.halo));
            let (scattered, off_y) = (halo * unit_halo, line(&down.off));
            let unit_beside = beside_x * line(&down.beside);
            let root = (shows / (dark + shot * lanes::positive(signal))).sqrt();
            rows[count] = [
                [
                    root * (core * place_x * core_y + scattered * off_x * inverse_px),
                    root * (core * core_x * place_y + scattered * off_y * inverse_px),
                    root * unit_core,
                ],
                [
                    root * (core * (width_x * core_y + core_x * width_y)),
                    root * unit_halo,
                    root * (scattered * (off_x * off_x + off_y * off_y)),
                ],
                [
                    root,
                    root * unit_beside,
                    root * (signal - (core * unit_core + scattered + level + beside * unit_beside)),
                ],
            ];
            count += 1;
            pixels += shows;
        }
    }
    let mut products = [[0.0; UNKNOWNS + 1]; UNKNOWNS + 1];
    // Three by three stay in registers; the rest is its mirror image.
    for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
        let mut sums = [[Lanes::default(); 3]; 3];
        for row in &rows[..count] {
            let (a, b) = (row[i], row[j]);
            for (sums, a) in sums.iter_mut().zip(a) {
                for (sum, b) in sums.iter_mut().zip(b) {
                    *sum += a * b;
                }
            }
        }
        for (a, sums) in sums.iter().enumerate() {
            for (b, &sum) in sums.iter().enumerate() {
                products[3 * i + a][3 * j + b] = lanes::sum(sum);
                products[3 * j + b][3 * i + a] = products[3 * i + a][3 * j + b];
            }
        }
    }
    Sums { products, pixels: lanes::sum(pixels) }
}

#[cfg(test)]
mod tests {
    use super::super::patch::Surroundings;
    use super::*;
    use crate::frame::FrameView;

    const SIDE: usize = 17;

    /// Share of a Gaussian in a pixel.
    fn share(pixel: usize, centre: f64, sigma_px: f64) -> f64 {
        let below = |edge: f64| 0.5 * libm::erfc((centre - edge) / (sigma_px * std::f64::consts::SQRT_2));
        below(pixel as f64 + 0.5) - below(pixel as f64 - 0.5)
    }

    /// A core with a halo as bright, of 2.2 px, integrated over pixels and rounded.
    fn pixels(centre: Pixel, core_px: f64, light: f64) -> Vec<u8> {
        let value = |i: usize| {
            let part =
                |sigma_px: f64| share(i % SIDE, centre.u, sigma_px) * share(i / SIDE, centre.v, sigma_px);
            (5.0 + light / 2.0 * (part(core_px) + part(2.2))).round().min(255.0) as u8
        };
        (0..SIDE * SIDE).map(value).collect()
    }

    #[test]
    fn the_grid_does_not_pull_and_a_saturated_pixel_is_not_missed() {
        let variance = PixelVariance { dark: 1.0 / 12.0, shot: 0.0 };
        let around = Surroundings { level: 5.0, slope: [0.0; 2], variance: 0.0 };
        let mut worst_px = 0.0_f64;
        for (core_px, light) in [(0.3, 400.0), (0.3, 1500.0), (0.4, 400.0), (0.4, 1500.0)] {
            for step in 0..11 {
                let truth = Pixel::new(7.5 + f64::from(step) / 10.0, 8.0 + 0.37 * f64::from(step) / 10.0);
                let pixels = pixels(truth, core_px, light);
                let frame = FrameView::packed(&pixels, SIDE, SIDE).unwrap();
                let mut patch = Patch::default();
                patch.read(&frame, (8, 8), 6, &around);
                // About as far off as the middle of a part's light.
                let centre = Pixel::new(truth.u + 0.15, truth.v - 0.15);
                let guess = Guess { centre, flux: light, beside: None };
                let found = fit(&patch, &guess, 5.0, 249.5, variance).unwrap();
                let off_px = libm::hypot(found.fit.centre.u - truth.u, found.fit.centre.v - truth.v);
                worst_px = worst_px.max(off_px);
            }
        }
        assert!(worst_px < 0.03, "{worst_px} px");
    }
}
