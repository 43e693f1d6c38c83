//! What the frames themselves tell of the camera, where nobody measured it.
//!
//! In: what spots say of the numbers that all of them share. Out: the point spread (a core and a halo around it, both Gaussians), what becomes of charge
//! above a full well, the noise of a pixel by its light, and how wrong the point spread is. All begin with what is believed of any camera; the same frames
//! in the same order give the same belief.

use nalgebra::{SMatrix, SVector};

use super::fit::{self, PixelNoise, Shape, U, V, WIDTH};
use super::fitting::{NO_POINT, SPILL_ERROR};
use super::window::Spill;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::Lanes;
use crate::optics::{GaussianShares, PlacedGaussian, PointSpread, Profile};

/// Numbers that are learnt ...
pub(super) const NUMBERS: usize = 5;
/// ... and the unknowns of a spot with them.
pub(super) const UNKNOWNS: usize = WIDTH + NUMBERS;
/// Logarithm of the core's sigma, share of the halo, logarithm of the halo's sigma over the core's, share of the excess that spills, logarithm of
/// the full well over what reads as full: what is believed of any lens, and how far.
const BELIEVED: [f64; NUMBERS] = [-0.6, 0.1, 1.3, 0.3, 0.7];
const KNOWN: [f64; NUMBERS] = [0.6, 0.2, 0.5, 0.4, 0.7];
/// Sigma of the logarithm of a full well over what reads as full where these are one.
const SAME_WELL: f64 = 0.03;
/// Each of them is no less and no more.
const LEAST: [f64; NUMBERS] = [-1.6, 0.0, 0.5, 0.0, 0.0];
const MOST: [f64; NUMBERS] = [1.1, 0.9, 2.5, 1.0, 3.0];
/// A belief this sure, per number, is good enough to fit spots with alone.
const SURE: [f64; NUMBERS] = [0.03, 0.1, 0.5, f64::INFINITY, f64::INFINITY];

/// The numbers that say how much spills.
const SPILL: usize = WIDTH + 3;
const WELL: usize = WIDTH + 4;
/// Error of charge that spills into a pixel, over that: where it is not known how much does, and while that is being learnt. Then an error as large as the
/// spill itself would make what spills least the likeliest, for its pixels would be the least noisy ones.
const UNKNOWN_ERROR: f64 = 0.3;
const LEARNING_ERROR: f64 = 0.03;

/// A step is no longer than this, in any number.
const LONGEST: f64 = 0.5;

/// How far windows see, about, px.
const SEEN_PX: f64 = 3.5;

/// A halo says how wide it is as if it had no less of the light than this.
const LEAST_HALO: f32 = 0.02;

type Numbers = SVector<f64, NUMBERS>;
pub(super) type Information = SMatrix<f64, NUMBERS, NUMBERS>;

/// Where the numbers of the point spread begin to be looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beginning {
    /// Width (sigma) of the core, px.
    pub(super) core_px: f64,
    /// Share of the excess of full pixels that spills.
    pub(super) spill: f64,
}

/// What a spot says of the numbers.
pub(super) type Said = fit::Said<NUMBERS>;

/// What is believed of a camera's optics.
#[derive(Debug)]
pub(super) struct Belief {
    numbers: Numbers,
    /// What is believed of any camera, and one over the variance of each number.
    believed: Numbers,
    known: Numbers,
    /// Covariance of the numbers, from all spots.
    covariance: Information,
    core: Profile,
    halo: Profile,
    /// The point spread that was learnt last.
    spread: PointSpread,
    noise: PixelNoise,
}

impl Belief {
    /// What is believed before a frame is seen of a camera with pixels of such noise whose full ones read `full_from` or more: where that is less than the
    /// converter's end, it is the well that is full.
    pub(super) fn new(noise: PixelNoise, full_from: u8) -> Self {
        let (mut numbers, mut known) = (Numbers::from(BELIEVED), KNOWN);
        if full_from < u8::MAX {
            (numbers[NUMBERS - 1], known[NUMBERS - 1]) = (0.0, SAME_WELL);
        }
        let known = Numbers::from(known.map(|sigma| 1.0 / (sigma * sigma)));
        let mut belief = Self {
            numbers,
            believed: numbers,
            known,
            covariance: Information::from_diagonal(&known.map(|weight| 1.0 / weight)),
            core: Profile::new(1.0),
            halo: Profile::new(1.0),
            spread: PointSpread::dark(),
            noise,
        };
        belief.go(numbers);
        belief.draw();
        belief
    }

