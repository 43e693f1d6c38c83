//! The pixels that tell of a spot.
//!
//! In: the frame, a place, how far to look, the background there. Out: the signal above the background in a disc of pixels, which of
//! them are full, and what other spots and overflown charge add to them. Rows are whole lanes, so that sums over them are the
//! same on every machine.

use super::patch::Surroundings;
use crate::camera::Pixel;
use crate::frame::FrameView;
use crate::lanes::{self, LANES, Lanes};
use crate::optics::PointSpread;

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
    /// Charge that spills over from full pixels, grey levels, its variance, and how it grows with the share that spills.
    pub(super) spilled: Lanes,
    pub(super) spilled_variance: Lanes,
    pub(super) by_spill: Lanes,
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
    /// Signal of a full pixel in the middle of the window, grey levels.
    full_dn: f32,
    charge: Vec<f32>,
    spilled: Vec<f32>,
    room: Vec<f32>,
}

/// Rounds in which charge spills on, at most.
const ROUNDS: usize = 24;
/// Step of the share of charge that spills, for its derivative.
const SPILL_STEP: f64 = 0.05;

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
        let (u, v) = nearest_pixel(place);
        let reach = (radius_px.max(1.0) as usize).min(WIDEST_PX) as i32;
        (self.middle, self.reach, self.full_px) = ((u, v), reach as usize, 0);
        self.full_dn = f32::from(full_from) - around.level;
        self.fours.clear();
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
                let four = Four { row: row as usize, column: column as usize, signal, counts, full, ..Four::default() };
                self.fours.push(four);
            }
        }
    }

    /// Lets charge above that of a full pixel spill, `share` of it into the four neighbours and the rest away, until no pixel has more;
    /// `model` is the light of a pixel without that.
    pub(super) fn overflow(&mut self, share: f64, relative_error: f64, model: impl Fn(&Four) -> Lanes) {
        let side = 2 * self.reach + 1;
        let stride = side + LANES + 1;
        self.charge.clear();
        self.charge.resize((side + 2) * stride, 0.0);
        for four in &self.fours {
            let at = (four.row + 1) * stride + four.column + 1;
            self.charge[at..at + LANES].copy_from_slice(&(model(four) + four.others).to_array());
        }
        let full_dn = self.full_dn;
        let spill = |share: f64, charge: &[f32], spilled: &mut Vec<f32>| {
            let quarter = 0.25 * share.clamp(0.0, 1.0) as f32;
            spilled.clear();
            spilled.resize(charge.len(), 0.0);
            if quarter <= 0.0 {
                return;
            }
            // What a pixel has given on so far: it gives on all above the full well.
            for _ in 0..ROUNDS {
                let mut most = 0.0_f32;
                for row in 1..=side {
                    for at in row * stride + 1..row * stride + 1 + side {
                        let excess = charge[at] + spilled[at] - full_dn;
                        if excess > 0.5 {
                            most = most.max(excess);
                            spilled[at] -= excess;
                            for neighbour in [at - 1, at + 1, at - stride, at + stride] {
                                spilled[neighbour] += quarter * excess;
                            }
                        }
                    }
                }
                if most < 1.0 {
                    break;
                }
            }
        };
        let mut further = std::mem::take(&mut self.spilled);
        let mut spilled = std::mem::take(&mut self.room);
        spill(share, &self.charge, &mut spilled);
        spill(share + SPILL_STEP, &self.charge, &mut further);
        for four in &mut self.fours {
            let at = (four.row + 1) * stride + four.column + 1;
            let read = |from: &[f32]| from[at..].first_chunk::<LANES>().map_or(Lanes::ZERO, |&four| Lanes::new(four));
            // What is full reads as full whatever it gives on.
            let (now, then) = (lanes::positive(read(&spilled)), lanes::positive(read(&further)));
            four.spilled = now;
            four.by_spill = (then - now) * Lanes::splat((1.0 / SPILL_STEP) as f32);
            let wrong = now * Lanes::splat(relative_error as f32);
            four.spilled_variance = wrong * wrong;
        }
        (self.spilled, self.room) = (further, spilled);
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

    /// Forgets the light of others.
    pub(super) fn forget_others(&mut self) {
        for four in &mut self.fours {
            (four.others, four.others_variance) = (Lanes::ZERO, Lanes::ZERO);
        }
    }

    /// All signal that counts, grey levels.
    pub(super) fn flux(&self) -> f64 {
        f64::from(lanes::sum(self.fours.iter().fold(Lanes::ZERO, |sum, four| sum + four.signal * four.counts)))
    }
}

pub(super) fn nearest_pixel(place: Pixel) -> (i32, i32) {
    (place.u.round() as i32, place.v.round() as i32)
}
