//! Whether a single bright pixel is a hot one.
//!
//! In: single bright pixels with what is around them. Out: the odds that each is hot. A point of light gives the eight pixels around its
//! brightest least where it falls on that one's middle; a hot pixel gives them nothing. Where the point spread is known, one frame tells
//! that. Where it is not, cameras that cut off what is dark show real markers so, too: then a pixel is hot if it stands alone frame after frame.

use alloc::vec::Vec;

use super::fit::PixelNoise;
use crate::optics::PointSpread;

/// Hot pixels over markers among what is bright, beforehand.
pub(crate) const BEFOREHAND: f64 = 0.05;
/// The same where a calibration found the pixel hot.
pub(super) const KNOWN: f64 = 1e3;
/// No look makes a pixel more certainly hot than this.
const MOST_ODDS: f64 = 1e4;
/// How much likelier a hot pixel stands alone in a frame than a marker, where the point spread is not known; how much less likely it is not
/// there.
const ALONE: f64 = 5.0;
const MISSED: f64 = 0.1;
/// Pixels that are remembered, at most.
const MOST_PIXELS: usize = 4096;

/// A bright pixel and those around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lone {
    /// Its signal, and the sum of that around it.
    pub(super) own: f32,
    pub(super) around: f32,
    pub(super) sides: Sides,
}

/// Where the pixels around one are that get light of any point that is brightest in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    /// Whether the image ends beside it, and above or below: then those count that lie along its border, for the point may be beyond.
    at_end: [bool; 2],
}

impl Sides {
    /// Of the pixel in a column and row of an image of `size` (width, height) px.
    pub(super) fn of((u, v): (u32, u32), size: [usize; 2]) -> Self {
        let at_end = |place: u32, size: usize| place == 0 || place as usize + 1 >= size;
        Self { at_end: [at_end(u, size[0]), at_end(v, size[1])] }
    }

    /// How many columns and rows away each of them is: eight, but for the border.
    pub(super) fn each(self) -> impl Iterator<Item = [i32; 2]> {
        let around = (0..9).map(|i| [i % 3 - 1, i / 3 - 1]).filter(|away| *away != [0, 0]);
        around.filter(move |away| (0..2).all(|axis| away[axis] == 0 || !self.at_end[axis]))
    }
}

/// How much likelier a hot pixel is to look so than a point of light.
pub(super) fn odds(pixel: Lone, spread: &PointSpread, noise: PixelNoise) -> f64 {
    let [own, around] = [pixel.own, pixel.around].map(f64::from);
    let [dark, shot, shape] = [noise.dark, noise.shot, noise.shape].map(f64::from);
    let count = pixel.sides.each().count();
    if count == 0 {
        return 1.0;
    }
    let shares: f64 =
        pixel.sides.each().map(|away| away.map(f64::from)).map(|[u, v]| spread.share(u, v)).sum();
    let least = own * shares / spread.share(0.0, 0.0);
    let wrong = shape * own;
    let of_hot = count as f64 * dark;
    let of_point = of_hot + shot * least.max(0.0) + wrong * wrong;
    let lacks = (least - around).max(0.0);
    let log_odds = 0.5 * (lacks * lacks / of_point - around * around / of_hot + libm::log(of_point / of_hot));
    libm::exp(log_odds).min(MOST_ODDS)
}

/// Pixels that stood alone in the frames so far.
#[derive(Debug, Default)]
pub(super) struct LonePixels {
    /// In the order of place.
    pixels: Vec<Seen>,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Row and column.
    place: (u32, u32),
    seen: i32,
    missed: i32,
    is_here: bool,
}

