//! The pixels that tell of a spot.
//!
//! In: the frame, a place, how far to look, the background there. Out: the signal above the background in a disc of pixels, which of
//! them are full, and what other spots and overflown charge add to them. Rows are whole lanes, so that sums over them are the
//! same on every machine.

use alloc::vec::Vec;
use core::mem;

use super::cut_off::CutOff;
use super::patch::Surroundings;
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::lanes::{self, LANES, Lanes};
use crate::optics::{HotPixels, PointSpread, Response};

/// Farthest pixels of a window from its middle, along rows and columns.
pub(super) const WIDEST_PX: usize = 10;

/// Four pixels of a window.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Four {
    pub(super) row: usize,
    pub(super) column: usize,
    /// Grey levels above the background.
    pub(super) signal: Lanes,
    /// 1 for a pixel that counts, 0 for one outside the window, the frame, or what is this spot's.
    pub(super) counts: Lanes,
    /// 1 for a pixel that is full: its signal is a lower limit.
    pub(super) full: Lanes,
    /// Light that is not this spot's, grey levels, and its variance.
    pub(super) others: Lanes,
    pub(super) others_variance: Lanes,
    /// Charge that spills over from full pixels, grey levels, and its variance.
    pub(super) spilled: Lanes,
    pub(super) spilled_variance: Lanes,
}

/// What was read into a window, to be looked at again.
#[derive(Debug, Default)]
pub(super) struct Copied {
    middle: (i32, i32),
    reach: usize,
    pub(super) full_px: u32,
    fours: Vec<Four>,
    floor_dn: Option<f32>,
    full_dn: f32,
    given: Vec<f32>,
}

impl Copied {
    /// Nothing, with room for the widest window.
    pub(super) fn blank() -> Self {
        Self {
            fours: Vec::with_capacity(MOST_FOURS),
            given: Vec::with_capacity(MOST_CHARGES),
            ..Self::default()
        }
    }
}

/// A model that pixels are read with: where the numbers of a point are among its unknowns, as `fit` has them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// The light of the first point and the level of the background, grey levels, ...
    pub(super) light: f32,
    pub(super) level: f32,
    /// ... and which unknowns they are.
    pub(super) numbers: [usize; 2],
}

/// The pixels around a spot.
#[derive(Debug, Default)]
pub(super) struct Window {
    /// The pixel in the middle.
    pub(super) middle: (i32, i32),
    /// Pixels from the middle to a side.
    pub(super) reach: usize,
    /// Pixels that are full.
    pub(super) full_px: u32,
    pub(super) fours: Vec<Four>,
    /// The share of the light that a shape has in each of them, and its slopes, those of one after those of another.
    shares: Vec<Lanes>,
    slopes: Vec<Lanes>,
    /// What noisy pixels read, and the signal at which they are cut off, grey levels; `None` where noise does not reach as low.
    pub(super) cut_off: CutOff,
    pub(super) floor_dn: Option<f32>,
    /// Signal of a full pixel in the middle of the window, grey levels.
    full_dn: f32,
    charge: Vec<f32>,
    /// What each pixel gives on.
    given: Vec<f32>,
    /// How what spills into each four pixels changes with the numbers, those of one after those of another.
    spilled_slopes: Vec<Lanes>,
    giving: Vec<Giving>,
    /// How what each pixel gives on changes with four of the numbers, by what light adds to it and in all.
    own_by: Vec<Lanes>,
    given_by: Vec<Lanes>,
}

/// A pixel that gives charge on: where it is among all, which four it is of, and which of these.
#[derive(Clone, Copy, Debug)]
struct Giving {
    at: usize,
    four: usize,
    lane: usize,
}

/// What becomes of charge above a full well.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spill {
    /// Share of it that spills into the neighbours.
    pub(super) share: f64,
    /// Logarithm of the charge of a full well over that of a pixel that reads as full.
    pub(super) ln_well: f64,
    /// Error of the charge that spills into a pixel, over that.
    pub(super) relative_error: f64,
    /// Which of the unknowns share and logarithm are, where they are unknown.
    pub(super) numbers: Option<[usize; 2]>,
}

