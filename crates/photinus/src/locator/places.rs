//! What an observation's place, look and light say of how dense clutter is there: the same however much of the frame is taken for clutter, so worked
//! out once a frame.

use alloc::vec::Vec;

use super::Sighting;
use super::cells::Cells;
use super::clutter::{BEFOREHAND, LIGHT_RANGE};
use super::fixtures::Fixtures;
use super::sun::Sun;
use crate::spots::HOT_BEFOREHAND;

/// Clutter that blinks one of our signals is so rare among clutter, as a logarithm: one in a hundred.
const BLINKS_BY_CHANCE: f64 = 4.6;
/// No reflection has larger odds for clutter by its look: a single pixel that has is a hot one, or noise.
const REFLECTION_ODDS: f64 = 8.0;
/// The light that clutter has is counted in steps of its logarithm.
pub(super) const LIGHT_STEP: f64 = 0.5;
pub(super) const LIGHT_STEPS: usize = 32;

/// What stands at an observation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Column and row of its cell.
    pub(super) cell: [usize; 2],
    /// The step that its light is in.
    pub(super) light_step: Option<usize>,
    /// Solid angle of a pixel.
    pub(super) rad2_per_px2: f64,
    /// How much of it, if it is clutter, is clutter that comes and goes: what stays where it is and the sun tell nothing of other places.
    pub(super) comes_and_goes: f64,
    /// Odds that it is a hot pixel, if it is clutter.
    hot_odds: f64,
    /// How dense clutter is there for each hot pixel that the frame has.
    hot_density: f64,
    /// Density of the sun, whose light may be any, where one is expected.
    sun: Option<f64>,
    /// Density of what was there before, and the logarithm of the odds that it is clutter.
    fixture: f64,
    fixture_log_odds: f64,
    /// What its look and its signal tell against its being clutter, as a logarithm.
    log_of_look: f64,
}

/// What stands at each observation of a frame.
#[derive(Debug, Default)]
pub(super) struct Places(Vec<Place>);

impl Places {
    /// Works them out, in an image of so many pixels that is counted by `cells`.
    pub(super) fn find(
        &mut self,
        sightings: &[Sighting],
        (cells, frame_px): (&Cells, f64),
        fixtures: &Fixtures,
        sun: Option<Sun>,
        with_light: bool,
    ) {
        let place = |(observation, sighting): (usize, &Sighting)| {
            let rad2_per_px2 = rad2_per_px2(sighting);
            let suns = sun.map(|sun| sun.per_sr(&sighting.bearing));
            let of_light = if with_light && sighting.log_light.is_some() { LIGHT_RANGE } else { 1.0 };
            let beforehand = BEFOREHAND / (frame_px * rad2_per_px2);
            let hot_odds = hot_odds(sighting);
            Place {
                cell: cells.of_observation(sighting),
                light_step: sighting.log_light.map(|light| light_step(light.value)),
                rad2_per_px2,
                comes_and_goes: (1.0 - fixtures.share(observation)) * beforehand
                    / (beforehand + suns.unwrap_or(0.0)),
                hot_odds,
                hot_density: hot_odds / (HOT_BEFOREHAND * frame_px * rad2_per_px2 * of_light),
                sun: suns.map(|per_sr| per_sr / of_light),
                fixture: fixtures.density(sighting, observation) / rad2_per_px2,
                fixture_log_odds: fixtures.log_odds(observation).max(0.0),
                log_of_look: log_of_look(sighting),
            }
        };
        self.0.clear();
        self.0.extend(sightings.iter().enumerate().map(place));
    }

    /// By observation.
    pub(super) fn each(&self) -> &[Place] {
        &self.0
    }
}

impl Place {
    /// How likely it is a hot pixel, if it is clutter: how many there are tells nothing of what looks otherwise.
    pub(super) fn is_hot(&self) -> f64 {
        self.hot_odds / (1.0 + self.hot_odds)
    }

    /// Logarithm of the density of clutter there, of what comes and goes, of the sun, of what stays where it is and of so many hot pixels in a frame, as it
    /// looks.
    pub(super) fn with_what_stands(&self, log_of_others: f64, hot_pixels: f64) -> f64 {
        let log_density = self.with_fixtures(log_of_others);
        let of_hot = hot_pixels * self.hot_density;
        if of_hot > 0.0 { libm::log(libm::exp(log_density) + of_hot) } else { log_density }
    }

    fn with_fixtures(&self, log_of_others: f64) -> f64 {
        let log_of_others = match self.sun {
            Some(sun) => libm::log(libm::exp(log_of_others) + sun),
            None => log_of_others,
        };
        if self.fixture == 0.0 {
            return log_of_others + self.log_of_look;
        }
        let gain = libm::log(libm::exp(log_of_others) + self.fixture) - log_of_others;
        log_of_others + gain.min(self.fixture_log_odds) + self.log_of_look
    }
}

fn rad2_per_px2(sighting: &Sighting) -> f64 {
    (sighting.rad_per_px * sighting.rad_per_px).max(1e-12)
}

/// Odds that an observation is a hot pixel, if it is clutter.
fn hot_odds(sighting: &Sighting) -> f64 {
    if sighting.spot.area_px != 1 {
        return 0.0;
    }
    (libm::exp(-sighting.spot.marker_log_odds) - REFLECTION_ODDS).max(0.0)
}

fn log_of_look(sighting: &Sighting) -> f64 {
    -sighting.spot.marker_log_odds.min(0.0) - sighting.signal.map_or(0.0, |_| BLINKS_BY_CHANCE)
}

/// The step that a logarithm of light is in.
pub(super) fn light_step(log_light: f64) -> usize {
    ((log_light / LIGHT_STEP).max(0.0) as usize).min(LIGHT_STEPS - 1)
}
