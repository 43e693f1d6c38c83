//! What the first spots looked like that tell of a camera that nobody measured.
//!
//! In: the pixels of such spots, frame after frame. Out: all of them, to be looked at again whenever more is known. What a spot said where the point
//! spread was wrong is worth nothing once it is right; its pixels are.

use alloc::vec::Vec;

use super::fit::{self, Fitted, PixelNoise, Shape, WIDTH};
use super::fitting::NO_POINT;
use super::learning::{NUMBERS, Said};
use super::smear::Motion;
use super::telling::Opened;
use super::window::{Copied, Window};
use nalgebra::SVector;

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
    /// Whether it fitted when it was looked at last.
    pub(super) fits: bool,
}

impl Page {
    pub(super) fn new(copied: Copied, opened: Opened, motion: Option<Motion>) -> Self {
        Self { copied, opened, motion, own: None, fits: false }
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
        fit::said(window, &mut free, &all, noise).filter(|said| said.chi2 < NO_POINT * said.freedom)
    }
}

/// The spots that are kept.
#[derive(Debug, Default)]
pub(super) struct Album {
    pages: Vec<Page>,
    /// How many there were when all were looked at last, and when the point spread was looked for everywhere.
    looked_at: usize,
    sought_at: usize,
}

impl Album {
    pub(super) fn pages(&mut self) -> &mut [Page] {
        &mut self.pages
    }

    pub(super) fn is_full(&self) -> bool {
        self.pages.len() >= PAGES
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
        self.pages.truncate(pages);
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
            self.pages.retain(|page| page.fits);
            self.looked_at = self.pages.len();
        }
    }

    /// How many fit and have no full pixel.
    pub(super) fn unsaturated(&self) -> usize {
        self.pages.iter().filter(|page| page.fits && page.copied.full_px == 0).count()
    }
}
