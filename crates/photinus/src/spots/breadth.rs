//! How much wider a spot is than what a lens makes of points.
//!
//! In: the effective area of each spot of a frame that shows all of its light. Out: odds that it is clutter for being wider than points are. LEDs of a frame
//! have much the same area (in real photos 16 px^2 within a fifth before one lens, 1 to 3 px^2 before a sharper one), texture has any. A lens makes nothing
//! narrower than its points, so it is no wider than the narrowest spots of the frame, but for hot pixels; what is believed of any lens says how wide beforehand.

use alloc::vec::Vec;

use crate::normal;

/// What any lens makes of points, by what is believed of it before a frame is seen ([`super::learning`]): the logarithm of their effective area, and how far it is above that.
pub(super) const ANY_LENS: f64 = 1.4;
pub(super) const ANY_LENS_SIGMA: f64 = 0.95;
/// So many of the spots of a frame may be narrower than its points: noise.
const NARROWER: usize = 10;
/// Share of the markers that may be of any area: near ones, and those beside others.
const ANY_MARKERS: f64 = 0.05;
/// The logarithm of the area of clutter may be anything over so many units, from a pixel to a thousand.
const RANGE: f64 = 7.0;

/// The area that a spot's light would fill were it as high everywhere as its brightest pixel, px^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EffectiveArea {
    log: f64,
    sigma: f64,
}

impl EffectiveArea {
    /// Of a spot of this light, known so far, and height, grey levels; `None` where it has none.
    pub(super) fn new(flux: f64, flux_sigma: f64, height: f64) -> Option<Self> {
        let has_any = flux > 0.0 && height > 0.0;
        has_any.then(|| Self { log: libm::log(flux / height), sigma: flux_sigma / flux })
    }
}

/// The areas of the spots of a frame.
#[derive(Debug, Default)]
pub(super) struct Breadths(Vec<f64>);

impl Breadths {
    /// The logarithm of the area that points have before this lens, at most, where these are the spots of more than one pixel.
    pub(super) fn of_points(&mut self, areas: impl Iterator<Item = EffectiveArea>) -> f64 {
        self.0.clear();
        self.0.extend(areas.map(|area| area.log));
        if self.0.is_empty() {
            return ANY_LENS;
        }
        let narrow = self.0.len() / NARROWER;
        let (_, narrow, _) = self.0.select_nth_unstable_by(narrow, f64::total_cmp);
        narrow.max(ANY_LENS)
    }
}

/// Odds that a spot is clutter for being of this area, where the logarithm of a point's is so much.
pub(super) fn odds(area: EffectiveArea, of_points: f64) -> f64 {
    let sigma = libm::hypot(ANY_LENS_SIGMA, area.sigma);
    let off = (area.log - of_points).max(0.0) / sigma;
    let markers = (1.0 - ANY_MARKERS) * normal::density(off, sigma) + ANY_MARKERS / RANGE;
    (1.0 / (RANGE * markers) - 1.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(px2: f64, relative_sigma: f64) -> EffectiveArea {
        EffectiveArea::new(100.0 * px2, relative_sigma * 100.0 * px2, 100.0).unwrap()
    }

    #[test]
    fn nothing_but_what_is_wider_than_any_points_may_be_is_clutter_for_it() {
        let odds = |px2: f64| odds(area(px2, 0.0), ANY_LENS);
        for px2 in [1.0, 2.0, 4.0, 8.0, 15.0] {
            assert!(odds(px2) == 0.0, "{px2}: {}", odds(px2));
        }
        let wider = [20.0, 40.0, 80.0, 200.0, 1000.0].map(odds);
        assert!(wider.is_sorted() && wider[1] > 3.0 && wider[2] > 10.0, "{wider:?}");
        assert!(wider[4] < 1.0 / ANY_MARKERS, "some markers are: {wider:?}");
    }

    #[test]
    fn light_that_is_hardly_known_tells_hardly_how_wide_it_is() {
        let odds = |relative_sigma: f64| odds(area(60.0, relative_sigma), ANY_LENS);
        assert!(
            odds(0.1) > 5.0 && odds(1.0) < 0.5 * odds(0.1) && odds(3.0) < 1.0,
            "{} {}",
            odds(1.0),
            odds(3.0)
        );
        assert_eq!(EffectiveArea::new(-3.0, 1.0, 20.0), None);
        assert_eq!(EffectiveArea::new(30.0, 1.0, 0.0), None);
    }

    #[test]
    fn a_lens_is_no_wider_than_the_narrowest_but_for_noise() {
        let of_points = |px2: &[f64]| {
            let areas = px2.iter().map(|&px2| area(px2, 0.1));
            Breadths::default().of_points(areas)
        };
        assert!(of_points(&[]) == ANY_LENS && of_points(&[2.0; 5]) == ANY_LENS, "as any lens is");
        let out_of_focus = [60.0, 70.0, 55.0, 65.0, 90.0, 62.0, 58.0, 61.0, 66.0, 300.0];
        assert!((of_points(&out_of_focus) - libm::log(58.0)).abs() < 1e-9);
        assert!(odds(area(65.0, 0.1), of_points(&out_of_focus)) == 0.0, "all markers are as wide");
        assert!(odds(area(600.0, 0.1), of_points(&out_of_focus)) > 1.0);
        assert!(of_points(&[60.0, 2.0, 60.0]) == ANY_LENS, "few: each may be a point");
    }
}
