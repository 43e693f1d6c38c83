//! Where the light of a spot fell, and how much of it: the camera's point spread, fitted to the pixels.
//!
//! In: the pixels around a spot, the point spread there, the noise of a pixel. Out: place, light and their covariances. The pixels are
//!
//! ```text
//! I(p) = A (P(p - c) + w L(p - c)) + B + others(p),
//! ```
//!
//! P the effective point spread, L half its Laplacian: a source that is no point widens it by its variance w. Unknown are c, A,
//! B and w, or, where the point spread is not known yet, the numbers that make it instead of w. Gauss and Newton's steps on
//! the squared residuals over the variance that the model itself gives each pixel. A full pixel says that its light is no less than
//! what it reads: it counts where the model has less. What is believed of B and w before a pixel is seen counts like pixels.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::window::{Four, Scale, Spill, Window};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{self, Lanes};
use crate::optics::{Measured, PointSpread, Shares, SourceSize};

/// Steps of Gauss and Newton at most; of a spot with full pixels, whose set of pixels that count changes.
const STEPS: usize = 8;
const STEPS_OF_FULL: usize = 12;
/// Steps that are never damped.
const UNDAMPED: usize = 3;
/// A step that undoes more of the one before than this overshoots; one that repeats more of it than this was too short.
const UNDOES: f64 = 0.25;
const REPEATS: f64 = 0.5;
/// Longest step of the centre, px.
const LONGEST_PX: f64 = 0.5;
/// A step shorter than this is the last, px and sigmas, if it changes the light by less than this share.
const DONE_SIGMAS: f64 = 0.3;
const DONE_PX: f64 = 0.03;
pub(super) const DONE_SHARE: f64 = 0.03;
/// A last step longer than this has not settled, px.
const SETTLED_PX: f64 = 0.05;
/// How far light is taken to change in a step, over the light.
const LIGHT_STEP: f64 = 3.0;
/// Share of a pixel's noise that must not be cut off for what it leaves to tell of noise.
const WHOLLY_SEEN: f32 = 0.98;
/// Of what a fit took more than this share of a pixel's noise tells little of it.
const MOST_TAKEN: f64 = 0.7;
/// No source's own variance is known better than this, px^2.
const LEAST_SIZE_PX2: f64 = 1e-4;
/// How far the level of the background is known beforehand, grey levels, and one over the variance.
const LEVEL_KNOWN_DN: f64 = 3.0;
const LEVEL_WEIGHT: f64 = 1.0 / (LEVEL_KNOWN_DN * LEVEL_KNOWN_DN);

pub(super) const U: usize = 0;
pub(super) const V: usize = 1;
pub(super) const LIGHT: usize = 2;
const LEVEL: usize = 3;
/// The first of the numbers that say how wide the light is.
pub(super) const WIDTH: usize = 4;

/// Noise of a pixel with signal s, m of it from a spot of light A: `dark` + `shot` s + (`shape` m)^2 + `faint` A m, grey levels^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelNoise {
    pub(super) dark: f32,
    pub(super) shot: f32,
    /// How wrong the point spread is, as a share of the light in a pixel.
    pub(super) shape: f32,
    /// Share of a spot's light below which a pixel's is not known at all.
    pub(super) faint: f32,
}

/// What a spot is fitted with.
pub(super) trait Shape<const N: usize> {
    /// The point spread of light 1 with these numbers of width at four pixels, its derivatives by u, v and by each of them in the columns
    /// from [`WIDTH`] on.
    fn shares(&self, row: usize, column: usize, widths: &SVector<f64, N>) -> (Lanes, [Lanes; N]);

    /// How many points of light it has.
    fn points(&self) -> usize {
        1
    }

    /// Which numbers are a point's place, u and v.
    fn place_of(&self, _point: usize) -> [usize; 2] {
        [U, V]
    }

    /// Whether a step is short enough to be the last, as far as places and light do not tell.
    fn is_short(&self, _step: &SVector<f64, N>) -> bool {
        true
    }

    /// Places the spread as these numbers say, (u, v) px from the middle of the window.
    fn place(&mut self, numbers: &SVector<f64, N>, reach: usize);

    /// What is believed of the numbers of width: mean and one over the variance, each by itself.
    fn believed(&self, number: usize) -> (f64, f64);

    /// What becomes of charge above a full well.
    fn spill(&self, numbers: &SVector<f64, N>) -> Spill;
}

