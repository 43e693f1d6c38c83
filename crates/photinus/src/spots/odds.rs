//! How likely a spot is the light of markers, from how it looks in its frame alone.
//!
//! In: the spots of a frame, each with the odds that it is clutter of a kind that its own look tells (glare, a streak, a hot pixel), and how wide it is. Out: each one's [`Spot::marker_log_odds`], beforehand markers and clutter being as likely as each
//! other. Faint images of markers in shiny surfaces are told by their light over that of the brightest spot. They share that with
//! markers that are far or turned away: rendered flights of one neighbour and of twelve have as many LEDs per logarithm of light from the
//! brightest down to a fiftieth, so that no look makes a faint spot certainly one or the other.

use super::breadth::{self, Breadths, EffectiveArea};
use super::settings::Shape;
use super::{Detections, Spot};
use crate::normal;

/// Odds for clutter of what lies beside the sun: its glare always does, a marker does as seldom as that part of the frame is small.
pub(super) const BESIDE_SUN: f64 = 50.0;
/// Odds for clutter of what is as long and thin as a streak, yet no longer than a marker that moves during the exposure.
pub(super) const LONG_AND_THIN: f64 = 20.0;
/// Odds for clutter of what is bright beside more light than its own, as glare and edges are.
pub(super) const STEP: f64 = 20.0;

/// Markers are fewer by e per this much less of the logarithm of light (rendered flights of one to twelve neighbours).
const MARKERS_FALL: f64 = 1.3;
/// The logarithm of a reflection's light: how far below the ratio at which it is as likely a marker, and its spread (real glossy surfaces
/// gave 0.09 to 0.18 of the brightest LED).
const REFLECTIONS_BELOW: f64 = 0.8;
const REFLECTIONS_SIGMA: f64 = 0.7;
/// Share of the reflections that may be of any light, and the logarithm of light over which they spread.
const ANY_REFLECTIONS: f64 = 0.15;
const ANY_SPAN: f64 = 6.0;
/// What is fainter than this share of the brightest is as likely a reflection as that.
const LEAST_SHARE: f64 = 1e-3;
/// Odds for clutter where nothing speaks for it: looks alone never make a marker more certain.
const LEAST_ODDS: f64 = 0.02;

/// Odds that a single bright pixel, so many sigmas above darkness in a frame of so many pixels, is noise: pixels of noise over markers, both per
/// unit of the logarithm of height. Of markers there is about one.
pub(super) fn of_noise(sigmas: f64, pixels: usize) -> f64 {
    pixels as f64 * sigmas * normal::density(sigmas, 1.0)
}

/// How a spot looks by itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Odds that clutter of other kinds has than reflections and what is wider than points.
    pub(super) clutter_odds: f64,
    /// Whether a point spread told its light: what a window tells may hide most of it.
    pub(super) is_point: bool,
    /// How wide it is, where all of its light shows.
    pub(super) area: Option<EffectiveArea>,
}

impl Look {
    /// All light of a spot that looks so, grey levels, or as much of it as shows.
    fn light(self, spot: &Spot) -> f64 {
        spot.light.filter(|_| self.is_point).map_or(spot.flux, |light| light.value)
    }

    /// Odds that it is clutter for being wider than points, whose area has this logarithm.
    fn breadth_odds(self, of_points: f64) -> f64 {
        self.area.filter(|_| !self.is_point).map_or(0.0, |area| breadth::odds(area, of_points))
    }
}

/// Weighs the odds of all spots by how each looks.
pub(super) fn weigh(detections: &mut Detections, looks: &[Look], breadths: &mut Breadths, shape: &Shape) {
    let spots = &mut detections.spots;
    let most = |of: fn(&Spot) -> f64| spots.iter().map(of).fold(0.0, f64::max);
    let light = spots.iter().zip(looks).map(|(spot, look)| look.light(spot)).fold(0.0, f64::max);
    let brightest = Brightest { light, flux: most(|spot| spot.flux), height: most(height) };
    let several_px = spots.iter().zip(looks).filter(|(spot, _)| spot.area_px > 1);
    let of_points = breadths.of_points(several_px.filter_map(|(_, look)| look.area));
    for (spot, &look) in spots.iter_mut().zip(looks) {
        let reflection = reflection_odds(brightest.share_of(spot, look), shape.reflection_ratio);
        spot.marker_log_odds = -libm::log(reflection + look.clutter_odds + look.breadth_odds(of_points));
    }
}

/// The most of each that a spot of the frame has.
struct Brightest {
    light: f64,
    flux: f64,
    height: f64,
}

