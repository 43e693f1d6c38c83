//! A shape with one more point of light beside it, of the same point spread.
//!
//! The point's own numbers come after those of the shape: where it is, and the logarithm of its light over the first one's. Numbers of width are both of
//! theirs. A shape with a point beside it may have another beside it.

use nalgebra::SVector;

use super::fit::{self, Shape, U, V, WIDTH, first};
use super::window::Spill;
use crate::lanes::Lanes;

/// How far the point is from where it is looked for, px, and its light from the first guess, as a logarithm.
const PLACE_KNOWN_PX: f64 = 1.5;
const LIGHT_KNOWN: f64 = 1.5;

/// A first guess of the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess {
    /// From the middle of the window, px.
    pub(super) place_px: (f64, f64),
    /// The logarithm of its light over that of the first.
    pub(super) ln_ratio: f64,
}

impl Guess {
    /// Of no point.
    pub(super) const NOWHERE: Self = Self { place_px: (0.0, 0.0), ln_ratio: 0.0 };
}

/// A shape of `K` unknowns with a point of `M` beside it.
pub(super) struct Beside<S, P, const K: usize, const M: usize> {
    shape: S,
    point: P,
    guess: Guess,
    /// The light of the point over that of the first, where they were placed last.
    times: Lanes,
}

impl<S: Shape<K>, P: Shape<M>, const K: usize, const M: usize> Beside<S, P, K, M> {
    /// The numbers of the point: where it is, and the logarithm of its light over the first one's.
    pub(super) const U: usize = K;
    pub(super) const V: usize = K + 1;
    pub(super) const RATIO: usize = K + 2;

    pub(super) fn new(shape: S, point: P, guess: Guess) -> Self {
        Self { shape, point, guess, times: Lanes::ONE }
    }

    /// The point's own numbers.
    fn own<const N: usize>(numbers: &SVector<f64, N>) -> SVector<f64, M> {
        let mut own = first(numbers);
        (own[U], own[V]) = (numbers[Self::U], numbers[Self::V]);
        own
    }
}

impl<S: Shape<K>, P: Shape<M>, const K: usize, const M: usize, const N: usize> Shape<N>
    for Beside<S, P, K, M>
{
    #[inline(always)]
    fn shares(&self, row: usize, column: usize, numbers: &SVector<f64, N>) -> (Lanes, [Lanes; N]) {
        let (share, by_number) = self.shape.shares(row, column, &first(numbers));
        let (own, by_own) = self.point.shares(row, column, &Self::own(numbers));
        let times = self.times;
        let mut columns = [Lanes::ZERO; N];
        columns[..K].copy_from_slice(&by_number);
        for width in WIDTH..M {
            columns[width] += times * by_own[width];
        }
        (columns[Self::U], columns[Self::V]) = (times * by_own[U], times * by_own[V]);
        columns[Self::RATIO] = times * own;
        (share + times * own, columns)
    }

    fn points(&self) -> usize {
        self.shape.points() + 1
    }

    fn place_of(&self, point: usize) -> [usize; 2] {
        if point < self.shape.points() { self.shape.place_of(point) } else { [Self::U, Self::V] }
    }

    fn is_short(&self, step: &SVector<f64, N>) -> bool {
        step[Self::RATIO].abs() < 0.3 * fit::DONE_SHARE && self.shape.is_short(&first(step))
    }

    fn place(&mut self, numbers: &SVector<f64, N>, reach: usize) {
        self.shape.place(&first(numbers), reach);
        self.point.place(&Self::own(numbers), reach);
        self.times = Lanes::splat(libm::exp(numbers[Self::RATIO]) as f32);
    }

    fn believed(&self, number: usize) -> (f64, f64) {
        let place_weight = 1.0 / (PLACE_KNOWN_PX * PLACE_KNOWN_PX);
        match number.checked_sub(K) {
            None => self.shape.believed(number),
            Some(0) => (self.guess.place_px.0, place_weight),
            Some(1) => (self.guess.place_px.1, place_weight),
            Some(_) => (self.guess.ln_ratio, 1.0 / (LIGHT_KNOWN * LIGHT_KNOWN)),
        }
    }

    fn spill(&self, numbers: &SVector<f64, N>) -> Spill {
        self.shape.spill(&first(numbers))
    }
}
