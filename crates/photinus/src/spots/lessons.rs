//! What the spots of a frame teach of the camera, where nobody measured it.
//!
//! In: the parts of a frame, and the fitter. Out: the fitter's belief of the point spread and of noise, and the level of full pixels, one frame
//! wiser. Spots and point spread are fitted to each other in turn; which spots tell is `telling`'s. After some frames there is nothing left to
//! learn.

use nalgebra::SVector;

use super::beside::Beside;
use super::fit::{self, Left, PixelNoise, PointSource, Shape, WIDTH};
use super::fitting::{Fitter, NO_POINT};
use super::learning::{Beginning, Belief, Information, NUMBERS, Told, UNKNOWNS};
use super::neighbourhood::Neighbourhood;
use super::part::Part;
use super::patch::NOISY_DN;
use super::smear::Smeared;
use super::telling::{self, Opened, TELLING_DN, Telling};
use super::window::{Spill, Window};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::optics::SourceSize;

/// Levels of full pixels that differ by no more are one, grey levels.
const SAME_LEVEL_DN: u8 = 4;
/// Share of the light of its brightest pixel that the eight around it get of a point, at least.
const LEAST_AROUND: f32 = 0.12;
/// Share of spilled charge in a spot from which its residuals say nothing of noise.
pub(super) const LEAST_SPILT: f64 = 0.02;
/// Spots of a frame that are learnt from, at most.
pub(super) const MOST_TELLING: usize = 40;
/// Rounds in which a frame's spots and the point spread are fitted to each other.
const ROUNDS: usize = 5;
/// Frames after which a belief that is sure of itself learns no more of the spread.
pub(super) const LEARNT_FRAMES: u32 = 32;
/// After so many frames noise that is so many times what is expected, as variance, is none.
const DOUBTED_FRAMES: u32 = 8;
const IMPLAUSIBLE: f64 = 4.0;
/// Share of the excess that spills where most of it does.
const SPILLS: f64 = 0.9;
/// A pixel that reads no further below the level of full ones, sigmas of noise, may be full.
const FULL_SIGMAS: f64 = 2.0;
/// So many sigmas of noise are from the mean level of full pixels to the lowest.
const LEVEL_SIGMAS: f64 = 2.5;

/// While the point spread is being learnt a spot's own variance takes in how wide it is not known to be.
const UNLEARNT: SourceSize = SourceSize { scatter_px2: 0.05, ..SourceSize::UNKNOWN };

impl Fitter {
    /// Whether frames still tell something of the camera.
    pub(super) fn learns(&self) -> bool {
        self.fits && self.optics.is_none() && self.frames < LEARNT_FRAMES
    }

    /// The lowest level that may be that of a full pixel, as far as it is known, in a frame of so much noise.
    pub(super) fn lowest_full(&self, noise_dn: f64) -> u8 {
        let known =
            self.optics.as_ref().map_or(self.full_level.lowest(), |optics| optics.sensor.full_from_dn());
        let lower_dn = if is_noisy(noise_dn) { FULL_SIGMAS * noise_dn } else { 0.0 };
        known.saturating_sub(lower_dn as u8)
    }

    /// Begins anew. Noise may have lowered what the converter cut off at its end: then it is not the well that was full.
    pub(super) fn unlearn(&mut self, noise_dn: f64) {
        let lowest = self.full_level.lowest();
        let is_end = is_noisy(noise_dn) && f64::from(lowest) + LEVEL_SIGMAS * noise_dn >= f64::from(u8::MAX);
        self.belief = Belief::new(self.noise, if is_end { u8::MAX } else { lowest });
        (self.frames, self.frames_beside, self.unsaturated) = (0, 0, 0);
    }

    /// The same with what a frame tells.
    pub(super) fn full_from(&mut self, frame: &FrameView<'_>, parts: &[Part]) -> u8 {
        let noise_dn = noise_of(parts);
        if self.optics.is_none() && self.frames < LEARNT_FRAMES {
            for part in parts.iter().filter(|part| part.reason.is_none() && part.outline.area_px > 2) {
                self.full_level.add(frame, &part.outline.extent, part.outline.peak);
            }
            let before = self.full_level.lowest();
            self.full_level.settle();
            // What was learnt of spots whose tops were cut off unnoticed was wrong.
            if self.full_level.lowest().abs_diff(before) > SAME_LEVEL_DN {
                self.unlearn(noise_dn);
            }
        }
        self.lowest_full(noise_dn)
    }

    /// Whether light fell on the window: no lens is so sharp that, wherever in a pixel a point's light falls, the eight pixels around the
    /// brightest get less than [`LEAST_AROUND`] of what it gets. What is sharper is a hot pixel.
    fn is_light(&self, noise: PixelNoise) -> bool {
        let (peak, around) = self.window.peak_and_around();
        around > LEAST_AROUND * peak + 3.0 * (8.0 * noise.dark).sqrt()
    }

    /// Whether no light did: between the two noise leaves it open.
    fn is_no_light(&self, noise: PixelNoise) -> bool {
        let (peak, around) = self.window.peak_and_around();
        around < LEAST_AROUND * peak - 2.0 * (8.0 * noise.dark).sqrt()
    }