/// The numbers of the shape that another is made of: they come first.
pub(super) fn first<const M: usize, const N: usize>(numbers: &SVector<f64, N>) -> SVector<f64, M> {
    SVector::from_fn(|number, _| numbers[number])
}

/// Places a shape in the window. Where pixels are full, keeps what it has in each four of them, and tells the window what spills over from those that the model makes full.
fn place<const N: usize>(window: &mut Window, shape: &mut impl Shape<N>, numbers: &SVector<f64, N>) {
    shape.place(numbers, window.reach);
    if window.full_px > 0 {
        window.keep(|four| shape.shares(four.row, four.column, numbers));
        let (light, level) = (numbers[LIGHT] as f32, numbers[LEVEL] as f32);
        window.overflow::<N>(&shape.spill(numbers), Scale { light, level, numbers: [LIGHT, LEVEL] });
    }
}

/// A spot as fitted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted<const N: usize> {
    /// u, v, light, level, numbers of width, as seen from the middle of the window.
    pub(super) numbers: SVector<f64, N>,
    /// Their covariance where pixels are as noisy as they were taken to be.
    pub(super) covariance: SMatrix<f64, N, N>,
    /// Squared residuals over their variances.
    pub(super) chi2: f64,
    /// Pixels that counted, less the unknowns.
    pub(super) freedom: f64,
    /// The spot's own light in pixels, squared over their variances.
    own: f64,
    /// Twice the negative log-likelihood, but for a constant and the squared residuals.
    rest_of_cost: f64,
}

impl<const N: usize> Fitted<N> {
    /// Whether it leaves no more than noise may, 3 sigmas of chi-square: two points with a dip between them leave more.
    pub(super) fn leaves_noise(&self) -> bool {
        self.chi2 < self.freedom + 3.0 * (2.0 * self.freedom).sqrt()
    }

    /// How far the spot is from the shape it was fitted with, as a share of its light, squared: by what it leaves more than noise does.
    pub(super) fn strange_share2(&self) -> f64 {
        (self.chi2 - self.freedom).max(0.0) / self.own.max(1.0)
    }

    /// Twice the negative log-likelihood, but for a constant, where squared residuals are so many times what noise leaves.
    pub(super) fn cost(&self, misfit: f64) -> f64 {
        self.chi2 / misfit + self.rest_of_cost + COUNTS * libm::log(self.light())
    }

    /// Whether it leaves about as much as noise.
    pub(super) fn fits(&self) -> bool {
        self.chi2 < GOOD_FIT * self.freedom
    }

    pub(super) fn centre_covariance_px2(&self) -> Matrix2<f64> {
        self.covariance.fixed_view::<2, 2>(0, 0).into_owned()
    }

    pub(super) fn light(&self) -> f64 {
        self.numbers[LIGHT]
    }

    /// The same with another centre and its covariance, as seen from the middle of the window.
    pub(super) fn with_centre(self, [u, v]: [f64; 2], covariance_px2: &Matrix2<f64>) -> Self {
        let Self { mut numbers, mut covariance, .. } = self;
        (numbers[U], numbers[V]) = (u, v);
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(covariance_px2);
        Self { numbers, covariance, ..self }
    }

    /// The same with another light and its variance.
    pub(super) fn with_light(self, light: f64, variance: f64) -> Self {
        let Self { mut numbers, mut covariance, .. } = self;
        numbers[LIGHT] = light;
        covariance[(LIGHT, LIGHT)] = variance;
        Self { numbers, covariance, ..self }
    }

    pub(super) fn light_variance(&self) -> f64 {
        self.covariance[(LIGHT, LIGHT)]
    }
}

/// Sums of the products of slopes and residual, the residual beside.
struct Sums<const N: usize> {
    matrix: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
    chi2: f64,
    log_variances: f64,
    pixels: f64,
}

/// Light of other first guesses over that of the first, where so many pixels are full that it may be far off.
const BRIGHTER: [f64; 2] = [3.0, 10.0];
/// Squared residuals over degrees of freedom from which others are tried.
pub(super) const GOOD_FIT: f64 = 1.5;
/// Lights spread evenly in space are as many per light as light^-5/2: what that adds to the cost per logarithm of light.
const COUNTS: f64 = 5.0;
/// A share of the excess from which on it counts that it spills.
const SPILLS: f64 = 0.05;
/// Fewer full pixels hide little.
const HIDING_PX: u32 = 2;