    pub(super) fn spread(&self) -> &PointSpread {
        &self.spread
    }

    /// Share of a point's light that falls where windows see it: how wide and strong a halo is beyond them is not known, and changes as it
    /// is learnt.
    pub(super) fn seen_share(&self) -> f64 {
        let sigmas = SEEN_PX / (self.core_px() * libm::exp(self.numbers[2]));
        1.0 - self.numbers[1] * libm::exp(-0.5 * sigmas * sigmas)
    }

    /// The share of the excess of full pixels that spills.
    pub(super) fn spill(&self) -> Spill {
        let share = self.numbers[3];
        let relative_error = SPILL_ERROR.max(self.sigmas()[3] / share.max(1e-3)).min(UNKNOWN_ERROR);
        Spill { share, ln_well: self.numbers[4], relative_error, numbers: None }
    }

    pub(super) fn noise(&self) -> PixelNoise {
        self.noise
    }

    /// Believes in such noise from now on.
    pub(super) fn set_noise(&mut self, noise: PixelNoise) {
        self.noise = noise;
    }

    /// Whether the core is as narrow as any that is tried, or cannot be told from it: what is sharper than that is none of the shapes that are known.
    pub(super) fn is_too_sharp(&self) -> bool {
        let above = self.numbers[0] - LEAST[0];
        above <= 2.0 * SURE[0] && above <= 2.0 * self.sigmas()[0]
    }

    /// Width (sigma) of the core, px.
    pub(super) fn core_px(&self) -> f64 {
        libm::exp(self.numbers[0])
    }

    /// Whether spots can be fitted with the spread as it stands.
    pub(super) fn is_sure(&self) -> bool {
        self.sigmas().iter().zip(SURE).all(|(sigma, sure)| *sigma < sure)
    }

    /// How well the share of a point's light that the brightest pixel gets is known, as a logarithm: it falls with the square of the core's width, and with what the
    /// halo takes.
    pub(super) fn summit_sigma(&self) -> f64 {
        let [core, halo, ..] = self.sigmas();
        libm::hypot(2.0 * core, halo / (1.0 - self.numbers[1]).max(0.1))
    }

    fn sigmas(&self) -> [f64; NUMBERS] {
        core::array::from_fn(|i| self.covariance[(i, i)].max(0.0).sqrt())
    }

    /// Covariance of the numbers.
    pub(super) fn covariance(&self) -> &Information {
        &self.covariance
    }

    /// How surely the numbers are known, each by itself: one over its variance.
    pub(super) fn weights(&self) -> [f64; NUMBERS] {
        self.sigmas().map(|sigma| 1.0 / (sigma * sigma))
    }

