//! What the frames themselves tell of the camera, where nobody measured it.
//!
//! In: spots as fitted, frame after frame. Out: the point spread (a core and a halo around it, both Gaussians), the noise of a
//! pixel by its light, how wrong the point spread is, and the level at which pixels are full. All begin with what is believed of
//! any camera, and each frame's spots count like more pixels of one great fit: the same frames in the same order
//! give the same belief.

use nalgebra::{SMatrix, SVector};

use super::fit::{PixelNoise, Shape, U, V, WIDTH};
use super::noise_bins::NoiseBins;
use super::settings::Noise;
use super::window::Spill;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::Lanes;
use crate::optics::{Placed, PointSpread, Profile, Shares};

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

/// The number that says how much spills, and how wrong the charge is that spills into a pixel, as a share of it.
const SPILL: usize = WIDTH + 3;
const WELL: usize = WIDTH + 4;
const SPILL_ERROR: f64 = 0.3;

/// What a spot says nothing of seems to be told by no more than this share of what was known of it.
const ROUNDING: f64 = 1e-6;

/// How far windows see, about, px.
const SEEN_PX: f64 = 3.5;

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

/// What is believed of a camera's optics.
#[derive(Debug)]
pub(super) struct Belief {
    numbers: Numbers,
    /// Information on the numbers and its product with them, from all frames.
    information: Information,
    weighted: Numbers,
    spread: PointSpread,
    by_number: [PointSpread; 3],
    noise: NoiseBins,
}

impl Belief {
    /// What is believed before a frame is seen of a camera whose full pixels read `full_from` or more: where that is less than the
    /// converter's end, it is the well that is full.
    pub(super) fn new(noise: Noise, full_from: u8) -> Self {
        let (mut numbers, mut known) = (Numbers::from(BELIEVED), KNOWN);
        if full_from < u8::MAX {
            (numbers[NUMBERS - 1], known[NUMBERS - 1]) = (0.0, SAME_WELL);
        }
        let weights = known.map(|sigma| 1.0 / (sigma * sigma));
        let information = Information::from_diagonal(&Numbers::from(weights));
        let mut belief = Self {
            numbers,
            information,
            weighted: information * numbers,
            spread: PointSpread::dark(),
            by_number: core::array::from_fn(|_| PointSpread::dark()),
            noise: NoiseBins::new(noise),
        };
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
        Spill { share: self.numbers[3], ln_well: self.numbers[4], relative_error: SPILL_ERROR, numbers: None }
    }

    pub(super) fn noise(&self) -> PixelNoise {
        self.noise.noise
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
        let covariance = self.information.try_inverse().unwrap_or_else(Information::zeros);
        core::array::from_fn(|i| covariance[(i, i)].max(0.0).sqrt())
    }

    /// How surely the numbers are known, each by itself: one over its variance.
    pub(super) fn weights(&self) -> [f64; NUMBERS] {
        self.sigmas().map(|sigma| 1.0 / (sigma * sigma))
    }

    /// The spread with its numbers free.
    pub(super) fn free(&self) -> FreeSpread<'_> {
        FreeSpread { belief: self, weights: self.weights(), placed: None }
    }

    /// Where the numbers of a camera that nobody measured are looked for.
    pub(super) fn believed() -> Beginning {
        Beginning { core_px: libm::exp(BELIEVED[0]), spill: BELIEVED[3] }
    }

    /// Begins to look for the numbers there, before a frame has told anything.
    pub(super) fn begin(&mut self, Beginning { core_px, spill }: Beginning) {
        let Some(covariance) = self.information.try_inverse() else { return };
        self.numbers = covariance * self.weighted;
        self.numbers[0] = libm::log(core_px.clamp(0.3, 2.5));
        self.numbers[3] = spill;
        self.draw();
    }

    /// How far the numbers are from what was believed before, squared, in sigmas.
    pub(super) fn strain(&self) -> f64 {
        let off = self.information * self.numbers - self.weighted;
        self.information.try_inverse().map_or(0.0, |covariance| off.dot(&(covariance * off)))
    }

    /// Takes in what a frame's spots say: their information on the numbers and its product with them, differences from the numbers of
    /// now. Says whether the spread has moved by more than its sigma allows.
    pub(super) fn take(&mut self, told: &Told) -> bool {
        let information = self.information + told.information;
        let weighted = self.weighted + told.weighted + told.information * self.numbers;
        let Some(covariance) = information.try_inverse() else { return false };
        let mut numbers = covariance * weighted;
        for i in 0..NUMBERS {
            numbers[i] =
                numbers[i].clamp(LEAST[i], MOST[i]).clamp(self.numbers[i] - 0.5, self.numbers[i] + 0.5);
        }
        let moved = (0..NUMBERS).any(|i| {
            let sigma = covariance[(i, i)].max(0.0).sqrt();
            (numbers[i] - self.numbers[i]).abs() > (0.5 * sigma).max(0.002)
        });
        if moved {
            self.numbers = numbers;
            self.draw();
        }
        moved
    }

    /// Keeps what a frame's spots said for good.
    pub(super) fn keep(&mut self, told: &Told, numbers: Numbers) {
        self.information += told.information;
        self.weighted += told.weighted + told.information * numbers;
    }

    pub(super) fn numbers(&self) -> Numbers {
        self.numbers
    }

    pub(super) fn noise_bins(&mut self) -> &mut NoiseBins {
        &mut self.noise
    }

    fn draw(&mut self) {
        let [core_px, share, wider] =
            [libm::exp(self.numbers[0]), self.numbers[1], libm::exp(self.numbers[2])];
        let (core, halo) = (Profile::new(core_px), Profile::new(core_px * wider));
        let mut add = |of: usize, terms: &[(f64, &Profile, bool)]| {
            let spread = if of == 3 { &mut self.spread } else { &mut self.by_number[of] };
            spread.clear();
            for &(weight, profile, is_slope) in terms {
                if is_slope {
                    spread.add_product(weight, &profile.by_ln_sigma, &profile.shares);
                    spread.add_product(weight, &profile.shares, &profile.by_ln_sigma);
                } else {
                    spread.add_product(weight, &profile.shares, &profile.shares);
                }
            }
            spread.sort_coefficients();
        };
        add(3, &[(1.0 - share, &core, false), (share, &halo, false)]);
        add(0, &[(1.0 - share, &core, true), (share, &halo, true)]);
        add(1, &[(1.0, &halo, false), (-1.0, &core, false)]);
        add(2, &[(share.max(0.02), &halo, true)]);
    }
}