/// Fits `shape` from a first guess (u, v, light); `None` where it does not settle.
///
/// Where pixels are full there may be several answers: one with light as the wings have it at first sight, one with no more than what shows.
pub(super) fn fit<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    (u, v, light): (f64, f64, f64),
    noise: PixelNoise,
) -> Option<Fitted<N>> {
    let mut found: [Option<Fitted<N>>; BRIGHTER.len() + 2] = [None; BRIGHTER.len() + 2];
    if let Some(seen) = light_there(window, shape, (u, v)) {
        found[0] = fit_from(window, shape, guessed(shape, (u, v), seen), noise);
    }
    // What keeps its charge, or hides little, has one answer.
    let is_plain = window.full_px < HIDING_PX || shape.spill(&believed(shape, (u, v))).share <= SPILLS;
    if found[0].as_ref().is_some_and(|first| window.full_px == 0 || (is_plain && first.fits())) {
        return found[0];
    }
    found[1] = fit_from(window, shape, guessed(shape, (u, v), (light, 0.0)), noise);
    for (tried, brighter) in BRIGHTER.into_iter().enumerate() {
        if window.full_px < HIDING_PX || found.iter().flatten().any(Fitted::fits) {
            break;
        }
        let guess = guessed(shape, (u, v), (brighter * light, 0.0));
        found[tried + 2] = fit_from(window, shape, guess, noise);
    }
    better(found)
}

/// The one of several fits that explains most; where nothing fits well, misfits count for less.
pub(super) fn better<const N: usize, const M: usize>(found: [Option<Fitted<N>>; M]) -> Option<Fitted<N>> {
    let misfits = found.iter().flatten().map(|fitted| fitted.chi2 / fitted.freedom);
    let least = misfits.fold(f64::INFINITY, f64::min).max(1.0);
    found.into_iter().flatten().min_by(|a, b| a.cost(least).total_cmp(&b.cost(least)))
}

/// Fits `shape` from numbers near the answer; `None` where it does not settle.
pub(super) fn fit_from<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    mut numbers: SVector<f64, N>,
    noise: PixelNoise,
) -> Option<Fitted<N>> {
    let (u, v) = (numbers[U], numbers[V]);
    let steps = if window.full_px > 0 { STEPS_OF_FULL } else { STEPS };
    let (mut last, mut previous, mut gain) = (None, SVector::<f64, N>::zeros(), 1.0_f64);
    for step_number in 0..steps {
        place(window, shape, &numbers);
        let sums = sums(window, shape, &numbers, noise, window.full_px > 0);
        let mut matrix = sums.matrix;
        let mut right = sums.right;
        let own = matrix[(LIGHT, LIGHT)] * numbers[LIGHT] * numbers[LIGHT];
        add_beliefs(shape, &numbers, WIDTH, &mut matrix, &mut right);
        // A step changes the light by no more than this much: where light, level and widths tell little apart, sums in 32 bits do not.
        matrix[(LIGHT, LIGHT)] += 1.0 / (LIGHT_STEP * LIGHT_STEP * numbers[LIGHT] * numbers[LIGHT]);
        // Where charge spills, full pixels and what they give on say the same of much light and of light without bounds. While it is being learnt how much
        // spills, less light would be taken for charge that does.
        let spill = shape.spill(&numbers);
        if window.full_px > 0 && spill.share > SPILLS && spill.numbers.is_none() {
            right[LIGHT] -= 0.5 * COUNTS / numbers[LIGHT];
        }
        let factor = matrix.cholesky()?;
        let mut step = factor.solve(&right);
        if !step.iter().all(|number| number.is_finite()) {
            return None;
        }
        for number in (0..shape.points()).flat_map(|point| shape.place_of(point)) {
            step[number] = step[number].clamp(-LONGEST_PX, LONGEST_PX);
        }
        let before = numbers[LIGHT];
        // Light neither vanishes nor explodes in a step: far from the answer slopes say little.
        step[LIGHT] = step[LIGHT].clamp(-0.6 * before, 4.0 * before);
        // Weights follow the model: what overshoots goes half as far, until it no longer does.
        if step_number >= UNDAMPED {
            let again = (step.transpose() * matrix * previous)[0];
            let before = (previous.transpose() * matrix * previous)[0];
            if again < -UNDOES * before {
                gain *= 0.5;
            } else if again > REPEATS * before {
                gain = (2.0 * gain).min(1.0);
            }
        }
        // No covariance is less than one over the information.
        let (mut step_px, mut sigmas) = (0.0_f64, 0.0_f64);
        for [u, v] in (0..shape.points()).map(|point| shape.place_of(point)) {
            let moved_px = libm::hypot(step[u], step[v]);
            step_px = step_px.max(moved_px);
            sigmas = sigmas.max(moved_px * matrix[(u, u)].max(matrix[(v, v)]).sqrt());
        }
        step *= gain;
        numbers += step;
        previous = step;
        let is_done = step_px < DONE_PX
            && sigmas < DONE_SIGMAS
            && step[LIGHT].abs() < DONE_SHARE * before
            && shape.is_short(&step);
        let mut cost = sums.log_variances;
        for number in WIDTH..N {
            let (mean, weight) = shape.believed(number);
            cost += weight * (numbers[number] - mean) * (numbers[number] - mean);
        }
        last = Some((factor, sums.chi2, sums.pixels, own, step_px, cost));
        if is_done && step_number > 0 {
            break;
        }
    }
    let (factor, chi2, pixels, own, step_px, cost) = last?;
    let freedom = pixels - N as f64;
    let off_px = libm::hypot(numbers[U] - u, numbers[V] - v);
    let settled = step_px < SETTLED_PX && off_px < 0.5 * window.reach as f64 && numbers[LIGHT] > 0.0;
    (settled && freedom >= 1.0).then(|| Fitted {
        numbers,
        covariance: factor.inverse(),
        chi2,
        freedom,
        own,
        rest_of_cost: cost,
    })
}