    /// A point of the spread as it stands.
    pub(super) fn known(&self) -> KnownSpread<'_> {
        KnownSpread { belief: self, placed: None }
    }

    /// The spread with its numbers free.
    pub(super) fn free(&self) -> FreeSpread<'_> {
        FreeSpread { belief: self, weights: self.weights(), placed: None }
    }

    /// Where the numbers of a camera that nobody measured are looked for.
    pub(super) fn believed() -> Beginning {
        Beginning { core_px: libm::exp(BELIEVED[0]), spill: BELIEVED[3] }
    }

    /// Begins to look for the numbers there.
    pub(super) fn begin(&mut self, Beginning { core_px, spill }: Beginning) {
        let mut numbers = self.believed;
        (numbers[0], numbers[3]) = (libm::log(core_px.clamp(0.3, 2.5)), spill);
        self.go(numbers);
    }

    /// Takes these numbers for true.
    pub(super) fn go(&mut self, numbers: Numbers) {
        self.numbers = numbers;
        let core_px = self.core_px();
        self.core = Profile::new(core_px);
        self.halo = Profile::new(core_px * libm::exp(numbers[2]));
    }

    pub(super) fn numbers(&self) -> Numbers {
        self.numbers
    }

    /// How far the numbers are from what was believed before, squared, in sigmas.
    pub(super) fn strain(&self) -> f64 {
        let off = self.numbers - self.believed;
        self.known.dot(&off.component_mul(&off))
    }

    /// The numbers to which what spots say of these leads, held back by a share of the diagonal; `None` where it leads nowhere.
    pub(super) fn stepped(&self, told: &Told, damping: f64) -> Option<Numbers> {
        let mut matrix = told.information + Information::from_diagonal(&self.known);
        let mut right = told.weighted + self.known.component_mul(&(self.believed - self.numbers));
        for i in 0..NUMBERS {
            matrix[(i, i)] *= 1.0 + damping;
            let is_out = |right: f64| {
                right < 0.0 && self.numbers[i] <= LEAST[i] || right > 0.0 && self.numbers[i] >= MOST[i]
            };
            if is_out(right[i]) {
                right[i] = 0.0;
                matrix.row_mut(i).fill(0.0);
                matrix.column_mut(i).fill(0.0);
                matrix[(i, i)] = 1.0;
            }
        }
        let step = matrix.cholesky()?.solve(&right);
        let number = |i: usize| (self.numbers[i] + step[i].clamp(-LONGEST, LONGEST)).clamp(LEAST[i], MOST[i]);
        step.iter().all(|step| step.is_finite()).then(|| Numbers::from_fn(|i, _| number(i)))
    }

    /// Believes what spots say of the numbers as they stand.
    pub(super) fn learn(&mut self, told: &Told) {
        let information = told.information + Information::from_diagonal(&self.known);
        self.covariance = information.try_inverse().unwrap_or(self.covariance);
        self.draw();
    }

    fn draw(&mut self) {
        let share = self.numbers[1];
        self.spread.become_sum(&[(1.0 - share, &self.core), (share, &self.halo)]);
    }

    /// The point spread around a point that is (u, v) px from the middle of a window.
    fn placed(&self, u: f64, v: f64, reach: usize) -> PlacedSpread {
        let placed = |profile: &Profile| PlacedGaussian {
            across: profile.placed(u as f32, reach),
            down: profile.placed(v as f32, reach),
        };
        PlacedSpread { share: self.numbers[1] as f32, core: placed(&self.core), halo: placed(&self.halo) }
    }
}

/// A core and a halo around a point.
#[derive(Clone, Copy)]
struct PlacedSpread {
    /// Share of the halo.
    share: f32,
    core: PlacedGaussian,
    halo: PlacedGaussian,
}

impl PlacedSpread {
    /// Shares in four pixels, how they change with the place of the point, and with the first three numbers.
    #[inline(always)]
    fn four(&self, row: usize, column: usize) -> (Lanes, [Lanes; 2], [Lanes; 3]) {
        let (core, halo): (GaussianShares, GaussianShares) =
            (self.core.four(row, column), self.halo.four(row, column));
        let (most, rest) = (Lanes::splat(1.0 - self.share), Lanes::splat(self.share));
        let both = |core: Lanes, halo: Lanes| most * core + rest * halo;
        let by_place = [both(core.by_u, halo.by_u), both(core.by_v, halo.by_v)];
        let by_wider = Lanes::splat(self.share.max(LEAST_HALO)) * halo.by_ln_sigma;
        let by_number = [both(core.by_ln_sigma, halo.by_ln_sigma), halo.share - core.share, by_wider];
        (both(core.share, halo.share), by_place, by_number)
    }
}

/// What spots say of the numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    information: Information,
    weighted: Numbers,
    /// Twice the negative log-likelihood, but for a constant.
    pub(super) cost: f64,
}

impl Told {
    /// Adds what a spot says. What misfits counts as if its pixels were as much noisier, to be told by nothing else: that is what the logarithm of its misfit costs.
    pub(super) fn add(&mut self, said: &Said) {
        let misfit = (said.chi2 / said.freedom).max(1.0);
        self.information += said.information / misfit;
        self.weighted += said.weighted / misfit;
        self.cost += said.chi2 / misfit + said.freedom * libm::log(misfit) + said.rest_of_cost;
    }

    /// Adds a spot of so many pixels that fits no point: each is as far off as may be.
    pub(super) fn add_misfit(&mut self, pixels: f64) {
        self.cost += pixels * (2.0 + libm::log(NO_POINT));
    }
}

/// A point whose spread is as believed.
#[derive(Clone, Copy)]
pub(super) struct KnownSpread<'a> {
    belief: &'a Belief,
    placed: Option<PlacedSpread>,
}

