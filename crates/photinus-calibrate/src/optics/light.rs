//! Noise against light: what fits leave of pixels, squared, explained by darkness, light, and the error of the point spread.
//!
//! A table follows the noise of the pixels that it is made of, so that they are left with too little. A table of other spots follows none
//! of it, but is wrong by its own noise, so that they are left with too much. What two such tables leave, made of spots that are neither each
//! other's nor those told, multiplied, is what there is: the noise of three has nothing in common. Where belief holds both tables back from
//! the lens alike, their error stays, as it should: so much of it has the table of all spots, at most.

use nalgebra::{SMatrix, SVector};
use photinus::optics::Measured;

use super::field::Field;
use super::noise::{Noise, ROUNDING};
use super::spot::{Pixel, Spot};
use super::table::Shares;

/// A pixel of a spot: its light and what is left of it, squared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual {
    pub(super) light: f64,
    pub(super) square: f64,
    /// What it is on average, by darkness, shot noise and the square of the table's error.
    row: SVector<f64, 3>,
    /// Which tenth of the spots it is of.
    part: usize,
}

impl Residual {
    /// The square that it would have if no fit had taken anything, of noise as told.
    pub(super) fn put_back(&self, noise: &Noise) -> f64 {
        self.square * noise.variance(self.light) / self.row.dot(&noise.terms())
    }
}

/// Noise with how sure it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightNoise {
    pub(super) noise: Noise,
    /// Standard deviations of darkness, shot and shape (that of its square over twice itself).
    pub(super) dark_sigma: f64,
    pub(super) shot_sigma: f64,
    pub(super) shape_sigma: f64,
    /// Whether shot noise is told, better than it is believed; otherwise the error of the shape explains the rest.
    pub(super) is_shot_seen: bool,
}

impl LightNoise {
    /// Whether the error of the shape is told: neither chance nor a few spots make it.
    pub(super) fn tells_shape(&self) -> bool {
        self.shape_sigma < TOLD_SHAPE || self.shape_sigma < 0.5 * self.noise.shape
    }
}

/// An error of the shape that is known to this is told, as a share of the light in a pixel.
const TOLD_SHAPE: f64 = 0.05;
/// What is believed of the shot noise of a sensor that nobody measured, grey levels^2 per grey level.
pub(super) const SHOT_BELIEVED: Measured = Measured { value: 0.03, sigma: 0.03 };
/// No sensor has less than this of it, grey levels^2 per grey level.
const LEAST_SHOT: f64 = 1e-5;
/// No sensor has less than an electron to a grey level of 8 bits: what asks for more is no noise of light.
const MOST_SHOT: f64 = 1.0;
/// Fewer pixels tell nothing of noise.
const LEAST_PX: usize = 100;
const PARTS: usize = 10;
const ROUNDS: usize = 6;
/// A pixel whose fit takes more of its noise than this tells too little.
const MOST_TAKEN: f64 = 0.7;
/// Pixels farther off than this many sigmas are something else.
const CLIP: f64 = 6.0;
/// Steps to the place of a spot by another table.
const PLACE_STEPS: usize = 3;
/// Pixels with less light say no more than patches without, and round alike, grey levels.
const LEAST_DN: f64 = 0.7;