/// What a spot says of numbers of width that it shares with others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Said<const C: usize> {
    /// Its information on them, and its product with how far they are off.
    pub(super) information: SMatrix<f64, C, C>,
    pub(super) weighted: SVector<f64, C>,
    /// Squared residuals over their variances, and the pixels that count less the numbers of the spot's own.
    pub(super) chi2: f64,
    pub(super) freedom: f64,
    /// Twice the negative log-likelihood, but for a constant and the squared residuals.
    pub(super) rest_of_cost: f64,
}

/// What a spot says of the first `C` numbers of width at these numbers, of which its own are those that fit best; `None` where pixels say too little of
/// its own.
pub(super) fn said<const N: usize, const C: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    numbers: &SVector<f64, N>,
    noise: PixelNoise,
) -> Option<Said<C>> {
    let Sums { mut matrix, mut right, chi2, log_variances, pixels } =
        with_beliefs::<N, C>(window, shape, numbers, noise);
    let mut rest_of_cost = log_variances + LEVEL_WEIGHT * numbers[LEVEL] * numbers[LEVEL];
    if window.full_px > 0 {
        rest_of_cost += COUNTS * libm::log(numbers[LIGHT]);
    }
    for number in WIDTH + C..N {
        let (mean, weight) = shape.believed(number);
        rest_of_cost += weight * (mean - numbers[number]) * (mean - numbers[number]);
    }
    let left = chi2 - eliminate::<N, C>(&mut matrix, &mut right)?;
    let freedom = pixels - (N - C) as f64;
    (freedom >= 1.0).then(|| Said {
        information: matrix.fixed_view::<C, C>(WIDTH, WIDTH).into_owned(),
        weighted: right.fixed_rows::<C>(WIDTH).into_owned(),
        chi2: left.max(0.0),
        freedom,
        rest_of_cost,
    })
}

/// A fit whose first four numbers are as much less sure as the `C` numbers of width that follow them in `shape` leave them, of which this is the covariance:
/// those were taken for given (consider covariance; S. F. Schmidt, Advances in Control Systems 3, 1966).
pub(super) fn considered<const M: usize, const N: usize, const C: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    fitted: Fitted<M>,
    noise: PixelNoise,
    covariance: &SMatrix<f64, C, C>,
) -> Fitted<M> {
    let mut numbers = SVector::<f64, N>::zeros();
    numbers.fixed_rows_mut::<WIDTH>(0).copy_from(&fitted.numbers.fixed_rows::<WIDTH>(0));
    let Sums { mut matrix, mut right, .. } = with_beliefs::<N, C>(window, shape, &numbers, noise);
    if eliminate::<N, C>(&mut matrix, &mut right).is_none() {
        return fitted;
    }
    let gain = matrix.fixed_view::<WIDTH, C>(0, WIDTH);
    let mut all = fitted.covariance;
    let mut own = all.fixed_view_mut::<WIDTH, WIDTH>(0, 0);
    own += gain * covariance * gain.transpose();
    Fitted { covariance: all, ..fitted }
}