impl Shape<WIDTH> for KnownSpread<'_> {
    #[inline(always)]
    fn shares(&self, row: usize, column: usize, _: &SVector<f64, WIDTH>) -> (Lanes, [Lanes; WIDTH]) {
        let Some(placed) = &self.placed else { return (Lanes::ZERO, [Lanes::ZERO; WIDTH]) };
        let (share, [by_u, by_v], _) = placed.four(row, column);
        (share, [by_u, by_v, Lanes::ZERO, Lanes::ZERO])
    }

    fn place(&mut self, numbers: &SVector<f64, WIDTH>, reach: usize) {
        self.placed = Some(self.belief.placed(numbers[U], numbers[V], reach));
    }

    fn believed(&self, _: usize) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn spill(&self, _: &SVector<f64, WIDTH>) -> Spill {
        Spill { relative_error: LEARNING_ERROR, ..self.belief.spill() }
    }
}

/// A point whose spread is not known yet: differences of the three numbers from what is believed are free.
#[derive(Clone, Copy)]
pub(super) struct FreeSpread<'a> {
    belief: &'a Belief,
    weights: [f64; NUMBERS],
    placed: Option<PlacedSpread>,
}

impl Shape<UNKNOWNS> for FreeSpread<'_> {
    #[inline(always)]
    fn shares(
        &self,
        row: usize,
        column: usize,
        numbers: &SVector<f64, UNKNOWNS>,
    ) -> (Lanes, [Lanes; UNKNOWNS]) {
        let Some(placed) = &self.placed else { return (Lanes::ZERO, [Lanes::ZERO; UNKNOWNS]) };
        let (mut share, [by_u, by_v], by_number) = placed.four(row, column);
        let mut columns = [Lanes::ZERO; UNKNOWNS];
        (columns[U], columns[V]) = (by_u, by_v);
        for (i, by_number) in by_number.into_iter().enumerate() {
            columns[WIDTH + i] = by_number;
            share += Lanes::splat(numbers[WIDTH + i] as f32) * by_number;
        }
        (share, columns)
    }

    fn place(&mut self, numbers: &SVector<f64, UNKNOWNS>, reach: usize) {
        self.placed = Some(self.belief.placed(numbers[U], numbers[V], reach));
    }

    fn believed(&self, number: usize) -> (f64, f64) {
        (0.0, self.weights[number - WIDTH])
    }

    fn spill(&self, numbers: &SVector<f64, UNKNOWNS>) -> Spill {
        Spill {
            share: self.belief.numbers[3] + numbers[SPILL],
            ln_well: (self.belief.numbers[4] + numbers[WELL]).max(0.0),
            relative_error: LEARNING_ERROR,
            numbers: Some([SPILL, WELL]),
        }
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal, Uniform};
    use rand_pcg::Pcg64;

    use super::super::breadth::{ANY_LENS, ANY_LENS_SIGMA};
    use super::*;

    /// Points at any place in a pixel before lenses drawn from what is believed: how wide they are is what `breadth` takes it to be.
    #[test]
    fn any_lens_makes_points_as_wide_as_is_believed() {
        let mut random = Pcg64::new(11, 5);
        let in_a_pixel = Uniform::new(-0.5, 0.5).unwrap();
        let noise = PixelNoise { dark: 1.0, shot: 0.0, shape: 0.0, faint: 0.0 };
        let mut belief = Belief::new(noise, u8::MAX);
        let mut draw = |number: usize| {
            let normal = Normal::new(BELIEVED[number], KNOWN[number]).unwrap();
            let mut drawn = normal.sample_iter(&mut random);
            drawn.find(|value| (LEAST[number]..=MOST[number]).contains(value)).unwrap()
        };
        let mut places = Pcg64::new(12, 5);
        let mut logs: Vec<f64> = (0..20_000)
            .map(|_| {
                belief.go(Numbers::from_fn(|number, _| draw(number)));
                belief.draw();
                let [x_px, y_px] = [0; 2].map(|_| in_a_pixel.sample(&mut places));
                -libm::log(belief.spread().share(x_px, y_px))
            })
            .collect();
        logs.sort_unstable_by(f64::total_cmp);
        // How much narrower than the usual ones points are does not matter.
        for (share, sigmas) in [(0.5, 0.0), (0.841, 1.0), (0.977, 2.0), (0.995, 2.576)] {
            let log = logs[(share * logs.len() as f64) as usize];
            let expected = ANY_LENS + sigmas * ANY_LENS_SIGMA;
            assert!((log - expected).abs() < 0.15, "{share}: {log:.2} not {expected:.2}");
        }
    }
}