/// Rounds in which charge spills on, at most; a change by which all is done, grey levels.
const ROUNDS: usize = 16;
const DONE_DN: f32 = 0.5;
/// What spills all around a pixel comes back to it less by so much, where as many pixels give as spots have full ones.
const COMES_BACK: f64 = 0.95;
/// Rounds in which slopes of what spills are worked out, at most, and what is left of their errors.
const SLOPE_ROUNDS: usize = 8;
const LEFT_OF_SLOPES: f64 = 0.004;
/// Rows of a window with one before and one after.
const MOST_ROWS: usize = 2 * WIDEST_PX + 3;
/// Fours of pixels of a window, and pixels with those around it, at most.
const MOST_FOURS: usize = (MOST_ROWS - 2) * (MOST_ROWS - 2).div_ceil(LANES);
const MOST_CHARGES: usize = MOST_ROWS * (MOST_ROWS - 2 + LANES + 1);
/// Unknowns of a fit, at most.
const MOST_UNKNOWNS: usize = 15;

impl Window {
    /// Reads the disc of `radius_px` around the pixel nearest to `place`, less the background; a pixel of `full_from` grey levels or
    /// more is full.
    pub(super) fn read(
        &mut self,
        frame: &FrameView<'_>,
        place: Pixel,
        radius_px: f64,
        around: &Surroundings,
        full_from: u8,
    ) {
        self.make_room();
        let (u, v) = nearest_pixel(place);
        let reach = (radius_px.max(1.0) as usize).min(WIDEST_PX) as i32;
        (self.middle, self.reach, self.full_px) = ((u, v), reach as usize, 0);
        self.full_dn = f32::from(full_from) - around.level;
        self.floor_dn = around.is_cut_off.then_some(-around.level);
        self.fours.clear();
        self.given.clear();
        let side = 2 * reach + 1;
        let room_px2 = (radius_px * radius_px) as f32;
        let width = frame.width() as i32;
        for row in 0..side {
            let dv = row - reach;
            if !(0..frame.height() as i32).contains(&(v + dv)) {
                continue;
            }
            let pixels = frame.row((v + dv) as usize);
            let [rise_u, rise_v] = around.slope;
            let level = around.level + rise_v * dv as f32;
            for column in (0..side).step_by(LANES) {
                let [mut signal, mut counts, mut full] = [[0.0; LANES]; 3];
                for lane in 0..LANES {
                    let du = column + lane as i32 - reach;
                    let inside = (0..width).contains(&(u + du)) && du <= reach;
                    if inside && (du * du + dv * dv) as f32 <= room_px2 {
                        let pixel = pixels[(u + du) as usize];
                        signal[lane] = f32::from(pixel) - (level + rise_u * du as f32);
                        counts[lane] = 1.0;
                        if pixel >= full_from {
                            full[lane] = 1.0;
                            self.full_px += 1;
                        }
                    }
                }
                let counts = Lanes::new(counts);
                if counts == Lanes::ZERO {
                    continue;
                }
                let (signal, full) = (Lanes::new(signal), Lanes::new(full));
                let four = Four {
                    row: row as usize,
                    column: column as usize,
                    signal,
                    counts,
                    full,
                    ..Four::default()
                };
                self.fours.push(four);
            }
        }
    }

    /// Takes all room that it will ever need, once.
    fn make_room(&mut self) {
        if self.giving.capacity() > 0 {
            return;
        }
        self.shares.reserve(MOST_FOURS);
        for slopes in [&mut self.slopes, &mut self.spilled_slopes] {
            slopes.reserve(MOST_UNKNOWNS * MOST_FOURS);
        }
        for charges in [&mut self.charge, &mut self.given] {
            charges.reserve(MOST_CHARGES);
        }
        self.giving.reserve(LANES * MOST_FOURS);
        self.own_by.reserve(LANES * MOST_FOURS);
        self.given_by.reserve(MOST_CHARGES);
    }

    /// Takes pixels out that are bright without light.
    pub(super) fn leave_out(&mut self, hot_pixels: &HotPixels) {
        for four in &mut self.fours {
            let at = |offset: usize, middle: i32| middle + offset as i32 - self.reach as i32;
            let first = at(four.column, self.middle.0);
            let Ok(row) = u32::try_from(at(four.row, self.middle.1)) else { continue };
            for hot in hot_pixels.of_row(row) {
                let lane = i64::from(hot.column) - i64::from(first);
                if (0..LANES as i64).contains(&lane) {
                    let (mut counts, mut full) = (four.counts.to_array(), four.full.to_array());
                    self.full_px -= full[lane as usize] as u32;
                    (counts[lane as usize], full[lane as usize]) = (0.0, 0.0);
                    (four.counts, four.full) = (Lanes::new(counts), Lanes::new(full));
                }
            }
        }
    }