/// A fit whose light is as much less sure as a point spread leaves it that is off alike all around, by what is not known of faint pixels: tables are held to their
/// own profile over the radius, and what a ring has too much all of a spot has.
pub(super) fn off_alike<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    fitted: Fitted<N>,
    noise: PixelNoise,
) -> Fitted<N> {
    place(window, shape, &fitted.numbers);
    let along = fitted.covariance.column(LIGHT).into_owned();
    let unknown = f64::from(noise.faint) * fitted.light();
    let mut off = 0.0;
    each_counted(window, shape, &fitted, noise, |pixel| {
        off += along.dot(&pixel.slopes) * pixel.weight * (unknown * pixel.light).sqrt();
    });
    fitted.with_light(fitted.light(), fitted.light_variance() + off * off)
}

/// What pixels say of the numbers, and what is believed of all but the first `C` numbers of width.
fn with_beliefs<const N: usize, const C: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    numbers: &SVector<f64, N>,
    noise: PixelNoise,
) -> Sums<N> {
    place(window, shape, numbers);
    let mut sums = sums(window, shape, numbers, noise, true);
    add_beliefs(shape, numbers, WIDTH + C, &mut sums.matrix, &mut sums.right);
    // What full pixels hide may be anything: a narrow core as bright as one likes beneath them, say.
    if window.full_px > 0 {
        sums.right[LIGHT] -= 0.5 * COUNTS / numbers[LIGHT];
    }
    sums
}

/// Adds what is believed beforehand of the level and of the numbers of width from `first` on.
fn add_beliefs<const N: usize>(
    shape: &impl Shape<N>,
    numbers: &SVector<f64, N>,
    first: usize,
    matrix: &mut SMatrix<f64, N, N>,
    right: &mut SVector<f64, N>,
) {
    matrix[(LEVEL, LEVEL)] += LEVEL_WEIGHT;
    right[LEVEL] -= LEVEL_WEIGHT * numbers[LEVEL];
    for number in first..N {
        let (mean, weight) = shape.believed(number);
        matrix[(number, number)] += weight;
        right[number] += weight * (mean - numbers[number]);
    }
}

/// Takes a spot's own numbers out of what is said of all of them, one after the other (Gauss and Jordan): of the first `C` numbers of width that leaves what the
/// spot says of them, and in their columns how far its own follow them. What a last step of its own numbers gains; `None` where too little is said of them.
fn eliminate<const N: usize, const C: usize>(
    matrix: &mut SMatrix<f64, N, N>,
    right: &mut SVector<f64, N>,
) -> Option<f64> {
    let mut gain = 0.0;
    for own in (0..N).filter(|number| !(WIDTH..WIDTH + C).contains(number)) {
        let pivot = matrix[(own, own)];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let (row, off) = (matrix.row(own) / pivot, right[own] / pivot);
        gain += right[own] * off;
        let along = matrix.column(own).into_owned();
        *matrix -= along * row;
        *right -= along * off;
        matrix.set_row(own, &row);
        right[own] = off;
    }
    Some(gain)
}

/// What is believed beforehand of a spot at a place, with a guess of its light and level.
fn guessed<const N: usize>(
    shape: &impl Shape<N>,
    place: (f64, f64),
    (light, level): (f64, f64),
) -> SVector<f64, N> {
    let mut numbers = believed(shape, place);
    (numbers[LIGHT], numbers[LEVEL]) = (light, level);
    numbers
}

/// What is believed beforehand of a spot at a place.
fn believed<const N: usize>(shape: &impl Shape<N>, (u, v): (f64, f64)) -> SVector<f64, N> {
    let mut numbers = SVector::<f64, N>::zeros();
    (numbers[U], numbers[V]) = (u, v);
    for number in WIDTH..N {
        numbers[number] = shape.believed(number).0;
    }
    numbers
}

/// Light and level of least squares of a spot at a place, by the pixels that are not full; `None` where they tell of no light.
fn light_there<const N: usize>(
    window: &Window,
    shape: &mut impl Shape<N>,
    place: (f64, f64),
) -> Option<(f64, f64)> {
    let numbers = believed(shape, place);
    shape.place(&numbers, window.reach);
    let mut sums = [Lanes::ZERO; 5];
    for four in &window.fours {
        let tells = four.counts * (Lanes::ONE - four.full);
        let share = shape.shares(four.row, four.column, &numbers).0;
        let (own, signal) = (tells * share, four.signal - four.others);
        for (sum, term) in sums.iter_mut().zip([tells, own, own * share, tells * signal, own * signal]) {
            *sum += term;
        }
    }
    let [n, s, ss, y, sy] = sums.map(|sum| f64::from(lanes::sum(sum)));
    let light = (n * sy - s * y) / (n * ss - s * s);
    let level = (y - light * s) / n;
    (light > 0.0 && light.is_finite()).then_some((light, level))
}