impl Brightest {
    /// How bright a spot is over the brightest. The height of a narrow spot depends on where in a pixel it falls, and what full pixels hide
    /// is in neither height nor flux: where no point spread told its light, it is as bright as the brighter of these says.
    fn share_of(&self, spot: &Spot, look: Look) -> f64 {
        if look.is_point {
            look.light(spot) / self.light
        } else {
            (spot.flux / self.flux).max(height(spot) / self.height)
        }
    }
}

/// Grey levels above the background.
fn height(spot: &Spot) -> f64 {
    f64::from(spot.peak) - spot.background
}

/// Odds that a spot with this share of the brightest one's light is a reflection.
fn reflection_odds(share: f64, ratio: f64) -> f64 {
    if ratio <= 0.0 {
        return LEAST_ODDS;
    }
    // A share that has no meaning is that of what hardly shows.
    let fainter = -libm::log(if share > LEAST_SHARE { share.min(1.0) } else { LEAST_SHARE });
    let off = (fainter + libm::log(ratio) - REFLECTIONS_BELOW) / REFLECTIONS_SIGMA;
    let log_normal = normal::density(off, REFLECTIONS_SIGMA);
    let reflections = (1.0 - ANY_REFLECTIONS) * log_normal + ANY_REFLECTIONS / ANY_SPAN;
    let markers = libm::exp(-fainter / MARKERS_FALL) / MARKERS_FALL;
    reflections / markers
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;

    use super::*;
    use crate::camera::Pixel;
    use crate::optics::Measured;
    use crate::spots::Extent;

    fn spot(peak: u8, flux: f64, light: Option<f64>) -> Spot {
        Spot {
            centre: Pixel::new(7.0, 9.0),
            covariance_px2: Matrix2::identity(),
            area_px: 1,
            peak,
            saturated_px: 0,
            flux,
            light: light.map(|value| Measured { value, sigma: 0.1 * value }),
            background: 0.0,
            marker_log_odds: 0.0,
            middle: (7, 9),
            extent: Extent { left: 7, top: 9, right: 7, bottom: 9 },
        }
    }

    fn odds(spots: &[Spot], clutter_odds: &[f64]) -> Vec<f64> {
        let mut detections = Detections { spots: spots.to_vec(), rejected: Vec::new() };
        let looks = spots.iter().zip(clutter_odds);
        let looks: Vec<Look> = looks
            .map(|(spot, &clutter_odds)| Look { clutter_odds, is_point: spot.light.is_some(), area: None })
            .collect();
        weigh(&mut detections, &looks, &mut Breadths::default(), &Shape::default());
        detections.spots.iter().map(|spot| libm::exp(spot.marker_log_odds)).collect()
    }

    #[test]
    fn what_is_as_faint_as_the_reflections_of_real_surfaces_is_more_likely_one_but_not_surely() {
        for share in [0.05, 0.09, 0.12, 0.18] {
            let found = odds(
                &[spot(200, 1000.0, None), spot((200.0 * share) as u8, 1000.0 * share, None)],
                &[0.0; 2],
            );
            assert!(found[0] > 10.0 && found[1] < 0.9 && found[1] > 0.1, "{share}: {found:?}");
        }
    }

    #[test]
    fn what_is_about_as_bright_as_the_brightest_is_a_marker() {
        for share in [0.33, 0.5, 1.0] {
            let found = odds(
                &[spot(200, 1000.0, None), spot((200.0 * share) as u8, 1000.0 * share, None)],
                &[0.0; 2],
            );
            assert!(found[1] > 2.0, "{share}: {found:?}");
        }
    }

    #[test]
    fn light_counts_where_it_is_known_else_the_more_of_flux_and_height() {
        let brightest = spot(255, 2000.0, Some(20_000.0));
        let [far, narrow, wide] =
            [spot(200, 1000.0, Some(2000.0)), spot(40, 1200.0, None), spot(160, 200.0, None)];
        let found = odds(&[brightest, far, narrow, wide], &[0.0; 4]);
        assert!(found[1] < 0.5 && found[2] > 2.0 && found[3] > 2.0, "{found:?}");
    }

    #[test]
    fn no_light_at_all_has_odds_too() {
        let found = odds(&[spot(0, 0.0, None), spot(0, -3.0, None)], &[0.0; 2]);
        assert!(found.iter().all(|odds| odds.is_finite() && *odds > 0.0), "{found:?}");
    }

    #[test]
    fn each_kind_of_clutter_lowers_the_odds() {
        let found = odds(&[spot(200, 1000.0, None), spot(200, 1000.0, None)], &[0.0, BESIDE_SUN]);
        assert!((1.0 / found[1] - 1.0 / found[0] - BESIDE_SUN).abs() < 1e-9, "{found:?}");
    }
}
