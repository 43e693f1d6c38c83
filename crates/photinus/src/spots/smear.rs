//! Light that moves while the shutter is open: a point spread averaged along a segment.
//!
//! In: the spread of a point that stands still, and what the outline of a spot says of how far it moved. Out: the spread of one that moved
//! evenly, whose place is that of the middle of the exposure; how far it moved along columns and rows are two more unknowns.

use alloc::vec::Vec;

use nalgebra::SVector;

use super::fit::{self, Fitted, PixelNoise, PointSource, Shape, U, V, first};
use super::fitting::{Fitter, NO_POINT, WIDEST_POINT_PX, radius_px, spread};
use super::learning::UNKNOWNS;
use super::lessons::noise_of;
use super::neighbourhood::Neighbourhood;
use super::part::Part;
use super::window::Spill;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::lanes::Lanes;

/// Places along the segment, at most, and how many there are per pixel of it: pixels themselves smooth what lies between.
const MOST_PLACES: usize = 24;
const PLACES_PER_PX: f64 = 2.0;
/// How far the outline of a spot says how far it moved, px.
const OUTLINE_PX: f64 = 1.5;
/// How far the light of one spot is believed to move unlike that of the frame's others, px, and how many numbers that belief is worth.
const UNLIKE_PX: f64 = 0.7;
const UNLIKE_NUMBERS: f64 = 4.0;
/// Spots that are asked how far light moved, at most.
const MOST_ASKED: usize = 8;
/// A spot that stands out of noise by less says nothing of motion, sigmas.
const ASKED_SIGMAS: f64 = 6.0;
/// Outlines of spots that stand still are long in any direction: where their mean is no longer than wide by this, nothing moved, px.
const COHERENT_PX: f64 = 0.4;
/// Radius of the curves along which what a camera passes by or turns past moves, px: about the focal length of a small fisheye camera.
const BEND_RADIUS_PX: f64 = 300.0;
/// How far what looks round is taken to have moved, to begin with, px.
const ROUND_PX: f64 = 2.0;
/// Squared residuals that motion must explain, per spot and in all.
const EXPLAINED_PER_SPOT: f64 = 4.0;
const EXPLAINED: f64 = 16.0;
/// What is no longer than wide by this may be round, px.
const LEAST_PX: f64 = 1.2;

/// How far the light of a part moved along columns and rows, as its outline has it, px; `None` for what may be round.
pub(super) fn of_outline(part: &Part) -> Option<[f64; 2]> {
    let ((u, v), longer_px) = part.outline.direction();
    (longer_px >= LEAST_PX).then_some([longer_px * u, longer_px * v])
}

/// How the light of a frame's spots moved while the shutter was open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Along columns and rows, px.
    pub(super) moved_px: [f64; 2],
    /// How far a single spot may be from that, px.
    pub(super) sigma_px: f64,
}

impl Motion {
    /// That of a spot as its outline has it.
    fn of_outline(part: &Part) -> Option<Self> {
        of_outline(part).map(|moved_px| Self { moved_px, sigma_px: OUTLINE_PX })
    }

    /// The same, along a direction where that may be round.
    fn along(part: &Part, [u, v]: [f64; 2]) -> Self {
        let round = Self { moved_px: [ROUND_PX * u, ROUND_PX * v], sigma_px: OUTLINE_PX };
        Self::of_outline(part).unwrap_or(round)
    }

    /// That of a frame from that of spots: both ways along a segment are one.
    fn of_all(found: &[[f64; 2]]) -> Option<Self> {
        let longest = found.iter().max_by(|a, b| length_px(**a).total_cmp(&length_px(**b)))?;
        let count = found.len() as f64;
        let aligned = |moved: &[f64; 2]| {
            let along = moved[0] * longest[0] + moved[1] * longest[1];
            if along < 0.0 { moved.map(|axis| -axis) } else { *moved }
        };
        let mut moved_px = [0.0; 2];
        for own in found.iter().map(aligned) {
            moved_px = [moved_px[0] + own[0] / count, moved_px[1] + own[1] / count];
        }
        let unlike: f64 = found
            .iter()
            .map(aligned)
            .map(|own| {
                (own[0] - moved_px[0]) * (own[0] - moved_px[0])
                    + (own[1] - moved_px[1]) * (own[1] - moved_px[1])
            })
            .sum();
        let variance =
            (UNLIKE_NUMBERS * UNLIKE_PX * UNLIKE_PX + unlike) / (UNLIKE_NUMBERS + 2.0 * count - 2.0);
        (length_px(moved_px) >= LEAST_PX).then(|| Self { moved_px, sigma_px: variance.sqrt() })
    }
}

fn length_px([u, v]: [f64; 2]) -> f64 {
    libm::hypot(u, v)
}

/// Error of the middle of a streak that went this far, as if it were straight and even, px: ways in the image are curves. Of a way of length L
/// whose radius is R the middle lies L^2 / 24 R beside the centre of its light.
pub(super) fn bend_px(moved_px: [f64; 2]) -> f64 {
    let length_px = length_px(moved_px);
    length_px * length_px / (24.0 * BEND_RADIUS_PX)
}