/// What pixels say of the numbers, with the logarithms of their variances where these are asked for.
fn sums<const N: usize>(
    window: &Window,
    shape: &impl Shape<N>,
    numbers: &SVector<f64, N>,
    noise: PixelNoise,
    logs: bool,
) -> Sums<N> {
    let model = PixelModel::new(numbers, noise, window);
    let [mut chi2, mut pixels, mut log_variances] = [Lanes::ZERO; 3];
    let mut equations = NormalEquations::<N>::ZERO;
    for (place, four) in window.fours.iter().enumerate() {
        let Modelled { columns, residual, variance, .. } =
            modelled(four, light_of(place, shape, numbers, window), &model);
        let weight = weight(four, residual, variance);
        let counts = lanes::less(Lanes::ZERO, weight);
        pixels += counts;
        if logs {
            log_variances -= counts * lanes::ln(weight + (Lanes::ONE - counts));
        }
        chi2 += weight * residual * residual;
        equations.add(&columns, residual, weight);
    }
    let sum = |lanes_of: Lanes| f64::from(lanes::sum(lanes_of));
    let (matrix, right) = equations.summed();
    Sums { matrix, right, chi2: sum(chi2), log_variances: sum(log_variances), pixels: sum(pixels) }
}

/// What pixels say of the numbers, lane by lane: products of the slopes, and of slopes and residual, over the variance.
struct NormalEquations<const N: usize> {
    products: [[Lanes; N]; N],
    right: [Lanes; N],
}

impl<const N: usize> NormalEquations<N> {
    const ZERO: Self = Self { products: [[Lanes::ZERO; N]; N], right: [Lanes::ZERO; N] };

    /// Adds four pixels.
    #[inline(always)]
    fn add(&mut self, columns: &[Lanes; N], residual: Lanes, weight: Lanes) {
        let weighted = weight * residual;
        for i in 0..N {
            self.right[i] += weighted * columns[i];
            let scaled = weight * columns[i];
            for (product, column) in self.products[i][..=i].iter_mut().zip(columns) {
                *product += scaled * *column;
            }
        }
    }

    /// Of all lanes: the information, and its product with how far the numbers are off.
    fn summed(&self) -> (SMatrix<f64, N, N>, SVector<f64, N>) {
        let sum = |lanes_of: Lanes| f64::from(lanes::sum(lanes_of));
        let information = SMatrix::from_fn(|i, j| sum(self.products[i.max(j)][i.min(j)]));
        (information, SVector::from_fn(|i, _| sum(self.right[i])))
    }
}

/// The share of light 1 in four pixels, its slopes, and those of what spills into them.
type Light<'a, const N: usize> = (Lanes, [Lanes; N], Option<&'a [Lanes; N]>);

/// What the four pixels of this number get: as it was kept, where charge may spill.
#[inline(always)]
fn light_of<'a, const N: usize>(
    place: usize,
    shape: &impl Shape<N>,
    numbers: &SVector<f64, N>,
    window: &'a Window,
) -> Light<'a, N> {
    match window.kept(place) {
        Some((share, slopes)) if window.full_px > 0 => (share, slopes, window.spilled_slopes(place)),
        _ => {
            let four = &window.fours[place];
            let (share, slopes) = shape.shares(four.row, four.column, numbers);
            (share, slopes, None)
        }
    }
}

/// What all pixels of a spot share.
struct PixelModel<'a> {
    light: Lanes,
    level: Lanes,
    noise: PixelNoise,
    window: &'a Window,
}

impl<'a> PixelModel<'a> {
    fn new<const N: usize>(numbers: &SVector<f64, N>, noise: PixelNoise, window: &'a Window) -> Self {
        let [light, level] = [LIGHT, LEVEL].map(|number| Lanes::splat(numbers[number] as f32));
        Self { light, level, noise, window }
    }
}

/// One over the variance of four pixels, 0 where they do not count: a full pixel does where the model has less than it reads.
#[inline(always)]
fn weight(four: &Four, residual: Lanes, variance: Lanes) -> Lanes {
    let tells = Lanes::ONE - four.full * lanes::less(residual, Lanes::ZERO);
    four.counts * tells / variance
}

