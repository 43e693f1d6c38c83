//! How far the light around a part is its own: up to the edge of the nearest other part.
//!
//! In: the centres and radii of all parts. Out: the room around each. Small parts are looked up in the cells of a grid, so
//! that a frame of ten thousands of specks takes no longer per speck; the few large ones are gone through.

use alloc::vec::Vec;

use super::tiles::TILE_PX;
use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;

/// Radius above which a part is one of the few large ones, px.
const LARGE_PX: f64 = 8.0;

/// The parts of one frame by where they lie, and the room to sort them in.
#[derive(Debug, Default)]
pub(super) struct Neighbourhood {
    columns: usize,
    rows: usize,
    parts: Vec<(Pixel, f64)>,
    starts: Vec<u32>,
    by_cell: Vec<u32>,
    large: Vec<u32>,
    widest_px: f64,
}

impl Neighbourhood {
    /// Takes in parts, each a centre within `frame` and a radius in px.
    pub(super) fn arrange(&mut self, frame: &FrameView<'_>, parts: impl Iterator<Item = (Pixel, f64)>) {
        (self.columns, self.rows) = (frame.width().div_ceil(TILE_PX), frame.height().div_ceil(TILE_PX));
        let (columns, rows) = (self.columns, self.rows);
        let cell = |place: Pixel| cell_of(place.v, rows) * columns + cell_of(place.u, columns);
        self.parts.clear();
        self.parts.extend(parts);
        if self.parts.is_empty() {
            return;
        }
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        self.large.clear();
        self.widest_px = 0.0;
        for (i, &(centre, radius_px)) in self.parts.iter().enumerate() {
            if radius_px > LARGE_PX {
                self.large.push(i as u32);
            } else {
                self.widest_px = self.widest_px.max(radius_px);
                self.starts[cell(centre)] += 1;
            }
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.by_cell.clear();
        self.by_cell.resize(end as usize, 0);
        for (i, &(centre, radius_px)) in self.parts.iter().enumerate() {
            if radius_px <= LARGE_PX {
                let start = &mut self.starts[cell(centre)];
                *start -= 1;
                self.by_cell[*start as usize] = i as u32;
            }
        }
    }

    /// The room around part `i`, at most `most_px`; negative inside another part.
    pub(super) fn room_px(&self, i: usize, most_px: f64) -> f64 {
        let mut room_px = most_px;
        self.each_near(i, most_px, |_, edge_px| room_px = room_px.min(edge_px));
        room_px
    }

    /// Tells of each part whose edge may be nearer to part `i` than `most_px`, with how far its edge is, px.
    pub(super) fn each_near(&self, i: usize, most_px: f64, mut with: impl FnMut(usize, f64)) {
        let (centre, _) = self.parts[i];
        let mut look = |other: &u32| {
            let other = *other as usize;
            let (place, radius_px) = self.parts[other];
            let (du, dv) = (place.u - centre.u, place.v - centre.v);
            if other != i {
                with(other, (du * du + dv * dv).sqrt() - radius_px - 0.5);
            }
        };
        let reach = most_px + self.widest_px + 0.5;
        let columns = cell_of(centre.u - reach, self.columns)..=cell_of(centre.u + reach, self.columns);
        self.large.iter().for_each(&mut look);
        for row in cell_of(centre.v - reach, self.rows)..=cell_of(centre.v + reach, self.rows) {
            let first = self.starts[row * self.columns + columns.start()] as usize;
            let end = self.starts[row * self.columns + columns.end() + 1] as usize;
            self.by_cell[first..end].iter().for_each(&mut look);
        }
    }
}

/// The row or column of cells that a coordinate lies in, the first or last outside the frame.
fn cell_of(place_px: f64, cells: usize) -> usize {
    ((place_px + 0.5).max(0.0) as usize / TILE_PX).min(cells - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_room_is_that_to_the_nearest_of_all(
            places in prop::collection::vec((0.0..199.0, 0.0..149.0, 0.5f64..14.0), 1..60), most_px in 1.0..40.0,
        ) {
            let parts: Vec<(Pixel, f64)> = places.iter().map(|&(u, v, radius)| (Pixel::new(u, v), radius)).collect();
            let pixels = vec![0; 200 * 150];
            let mut neighbourhood = Neighbourhood::default();
            neighbourhood.arrange(&FrameView::packed(&pixels, 200, 150).unwrap(), parts.iter().copied());
            for (i, (centre, _)) in parts.iter().enumerate() {
                let others = parts.iter().enumerate().filter(|&(j, _)| j != i);
                let edges = others.map(|(_, (place, radius))| {
                    let (du, dv) = (place.u - centre.u, place.v - centre.v);
                    (du * du + dv * dv).sqrt() - radius - 0.5
                });
                let expected = edges.fold(most_px, f64::min);
                prop_assert_eq!(neighbourhood.room_px(i, most_px).to_bits(), expected.to_bits());
            }
        }
    }
}