/// The direction in which outlines are long, if there is one.
fn common_direction<'a>(parts: impl Iterator<Item = &'a Part>) -> Option<[f64; 2]> {
    let (mut mean, mut count) = ([0.0; 2], 0.0_f64);
    for part in parts {
        let ((u, v), longer_px) = part.outline.direction();
        // Twice the angle: both ways along a direction are one.
        mean = [mean[0] + longer_px * (u * u - v * v), mean[1] + 2.0 * longer_px * u * v];
        count += 1.0;
    }
    let angle = 0.5 * libm::atan2(mean[1], mean[0]);
    (length_px(mean) > COHERENT_PX * count).then(|| [libm::cos(angle), libm::sin(angle)])
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

    /// How the light of a frame moved, if it did: spots by themselves are asked whether a point that moved explains them better than one
    /// that stood still.
    pub(super) fn motion(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        near: &Neighbourhood,
        full_from: u8,
    ) -> Option<Motion> {
        let may_tell = |part: &&Part| {
            part.reason.is_none()
                && part.clutter_odds == 0.0
                && !part.outline.cut
                && part.radius_px <= WIDEST_POINT_PX
        };
        let direction = common_direction(parts.iter().filter(may_tell))?;
        let mut found = [[0.0; 2]; MOST_ASKED];
        let (mut asked, mut moved, mut explained) = (0, 0, 0.0);
        // Some of all over the frame: what lies beside each other may be the glare of one lamp.
        let step = parts.iter().filter(may_tell).count().div_ceil(MOST_ASKED).max(1);
        let telling = parts.iter().enumerate().filter(|(_, part)| may_tell(part));
        for (index, part) in telling.step_by(step) {
            let alone_px = radius_px(part) + 1.0;
            let stands_out =
                f64::from(part.outline.peak) - f64::from(part.level) > ASKED_SIGMAS * part.noise_dn;
            if asked == MOST_ASKED || !stands_out || near.room_px(index, alone_px) < alone_px {
                continue;
            }
            asked += 1;
            let outline = Motion::along(part, direction);
            let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
            let (noise, guess) = (self.window_noise(around), self.guess(part));
            let Some((still, streak, moved_px)) = self.still_or_streak(part, guess, noise, outline) else {
                continue;
            };
            if still - streak > EXPLAINED_PER_SPOT && length_px(moved_px) >= LEAST_PX {
                found[moved] = moved_px;
                moved += 1;
                explained += still - streak;
            }
        }
        let is_told = 2 * moved > asked && explained > EXPLAINED;
        let motion = Motion::of_all(&found[..moved]).filter(|_| is_told);
        // What was learnt of spots that moved unnoticed was wrong.
        if motion.is_some() && self.unknown_shape() > 0.0 {
            self.unlearn(noise_of(parts));
        }
        motion
    }

    /// What a part in the window leaves as a point that stands still and as one that moved, and how far that one moved, px; nothing where it
    /// stands still and fits.
    fn still_or_streak(
        &mut self,
        part: &Part,
        guess: (f64, f64, f64),
        noise: PixelNoise,
        outline: Motion,
    ) -> Option<(f64, f64, [f64; 2])> {
        if self.is_sharp() {
            let spread = spread(self.optics.as_deref(), &self.belief, part.guess);
            let mut point = PointSource::new(spread, self.source_size(), self.spill());
            let still = fit::fit(&mut self.window, &mut point, guess, noise);
            if still.as_ref().is_some_and(Fitted::fits) {
                return None;
            }
            let streak: Option<Fitted<7>> =
                fit::fit(&mut self.window, &mut Smeared::new(point, outline), guess, noise);
            compared(still.as_ref(), &streak?, 5)
        } else {
            let mut free = self.belief.free();
            let still = fit::fit(&mut self.window, &mut free, guess, noise);
            let streak: Option<Fitted<{ UNKNOWNS + 2 }>> =
                fit::fit(&mut self.window, &mut Smeared::new(free, outline), guess, noise);
            compared(still.as_ref(), &streak?, UNKNOWNS)
        }
    }

    /// Whether a point that moved leaves of a part no more than noise.
    fn is_streak(&mut self, frame: &FrameView<'_>, part: &Part) -> bool {
        let Some(moved) = Motion::of_outline(part) else { return false };
        let full_from = self.lowest_full(part.noise_dn);
        let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
        let (noise, guess) = (self.window_noise(around), self.guess(part));
        // Where the way bends, what a pixel has of the light is wrong by about as much as that moves a centre, in pixels.
        let bend_px = bend_px(moved.moved_px) as f32;
        let noise = PixelNoise { shape: (noise.shape * noise.shape + bend_px * bend_px).sqrt(), ..noise };
        if self.is_sharp() {
            let spread = spread(self.optics.as_deref(), &self.belief, part.guess);
            let mut streak = Smeared::new(PointSource::new(spread, self.source_size(), self.spill()), moved);
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

/// What two fits leave where what the better one leaves is noise, and how far the one that moved did.
fn compared<const M: usize, const N: usize>(
    still: Option<&Fitted<M>>,
    streak: &Fitted<N>,
    first: usize,
) -> Option<(f64, f64, [f64; 2])> {
    let misfit = (streak.chi2 / streak.freedom).max(1.0);
    let still = still.map_or(NO_POINT * streak.freedom, |still| still.chi2);
    Some((still / misfit, streak.chi2 / misfit, [streak.numbers[first], streak.numbers[first + 1]]))
}

/// A shape of `M` unknowns that moved; the two after them are how far.
pub(super) struct Smeared<S, const M: usize> {
    still: S,
    motion: Motion,
    places: [S; MOST_PLACES],
    count: usize,
}

impl<S: Shape<M> + Copy, const M: usize> Smeared<S, M> {
    pub(super) fn new(still: S, motion: Motion) -> Self {
        Self { still, motion, places: [still; MOST_PLACES], count: 0 }
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
            Some(axis) => (self.motion.moved_px[axis], 1.0 / (self.motion.sigma_px * self.motion.sigma_px)),
            None => self.still.believed(number),
        }
    }

    fn spill(&self, numbers: &SVector<f64, N>) -> Spill {
        self.still.spill(&first::<M, N>(numbers))
    }
}