/// Four pixels as a model has them.
struct Modelled<const N: usize> {
    /// How they change with each number.
    columns: [Lanes; N],
    residual: Lanes,
    variance: Lanes,
    /// The light of the spot in them.
    own: Lanes,
    /// The share of their noise that is not cut off.
    seen: Lanes,
}

#[inline(always)]
fn modelled<const N: usize>(
    four: &Four,
    (share, mut columns, spilled): Light<'_, N>,
    &PixelModel { light, level, noise, window }: &PixelModel<'_>,
) -> Modelled<N> {
    let own = light * share;
    for column in &mut columns {
        *column *= light;
    }
    columns[LIGHT] = share;
    columns[LEVEL] = Lanes::ONE;
    for (column, spilled) in columns.iter_mut().zip(spilled.into_iter().flatten()) {
        *column += *spilled;
    }
    let mut model = own + level + four.others + four.spilled;
    let wrong = Lanes::splat(noise.shape) * own;
    let mut variance = Lanes::splat(noise.dark)
        + Lanes::splat(noise.shot) * lanes::positive(own + four.others)
        + wrong * wrong
        + Lanes::splat(noise.faint) * light * lanes::positive(own)
        + four.others_variance
        + four.spilled_variance;
    let mut seen = Lanes::ONE;
    if let Some(floor) = window.floor_dn {
        let floor = Lanes::splat(floor);
        let read = window.cut_off.read(model - floor, variance.sqrt());
        model = floor + read.mean;
        variance *= read.variance;
        seen = read.slope;
        for column in &mut columns {
            *column *= seen;
        }
    }
    Modelled { columns, residual: four.signal - model, variance, own, seen }
}

/// A full pixel near the answer of a fit: model + `slopes` step is no less than what it reads, but for noise.
pub(super) struct FullPixel<const N: usize> {
    pub(super) slopes: SVector<f64, N>,
    /// What it reads less what the model has.
    pub(super) residual: f64,
    pub(super) variance: f64,
}

/// Tells of the full pixels at the answer of a fit. What the others and what is believed beforehand say of the numbers: their information, and its product with
/// how far the answer is off.
pub(super) fn each_full_pixel<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    fitted: &Fitted<N>,
    noise: PixelNoise,
    mut with: impl FnMut(FullPixel<N>),
) -> (SMatrix<f64, N, N>, SVector<f64, N>) {
    let numbers = &fitted.numbers;
    place(window, shape, numbers);
    let model = PixelModel::new(numbers, noise, window);
    let mut others = NormalEquations::<N>::ZERO;
    for (place, four) in window.fours.iter().enumerate() {
        let Modelled { columns, residual, variance, .. } =
            modelled(four, light_of(place, shape, numbers, window), &model);
        let weight = four.counts * (Lanes::ONE - four.full) / variance;
        others.add(&columns, residual, weight);
        if four.full == Lanes::ZERO {
            continue;
        }
        let columns = columns.map(Lanes::to_array);
        let (residual, variance) = (residual.to_array(), variance.to_array());
        let full = (four.full * four.counts).to_array();
        for lane in (0..lanes::LANES).filter(|&lane| full[lane] > 0.0) {
            with(FullPixel {
                slopes: SVector::from_fn(|i, _| f64::from(columns[i][lane])),
                residual: f64::from(residual[lane]),
                variance: f64::from(variance[lane]),
            });
        }
    }
    let (mut information, mut right) = others.summed();
    add_beliefs(shape, numbers, WIDTH, &mut information, &mut right);
    (information, right)
}

/// What a fit left of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    /// The own light of the spot there.
    pub(super) light: f64,
    pub(super) square: f64,
    /// What noise of 1, of the light and of its square in each pixel leaves there on average, whatever weights the fit had.
    pub(super) of: [f64; 3],
    /// The same of what others' light and spilled charge are not known.
    pub(super) known: f64,
}

/// A pixel that counts in a fit.
struct Counted<const N: usize> {
    slopes: SVector<f64, N>,
    residual: f64,
    weight: f64,
    light: f64,
    /// Variance of others' light and of spilled charge.
    known: f64,
    /// Neither full nor cut off: what is tells of less noise than there is.
    tells_noise: bool,
}