    /// Makes of grey levels the light that they stand for; the noise of darkness, `dark` grey levels^2, grows with the slope.
    pub(super) fn straighten(&mut self, response: &Response, dark: f32) {
        for four in &mut self.fours {
            let (mut light, mut more) = (four.signal.to_array(), [0.0; LANES]);
            for (light, more) in light.iter_mut().zip(&mut more) {
                let (straight, slope) = response.straightened(f64::from(*light));
                (*light, *more) = (straight as f32, dark * (slope * slope - 1.0) as f32);
            }
            four.signal = Lanes::new(light);
            four.others_variance += Lanes::new(more);
        }
        self.full_dn = response.straightened(f64::from(self.full_dn)).0 as f32;
    }

    /// Keeps the share of the light and the slopes that a shape has in every four pixels.
    pub(super) fn keep<const N: usize>(&mut self, shape: impl Fn(&Four) -> (Lanes, [Lanes; N])) {
        self.shares.clear();
        self.slopes.clear();
        for four in &self.fours {
            let (share, slopes) = shape(four);
            self.shares.push(share);
            self.slopes.extend_from_slice(&slopes);
        }
    }

    /// What was kept of the four pixels of this number, as many slopes as were.
    #[inline(always)]
    pub(super) fn kept<const N: usize>(&self, four: usize) -> Option<(Lanes, [Lanes; N])> {
        let slopes = self.slopes.get(four * N..)?.first_chunk()?;
        Some((*self.shares.get(four)?, *slopes))
    }

    /// Lets charge above a full well spill: a share of it into the four neighbours and the rest away, until no pixel has more; the light of pixels without
    /// that is by the share that was kept. Says how what spills changes with each of `N` numbers, too.
    pub(super) fn overflow<const N: usize>(&mut self, spill: &Spill, scale: Scale) {
        let side = 2 * self.reach + 1;
        let stride = side + LANES + 1;
        self.charge.clear();
        self.charge.resize((side + 2) * stride, 0.0);
        let (of_all, level) = (Lanes::splat(scale.light), Lanes::splat(scale.level));
        for (four, &share) in self.fours.iter().zip(&self.shares) {
            let at = (four.row + 1) * stride + four.column + 1;
            let light = (of_all * share + level + four.others).to_array();
            // Beside the pixels that count a model may be without bounds.
            let charge = light.map(|light| if light.is_finite() { light } else { 0.0 });
            self.charge[at..at + LANES].copy_from_slice(&charge);
        }
        let well_dn = self.full_dn * libm::exp(spill.ln_well) as f32;
        let relative_error = Lanes::splat(spill.relative_error as f32);
        // What pixels gave on in the step before is where to begin, unless it was of another window, or of light without bounds.
        if self.given.len() != self.charge.len() || self.given.iter().any(|given| !given.is_finite()) {
            self.given.clear();
            self.given.resize(self.charge.len(), 0.0);
        }
        self.spill(spill.share, well_dn, stride);
        let quarter = Lanes::splat(quarter(spill.share));
        for four in &mut self.fours {
            let at = (four.row + 1) * stride + four.column + 1;
            let read = |at: usize| {
                self.given[at..].first_chunk::<LANES>().map_or(Lanes::ZERO, |&four| Lanes::new(four))
            };
            let received = read(at - 1) + read(at + 1) + read(at - stride) + read(at + stride);
            // What is full reads as full whatever it gives on.
            four.spilled = lanes::positive(quarter * received - read(at));
            four.spilled_variance = (four.spilled * relative_error) * (four.spilled * relative_error);
        }
        self.spilled_slopes.clear();
        self.spilled_slopes.resize(self.fours.len() * N, Lanes::ZERO);
        self.find_giving(stride);
        if !self.giving.is_empty() {
            for first in (0..N).step_by(LANES) {
                self.slope::<N>(first, spill, scale, well_dn, stride);
            }
        }
    }

    /// Finds the pixels that give charge on.
    fn find_giving(&mut self, stride: usize) {
        self.giving.clear();
        for (number, four) in self.fours.iter().enumerate() {
            for lane in 0..LANES {
                let at = (four.row + 1) * stride + four.column + 1 + lane;
                if self.given[at] > 0.0 {
                    self.giving.push(Giving { at, four: number, lane });
                }
            }
        }
    }

