//! What the first spots looked like that tell of a camera that nobody measured.
//!
//! In: the pixels of such spots, frame after frame. Out: all of them, to be looked at again whenever more is known. What a spot said where the point
//! spread was wrong is worth nothing once it is right; its pixels are.

use alloc::vec::Vec;
use core::mem;

use nalgebra::SVector;

use super::fit::{self, Fitted, PixelNoise, Shape, WIDTH};
use super::fitting::NO_POINT;
use super::learning::{NUMBERS, Said};
use super::smear::Motion;
use super::telling::Opened;
use super::window::{Copied, Window};

/// Spots that are kept, at most.
const PAGES: usize = 128;
/// Numbers of a spot's own, at most: those of three points beside each other.
const MOST_OWN: usize = WIDTH + 6;
/// All are looked at again when there are this share more.
const GROWN: f64 = 1.125;

/// A spot that tells, or a few beside each other.
#[derive(Debug)]
pub(super) struct Page {
    pub(super) copied: Copied,
    pub(super) opened: Opened,
    pub(super) motion: Option<Motion>,
    /// What was found of it: its numbers but for those of the point spread.
    own: Option<[f64; MOST_OWN]>,
    /// What it left when it was looked at last (squared residuals over degrees of freedom), if it fitted.
    pub(super) misfit: Option<f64>,
}

impl Page {
    pub(super) fn new(copied: Copied, opened: Opened, motion: Option<Motion>) -> Self {
        Self { copied, opened, motion, own: None, misfit: None }
    }

    /// Whether it fitted when it was looked at last.
    pub(super) fn fits(&self) -> bool {
        self.misfit.is_some()
    }

    /// Where the spot was looked for: where it was found last, if it was.
    pub(super) fn guess(&self) -> (f64, f64, f64) {
        self.own.map_or(self.opened.guess, |[u, v, light, ..]| (u, v, light))
    }

    /// What the spot says of the point spread: `known` and `free` are its shape, the numbers of the point spread as believed and free. `None` where it fits
    /// no point.
    pub(super) fn says<const K: usize, const N: usize>(
        &mut self,
        window: &mut Window,
        mut known: impl Shape<K>,
        mut free: impl Shape<N>,
        noise: PixelNoise,
    ) -> Option<Said> {
        self.misfit = None;
        let before = self.own.take().map(|own| SVector::<f64, K>::from_fn(|number, _| own[number]));
        let again = before.and_then(|numbers| fit::fit_from(window, &mut known, numbers, noise));
        let fitted = match again.filter(Fitted::fits) {
            Some(again) => again,
            None => {
                let anew = fit::fit(window, &mut known, self.opened.guess, noise);
                fit::better([again, anew])?
            }
        };
        let own = fitted.numbers;
        self.own = Some(core::array::from_fn(|number| if number < K { own[number] } else { 0.0 }));
        let all = SVector::<f64, N>::from_fn(|number, _| match number.checked_sub(WIDTH) {
            None => own[number],
            Some(width) if width < NUMBERS => 0.0,
            Some(_) => own[number - NUMBERS],
        });
        let said = fit::said(window, &mut free, &all, noise)?;
        let misfit = said.chi2 / said.freedom;
        self.misfit = (misfit < NO_POINT).then_some(misfit);
        self.fits().then_some(said)
    }
}

/// The spots that are kept.
#[derive(Debug, Default)]
pub(super) struct Album {
    pages: Vec<Page>,
    /// Pages that are torn out, to be written on again.
    blank: Vec<Copied>,
    /// How many there were when all were looked at last, and when the point spread was looked for everywhere.
    looked_at: usize,
    sought_at: usize,
}

impl Album {
    pub(super) fn pages(&mut self) -> &mut [Page] {
        &mut self.pages
    }

    /// Whether half of it is full.
    pub(super) fn is_half_full(&self) -> bool {
        2 * self.pages.len() >= PAGES
    }

    pub(super) fn is_full(&self) -> bool {
        self.pages.len() >= PAGES
    }

