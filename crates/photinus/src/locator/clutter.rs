//! How dense clutter is: bright points that are no neighbour's markers.
//!
//! In: how likely each observation of the frame is clutter. Out: the density of clutter where each observation is, from the others: those of the frame
//! as a whole and those around it, for glints and hot pixels come in crowds. A density is per sr of direction and per unit of the logarithm of light.

use super::Sighting;

/// Clutter of a frame before it is seen: so many points, worth so many frames.
const BEFOREHAND: f64 = 0.2;
const WORTH_FRAMES: f64 = 0.3;
/// Side of the cells in which clutter is counted, px: an observation's surroundings are three by three of them.
const CELL_PX: f64 = 64.0;
/// The surroundings are as good as the whole frame's mean over so many times their area.
const WORTH_SURROUNDINGS: f64 = 1.0;
/// The light of clutter may be anything over so many units of its logarithm: a factor of 3,000.
const LIGHT_RANGE: f64 = 8.0;

/// The density of clutter at each observation.
#[derive(Debug, Default)]
pub(super) struct Clutter {
    log_density: Vec<f64>,
    cells: Vec<f64>,
}

impl Clutter {
    /// Logarithm of the density at each observation.
    pub(super) fn log_density(&self) -> &[f64] {
        &self.log_density
    }

    /// Measures the density, in an image of `width` by `height` px, where `share` tells how likely an observation is clutter. Without
    /// `with_light` the density is one of directions alone.
    pub(super) fn measure(
        &mut self,
        sightings: &[Sighting],
        [width, height]: [usize; 2],
        with_light: bool,
        share: impl Fn(usize) -> f64,
    ) {
        let [columns, rows] = [width, height].map(|side| (side as f64 / CELL_PX).ceil().max(1.0) as usize);
        let cell = |sighting: &Sighting| {
            let at = |px: f64, cells: usize| ((px / CELL_PX).max(0.0) as usize).min(cells - 1);
            [at(sighting.spot.centre.u, columns), at(sighting.spot.centre.v, rows)]
        };
        self.cells.clear();
        self.cells.resize(columns * rows, 0.0);
        let mut all = 0.0;
        for (index, sighting) in sightings.iter().enumerate() {
            let [column, row] = cell(sighting);
            self.cells[row * columns + column] += share(index);
            all += share(index);
        }
        let frame_px = (width * height) as f64;
        self.log_density.clear();
        for (index, sighting) in sightings.iter().enumerate() {
            let own = share(index);
            let [column, row] = cell(sighting);
            let (across, down) = (column.saturating_sub(1)..(column + 2).min(columns), row.saturating_sub(1)..(row + 2).min(rows));
            let area_px = (across.len() * down.len()) as f64 * CELL_PX * CELL_PX;
            let around: f64 = down.flat_map(|row| across.clone().map(move |column| row * columns + column)).map(|cell| self.cells[cell]).sum();
            let mean = (BEFOREHAND * WORTH_FRAMES + (all - own).max(0.0)) / (frame_px * (1.0 + WORTH_FRAMES));
            let here = (mean * area_px * WORTH_SURROUNDINGS + (around - own).max(0.0)) / (area_px * (1.0 + WORTH_SURROUNDINGS));
            let rad2_per_px = (sighting.rad_per_px * sighting.rad_per_px).max(1e-12);
            let light = if with_light && sighting.log_light.is_some() { libm::log(LIGHT_RANGE) } else { 0.0 };
            self.log_density.push(libm::log(here / rad2_per_px) - light);
        }
    }
}