    /// Works out how what spills changes with the four numbers from `first` on: where pixels give, given = charge - well + what the neighbours give, all of
    /// it linear.
    fn slope<const N: usize>(
        &mut self,
        first: usize,
        spill: &Spill,
        scale: Scale,
        well_dn: f32,
        stride: usize,
    ) {
        let share_and_well = spill.numbers.unwrap_or([N; 2]);
        let Self { fours, shares, slopes, given, giving, own_by, given_by, spilled_slopes, .. } = self;
        let around = |at: usize| given[at - 1] + given[at + 1] + given[at - stride] + given[at + stride];
        own_by.clear();
        own_by.extend(giving.iter().map(|&Giving { at, four, lane }| {
            let own = |number: usize| match number {
                _ if number >= N => 0.0,
                _ if number == scale.numbers[0] => shares[four].to_array()[lane],
                _ if number == scale.numbers[1] => 1.0,
                _ if number == share_and_well[0] => 0.25 * around(at),
                _ if number == share_and_well[1] => -well_dn,
                _ => scale.light * slopes[four * N + number].to_array()[lane],
            };
            Lanes::new(core::array::from_fn(|number| own(first + number)))
        }));
        given_by.clear();
        given_by.resize(given.len(), Lanes::ZERO);
        let quarter = Lanes::splat(quarter(spill.share));
        let over_relaxed = over_relaxed(spill.share);
        let rounds = libm::ceil(libm::log(LEFT_OF_SLOPES) / libm::log(over_relaxed - 1.0)) as usize + 1;
        let over_relaxed = Lanes::splat(over_relaxed as f32);
        let received =
            |by: &[Lanes], at: usize| quarter * (by[at - 1] + by[at + 1] + by[at - stride] + by[at + stride]);
        for round in 0..rounds.min(SLOPE_ROUNDS) {
            for step in 0..giving.len() {
                let step = if round % 2 == 0 { step } else { giving.len() - 1 - step };
                let at = giving[step].at;
                let wanted = own_by[step] + received(given_by, at);
                let before = given_by[at];
                given_by[at] = before + over_relaxed * (wanted - before);
            }
        }
        for (number, four) in fours.iter().enumerate() {
            let spilled = four.spilled.to_array();
            let mut by = [[0.0; LANES]; LANES];
            for (lane, spilled) in spilled.into_iter().enumerate() {
                let at = (four.row + 1) * stride + four.column + 1 + lane;
                let (received_of_one, gives) = (around(at), given[at] > 0.0);
                // What gives on and is full reads as full.
                if received_of_one <= 0.0 || (gives && spilled <= 0.0) {
                    continue;
                }
                let mut own = (received(given_by, at) - given_by[at]).to_array();
                if let Some(of_share) = share_and_well[0].checked_sub(first).filter(|of| *of < LANES) {
                    own[of_share] += 0.25 * received_of_one;
                }
                for (by, own) in by.iter_mut().zip(own) {
                    by[lane] = own;
                }
            }
            for (slope, by) in spilled_slopes[number * N..][first..N].iter_mut().zip(by) {
                *slope = Lanes::new(by);
            }
        }
    }

    /// How what spills into the four pixels of this number changes with each of the numbers.
    #[inline(always)]
    pub(super) fn spilled_slopes<const N: usize>(&self, four: usize) -> Option<&[Lanes; N]> {
        self.spilled_slopes.get(four * N..)?.first_chunk()
    }

