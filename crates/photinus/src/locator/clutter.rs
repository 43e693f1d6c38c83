//! How dense clutter is: bright points that are no neighbour's markers.
//!
//! In: how likely each observation of the frame is clutter, and which belong together if they are none. Out: the density of clutter at each
//! observation, from the others: those of the frame as a whole and those around it, for glints and hot pixels come in crowds. Observations that belong
//! together are clutter together or not at all: the first of them is as dense as what is around, each further one as if those before were clutter
//! (a Poisson process whose rate is not known), and each gets the mean of the logarithms. A density is per sr and per unit of the logarithm of light.

use super::Sighting;
use super::grouping::Groups;
use super::memory::Memory;

/// Clutter of a frame before any was seen: so many points, worth so many frames.
const BEFOREHAND: f64 = 0.2;
const WORTH_FRAMES: f64 = 0.3;
/// Side of the cells in which clutter is counted, px: an observation's surroundings are three by three of them.
const CELL_PX: f64 = 64.0;
/// The mean of the whole frame is worth what the surroundings tell over so many times their area.
const WORTH_SURROUNDINGS: f64 = 1.0;
/// The light of clutter may be anything over so many units of its logarithm, a factor of 3,000: as good as so many points that show their light.
const LIGHT_RANGE: f64 = 8.0;
const WORTH_POINTS: f64 = 3.0;
/// Clutter that blinks one of our signals is so rare among clutter, as a logarithm: one in a hundred.
const BLINKS_BY_CHANCE: f64 = 4.6;
/// The light that clutter has is counted in steps of its logarithm.
const LIGHT_STEP: f64 = 0.5;
const LIGHT_STEPS: usize = 32;

/// The density of clutter at each observation.
#[derive(Debug, Default)]
pub(super) struct Clutter {
    log_density: Vec<f64>,
    /// By cell of the image, then by step of light.
    counts: Vec<f64>,
}

/// An image that is divided into cells.
#[derive(Clone, Copy)]
struct Cells {
    columns: usize,
    rows: usize,
}

impl Cells {
    fn of([width, height]: [usize; 2]) -> Self {
        let count = |side: usize| (side as f64 / CELL_PX).ceil().max(1.0) as usize;
        Self { columns: count(width), rows: count(height) }
    }

    fn of_observation(&self, sighting: &Sighting) -> [usize; 2] {
        let at = |px: f64, cells: usize| ((px / CELL_PX).max(0.0) as usize).min(cells - 1);
        [at(sighting.spot.centre.u, self.columns), at(sighting.spot.centre.v, self.rows)]
    }

    /// The cells around and with one.
    fn around(self, [column, row]: [usize; 2]) -> impl Iterator<Item = usize> + Clone {
        let across = column.saturating_sub(1)..(column + 2).min(self.columns);
        let down = row.saturating_sub(1)..(row + 2).min(self.rows);
        down.flat_map(move |row| across.clone().map(move |column| row * self.columns + column))
    }
}

impl Clutter {
    /// How many counts there are of an image of `size` (width, height) px.
    pub(super) fn counts_of(size: [usize; 2]) -> usize {
        let Cells { columns, rows } = Cells::of(size);
        columns * rows + LIGHT_STEPS
    }

    /// How much clutter is in every cell of the image and step of light, as measured last.
    pub(super) fn counts(&self) -> &[f64] {
        &self.counts
    }

    /// Logarithm of the density at each observation.
    pub(super) fn log_density(&self) -> &[f64] {
        &self.log_density
    }

