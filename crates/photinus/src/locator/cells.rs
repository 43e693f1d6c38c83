//! An image that is divided into cells, to count what is in them and to find what is near.

use alloc::vec::Vec;
use core::ops::Range;

use super::Sighting;
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Square cells over an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    side_px: f64,
    columns: usize,
    rows: usize,
}

impl Cells {
    /// Cells of this side over an image of `size` (width, height) px.
    pub(super) fn new([width, height]: [usize; 2], side_px: f64) -> Self {
        let count = |side: usize| (side as f64 / side_px).ceil().max(1.0) as usize;
        Self { side_px, columns: count(width), rows: count(height) }
    }

    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Area of one, px^2.
    pub(super) fn area_px2(&self) -> f64 {
        self.side_px * self.side_px
    }

    /// Column and row of the cell that an observation is in.
    pub(super) fn of_observation(&self, sighting: &Sighting) -> [usize; 2] {
        self.at(sighting.spot.centre)
    }

    /// Column and row of the cell that a place is in; of the nearest if it is outside the image.
    pub(super) fn at(&self, place: Pixel) -> [usize; 2] {
        let at = |px: f64, cells: usize| ((px / self.side_px).max(0.0) as usize).min(cells - 1);
        [at(place.u, self.columns), at(place.v, self.rows)]
    }

    pub(super) fn index(&self, [column, row]: [usize; 2]) -> usize {
        row * self.columns + column
    }

    /// A cell and those around it, row by row: the cells of each row.
    pub(super) fn around(
        self,
        [column, row]: [usize; 2],
    ) -> impl ExactSizeIterator<Item = Range<usize>> + Clone {
        let across = column.saturating_sub(1)..(column + 2).min(self.columns);
        let down = row.saturating_sub(1)..(row + 2).min(self.rows);
        down.map(move |row| row * self.columns + across.start..row * self.columns + across.end)
    }
}

/// The observations of a frame by cell.
#[derive(Debug, Default)]
pub(super) struct ByCell {
    /// Observations, those of a cell together.
    order: Vec<usize>,
    starts: Vec<usize>,
}

impl ByCell {
    /// Sorts the observations of a frame.
    pub(super) fn sort(&mut self, cells: &Cells, sightings: &[Sighting]) {
        let cell = |sighting: &Sighting| cells.index(cells.of_observation(sighting));
        self.starts.clear();
        self.starts.resize(cells.count() + 1, 0);
        for sighting in sightings {
            self.starts[cell(sighting)] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.order.clear();
        self.order.resize(sightings.len(), 0);
        // From the last to the first, so that those of a cell are in their order.
        for (index, sighting) in sightings.iter().enumerate().rev() {
            let start = &mut self.starts[cell(sighting)];
            *start -= 1;
            self.order[*start] = index;
        }
    }

    /// The others nearer to an observation than `reach_px`, at most the side of a cell, each with the gap, px.
    pub(super) fn near<'a>(
        &'a self,
        cells: &Cells,
        sightings: &'a [Sighting],
        observation: usize,
        reach_px: f64,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let here = sightings[observation].spot.centre;
        let around = cells.around(cells.of_observation(&sightings[observation]));
        // The observations of cells beside each other are beside each other.
        let within = around.flat_map(|cells| &self.order[self.starts[cells.start]..self.starts[cells.end]]);
        within.filter(move |&&other| other != observation).filter_map(move |&other| {
            let there = sightings[other].spot.centre;
            let (across, down) = (here.u - there.u, here.v - there.v);
            let gap_px = (across * across + down * down).sqrt();
            (gap_px < reach_px).then_some((other, gap_px))
        })
    }
}