    /// With all room that it will ever need, 2.4 MB.
    pub(super) fn roomy() -> Self {
        let blank = (0..PAGES).map(|_| Copied::blank()).collect();
        Self { pages: Vec::with_capacity(PAGES), blank, ..Self::default() }
    }

    /// Room for what a window shows, to be added with it.
    pub(super) fn blank(&mut self) -> Copied {
        self.blank.pop().unwrap_or_default()
    }

    pub(super) fn add(&mut self, page: Page) {
        self.pages.push(page);
    }

    pub(super) fn len(&self) -> usize {
        self.pages.len()
    }

    /// Those from a number on.
    pub(super) fn from(&mut self, first: usize) -> &mut [Page] {
        &mut self.pages[first..]
    }

    /// Leaves so many.
    pub(super) fn leave(&mut self, pages: usize) {
        self.blank.extend(self.pages.drain(pages.min(self.pages.len())..).map(|page| page.copied));
        self.looked_at = self.looked_at.min(pages);
        self.sought_at = self.sought_at.min(pages);
    }

    /// Leaves none.
    pub(super) fn clear(&mut self) {
        self.leave(0);
    }

    /// Whether there are so many more than were looked at that all should be.
    pub(super) fn has_grown(&self) -> bool {
        let pages = self.pages.len();
        pages > self.looked_at && pages as f64 >= GROWN * self.looked_at as f64
    }

    /// Whether there are twice as many as when the point spread was looked for everywhere.
    pub(super) fn has_doubled(&self) -> bool {
        self.pages.len() >= (2 * self.sought_at).max(1)
    }

    /// All were looked at, and the point spread was looked for everywhere if `everywhere`.
    pub(super) fn was_looked_at(&mut self, everywhere: bool) {
        self.looked_at = self.pages.len();
        if everywhere {
            self.sought_at = self.pages.len();
        }
    }

    /// Makes room where there is none: what fits nothing tells nothing.
    pub(super) fn drop_what_fits_nothing(&mut self) {
        if self.is_full() {
            let Self { pages, blank, .. } = self;
            pages.retain_mut(|page| {
                if !page.fits() {
                    blank.push(mem::take(&mut page.copied));
                }
                page.fits()
            });
            self.looked_at = self.pages.len();
        }
    }