impl LonePixels {
    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        for pixel in &mut self.pixels {
            pixel.is_here = false;
        }
    }

    /// Column and row of a pixel that stands alone in it.
    pub(super) fn see(&mut self, (u, v): (u32, u32)) {
        match self.pixels.binary_search_by_key(&(v, u), |pixel| pixel.place) {
            Ok(at) => self.pixels[at].is_here = true,
            Err(at) if self.pixels.len() < MOST_PIXELS => {
                self.pixels.insert(at, Seen { place: (v, u), seen: 0, missed: 0, is_here: true });
            }
            Err(_) => {}
        }
    }

    /// Ends it.
    pub(super) fn end(&mut self) {
        for pixel in &mut self.pixels {
            *(if pixel.is_here { &mut pixel.seen } else { &mut pixel.missed }) += 1;
        }
        self.pixels.retain(|pixel| pixel.missed <= pixel.seen);
    }

    /// Odds that a pixel is hot.
    pub(super) fn odds(&self, (u, v): (u32, u32)) -> f64 {
        let found = self.pixels.binary_search_by_key(&(v, u), |pixel| pixel.place);
        found.map_or(0.0, |at| {
            let Seen { seen, missed, .. } = self.pixels[at];
            let log_odds = f64::from(seen) * libm::log(ALONE) + f64::from(missed) * libm::log(MISSED);
            BEFOREHAND * libm::exp(log_odds.min(libm::log(MOST_ODDS)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Gaussian;

    const SIZE: [usize; 2] = [40, 30];
    const NOISE: PixelNoise = PixelNoise { dark: 0.5, shot: 0.03, shape: 0.05, faint: 0.0 };

    #[test]
    fn a_pixel_with_nothing_around_it_is_hot_and_a_point_is_not() {
        for sigma_px in [0.4, 0.6, 1.0] {
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap();
            for own in [30.0, 200.0] {
                let sides = Sides::of((7, 9), SIZE);
                let hot = Lone { own, around: 0.5, sides };
                assert!(BEFOREHAND * odds(hot, &spread, NOISE) > 5.0, "{sigma_px} px, {own}");
                for phase in [0.0, 0.25, 0.5] {
                    let share =
                        |x: i32, y: i32| spread.share(f64::from(x) - phase, f64::from(y) - phase / 2.0);
                    let eight: f64 = (0..9).filter(|&i| i != 4).map(|i| share(i % 3 - 1, i / 3 - 1)).sum();
                    let around = f64::from(own) * eight / share(0, 0);
                    let odds = odds(Lone { around: around as f32, ..hot }, &spread, NOISE);
                    assert!(BEFOREHAND * odds < 0.02, "{sigma_px} px, {own}, {phase}");
                }
            }
        }
    }

    #[test]
    fn at_the_border_a_point_that_lies_beyond_is_not_hot_and_a_pixel_with_nothing_beside_it_is() {
        let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.6 }]).unwrap();
        for middle in [(0, 9), (39, 9), (7, 0), (7, 29)] {
            let sides = Sides::of(middle, SIZE);
            assert_eq!(sides.each().count(), 2);
            let hot = Lone { own: 120.0, around: 0.3, sides };
            assert!(BEFOREHAND * odds(hot, &spread, NOISE) > 5.0, "{middle:?}");
            for beyond_px in [0.0, 0.4, 0.9] {
                // (0, 9) and (39, 9) have their point beside them, the others above or below.
                let from = |[u, v]: [i32; 2]| match middle.1 {
                    9 => spread.share(f64::from(u) + beyond_px, f64::from(v)),
                    _ => spread.share(f64::from(u), f64::from(v) + beyond_px),
                };
                let around = 120.0 * sides.each().map(from).sum::<f64>() / from([0, 0]);
                let odds = odds(Lone { around: around as f32, ..hot }, &spread, NOISE);
                assert!(BEFOREHAND * odds < 0.02, "{middle:?}, {beyond_px} px");
            }
        }
        assert_eq!(Sides::of((39, 29), SIZE).each().count(), 0);
    }

    #[test]
    fn a_point_spread_within_a_pixel_tells_nothing() {
        let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.1 }]).unwrap();
        let odds = odds(Lone { own: 100.0, around: 0.0, sides: Sides::of((7, 9), SIZE) }, &spread, NOISE);
        assert!((0.1..10.0).contains(&odds), "{odds}");
    }

    #[test]
    fn what_stands_alone_frame_after_frame_is_hot_and_what_passes_is_not() {
        let mut lone = LonePixels::default();
        for frame in 0..8 {
            lone.begin();
            lone.see((30, 20));
            lone.see((frame, 7));
            lone.end();
            assert!(lone.odds((frame, 7)) < 0.5);
        }
        assert!(lone.odds((30, 20)) > 100.0 && lone.odds((3, 7)) == 0.0 && lone.odds((20, 30)) == 0.0);
    }
}
