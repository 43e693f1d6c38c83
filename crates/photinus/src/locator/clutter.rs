//! How dense clutter is: bright points that are no neighbour's markers.
//!
//! In: how likely each observation of the frame is clutter, and which belong together if they are not clutter. Out: the density of clutter at each
//! observation, from the others: those of the frame as a whole, those around it, for glints and hot pixels come in crowds, and those right beside it, for
//! clutter comes in clumps; and from what stays where it is. Observations that belong
//! together are clutter together or not at all: the first of them is as dense as what is around, each further one as if those before were clutter
//! (a Poisson process whose rate is not known), and each gets the mean of the logarithms. A density is per sr and per unit of the logarithm of light.

use alloc::vec;
use alloc::vec::Vec;

use super::Sighting;
use super::cells::Cells;
use super::companions::Companions;
use super::fixtures::Fixtures;
use super::grouping::Groups;
use super::memory::Memory;
use super::sun::Sun;

/// Clutter of a frame before any was seen: this many points, worth this many frames.
const BEFOREHAND: f64 = 0.2;
const WORTH_FRAMES: f64 = 0.3;
/// Side of the cells in which clutter is counted, px: an observation's surroundings are three by three of them.
const CELL_PX: f64 = 64.0;
/// The mean of the whole frame is worth what the surroundings tell over this many times their area.
const WORTH_SURROUNDINGS: f64 = 1.0;
/// The light of clutter may be anything over this many units of its logarithm, a factor of 3,000: as good as this many points that show their light.
const LIGHT_RANGE: f64 = 8.0;
const WORTH_POINTS: f64 = 3.0;
/// Clutter that blinks one of our signals is so rare among clutter, as a logarithm: one in a hundred.
const BLINKS_BY_CHANCE: f64 = 4.6;
/// The light that clutter has is counted in steps of its logarithm.
const LIGHT_STEP: f64 = 0.5;
const LIGHT_STEPS: usize = 32;

/// What the density of clutter at an observation depends on.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) sightings: &'a [Sighting],
    /// Clutter of the frame besides.
    pub(super) besides: &'a Counts,
    pub(super) companions: &'a Companions,
    pub(super) fixtures: &'a Fixtures,
    pub(super) memory: &'a Memory,
    pub(super) sun: Option<Sun>,
    /// Whether densities are of light, too.
    pub(super) with_light: bool,
}

impl Surroundings<'_> {
    /// Logarithm of the density of clutter at an observation, of what comes and goes, of the sun and of what stays where it is, as it looks.
    fn with_what_stands(&self, log_of_others: f64, observation: usize) -> f64 {
        let sighting = &self.sightings[observation];
        let log_of_others = self.with_sun(log_of_others, sighting);
        let there = self.fixtures.density(sighting, observation) / rad2_per_px2(sighting);
        if there == 0.0 {
            return log_of_others + log_of_look(sighting);
        }
        let gain = libm::log(libm::exp(log_of_others) + there) - log_of_others;
        log_of_others + gain.min(self.fixtures.log_odds(observation).max(0.0)) + log_of_look(sighting)
    }

    /// How much of an observation, if it is clutter, is clutter that comes and goes: what stays where it is and the sun tell nothing of other places.
    fn comes_and_goes(&self, observation: usize, frame_px: f64) -> f64 {
        let sighting = &self.sightings[observation];
        let suns = self.sun.map_or(0.0, |sun| sun.per_sr(&sighting.bearing));
        let beforehand = BEFOREHAND / (frame_px * rad2_per_px2(sighting));
        (1.0 - self.fixtures.share(observation)) * beforehand / (beforehand + suns)
    }

    /// The same of what comes and goes with the sun, whose light may be any.
    fn with_sun(&self, log_of_others: f64, sighting: &Sighting) -> f64 {
        let Some(sun) = &self.sun else { return log_of_others };
        let of_light = if self.with_light && sighting.log_light.is_some() { LIGHT_RANGE } else { 1.0 };
        libm::log(libm::exp(log_of_others) + sun.per_sr(&sighting.bearing) / of_light)
    }
}