/// What is left of the pixels of spots by a table that was made of them, put back as if fits weighed pixels by their own variances: while the table is learnt, and
/// of few spots, its error is no chance share of the light in each pixel, as it must be for what fits leave of it to be told pixel by pixel.
pub(super) fn residuals(spots: &[Spot<'_>], field: &Field, noise: &Noise) -> Vec<Residual> {
    residuals_by(spots, noise, |_, spot| {
        let Some(told) = spot.told(field.at(spot.place_px()), noise, usize::MAX) else { return Vec::new() };
        let square = |pixel: &Pixel| {
            let &Pixel { light, left, .. } = pixel;
            let taken = told.taken(pixel);
            (Left { light, left, row: by_light(light) * (1.0 - taken), taken }, left * left)
        };
        told.pixels.iter().map(square).collect()
    })
}

/// What is left of them by the tables of two thirds of the spots that they are not of, multiplied: `thirds` are the tables of every third
/// spot, of the first, the second and the third on.
pub(super) fn free_residuals(spots: &[Spot<'_>], thirds: [&Field; 3], noise: &Noise) -> Vec<Residual> {
    let mut shares = Shares::default();
    residuals_by(spots, noise, |number, spot| {
        let [one, other] = [1, 2].map(|further| {
            let field = thirds[(number + further) % 3];
            let mut spot = spot.clone();
            spot.fit(field.at(spot.place_px()), noise, super::PLACE_REACH, PLACE_STEPS, &mut shares);
            left_by_pixel(&spot, field, noise)
        });
        if one.len() != other.len() {
            return Vec::new();
        }
        let both = |(one, other): (Left, Left)| {
            let row = (one.row + other.row) * 0.5;
            (Left { row, ..one }, one.left * other.left)
        };
        one.into_iter().zip(other).map(both).collect()
    })
}

/// What is left of a pixel.
#[derive(Clone, Copy)]
struct Left {
    light: f64,
    left: f64,
    /// What is left of a unit of darkness, of shot noise, and of the error of the table in all pixels of the spot.
    row: SVector<f64, 3>,
    /// Share of its noise that the fit took.
    taken: f64,
}

fn residuals_by(
    spots: &[Spot<'_>],
    noise: &Noise,
    mut squares: impl FnMut(usize, &Spot<'_>) -> Vec<(Left, f64)>,
) -> Vec<Residual> {
    let mut residuals = Vec::new();
    for (number, spot) in spots.iter().enumerate().filter(|(_, spot)| spot.is_used && spot.is_linear()) {
        let part = number % PARTS;
        for (Left { light, row, taken, .. }, square) in squares(number, spot) {
            let is_odd = square.abs() >= CLIP * CLIP * row.dot(&noise.terms());
            if taken < MOST_TAKEN && light > LEAST_DN && !is_odd {
                residuals.push(Residual { light, square, row, part });
            }
        }
    }
    residuals
}

/// What a fit H leaves of independent pixels, which it weighs by variances that need not be theirs: of a pixel j the sum over all pixels k of
/// ([j = k] - H_jk)^2 of their own. Bright pixels count for less in a fit, by the error of the table; were that forgotten, dim ones would be left with less than is
/// put back, and shot noise would be a sixth too low behind sharp lenses.
fn left_by_pixel(spot: &Spot<'_>, field: &Field, noise: &Noise) -> Vec<Left> {
    let Some(told) = spot.told(field.at(spot.place_px()), noise, usize::MAX) else { return Vec::new() };
    // One that is cut off at 0 varies by another amount than its light has it.
    let own = |pixel: &Pixel| by_light(pixel.light) / (pixel.weight * noise.variance(pixel.light));
    let mut through = [SMatrix::<f64, 4, 4>::zeros(); 3];
    for pixel in &told.pixels {
        let product = pixel.jacobian * pixel.jacobian.transpose() * (pixel.weight * pixel.weight);
        through.iter_mut().zip(own(pixel).iter()).for_each(|(sum, own)| *sum += product * *own);
    }
    let through = through.map(|sum| told.covariance * sum * told.covariance);
    let of_pixel = |pixel: &Pixel| {
        let along = |matrix: &SMatrix<f64, 4, 4>| (pixel.jacobian.transpose() * matrix * pixel.jacobian)[0];
        let taken = told.taken(pixel);
        let row = own(pixel) * (1.0 - 2.0 * taken) + SVector::from(through.each_ref().map(along));
        Left { light: pixel.light, left: pixel.left, row, taken }
    };
    told.pixels.iter().map(of_pixel).collect()
}

/// What variance has of darkness, of shot noise and of the square of the table's error, where there is this much light.
fn by_light(light: f64) -> SVector<f64, 3> {
    SVector::from([1.0, light, light * light])
}

/// Explains residuals, by what was believed `before` where there are too few; `dark_dn` is the noise of patches without light, where it is known.
pub(super) fn explain(residuals: &[Residual], dark_dn: Option<Measured>, before: &Noise) -> LightNoise {
    // patches know darkness only so well, and where there is little light every error of it is one of shot noise
    let dark = dark_dn.map(|Measured { value, sigma }| Measured {
        value: value * value + ROUNDING,
        sigma: 2.0 * value * sigma.max(1e-4),
    });
    if residuals.len() < LEAST_PX {
        let dark_sigma = dark.map_or(before.dark, |dark| dark.sigma);
        let unsure = LightNoise {
            noise: *before,
            dark_sigma,
            shot_sigma: SHOT_BELIEVED.sigma,
            shape_sigma: before.shape,
            is_shot_seen: false,
        };
        return unsure;
    }
    let (told, free) = split(residuals, dark, None, before);
    let is_shot_seen =
        told.value < MOST_SHOT && told.sigma < (0.5 * SHOT_BELIEVED.sigma).max(0.1 * told.value);
    if is_shot_seen && told.value > 3.0 * told.sigma {
        return free;
    }
    // The error of the shape explains the rest.
    let shot = with_belief(told);
    let (_, held) = split(residuals, dark, Some(shot.value), before);
    LightNoise { shot_sigma: shot.sigma, is_shot_seen, ..held }
}

/// What is told of shot noise, together with what is believed of it; none is below 0.
fn with_belief(told: Measured) -> Measured {
    let [by_told, by_belief] = [told, SHOT_BELIEVED].map(|of| 1.0 / (of.sigma * of.sigma));
    let value = (by_told * told.value + by_belief * SHOT_BELIEVED.value) / (by_told + by_belief);
    Measured { value: value.max(LEAST_SHOT), sigma: (1.0 / (by_told + by_belief)).sqrt() }
}

/// The shot noise that all spots tell, which by chance may be below 0, and their noise, by how they scatter when tenths of them are left out.
fn split(
    residuals: &[Residual],
    dark: Option<Measured>,
    shot: Option<f64>,
    before: &Noise,
) -> (Measured, LightNoise) {
    let solve = |is_used: &dyn Fn(&Residual) -> bool| solve(residuals, (dark, shot), before, is_used);
    let (told, noise) = solve(&|_| true);
    let mut squares = [0.0; 3];
    for part in 0..PARTS {
        let (told_without, without) = solve(&|residual| residual.part != part);
        let changes = [without.dark - noise.dark, told_without - told, without.shape - noise.shape];
        squares.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change * change);
    }
    let [dark_sigma, shot_sigma, shape_sigma] =
        squares.map(|sum| (sum * (PARTS - 1) as f64 / PARTS as f64).sqrt());
    let light = LightNoise { noise, dark_sigma, shot_sigma, shape_sigma, is_shot_seen: true };
    (Measured { value: told, sigma: shot_sigma.max(LEAST_SHOT) }, light)
}

/// Least squares of squared residuals on what makes them; a normal residual's square has twice its variance squared. Shot noise is also
/// told as it comes out, which by chance may be below 0.
fn solve(
    residuals: &[Residual],
    (dark, shot): (Option<Measured>, Option<f64>),
    before: &Noise,
    is_used: impl Fn(&Residual) -> bool,
) -> (f64, Noise) {
    let (mut told, mut noise) = (before.shot, *before);
    for _ in 0..ROUNDS {
        let mut normal = SMatrix::<f64, 3, 3>::zeros();
        let mut right = SVector::<f64, 3>::zeros();
        if let Some(Measured { value, sigma }) = dark {
            normal[(0, 0)] = 1.0 / (sigma * sigma);
            right[0] = value / (sigma * sigma);
        }
        for residual in residuals.iter().filter(|residual| is_used(residual)) {
            let variance = residual.row.dot(&noise.terms());
            let weight = 0.5 / (variance * variance);
            let mut row = residual.row;
            let known = shot.unwrap_or(0.0) * row[1];
            if shot.is_some() {
                row[1] = 0.0;
            }
            normal += row * row.transpose() * weight;
            right += row * ((residual.square - known) * weight);
        }
        let found = least_squares(&normal, &right);
        told = shot.unwrap_or(found[1]);
        noise = Noise {
            dark: found[0].max(ROUNDING),
            shot: told.max(LEAST_SHOT),
            shape: found[2].max(0.0).sqrt(),
            bend: before.bend,
            is_dark_seen: before.is_dark_seen,
        };
    }
    (told, noise)
}

/// The least squares, where darkness comes out as what can be. Shot noise and the square of the shape may then be below 0: were one held at
/// 0 there, the other would be too low on average.
fn least_squares(normal: &SMatrix<f64, 3, 3>, right: &SVector<f64, 3>) -> SVector<f64, 3> {
    let mut matrix = *normal;
    if normal[(1, 1)] <= 0.0 {
        matrix[(1, 1)] = 1.0; // shot noise is known
    }
    let free = matrix.lu().solve(right).filter(|found| found[0] >= 0.0);
    free.filter(|found| found.iter().all(|value| value.is_finite()))
        .unwrap_or_else(|| non_negative(normal, right))
}

/// The least squares among numbers not below 0: of all choices of those that are 0, the best.
fn non_negative(normal: &SMatrix<f64, 3, 3>, right: &SVector<f64, 3>) -> SVector<f64, 3> {
    let mut best = (f64::INFINITY, SVector::zeros());
    for zeros in 0..8_u32 {
        let is_zero = |index: usize| zeros & (1 << index) != 0;
        let mut matrix = *normal;
        let mut vector = *right;
        for index in (0..3).filter(|&index| is_zero(index)) {
            matrix.row_mut(index).fill(0.0);
            matrix.column_mut(index).fill(0.0);
            (matrix[(index, index)], vector[index]) = (1.0, 0.0);
        }
        let Some(found) = matrix.lu().solve(&vector) else { continue };
        if found.iter().any(|value| !value.is_finite()) {
            continue;
        }
        let cost = (found.transpose() * normal * found)[0] - 2.0 * found.dot(right);
        if found.iter().all(|value| *value >= 0.0) && cost < best.0 {
            best = (cost, found);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;
    use rand_pcg::Pcg64;

    use super::super::table::Table;
    use super::super::window::Window;
    use super::super::{field_of_part, place, spot};
    use super::*;

    const SHOT: f64 = 0.025;

    fn table() -> Table {
        Table::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.5 }])
    }

    /// Spots on a level, in noise.
    fn windows(level: f64, shot: f64, seed: u64) -> Vec<Window> {
        let mut random = Pcg64::new(u128::from(seed), 1);
        let light = |number: usize| 25.0 + 22.0 * (number % 20) as f64;
        (0..250)
            .map(|number| Window::drawn(number, &table(), light(number), (level, shot), &mut random))
            .collect()
    }

    /// Noise of spots whose table is taken to be wrong by `shape`, by the tables that `thirds` makes of them.
    fn told(
        windows: &[Window],
        shape: f64,
        thirds: impl Fn(&[Spot<'_>], &Field, &Noise) -> [Field; 3],
    ) -> LightNoise {
        let noise = Noise { dark: 0.36 + ROUNDING, shot: SHOT, shape, bend: 0.0, is_dark_seen: true };
        let dark_dn = Some(Measured { value: 0.6, sigma: 0.003 });
        let field = Field::new(table(), [200, 200], [1, 1]);
        let mut spots = spot::of(windows, 255);
        place(&mut spots, &field, &noise, 6);
        let thirds = thirds(&spots, &field, &noise);
        explain(&free_residuals(&spots, thirds.each_ref(), &noise), dark_dn, &noise)
    }

    fn of_seeds(seeds: u64, shot: impl Fn(u64) -> f64) -> f64 {
        (0..seeds).map(shot).sum::<f64>() / seeds as f64
    }

    fn given(_: &[Spot<'_>], field: &Field, _: &Noise) -> [Field; 3] {
        std::array::from_fn(|_| field.clone())
    }

    #[test]
    fn shot_noise_is_told_however_wrong_a_table_is_taken_to_be() {
        for (level, shape) in [(6.0, 0.05), (6.0, 0.2), (0.3, 0.05)] {
            let shot = of_seeds(4, |seed| told(&windows(level, SHOT, seed), shape, given).noise.shot);
            assert!((shot / SHOT - 1.0).abs() < 0.15, "{shot} not {SHOT}, on {level}, shape {shape}");
        }
    }

    #[test]
    fn shot_noise_is_told_by_tables_that_are_made_of_the_spots() {
        let learned = |spots: &[Spot<'_>], start: &Field, noise: &Noise| {
            [0, 1, 2].map(|third| field_of_part(spots, start.clone(), noise, (third, 3)))
        };
        let shot = of_seeds(8, |seed| told(&windows(6.0, SHOT, 100 + seed), 0.01, learned).noise.shot);
        let by_truth = of_seeds(8, |seed| told(&windows(6.0, SHOT, 100 + seed), 0.01, given).noise.shot);
        assert!((shot / by_truth - 1.0).abs() < 0.05, "{shot} not {by_truth}");
    }

    #[test]
    fn shot_noise_too_little_to_be_told_is_not_surely_none() {
        for shot in [0.0, 5e-4] {
            for seed in 0..4 {
                let light = told(&windows(6.0, shot, seed), 0.01, given);
                let off = (light.noise.shot - shot) / light.shot_sigma;
                assert!(off.abs() < 3.5, "{} +- {} for {shot}", light.noise.shot, light.shot_sigma);
                assert!(light.shot_sigma > 1e-4, "{}", light.shot_sigma);
            }
        }
    }
}