    /// Works out what each pixel gives on so that none holds more than a well: given = max(0, charge - well + what the neighbours
    /// give), by over-relaxation, there and back, so that no side is preferred.
    fn spill(&mut self, share: f64, well_dn: f32, stride: usize) {
        let (quarter, over_relaxed) = (quarter(share), over_relaxed(share) as f32);
        let Self { charge, given, .. } = self;
        let rows = charge.len() / stride;
        // By row: pixels that hold more than a well, and those that give. What is away from both gives nothing.
        let (mut over, mut gives) = ([Columns::NONE; MOST_ROWS], [Columns::NONE; MOST_ROWS]);
        for (row, (charge, given)) in charge.chunks(stride).zip(given.chunks(stride)).enumerate() {
            over[row] = Columns::of(charge, |charge| charge > well_dn);
            gives[row] = Columns::of(given, |given| given > 0.0);
        }
        for round in 0..ROUNDS {
            let mut most = 0.0_f32;
            for step in 1..rows - 1 {
                let is_forth = round % 2 == 0;
                let row = if is_forth { step } else { rows - 1 - step };
                let near = gives[row - 1].with(gives[row]).with(gives[row + 1]).with(over[row]);
                let Some(Columns { first, end }) = near.wider(stride) else { continue };
                for step in 0..end - first {
                    let at = row * stride + if is_forth { first + step } else { end - 1 - step };
                    let received =
                        quarter * (given[at - 1] + given[at + 1] + given[at - stride] + given[at + stride]);
                    let wanted = charge[at] - well_dn + received;
                    let new = (given[at] + over_relaxed * (wanted - given[at])).max(0.0);
                    most = most.max((new - given[at]).abs());
                    given[at] = new;
                }
                gives[row] = Columns::of(&given[row * stride..(row + 1) * stride], |given| given > 0.0);
            }
            if most < DONE_DN {
                break;
            }
        }
    }

    /// Changes what was read for what was read another time.
    pub(super) fn trade(&mut self, copied: &mut Copied) {
        mem::swap(&mut self.middle, &mut copied.middle);
        mem::swap(&mut self.reach, &mut copied.reach);
        mem::swap(&mut self.full_px, &mut copied.full_px);
        mem::swap(&mut self.fours, &mut copied.fours);
        mem::swap(&mut self.floor_dn, &mut copied.floor_dn);
        mem::swap(&mut self.full_dn, &mut copied.full_dn);
        mem::swap(&mut self.given, &mut copied.given);
    }

    /// A place in the image as seen from the middle of the window.
    pub(super) fn local(&self, place: Pixel) -> (f64, f64) {
        (place.u - f64::from(self.middle.0), place.v - f64::from(self.middle.1))
    }

    /// A place seen from the middle of the window in the image.
    pub(super) fn place(&self, u: f64, v: f64) -> Pixel {
        Pixel::new(f64::from(self.middle.0) + u, f64::from(self.middle.1) + v)
    }

    /// Adds the light of another spot at `place` to what is not this spot's; it is known to `error` of itself.
    pub(super) fn add_other(&mut self, spread: &PointSpread, place: Pixel, light: f64, error: f64) {
        let (u, v) = self.local(place);
        let reach = self.reach as f64;
        for four in &mut self.fours {
            let dy = four.row as f64 - reach - v;
            let mut light_of = [0.0; LANES];
            for (lane, own) in light_of.iter_mut().enumerate() {
                let dx = (four.column + lane) as f64 - reach - u;
                *own = (light * spread.share(dx, dy)) as f32;
            }
            let other = Lanes::new(light_of);
            let wrong = other * Lanes::splat(error as f32);
            four.others += other;
            four.others_variance += wrong * wrong;
        }
    }

    /// How much of what is seen has spilled over from full pixels, 0 to 1.
    pub(super) fn spilled_share(&self) -> f64 {
        let sum = |of: &dyn Fn(&Four) -> Lanes| {
            f64::from(lanes::sum(
                self.fours.iter().fold(Lanes::ZERO, |sum, four| sum + of(four) * four.counts),
            ))
        };
        let spilled = sum(&|four| four.spilled * (Lanes::ONE - four.full));
        let seen = sum(&|four| lanes::positive(four.signal) * (Lanes::ONE - four.full));
        (spilled / seen.max(spilled).max(1.0)).clamp(0.0, 1.0)
    }

    /// The signal of the brightest pixel, and that of the eight around it, grey levels.
    pub(super) fn peak_and_around(&self) -> (f32, f32) {
        let mut peak = (f32::NEG_INFINITY, 0, 0);
        let lanes_of = |four: &Four| (four.signal * four.counts).to_array();
        for four in &self.fours {
            for (lane, signal) in lanes_of(four).into_iter().enumerate() {
                if signal > peak.0 {
                    peak = (signal, four.row, four.column + lane);
                }
            }
        }
        let mut around = -peak.0;
        for four in self.fours.iter().filter(|four| four.row.abs_diff(peak.1) <= 1) {
            for (lane, signal) in lanes_of(four).into_iter().enumerate() {
                around += if (four.column + lane).abs_diff(peak.2) <= 1 { signal } else { 0.0 };
            }
        }
        (peak.0, around)
    }