/// Solid angle of a pixel.
fn rad2_per_px2(sighting: &Sighting) -> f64 {
    (sighting.rad_per_px * sighting.rad_per_px).max(1e-12)
}

/// The density of clutter at each observation.
#[derive(Debug)]
pub(super) struct Clutter {
    frame_px: f64,
    with_light: bool,
    log_density: Vec<f64>,
    counts: Counts,
    /// Counts of the observations before one.
    before: Counts,
}

impl Clutter {
    /// Nothing measured yet, in images of `size` (width, height) px. Without `with_light` the density is one of directions alone.
    pub(super) fn new(size: [usize; 2], with_light: bool) -> Self {
        Self {
            frame_px: (size[0] * size[1]) as f64,
            with_light,
            log_density: Vec::new(),
            counts: Counts::of(size),
            before: Counts::of(size),
        }
    }

    /// How much clutter is in every cell of the image and step of light, as measured last.
    pub(super) fn counts(&self) -> &[f64] {
        &self.counts.list
    }

    /// Logarithm of the density at each observation.
    pub(super) fn log_density(&self) -> &[f64] {
        &self.log_density
    }

    /// Measures the density, where `share` tells how likely an observation is clutter, after the frames that are remembered.
    pub(super) fn measure(
        &mut self,
        frame: &Surroundings<'_>,
        groups: &Groups,
        share: impl Fn(usize) -> f64,
    ) {
        let Surroundings { sightings, besides, companions, .. } = *frame;
        let frame_px = self.frame_px;
        let share = |index: usize| share(index) * frame.comes_and_goes(index, frame_px);
        self.counts.list.copy_from_slice(&besides.list);
        for (index, sighting) in sightings.iter().enumerate() {
            self.counts.add(sighting, share(index));
        }
        self.log_density.clear();
        self.log_density.resize(sightings.len(), 0.0);
        for members in (0..groups.len()).map(|group| groups.group(group)) {
            members.iter().for_each(|&index| self.counts.add(&sightings[index], -share(index)));
            let each = members.iter().map(|&index| share(index)).sum::<f64>() / members.len() as f64;
            let one_after_the_other = |(before, &index): (usize, &usize)| {
                let sighting = &sightings[index];
                let weight = |other: usize| match members[..before].contains(&other) {
                    true => each,
                    false if members.contains(&other) => 0.0,
                    false => share(other),
                };
                let beside: f64 =
                    companions.of(index).iter().map(|near| weight(near.observation) * near.density).sum();
                self.log_per_sr(&self.counts, frame, sighting, before as f64 * each, beside)
            };
            let mean =
                members.iter().enumerate().map(one_after_the_other).sum::<f64>() / members.len() as f64;
            for &index in members {
                self.log_density[index] = frame.with_what_stands(mean, index);
                self.counts.add(&sightings[index], share(index));
            }
        }
    }

    /// How much less likely it is that all observations are clutter, as likely as `share` tells, than the densities measured have it: each of those is
    /// after all others, but a frame is drawn one after the other (chain rule).
    pub(super) fn excess(&mut self, frame: &Surroundings<'_>, share: impl Fn(usize) -> f64) -> f64 {
        let Surroundings { sightings, besides, companions, .. } = *frame;
        let frame_px = self.frame_px;
        let comes_and_goes = |index: usize| share(index) * frame.comes_and_goes(index, frame_px);
        self.before.list.copy_from_slice(&besides.list);
        let mut excess = 0.0;
        for (index, sighting) in sightings.iter().enumerate() {
            let earlier = companions.of(index).iter().filter(|near| near.observation < index);
            let beside: f64 = earlier.map(|near| comes_and_goes(near.observation) * near.density).sum();
            let first =
                frame.with_what_stands(self.log_per_sr(&self.before, frame, sighting, 0.0, beside), index);
            excess += share(index) * (self.log_density[index] - first);
            self.before.add(sighting, comes_and_goes(index));
        }
        excess
    }