    /// Takes in what the frame's spots say of the point spread and of noise.
    pub(super) fn learn(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        near: &Neighbourhood,
        full_from: u8,
    ) {
        if !self.learns() {
            return;
        }
        self.look_for_hot_pixels(frame, parts, full_from);
        let mut telling = core::mem::take(&mut self.telling);
        telling::find(parts, near, &mut telling);
        let stand_alone = !telling.is_empty();
        if !stand_alone && self.motion.is_none() && self.frames_beside < LEARNT_FRAMES {
            telling::find_beside(parts, near, full_from, &mut telling);
        }
        if self.frames == 0 && self.frames_beside == 0 {
            self.begin(frame, parts, &telling, full_from);
        }
        let most = &telling[..telling.len().min(MOST_TELLING)];
        let lesson = self.settle(frame, parts, most, full_from);
        if lesson.tells {
            self.belief.keep(&lesson.told, lesson.at);
            self.unsaturated += lesson.unsaturated;
            if stand_alone {
                self.learn_noise(frame, parts, most, full_from);
                self.frames += 1;
                self.begin_again(noise_of(parts));
            } else {
                // What they leave is no noise: any of them may be two.
                self.frames_beside += 1;
            }
        }
        self.telling = telling;
    }

    /// Begins to look for the point spread at a core as wide as the first spots that are not full. What is full is wider than that: where all are, it begins
    /// at what explains them better, their width or what is believed of any lens. In noise how wide faint ones are is noise: all spots tell, full or not.
    fn begin(&mut self, frame: &FrameView<'_>, parts: &[Part], telling: &[Telling], full_from: u8) {
        let is_noisy = is_noisy(noise_of(parts));
        let is_too_wide = |part: &Part| !is_noisy && part.outline.peak >= full_from;
        let all = telling.iter().flat_map(|telling| telling.parts(parts));
        let all_too_wide = all.clone().all(is_too_wide);
        let beginning = all.filter(|part| all_too_wide || !is_too_wide(part));
        self.widths.clear();
        self.widths.extend(beginning.map(|part| part.width_px(f32::from(part.level))));
        self.widths.sort_unstable_by(f64::total_cmp);
        let Some(&width_px) = self.widths.get(self.widths.len() / 2) else { return };
        let most = &telling[..telling.len().min(MOST_TELLING)];
        let believed = Belief::believed();
        let believed = Beginning { spill: self.begun_again_at.unwrap_or(believed.spill), ..believed };
        let as_wide = Beginning { core_px: width_px, ..believed };
        let other = if all_too_wide { believed } else { as_wide };
        let mut cost = |beginning: Beginning| {
            self.belief.begin(beginning);
            self.settle(frame, parts, most, full_from).cost + self.belief.strain()
        };
        let is_as_wide = other == as_wide || cost(as_wide) < cost(other);
        self.belief.begin(if is_as_wide { as_wide } else { other });
    }

    /// Begins anew, once, where what is left after some frames is far more than noise: the numbers were found where they explain little. There are two such
    /// places, and it is the spill that they are looked for from that decides between them.
    fn begin_again(&mut self, noise_dn: f64) {
        if self.frames != DOUBTED_FRAMES || self.begun_again_at.is_some() {
            return;
        }
        let variance = |noise: &PixelNoise| f64::from(noise.dark) + TELLING_DN * f64::from(noise.shot);
        let expected = noise_dn * noise_dn + 1.0 / 12.0 + TELLING_DN * self.noise.shot;
        if variance(&self.belief.noise()) > IMPLAUSIBLE * expected {
            let Spill { share, .. } = self.belief.spill();
            self.unlearn(noise_dn);
            self.begun_again_at = Some(if share < 0.5 { SPILLS } else { 1.0 - SPILLS });
        }
    }

    /// Fits the frame's spots and the point spread to each other.
    fn settle(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        telling: &[Telling],
        full_from: u8,
    ) -> Lesson {
        let mut lesson = Lesson::default();
        for _ in 0..ROUNDS {
            lesson = Lesson { at: self.belief.numbers(), ..Lesson::default() };
            for spots in telling {
                let opened = self.open_telling(frame, parts, spots, full_from);
                if !self.is_light(self.pixel_noise(opened.around)) {
                    continue;
                }
                let Some(spot) = self.fit_freely(&opened) else {
                    // It is no point's light: each pixel is as far off as may be.
                    lesson.cost += NO_POINT * (4 * self.window.fours.len()) as f64;
                    continue;
                };
                lesson.told.add(&spot.numbers, &spot.covariance, self.belief.weights(), spot.trust);
                lesson.unsaturated += u32::from(self.window.full_px == 0);
                lesson.cost += spot.cost;
                lesson.tells = true;
            }
            if !lesson.tells || !self.belief.take(&lesson.told) {
                break;
            }
        }
        lesson
    }