    /// All signal that counts, grey levels.
    pub(super) fn flux(&self) -> f64 {
        f64::from(lanes::sum(
            self.fours.iter().fold(Lanes::ZERO, |sum, four| sum + four.signal * four.counts),
        ))
    }
}

/// Columns of a row from the first to the last of some pixels.
#[derive(Clone, Copy)]
struct Columns {
    first: usize,
    end: usize,
}

impl Columns {
    const NONE: Self = Self { first: usize::MAX, end: 0 };

    /// Those of a row of which something is true.
    fn of(row: &[f32], is: impl Fn(f32) -> bool) -> Self {
        match (row.iter().position(|&of| is(of)), row.iter().rposition(|&of| is(of))) {
            (Some(first), Some(last)) => Self { first, end: last + 1 },
            _ => Self::NONE,
        }
    }

    /// These and others.
    fn with(self, other: Self) -> Self {
        Self { first: self.first.min(other.first), end: self.end.max(other.end) }
    }

    /// One more on both sides, in a row of so many; `None` where there are none.
    fn wider(self, columns: usize) -> Option<Self> {
        let wider = || Self { first: self.first.saturating_sub(1), end: (self.end + 1).min(columns) };
        (self.first < self.end).then(wider)
    }
}

/// What each neighbour gets of charge of which this share spills.
fn quarter(share: f64) -> f32 {
    0.25 * share.clamp(0.0, 1.0) as f32
}

/// How far a round goes past its answer: as far as makes the largest error the smallest (D. M. Young, Iterative Solution of Large Linear Systems, 1971).
fn over_relaxed(share: f64) -> f64 {
    let comes_back = COMES_BACK * share.clamp(0.0, 1.0);
    2.0 / (1.0 + (1.0 - comes_back * comes_back).sqrt())
}