    /// Measures the density, in an image of `size` (width, height) px, where `share` tells how likely an observation is clutter, after the frames
    /// that are remembered, if any. Without `with_light` the density is one of directions alone.
    pub(super) fn measure(
        &mut self,
        sightings: &[Sighting],
        groups: &Groups,
        size: [usize; 2],
        with_light: bool,
        memory: Option<&Memory>,
        share: impl Fn(usize) -> f64,
    ) {
        let cells = Cells::of(size);
        let in_cells = cells.columns * cells.rows;
        self.count(sightings, cells, &share);
        let frames = memory.map_or(0, Memory::frames) as f64;
        let remembered = |count: usize| memory.map_or(0.0, |memory| memory.clutter(count));
        let all: f64 = self.counts[..in_cells].iter().sum();
        let ever: f64 = (0..in_cells).map(remembered).sum();
        self.log_density.clear();
        self.log_density.resize(sightings.len(), 0.0);
        for group in 0..groups.len() {
            let members = groups.group(group);
            let own: f64 = members.iter().map(|&index| share(index)).sum();
            let each = own / members.len() as f64;
            for &index in members {
                let sighting = &sightings[index];
                let around = cells.around(cells.of_observation(sighting));
                let area_px = around.clone().count() as f64 * CELL_PX * CELL_PX;
                let near = Surroundings {
                    frame_px: (size[0] * size[1]) as f64,
                    frames: 1.0 + frames,
                    in_frame: (all - own).max(0.0) + ever,
                    area_px,
                    in_area: (around.clone().map(|cell| self.counts[cell]).sum::<f64>() - own).max(0.0)
                        + around.map(remembered).sum::<f64>(),
                };
                let log_per_px2 =
                    (0..members.len()).map(|before| near.log_per_px2(before as f64 * each)).sum::<f64>()
                        / members.len() as f64;
                let rad2_per_px = (sighting.rad_per_px * sighting.rad_per_px).max(1e-12);
                let light = sighting.log_light.filter(|_| with_light).map_or(0.0, |light| {
                    let step = light_step(light.value);
                    let count = |step: usize| self.counts[in_cells + step] + remembered(in_cells + step);
                    let own_there = members.iter().filter_map(|&other| {
                        let light = sightings[other].log_light?;
                        Some(share(other) * weight_of(step, light_step(light.value)))
                    });
                    let there = [step.saturating_sub(1), step, (step + 1).min(LIGHT_STEPS - 1)];
                    let there = 0.25 * count(there[0]) + 0.5 * count(there[1]) + 0.25 * count(there[2]);
                    let there = (there - own_there.sum::<f64>()).max(0.0) / LIGHT_STEP;
                    let points = (all - own).max(0.0) + ever;
                    libm::log((WORTH_POINTS / LIGHT_RANGE + there) / (WORTH_POINTS + points))
                });
                self.log_density[index] = log_per_px2 - libm::log(rad2_per_px) + light
                    - sighting.spot.marker_log_odds.min(0.0)
                    - sighting.signal.map_or(0.0, |_| BLINKS_BY_CHANCE);
            }
        }
    }

    fn count(&mut self, sightings: &[Sighting], cells: Cells, share: &impl Fn(usize) -> f64) {
        let in_cells = cells.columns * cells.rows;
        self.counts.clear();
        self.counts.resize(in_cells + LIGHT_STEPS, 0.0);
        for (index, sighting) in sightings.iter().enumerate() {
            let [column, row] = cells.of_observation(sighting);
            self.counts[row * cells.columns + column] += share(index);
            if let Some(light) = sighting.log_light {
                self.counts[in_cells + light_step(light.value)] += share(index);
            }
        }
    }
}

/// The step that a logarithm of light is in.
fn light_step(log_light: f64) -> usize {
    ((log_light / LIGHT_STEP).max(0.0) as usize).min(LIGHT_STEPS - 1)
}

/// What a point in one step of light counts in another.
fn weight_of(step: usize, other: usize) -> f64 {
    match step.abs_diff(other) {
        0 => 0.5,
        1 => 0.25,
        _ => 0.0,
    }
}

/// Clutter in some frames and around an observation, without what belongs to it.
struct Surroundings {
    frames: f64,
    frame_px: f64,
    in_frame: f64,
    area_px: f64,
    in_area: f64,
}

impl Surroundings {
    /// Logarithm of the density per px^2, with so many more points at the same place.
    fn log_per_px2(&self, more: f64) -> f64 {
        let mean = (BEFOREHAND * WORTH_FRAMES + self.in_frame + more)
            / (self.frame_px * (self.frames + WORTH_FRAMES));
        let here = mean * self.area_px * WORTH_SURROUNDINGS + self.in_area + more;
        libm::log(here / (self.area_px * (self.frames + WORTH_SURROUNDINGS)))
    }
}