    /// Fits the window with the numbers of the point spread free.
    fn fit_freely(&mut self, opened: &Opened) -> Option<FreelyFitted> {
        let noise = self.pixel_noise(opened.around);
        let (window, shape, guess) = (&mut self.window, self.belief.free(), opened.guess);
        match (opened.beside(), self.motion) {
            ([], None) => told_by::<UNKNOWNS>(window, shape, guess, noise),
            ([], Some(motion)) => {
                told_by::<{ UNKNOWNS + 2 }>(window, Smeared::new(shape, motion), guess, noise)
            }
            (&[one], _) => told_by::<{ UNKNOWNS + 3 }>(window, Beside::new(shape, shape, one), guess, noise),
            (&[one, other, ..], _) => {
                let both =
                    Beside::<_, _, { UNKNOWNS + 3 }, _>::new(Beside::new(shape, shape, one), shape, other);
                told_by::<{ UNKNOWNS + 6 }>(window, both, guess, noise)
            }
        }
    }

    fn look_for_hot_pixels(&mut self, frame: &FrameView<'_>, parts: &[Part], full_from: u8) {
        self.lone_pixels.begin();
        for part in parts {
            if part.reason.is_none() && part.outline.area_px == 1 && !part.outline.cut {
                let (_, around) = self.open(frame, part, f64::INFINITY, full_from);
                if self.is_no_light(self.pixel_noise(around)) {
                    self.lone_pixels.see(part.middle);
                }
            }
        }
        self.lone_pixels.end();
    }

    fn learn_noise(&mut self, frame: &FrameView<'_>, parts: &[Part], telling: &[Telling], full_from: u8) {
        // What was left by a spread that frames had told less of says little of today's: frame k counts as k of the first.
        let frames = f64::from(self.frames);
        let mut bins = *self.belief.noise_bins();
        bins.fade(frames / (frames + 1.0));
        for spots in telling {
            let opened = self.open_telling(frame, parts, spots, full_from);
            let around = opened.around;
            if !self.is_light(self.pixel_noise(around)) {
                continue;
            }
            // Wings beside a spot make its frame no noisier: what is cut off does.
            let noise = if around.is_cut_off { self.pixel_noise(around) } else { self.belief.noise() };
            let known = f64::from((noise.dark - self.belief.noise().dark).max(0.0));
            let shape = PointSource::new(self.belief.spread(), UNLEARNT, self.belief.spill());
            let add = |left| bins.add(&left, known);
            let (window, guess) = (&mut self.window, opened.guess);
            match self.motion {
                None => tell_noise::<5>(window, shape, guess, noise, add),
                Some(motion) => tell_noise::<7>(window, Smeared::new(shape, motion), guess, noise, add),
            }
        }
        bins.solve();
        *self.belief.noise_bins() = bins;
    }
}

/// Noise of a frame in the dark, about, grey levels.
pub(super) fn noise_of(parts: &[Part]) -> f64 {
    parts.first().map_or(0.0, |part| part.noise_dn)
}

/// Whether so much noise changes what pixels tell by themselves.
fn is_noisy(noise_dn: f64) -> bool {
    noise_dn >= f64::from(NOISY_DN)
}

/// What the spots of a frame say of the point spread.
#[derive(Default)]
struct Lesson {
    /// Whether any spot says something.
    tells: bool,
    told: Told,
    /// The numbers of the spread that they were fitted from.
    at: SVector<f64, NUMBERS>,
    /// Spots that say something and are not full.
    unsaturated: u32,
    /// Twice the negative log-likelihood.
    cost: f64,
}

/// What a spot that was fitted with the spread's numbers free says of them, and how far it is to be trusted.
struct FreelyFitted {
    numbers: SVector<f64, NUMBERS>,
    covariance: Information,
    trust: f64,
    cost: f64,
}

fn told_by<const N: usize>(
    window: &mut Window,
    mut shape: impl Shape<N>,
    guess: (f64, f64, f64),
    noise: PixelNoise,
) -> Option<FreelyFitted> {
    let fitted = fit::fit(window, &mut shape, guess, noise)?;
    let misfit = fitted.chi2 / fitted.freedom;
    (misfit < NO_POINT).then(|| FreelyFitted {
        numbers: fitted.numbers.fixed_rows::<NUMBERS>(WIDTH).into_owned(),
        covariance: fitted.covariance.fixed_view::<NUMBERS, NUMBERS>(WIDTH, WIDTH).into_owned(),
        trust: 1.0 / misfit.max(1.0),
        cost: fitted.cost(1.0),
    })
}

/// Tells what a spot leaves of each pixel, unless it is no point or its charge spills.
fn tell_noise<const N: usize>(
    window: &mut Window,
    mut shape: impl Shape<N>,
    guess: (f64, f64, f64),
    noise: PixelNoise,
    with: impl FnMut(Left),
) {
    let Some(fitted) = fit::fit(window, &mut shape, guess, noise) else { return };
    let spills = window.full_px > 0 && window.spilled_share() > LEAST_SPILT;
    if fitted.chi2 / fitted.freedom < NO_POINT && !spills {
        fit::residuals(window, &mut shape, &fitted, noise, with);
    }
}