pub(super) fn nearest_pixel(place: Pixel) -> (i32, i32) {
    (place.u.round() as i32, place.v.round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{Gaussian, Shares};
    use proptest::prelude::*;
    use rand_distr::{Distribution as _, Uniform};
    use rand_pcg::rand_core::SeedableRng as _;

    const AS_KEPT: Scale = Scale { light: 1.0, level: 0.0, numbers: [0, 1] };

    /// What each pixel gives on, by whole sweeps until nothing changes.
    fn swept(charge: &[f32], quarter: f32, well_dn: f32, stride: usize) -> Vec<f32> {
        let mut given = vec![0.0_f32; charge.len()];
        for _ in 0..2000 {
            for at in stride..charge.len() - stride {
                let received =
                    quarter * (given[at - 1] + given[at + 1] + given[at - stride] + given[at + stride]);
                given[at] = (charge[at] - well_dn + received).max(0.0);
            }
        }
        given
    }

    #[test]
    fn light_without_bounds_leaves_nothing_to_the_next_step() {
        let mut window = Window { reach: 3, full_dn: 200.0, ..Window::default() };
        let spill = Spill { share: 0.3, ln_well: 0.7, relative_error: 0.3, numbers: None };
        window.keep(|_| (Lanes::ZERO, []));
        window.overflow::<0>(&spill, AS_KEPT);
        window.given[40] = f32::INFINITY;
        window.overflow::<0>(&spill, AS_KEPT);
        assert!(window.given.iter().all(|&given| given == 0.0));
    }

    #[test]
    fn light_without_bounds_beside_the_pixels_that_count_spills_nothing() {
        let four = Four { row: 3, column: 0, ..Four::default() };
        let spilled = |beside: f32| {
            let mut window = Window { reach: 3, full_dn: 200.0, fours: vec![four], ..Window::default() };
            let spill = Spill { share: 0.3, ln_well: 0.0, relative_error: 0.3, numbers: None };
            let mut light = [0.0; LANES];
            (light[0], light[LANES - 1]) = (1000.0, beside);
            window.keep(|_| (Lanes::new(light), []));
            window.overflow::<0>(&spill, AS_KEPT);
            window.fours[0].spilled.to_array().map(f32::to_bits)
        };
        assert!(f32::from_bits(spilled(0.0)[1]) > 0.0);
        assert_eq!(spilled(f32::INFINITY), spilled(0.0));
        assert_eq!(spilled(f32::NAN), spilled(0.0));
    }

    /// A window of `2 reach + 1` pixels in which all count, without a background.
    fn dark(reach: usize, full_dn: f32) -> Window {
        let side = 2 * reach + 1;
        let places = (0..side).flat_map(|row| (0..side).step_by(LANES).map(move |column| (row, column)));
        let four = |(row, column): (usize, usize)| {
            let counts = core::array::from_fn(|lane| if column + lane < side { 1.0 } else { 0.0 });
            Four { row, column, counts: Lanes::new(counts), ..Four::default() }
        };
        Window { reach, full_dn, fours: places.map(four).collect(), ..Window::default() }
    }

    /// What spills into pixels of a point of a Gaussian at (u, v) with some light, and its slopes by u, v, light, level, share and well.
    fn spilled(window: &mut Window, numbers: [f64; 6]) -> Vec<(f32, [f32; 6])> {
        let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.8 }]).unwrap();
        let [u, v, light, level, share, ln_well] = numbers;
        let placed = spread.placed(u as f32, v as f32, window.reach);
        window.keep(|four| {
            let Shares { share, by_u, by_v, .. } = placed.four(four.row, four.column);
            (share, [by_u, by_v, Lanes::ZERO, Lanes::ZERO, Lanes::ZERO, Lanes::ZERO])
        });
        let spill = Spill { share, ln_well, relative_error: 0.0, numbers: Some([4, 5]) };
        let scale = Scale { light: light as f32, level: level as f32, numbers: [2, 3] };
        // Both after the same first guess, and well past what few rounds leave.
        for _ in 0..8 {
            window.overflow::<6>(&spill, scale);
        }
        let mut all = Vec::new();
        for (number, four) in window.fours.iter().enumerate() {
            let slopes = window.spilled_slopes::<6>(number).unwrap().map(Lanes::to_array);
            let spilled = four.spilled.to_array();
            all.extend((0..LANES).map(|lane| (spilled[lane], slopes.map(|slope| slope[lane]))));
        }
        all
    }

    /// Single pixels begin and cease to give: what all of them get, in many spots, changes as slopes have it.
    #[test]
    fn slopes_of_what_spills_are_those_of_other_numbers() {
        let mut window = dark(8, 200.0);
        let steps = [0.01, 0.01, 40.0, 0.5, 0.01, 0.01];
        let [mut off, mut change] = [[0.0; 6]; 2];
        let mut rng = rand_pcg::Pcg64::seed_from_u64(5);
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
        for _ in 0..200 {
            let numbers = [
                uniform(-0.5, 0.5),
                uniform(-0.5, 0.5),
                uniform(2000.0, 20000.0),
                uniform(0.0, 2.0),
                uniform(0.1, 0.95),
                uniform(0.0, 0.7),
            ];
            let here = spilled(&mut window, numbers);
            for (number, step) in steps.into_iter().enumerate() {
                let mut at = |by: f64| {
                    let mut other = numbers;
                    other[number] += by;
                    spilled(&mut window, other)
                };
                let (after, before) = (at(step), at(-step));
                for ((here, after), before) in here.iter().zip(after).zip(before) {
                    let slope = f64::from(after.0 - before.0) / (2.0 * step);
                    off[number] += (slope - f64::from(here.1[number])).abs();
                    change[number] += slope.abs();
                }
            }
        }
        for (number, (off, change)) in off.into_iter().zip(change).enumerate() {
            assert!(change > 0.0 && off < 0.1 * change, "{number}: {off} of {change}");
        }
    }

    proptest! {
        #[test]
        fn charge_spills_as_whole_sweeps_have_it(
            share in 0.0..0.9f64,
            cores in prop::collection::vec((4usize..15, 4usize..15, 0.0..6.0f32), 1..6),
        ) {
            let (reach, well_dn) = (9, 200.0);
            let stride = 2 * reach + 1 + LANES + 1;
            let mut charge = vec![0.0; (2 * reach + 3) * stride];
            for (row, column, wells) in cores {
                charge[(row + 1) * stride + column + 1] += wells * well_dn;
            }
            let mut window = Window { reach, given: vec![0.0; charge.len()], charge, ..Window::default() };
            window.spill(share, well_dn, stride);
            let swept = swept(&window.charge, 0.25 * share as f32, well_dn, stride);
            for (given, swept) in window.given.iter().zip(swept) {
                prop_assert!((given - swept).abs() < 4.0 * DONE_DN, "{given} {swept}");
            }
        }
    }
}
