//! What the spots of a frame teach of the camera, where nobody measured it.
//!
//! In: the parts of a frame, and the fitter. Out: the fitter's belief of the point spread and of noise, and the level of full pixels, one frame
//! wiser. Which spots tell is `telling`'s; their pixels go into the `album`, and whenever there are some more all of its spots and the point spread
//! are fitted to each other anew. After some frames there is nothing left to learn.

use core::{mem, slice};

use super::album::{Album, Page};
use super::beside::Beside;
use super::fit::{self, Left, PixelNoise, PointSource, Shape, WIDTH};
use super::fitting::{Fitter, NO_POINT};
use super::learning::{Beginning, Belief, Said, Told, UNKNOWNS};
use super::neighbourhood::Neighbourhood;
use super::noise_bins::NoiseBins;
use super::part::Part;
use super::patch::{NOISY_DN, Surroundings};
use super::smear::{Motion, Smeared};
use super::telling::{self, Telling};
use super::window::Window;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;

/// Levels of full pixels that differ by no more are one, grey levels.
const SAME_LEVEL_DN: u8 = 4;
/// Share of the light of its brightest pixel that the eight around it get of a point, at least.
const LEAST_AROUND: f32 = 0.12;
/// Share of spilled charge in a spot from which its residuals say nothing of noise.
pub(super) const LEAST_SPILT: f64 = 0.02;
/// Spots of a frame that are learnt from, at most.
const MOST_TELLING: usize = 12;
/// Steps in which spots and the point spread are fitted to each other, at most; how far the first is held back, a share of the diagonal, and how much
/// further or less far the next ones are. What one gains that is the last, twice the negative log-likelihood.
const STEPS: usize = 12;
const HELD_BACK: f64 = 1e-3;
const FURTHER: f64 = 8.0;
const LESS_FAR: f64 = 0.1;
const SMALL_GAIN: f64 = 0.1;
/// Shares of the excess that spill, from each of which the point spread is looked for.
const SPILLS: [f64; 3] = [0.1, 0.5, 0.9];
/// Frames after which a belief that is sure of itself learns no more of the spread.
pub(super) const LEARNT_FRAMES: u32 = 32;
/// Where no pixel tells noise, spots of which the one in the middle leaves more than this (squared residuals over degrees of freedom) are no points.
const UNEXPLAINED: f64 = 2.0;
/// Spots that leave no more than this, over what the one in the middle leaves, are usual: others may be two, or stand in a smear.
const USUAL: f64 = 1.5;
/// Where a point spread that half an album told is wrong by more of the light of usual spots than this, though they are not full, points have no one shape: it is
/// not worth while to look for what full ones hide.
const ODD: f32 = 0.06;
/// A pixel that reads no further below the level of full ones, sigmas of noise, may be full.
const FULL_SIGMAS: f64 = 2.0;
/// So many sigmas of noise are from the mean level of full pixels to the lowest.
const LEVEL_SIGMAS: f64 = 2.5;

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
        self.noise_bins = NoiseBins::new(self.noise);
        self.belief = Belief::new(self.noise_bins.noise, if is_end { u8::MAX } else { lowest });
        self.album.clear();
        (self.frames, self.frames_beside, self.unsaturated) = (0, 0, 0);
        (self.frames_in_vain, self.frames_beside_in_vain, self.is_unexplained, self.is_odd) =
            (0, 0, false, false);
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
        let mut telling = mem::take(&mut self.telling);
        telling::find(parts, near, &mut telling);
        let stand_alone = !telling.is_empty();
        let learns_beside =
            self.frames_beside < LEARNT_FRAMES && self.frames_beside_in_vain < 4 * LEARNT_FRAMES;
        if !stand_alone && self.motion.is_none() && learns_beside {
            telling::find_beside(parts, near, full_from, &mut telling);
        }
        if self.frames == 0 && self.frames_beside == 0 {
            self.begin(parts, &telling, full_from);
        }
        let mut album = mem::take(&mut self.album);
        // What stands alone and fits nothing is of no shape that is known; what lies beside each other may be more than was told apart.
        match (self.taught(frame, parts, &telling, full_from, &mut album), stand_alone) {
            (Taught::Nothing, _) => {}
            (taught, true) => {
                self.frames += 1;
                self.frames_in_vain += u32::from(taught == Taught::InVain);
            }
            (Taught::InVain, false) => self.frames_beside_in_vain += 1,
            (Taught::Something, false) => self.frames_beside += 1,
        }
        (self.album, self.telling) = (album, telling);
    }

    /// Begins to look for the point spread at a core as wide as the first spots that are not full; what is full is wider than that. In noise how wide faint
    /// ones are is noise: all spots tell, full or not.
    fn begin(&mut self, parts: &[Part], telling: &[Telling], full_from: u8) {
        let is_noisy = is_noisy(noise_of(parts));
        let is_too_wide = |part: &Part| !is_noisy && part.outline.peak >= full_from;
        let all = telling.iter().flat_map(|telling| telling.parts(parts));
        let all_too_wide = all.clone().all(is_too_wide);
        let beginning = all.filter(|part| all_too_wide || !is_too_wide(part));
        self.widths.clear();
        self.widths.extend(beginning.map(|part| part.width_px(f32::from(part.level))));
        self.widths.sort_unstable_by(f64::total_cmp);
        if let Some(&core_px) = self.widths.get(self.widths.len() / 2) {
            self.as_wide = Beginning { core_px, ..Belief::believed() };
            self.belief.begin(self.as_wide);
        }
    }

    /// Takes in what the frame's spots look like, and what that says of the camera. What fits nothing is not kept.
    fn taught(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        telling: &[Telling],
        full_from: u8,
        album: &mut Album,
    ) -> Taught {
        if album.is_full() {
            if telling.iter().all(Telling::is_alone) {
                self.learn_more_noise(frame, parts, telling, full_from);
            }
            return if telling.is_empty() { Taught::Nothing } else { Taught::Something };
        }
        let before = album.len();
        for spots in telling.iter().take(MOST_TELLING) {
            let opened = self.open_telling(frame, parts, spots, full_from);
            if album.is_full() {
                break;
            }
            if self.is_light(self.pixel_noise(opened.around)) {
                let mut copied = album.blank();
                self.window.trade(&mut copied);
                album.add(Page::new(copied, opened, self.motion));
            }
        }
        if album.len() == before {
            return Taught::Nothing;
        }
        if album.has_grown() {
            self.revise(album);
        } else {
            self.look(album.from(before));
        }
        let tells = album.from(before).iter().any(Page::fits);
        if !tells {
            album.leave(before);
        }
        self.unsaturated = album.unsaturated();
        album.drop_what_fits_nothing();
        if tells { Taught::Something } else { Taught::InVain }
    }

    /// Fits all spots of the album and the point spread to each other anew. Whenever there are twice as many the point spread is looked for from elsewhere,
    /// too: there is more than one place where it explains something.
    fn revise(&mut self, album: &mut Album) {
        let everywhere = album.has_doubled();
        let mut least = self.settle(album);
        let mut numbers = self.belief.numbers();
        let believed = SPILLS.map(|spill| Beginning { spill, ..Belief::believed() });
        let elsewhere = believed.into_iter().chain([self.as_wide]);
        for beginning in elsewhere.filter(|_| everywhere) {
            self.belief.begin(beginning);
            let cost = self.settle(album);
            if cost < least {
                (least, numbers) = (cost, self.belief.numbers());
            }
        }
        self.belief.go(numbers);
        let told = self.look(album.pages());
        self.belief.learn(&told);
        let misfit = album.median_misfit(&mut self.widths).unwrap_or(0.0);
        let usual = self.learn_noise(album.pages(), USUAL * misfit);
        self.is_odd = album.is_half_full() && usual.are_told() && usual.noise.shape > ODD;
        self.is_unexplained = !self.noise_bins.are_told() && misfit > UNEXPLAINED;
        album.was_looked_at(everywhere);
    }

    /// Finds the numbers of the point spread that explain the album best, near those of now, by Levenberg and Marquardt's way down; what is left costs so
    /// much.
    fn settle(&mut self, album: &mut Album) -> f64 {
        let mut damping = HELD_BACK;
        let mut told = self.look(album.pages());
        let mut cost = told.cost + self.belief.strain();
        for _ in 0..STEPS {
            let before = self.belief.numbers();
            let Some(numbers) = self.belief.stepped(&told, damping) else { break };
            self.belief.go(numbers);
            let next = self.look(album.pages());
            let gain = cost - (next.cost + self.belief.strain());
            if gain > 0.0 {
                (told, cost) = (next, cost - gain);
                damping *= LESS_FAR;
                if gain < SMALL_GAIN {
                    break;
                }
            } else {
                self.belief.go(before);
                damping *= FURTHER;
            }
        }
        cost
    }

    /// Fits spots with the point spread as it stands: what they say of it.
    fn look(&mut self, pages: &mut [Page]) -> Told {
        let mut told = Told::default();
        for page in pages {
            self.window.trade(&mut page.copied);
            let said = self.says(page);
            match said {
                Some(said) => told.add(&said),
                None => told.add_misfit((4 * self.window.fours.len()) as f64),
            }
            self.window.trade(&mut page.copied);
        }
        told
    }

    /// What the spot in the window says of the point spread as it stands.
    fn says(&mut self, page: &mut Page) -> Option<Said> {
        let noise = self.pixel_noise(page.opened.around);
        let (window, known, free) = (&mut self.window, self.belief.known(), self.belief.free());
        match (page.opened.beside(), page.motion) {
            ([], None) => page.says::<WIDTH, UNKNOWNS>(window, known, free, noise),
            ([], Some(motion)) => {
                let (known, free) = (Smeared::new(known, motion), Smeared::new(free, motion));
                page.says::<{ WIDTH + 2 }, { UNKNOWNS + 2 }>(window, known, free, noise)
            }
            (&[one], _) => {
                let (known, free) = (Beside::new(known, known, one), Beside::new(free, free, one));
                page.says::<{ WIDTH + 3 }, { UNKNOWNS + 3 }>(window, known, free, noise)
            }
            (&[one, other, ..], _) => {
                type Both<S, const M: usize, const N: usize> = Beside<Beside<S, S, M, M>, S, N, M>;
                let known_both: Both<_, WIDTH, { WIDTH + 3 }> =
                    Beside::new(Beside::new(known, known, one), known, other);
                let free_both: Both<_, UNKNOWNS, { UNKNOWNS + 3 }> =
                    Beside::new(Beside::new(free, free, one), free, other);
                page.says::<{ WIDTH + 6 }, { UNKNOWNS + 6 }>(window, known_both, free_both, noise)
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

    /// Learns the noise of pixels from what all spots of the album leave but those beside each other: any of these may be two. Says what those tell of it
    /// that are not full and whose misfit is no more than `most`.
    fn learn_noise(&mut self, pages: &mut [Page], most: f64) -> NoiseBins {
        let mut all_and_usual = [NoiseBins::new(self.noise); 2];
        for page in pages.iter_mut().filter(|page| page.opened.beside().is_empty()) {
            let Some(misfit) = page.misfit else { continue };
            let is_usual = page.copied.full_px == 0 && misfit <= most;
            let bins = if is_usual { &mut all_and_usual[..] } else { &mut all_and_usual[..1] };
            self.window.trade(&mut page.copied);
            self.add_left(bins, page.opened.around, page.guess(), page.motion);
            self.window.trade(&mut page.copied);
        }
        let [all, mut usual] = all_and_usual;
        usual.solve();
        self.solve_noise(all);
        usual
    }

    /// Learns the noise of pixels from what a frame's spots leave, too.
    fn learn_more_noise(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        telling: &[Telling],
        full_from: u8,
    ) {
        let mut bins = self.noise_bins;
        for spots in telling.iter().take(MOST_TELLING) {
            let opened = self.open_telling(frame, parts, spots, full_from);
            if self.is_light(self.pixel_noise(opened.around)) {
                self.add_left(slice::from_mut(&mut bins), opened.around, opened.guess, self.motion);
            }
        }
        self.solve_noise(bins);
    }

    /// Adds what the spot in the window leaves of each pixel.
    fn add_left(
        &mut self,
        bins: &mut [NoiseBins],
        around: Surroundings,
        guess: (f64, f64, f64),
        motion: Option<Motion>,
    ) {
        // Wings beside a spot make its frame no noisier: what is cut off does.
        let noise = if around.is_cut_off { self.pixel_noise(around) } else { self.belief.noise() };
        let known = f64::from((noise.dark - self.belief.noise().dark).max(0.0));
        let shape = PointSource::new(self.belief.spread(), self.source_size(), self.belief.spill());
        let add = |left| bins.iter_mut().for_each(|bins| bins.add(&left, known));
        match motion {
            None => tell_noise::<5>(&mut self.window, shape, guess, noise, add),
            Some(motion) => {
                tell_noise::<7>(&mut self.window, Smeared::new(shape, motion), guess, noise, add);
            }
        }
    }

    fn solve_noise(&mut self, mut bins: NoiseBins) {
        bins.solve();
        self.belief.set_noise(bins.noise);
        self.noise_bins = bins;
    }
}

/// What a frame taught of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Taught {
    /// It has no spot that might tell.
    Nothing,
    /// It has, but none fits a point.
    InVain,
    Something,
}

/// Noise of a frame in the dark, about, grey levels.
pub(super) fn noise_of(parts: &[Part]) -> f64 {
    parts.first().map_or(0.0, |part| part.noise_dn)
}

/// Whether so much noise changes what pixels tell by themselves.
fn is_noisy(noise_dn: f64) -> bool {
    noise_dn >= f64::from(NOISY_DN)
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