/// Tells what a fit left of each pixel that tells of noise: residuals are noise less what of it the fit took away, r = (1 - J C J' W) n.
pub(super) fn residuals<const N: usize>(
    window: &mut Window,
    shape: &mut impl Shape<N>,
    fitted: &Fitted<N>,
    noise: PixelNoise,
    mut with: impl FnMut(Left),
) {
    place(window, shape, &fitted.numbers);
    let parts = |pixel: &Counted<N>| [1.0, pixel.light, pixel.light * pixel.light, pixel.known];
    let mut taken_by_all = [SMatrix::<f64, N, N>::zeros(); 4];
    each_counted(window, shape, fitted, noise, |pixel| {
        let outer = pixel.slopes * pixel.slopes.transpose() * (pixel.weight * pixel.weight);
        for (sum, part) in taken_by_all.iter_mut().zip(parts(&pixel)) {
            *sum += outer * part;
        }
    });
    each_counted(window, shape, fitted, noise, |pixel| {
        let along = fitted.covariance * pixel.slopes;
        let taken = pixel.slopes.dot(&along) * pixel.weight;
        if !pixel.tells_noise || taken > MOST_TAKEN {
            return;
        }
        let parts = parts(&pixel);
        let [one, light, light2, known] = core::array::from_fn(|part| {
            parts[part] * (1.0 - 2.0 * taken) + along.dot(&(taken_by_all[part] * along))
        });
        let square = pixel.residual * pixel.residual;
        with(Left { light: pixel.light, square, of: [one, light, light2], known });
    });
}

fn each_counted<const N: usize>(
    window: &Window,
    shape: &impl Shape<N>,
    fitted: &Fitted<N>,
    noise: PixelNoise,
    mut with: impl FnMut(Counted<N>),
) {
    let numbers = &fitted.numbers;
    let model = PixelModel::new(numbers, noise, window);
    for (place, four) in window.fours.iter().enumerate() {
        let Modelled { columns, residual, variance, own, seen } =
            modelled(four, light_of(place, shape, numbers, window), &model);
        let weight = weight(four, residual, variance).to_array();
        let known = (four.others_variance + four.spilled_variance).to_array();
        let columns = columns.map(Lanes::to_array);
        let [own, seen, residual, full] = [own, seen, residual, four.full].map(Lanes::to_array);
        for lane in (0..lanes::LANES).filter(|&lane| weight[lane] > 0.0) {
            with(Counted {
                slopes: SVector::from_fn(|i, _| f64::from(columns[i][lane])),
                residual: f64::from(residual[lane]),
                weight: f64::from(weight[lane]),
                light: f64::from(own[lane].max(0.0)),
                known: f64::from(known[lane]),
                tells_noise: full[lane] <= 0.0 && seen[lane] >= WHOLLY_SEEN,
            });
        }
    }
}

/// A point, or a source of some size.
#[derive(Clone, Copy)]
pub(super) struct PointSource<'a> {
    spread: &'a PointSpread,
    size: SourceSize,
    /// What is believed of its own variance, px^2: mean and one over the variance.
    believed: (f64, f64),
    spill: Spill,
    placed: Option<crate::optics::Placed<'a>>,
}

impl<'a> PointSource<'a> {
    pub(super) fn new(spread: &'a PointSpread, size: SourceSize, spill: Spill) -> Self {
        Self { spread, size, believed: (0.0, 0.0), spill, placed: None }
    }
}

impl Shape<5> for PointSource<'_> {
    #[inline(always)]
    fn shares(&self, row: usize, column: usize, numbers: &SVector<f64, 5>) -> (Lanes, [Lanes; 5]) {
        let Some(placed) = &self.placed else { return (Lanes::ZERO, [Lanes::ZERO; 5]) };
        let Shares { share, by_u, by_v, by_variance } = placed.four(row, column);
        let share = share + Lanes::splat(numbers[WIDTH] as f32) * by_variance;
        (share, [by_u, by_v, Lanes::ZERO, Lanes::ZERO, by_variance])
    }

    fn place(&mut self, numbers: &SVector<f64, 5>, reach: usize) {
        self.placed = Some(self.spread.placed(numbers[U] as f32, numbers[V] as f32, reach));
        let Measured { value, sigma } = self.size.believed_near(numbers[LIGHT], numbers[WIDTH]);
        self.believed = (value, 1.0 / (sigma * sigma).max(LEAST_SIZE_PX2 * LEAST_SIZE_PX2));
    }

    fn believed(&self, _: usize) -> (f64, f64) {
        self.believed
    }

    fn spill(&self, _: &SVector<f64, 5>) -> Spill {
        self.spill
    }
}
