//! Light that moves while the shutter is open: a point spread averaged along a segment.
//!
//! In: the spread of a point that stands still, and what the outline of a spot says of how far it moved. Out: the spread of one that moved
//! evenly, whose place is that of the middle of the exposure; how far it moved along columns and rows are two more unknowns.

use alloc::vec::Vec;

use nalgebra::SVector;

use super::fit::{self, Fitted, PointSource, Shape, U, V};
use super::fitting::{Fitter, SIZE_PX2, WIDEST_POINT_PX, spread};
use super::learning::UNKNOWNS;
use super::part::Part;
use super::window::Spill;
use crate::frame::FrameView;
use crate::lanes::Lanes;

/// Places along the segment, at most, and how many there are per pixel of it: pixels themselves smooth what lies between.
const MOST_PLACES: usize = 24;
const PLACES_PER_PX: f64 = 2.0;
/// How far the outline of a spot says how far it moved, px.
const OUTLINE_PX: f64 = 1.5;
/// What is no longer than wide by this may be round, px.
const LEAST_PX: f64 = 1.2;

/// How far the light of a part moved along columns and rows, as its outline has it, px; `None` for what may be round.
pub(super) fn of_outline(part: &Part) -> Option<[f64; 2]> {
    let ((u, v), longer_px) = part.outline.direction();
    (longer_px >= LEAST_PX).then_some([longer_px * u, longer_px * v])
}

/// Whether most of a frame's parts are long: light moved, the vehicles or the camera with it.
fn is_smeared<'a>(parts: impl Iterator<Item = &'a Part>) -> bool {
    let (mut long, mut all) = (0, 0);
    for part in parts {
        all += 1;
        long += u32::from(of_outline(part).is_some());
    }
    2 * long > all
}

impl Fitter {
    /// Tells whether light moved in a frame, and takes components that were split for one part each where it did and explains them: the
    /// steps of a streak across pixels look like summits.
    pub(super) fn join_smeared(&mut self, frame: &FrameView<'_>, parts: &mut Vec<Part>, split: &[Part]) {
        let whole = parts.iter().filter(|part| part.split_from.is_none()).chain(split);
        self.is_smeared = self.fits && is_smeared(whole.filter(|part| part.radius_px <= WIDEST_POINT_PX));
        if !self.is_smeared {
            return;
        }
        let mut joined = core::mem::take(&mut self.joined);
        joined.clear();
        joined.extend(
            (0..split.len())
                .filter(|&at| split[at].radius_px <= WIDEST_POINT_PX && self.is_streak(frame, &split[at])),
        );
        parts.retain(|part| part.split_from.is_none_or(|at| joined.binary_search(&at).is_err()));
        parts.extend(joined.iter().map(|&at| split[at]));
        self.joined = joined;
    }

    /// Whether a point that moved leaves of a part no more than noise.
    fn is_streak(&mut self, frame: &FrameView<'_>, part: &Part) -> bool {
        let Some(moved) = of_outline(part) else { return false };
        let full_from = self.lowest_full();
        let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
        let (noise, guess) = (self.pixel_noise(around), self.guess(part));
        if self.is_sure() {
            let spread = spread(self.optics.as_deref(), &self.belief, part.guess);
            let mut streak = Smeared::new(PointSource::new(spread, SIZE_PX2, self.spill()), moved);
            let fitted: Option<Fitted<7>> = fit::fit(&mut self.window, &mut streak, guess, noise);
            fitted.is_some_and(|fitted| fitted.leaves_noise())
        } else {
            let mut streak = Smeared::new(self.belief.free(), moved);
            let fitted: Option<Fitted<{ UNKNOWNS + 2 }>> =
                fit::fit(&mut self.window, &mut streak, guess, noise);
            fitted.is_some_and(|fitted| fitted.leaves_noise())
        }
    }
}

/// A shape of `M` unknowns that moved; the two after them are how far.
pub(super) struct Smeared<S, const M: usize> {
    still: S,
    moved_px: [f64; 2],
    places: [S; MOST_PLACES],
    count: usize,
}

impl<S: Shape<M> + Copy, const M: usize> Smeared<S, M> {
    pub(super) fn new(still: S, moved_px: [f64; 2]) -> Self {
        Self { still, moved_px, places: [still; MOST_PLACES], count: 0 }
    }

    /// Where in the exposure a place stands, -1/2 to 1/2.
    fn time(&self, place: usize) -> f64 {
        (place as f64 + 0.5) / self.count as f64 - 0.5
    }
}

impl<S: Shape<M> + Copy, const M: usize, const N: usize> Shape<N> for Smeared<S, M> {
    fn shares(&self, row: usize, column: usize, numbers: &SVector<f64, N>) -> (Lanes, [Lanes; N]) {
        let still = first::<M, N>(numbers);
        let (mut share, mut columns) = (Lanes::ZERO, [Lanes::ZERO; N]);
        let weight = Lanes::splat(1.0 / self.count.max(1) as f32);
        for (place, spread) in self.places[..self.count].iter().enumerate() {
            let (own, slopes) = spread.shares(row, column, &still);
            share += weight * own;
            for (column, slope) in columns.iter_mut().zip(slopes) {
                *column += weight * slope;
            }
            let time = weight * Lanes::splat(self.time(place) as f32);
            columns[M] += time * slopes[U];
            columns[M + 1] += time * slopes[V];
        }
        (share, columns)
    }

    fn place(&mut self, numbers: &SVector<f64, N>, reach: usize) {
        let [along_u, along_v] = [numbers[M], numbers[M + 1]];
        let places = (PLACES_PER_PX * libm::hypot(along_u, along_v)) as usize + 2;
        self.count = places.min(MOST_PLACES);
        for place in 0..self.count {
            let mut there = first::<M, N>(numbers);
            there[U] += self.time(place) * along_u;
            there[V] += self.time(place) * along_v;
            self.places[place].place(&there, reach);
        }
    }

    fn believed(&self, number: usize) -> (f64, f64) {
        match number.checked_sub(M) {
            Some(axis) => (self.moved_px[axis], 1.0 / (OUTLINE_PX * OUTLINE_PX)),
            None => self.still.believed(number),
        }
    }

    fn spill(&self, numbers: &SVector<f64, N>) -> Spill {
        self.still.spill(&first::<M, N>(numbers))
    }
}

fn first<const M: usize, const N: usize>(numbers: &SVector<f64, N>) -> SVector<f64, M> {
    SVector::from_fn(|number, _| numbers[number])
}