    /// What the one in the middle of those that fit and stand alone leaves, `sorted` being room to work in: any of those beside each other may be two.
    pub(super) fn median_misfit(&self, sorted: &mut Vec<f64>) -> Option<f64> {
        sorted.clear();
        let alone = self.pages.iter().filter(|page| page.opened.beside().is_empty());
        sorted.extend(alone.filter_map(|page| page.misfit));
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// How many fit and have no full pixel.
    pub(super) fn unsaturated(&self) -> usize {
        self.pages.iter().filter(|page| page.fits() && page.copied.full_px == 0).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Pixel;
    use crate::frame::FrameView;
    use crate::lanes::{self, Lanes};
    use crate::optics::{Gaussian, PointSpread};
    use crate::spots::fit::{LIGHT, Shape};
    use crate::spots::learning::{Belief, Told};
    use crate::spots::patch::Surroundings;
    use crate::spots::window::Spill;
    use nalgebra::SMatrix;
    use rand_distr::{Distribution as _, Normal};
    use rand_pcg::rand_core::SeedableRng as _;

    const SIDE: usize = 31;
    const LEVEL_DN: f64 = 10.0;
    const AROUND: Surroundings =
        Surroundings { level: LEVEL_DN as f32, slope: [0.0; 2], variance: 0.3, is_cut_off: false };
    /// Of one variance everywhere: what it is does not depend on the numbers.
    const NOISE: PixelNoise = PixelNoise { dark: 0.3, shot: 0.0, shape: 0.0, faint: 0.0 };

    /// A page of a point beside the middle of a frame, behind a lens with a core and a halo, whose full pixels keep what is theirs.
    fn page(light: f64, window: &mut Window) -> Page {
        let parts = [Gaussian { share: 0.8, sigma_px: 0.5 }, Gaussian { share: 0.2, sigma_px: 1.6 }];
        let spread = PointSpread::gaussians(&parts).unwrap();
        let noise = Normal::new(0.0, 0.55).unwrap();
        let mut rng = rand_pcg::Pcg64::seed_from_u64(7);
        let (u, v) = (15.3, 14.8);
        let pixels: Vec<u8> = (0..SIDE * SIDE)
            .map(|at| {
                let share = spread.share((at % SIDE) as f64 - u, (at / SIDE) as f64 - v);
                (LEVEL_DN + light * share + noise.sample(&mut rng)).round() as u8
            })
            .collect();
        let frame = FrameView::new(&pixels, SIDE, SIDE, SIDE).unwrap();
        window.read(&frame, Pixel::new(u, v), 7.0, &AROUND, u8::MAX);
        let mut copied = Copied::default();
        window.trade(&mut copied);
        Page::new(copied, Opened::alone(AROUND, (0.2, -0.1, 0.8 * light)), None)
    }

    /// What a page says where the numbers are those that are believed, but for some.
    fn said(page: &mut Page, window: &mut Window, off: [f64; NUMBERS]) -> Said {
        let mut belief = Belief::new(NOISE, u8::MAX);
        belief.go(belief.numbers() + SVector::from(off));
        window.trade(&mut page.copied);
        let said = page.says::<WIDTH, { WIDTH + NUMBERS }>(window, belief.known(), belief.free(), NOISE);
        window.trade(&mut page.copied);
        said.expect("it fits")
    }

    #[test]
    fn what_a_spot_says_is_how_its_cost_changes() {
        let mut window = Window::default();
        for (light, is_full, allowed) in [(600.0, false, 0.02), (2500.0, true, 0.1)] {
            let mut page = page(light, &mut window);
            assert_eq!(page.copied.full_px > 0, is_full);
            let here = said(&mut page, &mut window, [0.0; NUMBERS]);
            for number in 0..if is_full { NUMBERS } else { 3 } {
                let mut cost = |by: f64| {
                    let mut off = [0.0; NUMBERS];
                    off[number] += by;
                    let said = said(&mut page, &mut window, off);
                    said.chi2 + said.rest_of_cost
                };
                let slope = (cost(0.002) - cost(-0.002)) / 0.004;
                let told = -2.0 * here.weighted[number];
                assert!(
                    (slope - told).abs() < 1.0 + allowed * slope.abs(),
                    "{light} {number}: {slope} {told}"
                );
            }
        }
    }

    #[test]
    fn a_light_is_as_unsure_as_the_spread_that_tells_it() {
        let mut window = Window::default();
        let mut page = page(2500.0, &mut window);
        let belief = Belief::new(NOISE, u8::MAX);
        window.trade(&mut page.copied);
        let light = |belief: &Belief, window: &mut Window| {
            let guess = page.opened.guess;
            fit::fit(window, &mut belief.known(), guess, NOISE).expect("it fits")
        };
        let fitted = light(&belief, &mut window);
        // The core alone is not known.
        let (sigma, mut covariance) = (0.01, SMatrix::<f64, NUMBERS, NUMBERS>::zeros());
        covariance[(0, 0)] = sigma * sigma;
        let considered = fit::considered(&mut window, &mut belief.free(), fitted, NOISE, &covariance);
        let mut wider = |by: f64| {
            let mut other = Belief::new(NOISE, u8::MAX);
            let mut off = SVector::<f64, NUMBERS>::zeros();
            off[0] = by;
            other.go(belief.numbers() + off);
            light(&other, &mut window).numbers[LIGHT]
        };
        let change = 0.5 * (wider(sigma) - wider(-sigma));
        let added = (considered.light_variance() - fitted.light_variance()).sqrt();
        assert!((added / change.abs() - 1.0).abs() < 0.2, "{added} {change}");
    }

    /// Told by [`fit::off_alike`] and by a spread that has so much more all around.
    #[test]
    fn a_light_is_as_unsure_as_the_ring_that_tells_it() {
        let mut window = Window::default();
        let mut page = page(2500.0, &mut window);
        let belief = Belief::new(NOISE, u8::MAX);
        let noise = PixelNoise { faint: 1e-5, ..NOISE };
        window.trade(&mut page.copied);
        let mut fitted_with = |off_sigmas: f32| {
            let mut brighter =
                BrighterRing { shape: belief.known(), unknown: off_sigmas * off_sigmas.abs() * noise.faint };
            fit::fit(&mut window, &mut brighter, page.opened.guess, noise).expect("it fits")
        };
        let change = 0.5 * (fitted_with(1.0).light() - fitted_with(-1.0).light());
        let fitted = fitted_with(0.0);
        let told = fit::off_alike(&mut window, &mut belief.known(), fitted, noise);
        let added = (told.light_variance() - fitted.light_variance()).sqrt();
        assert!((added / change.abs() - 1.0).abs() < 0.1, "{added} {change}");
        let by_chance =
            fit::fit(&mut window, &mut belief.known(), page.opened.guess, NOISE).expect("it fits");
        let by_chance = (fitted.light_variance() - by_chance.light_variance()).sqrt();
        assert!(added > 1.5 * by_chance, "{added}, {by_chance} where each pixel is off for itself");
    }

    /// A shape whose shares are off alike all around: by the root of `unknown` of the light for each share, as its sign says.
    struct BrighterRing<S> {
        shape: S,
        unknown: f32,
    }

    impl<const N: usize, S: Shape<N>> Shape<N> for BrighterRing<S> {
        fn shares(&self, row: usize, column: usize, numbers: &SVector<f64, N>) -> (Lanes, [Lanes; N]) {
            let (share, slopes) = self.shape.shares(row, column, numbers);
            let off = (Lanes::splat(self.unknown.abs()) * lanes::positive(share)).sqrt();
            (share + off * Lanes::splat(self.unknown.signum()), slopes)
        }

        fn place(&mut self, numbers: &SVector<f64, N>, reach: usize) {
            self.shape.place(numbers, reach);
        }

        fn believed(&self, number: usize) -> (f64, f64) {
            self.shape.believed(number)
        }

        fn spill(&self, numbers: &SVector<f64, N>) -> Spill {
            self.shape.spill(numbers)
        }
    }

    #[test]
    fn what_misfits_costs_as_if_its_pixels_were_noisier() {
        let mut window = Window::default();
        let mut page = page(600.0, &mut window);
        let mut said = said(&mut page, &mut window, [0.0; NUMBERS]);
        let cost = |said: &Said| {
            let mut told = Told::default();
            told.add(said);
            told.cost - said.rest_of_cost
        };
        for misfit in [0.5, 0.99, 1.01, 4.0, 20.0] {
            said.chi2 = misfit * said.freedom;
            // Least over how much noisier they may be, no less than they are.
            let noisier = (0..6000).map(|step| 1.0 + f64::from(step) * 0.01);
            let least = noisier
                .map(|noisier| said.chi2 / noisier + said.freedom * libm::log(noisier))
                .fold(f64::INFINITY, f64::min);
            assert!((cost(&said) - least).abs() < 0.01 * said.freedom, "{misfit}: {} {least}", cost(&said));
        }
    }

    #[test]
    fn an_album_is_looked_at_again_as_it_grows() {
        let mut window = Window::default();
        let mut album = Album::default();
        assert!(!album.has_grown());
        let mut looks = Vec::new();
        while !album.is_full() {
            album.add(page(600.0, &mut window));
            if album.has_grown() {
                looks.push((album.len(), album.has_doubled()));
                album.was_looked_at(album.has_doubled());
            }
        }
        let everywhere: Vec<_> =
            looks.iter().filter(|(_, doubled)| *doubled).map(|(pages, _)| *pages).collect();
        assert!(everywhere.windows(2).all(|two| two[1] >= 2 * two[0]), "{everywhere:?}");
        assert!(looks.windows(2).all(|two| 8 * two[1].0 >= 9 * two[0].0), "{looks:?}");
        album.drop_what_fits_nothing();
        assert_eq!(album.len(), 0);
        assert!(!album.has_grown());
    }
}