/// What the spots of a frame say of the numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    information: Information,
    weighted: Numbers,
}

impl Told {
    /// Adds a spot that was fitted with the numbers free: its answer and covariance, with what was believed beforehand taken out.
    pub(super) fn add(
        &mut self,
        answer: &Numbers,
        covariance: &Information,
        weights: [f64; NUMBERS],
        trust: f64,
    ) {
        let Some(information) = covariance.try_inverse() else { return };
        let mut own = information - Information::from_diagonal(&Numbers::from(weights));
        let mut weighted = information * answer;
        for i in 0..NUMBERS {
            let rounding = ROUNDING * weights[i];
            // No fit takes away what was known.
            if own[(i, i)] < -rounding {
                return;
            }
            if own[(i, i)] < rounding {
                own.row_mut(i).fill(0.0);
                own.column_mut(i).fill(0.0);
                weighted[i] = 0.0;
            }
        }
        self.information += own * trust;
        self.weighted += weighted * trust;
    }
}

/// A point whose spread is not known yet: differences of the three numbers from what is believed are free.
#[derive(Clone, Copy)]
pub(super) struct FreeSpread<'a> {
    belief: &'a Belief,
    weights: [f64; NUMBERS],
    placed: Option<[Placed<'a>; 4]>,
}

impl Shape<UNKNOWNS> for FreeSpread<'_> {
    #[inline(always)]
    fn shares(
        &self,
        row: usize,
        column: usize,
        numbers: &SVector<f64, UNKNOWNS>,
    ) -> (Lanes, [Lanes; UNKNOWNS]) {
        let Some([spread, by_number @ ..]) = &self.placed else {
            return (Lanes::ZERO, [Lanes::ZERO; UNKNOWNS]);
        };
        let Shares { mut share, by_u, by_v, .. } = spread.four(row, column);
        let mut columns = [Lanes::ZERO; UNKNOWNS];
        (columns[0], columns[1]) = (by_u, by_v);
        for (i, by_number) in by_number.iter().enumerate() {
            columns[WIDTH + i] = by_number.four(row, column).share;
            share += Lanes::splat(numbers[WIDTH + i] as f32) * columns[WIDTH + i];
        }
        (share, columns)
    }

    fn place(&mut self, numbers: &SVector<f64, UNKNOWNS>, reach: usize) {
        let (u, v) = (numbers[U], numbers[V]);
        let [a, b, c] = &self.belief.by_number;
        let spreads = [&self.belief.spread, a, b, c];
        self.placed = Some(spreads.map(|spread| spread.placed(u as f32, v as f32, reach)));
    }

    fn believed(&self, number: usize) -> (f64, f64) {
        (0.0, self.weights[number - WIDTH])
    }

    fn spill(&self, numbers: &SVector<f64, UNKNOWNS>) -> Spill {
        Spill {
            share: self.belief.numbers[3] + numbers[SPILL],
            ln_well: (self.belief.numbers[4] + numbers[WELL]).max(0.0),
            relative_error: SPILL_ERROR,
            numbers: Some([SPILL, WELL]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A spot that says nothing of what spills does so but for rounding, to either side.
        #[test]
        fn a_spot_tells_what_it_tells_whatever_it_says_nothing_of(
            sigmas in prop::array::uniform5(0.01..1.0f64), told in 1.0..1e6f64, off in -0.1..0.1f64,
        ) {
            let weights = sigmas.map(|sigma| 1.0 / (sigma * sigma));
            let mut information = Information::from_diagonal(&Numbers::from(weights));
            information[(0, 0)] += told;
            let covariance = information.try_inverse().unwrap();
            let mut answer = Numbers::zeros();
            answer[0] = off * told / information[(0, 0)];
            let mut all = Told::default();
            all.add(&answer, &covariance, weights, 1.0);
            prop_assert!((all.information[(0, 0)] / told - 1.0).abs() < 1e-6 * weights[0]);
            prop_assert!((all.weighted[0] - off * told).abs() < 1e-9 * told * (1.0 + weights[0]));
            prop_assert_eq!(all.information.fixed_view::<4, 4>(1, 1), SMatrix::<f64, 4, 4>::zeros());
            prop_assert_eq!(all.weighted.fixed_rows::<4>(1), SVector::<f64, 4>::zeros());
        }
    }

    #[test]
    fn a_fit_that_would_take_away_what_was_known_tells_nothing() {
        let weights = [4.0; NUMBERS];
        let mut information = Information::from_diagonal(&Numbers::from(weights)) * 2.0;
        information[(4, 4)] = 3.0;
        let mut all = Told::default();
        all.add(&Numbers::zeros(), &information.try_inverse().unwrap(), weights, 1.0);
        assert_eq!(all.information, Information::zeros());
    }
}