    /// Logarithm of how dense clutter is at an observation, with this many more points at the same place, and so dense beside others per px^2.
    fn log_per_sr(
        &self,
        counts: &Counts,
        frame: &Surroundings<'_>,
        sighting: &Sighting,
        more: f64,
        beside: f64,
    ) -> f64 {
        let memory = frame.memory;
        let frames = 1.0 + memory.frames() as f64;
        let cells = counts.cells;
        let around = cells.around(cells.of_observation(sighting));
        let area_px = around.clone().count() as f64 * cells.area_px2();
        let in_area =
            around.map(|cell| counts.list[cell] + memory.clutter(cell)).sum::<f64>().max(0.0) + more;
        let in_frame = counts.total(memory) + more;
        let mean = (BEFOREHAND * WORTH_FRAMES + in_frame) / (self.frame_px * (frames + WORTH_FRAMES));
        let here = mean * area_px * WORTH_SURROUNDINGS + in_area;
        let by_itself =
            here / (area_px * (frames + WORTH_SURROUNDINGS)) * self.of_light(counts, memory, sighting);
        libm::log((by_itself + beside) / rad2_per_px2(sighting))
    }

    /// How dense the light of clutter is at that of an observation.
    fn of_light(&self, counts: &Counts, memory: &Memory, sighting: &Sighting) -> f64 {
        let Some(light) = sighting.log_light.filter(|_| self.with_light) else { return 1.0 };
        let step = light_step(light.value);
        let count = |step: usize| {
            let place = counts.cells.count() + step;
            counts.list[place] + memory.clutter(place)
        };
        let there = 0.25 * count(step.saturating_sub(1))
            + 0.5 * count(step)
            + 0.25 * count((step + 1).min(LIGHT_STEPS - 1));
        let density = WORTH_POINTS / LIGHT_RANGE + there.max(0.0) / LIGHT_STEP;
        density / (WORTH_POINTS + counts.total(memory))
    }
}

/// What the look and the signal of an observation tell against its being clutter, as a logarithm.
fn log_of_look(sighting: &Sighting) -> f64 {
    -sighting.spot.marker_log_odds.min(0.0) - sighting.signal.map_or(0.0, |_| BLINKS_BY_CHANCE)
}

/// Clutter by cell of the image, then by step of light, then in all.
#[derive(Debug)]
pub(super) struct Counts {
    cells: Cells,
    list: Vec<f64>,
}

impl Counts {
    /// None, in images of `size` (width, height) px.
    pub(super) fn of(size: [usize; 2]) -> Self {
        let cells = Cells::new(size, CELL_PX);
        Self { cells, list: vec![0.0; cells.count() + LIGHT_STEPS + 1] }
    }

    /// Counts these observations and no others.
    pub(super) fn count(&mut self, clutter: &[Sighting]) {
        self.list.fill(0.0);
        clutter.iter().for_each(|sighting| self.add(sighting, 1.0));
    }

    /// All of it, with what is remembered.
    fn total(&self, memory: &Memory) -> f64 {
        let place = self.list.len() - 1;
        (self.list[place] + memory.clutter(place)).max(0.0)
    }

    /// Counts an observation by this much.
    fn add(&mut self, sighting: &Sighting, share: f64) {
        self.list[self.cells.index(self.cells.of_observation(sighting))] += share;
        let total = self.list.len() - 1;
        self.list[total] += share;
        if let Some(light) = sighting.log_light {
            self.list[self.cells.count() + light_step(light.value)] += share;
        }
    }
}

/// The step that a logarithm of light is in.
fn light_step(log_light: f64) -> usize {
    ((log_light / LIGHT_STEP).max(0.0) as usize).min(LIGHT_STEPS - 1)
}
