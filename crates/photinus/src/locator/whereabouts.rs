//! Where neighbours are: how much likelier one is at a place and at a distance than anywhere.
//!
//! In: neighbours of the frames before, each by how likely it is. Out: the density of neighbours at an observation, and at a distance, over what it is on average. Clutter is
//! known by place and light; were neighbours taken to be anywhere, what is where they are would be taken for clutter that is there. Frames show the
//! same vehicles again: all of them tell no more than one does.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use super::cells::Cells;
use super::posing::LOG_RANGE;

/// That they are anywhere is as sure as what so many of them would tell.
const SUPPOSED: f64 = 6.0;
/// The logarithm of their distance is counted in steps, from this distance on.
const STEPS: usize = 10;
const NEAREST_M: f64 = 0.3;
/// Neighbours that are less likely than this are not counted.
const LEAST_LIKELY: f64 = 1e-3;

/// Neighbours by cell of the image, then by step of distance.
#[derive(Debug)]
pub(super) struct Whereabouts {
    cells: Cells,
    list: Vec<f64>,
}

impl Whereabouts {
    /// Of nobody, in an image of these cells.
    pub(super) fn new(cells: Cells) -> Self {
        Self { cells, list: vec![0.0; cells.count() + STEPS] }
    }

    /// How many are in every cell and step of distance.
    pub(super) fn counts(&self) -> &[f64] {
        &self.list
    }

    /// Counts nobody.
    pub(super) fn clear(&mut self) {
        self.list.fill(0.0);
    }

    /// Counts a neighbour in a cell by how likely it is.
    pub(super) fn add(&mut self, cell: [usize; 2], distance_m: f64, probability: f64) {
        if probability > LEAST_LIKELY {
            self.list[self.cells.index(cell)] += probability;
            self.list[self.cells.count() + step(distance_m)] += probability;
        }
    }

    /// The logarithm of how much likelier a neighbour is in a cell, where pixels see so much solid angle, and at a distance than anywhere, if frames had so
    /// many each by cell and step: than even over half a sphere and over the logarithm of distance.
    pub(super) fn log_likelier(
        &self,
        per_frame: &PerFrame<'_>,
        (cell, rad2_per_px2): ([usize; 2], f64),
        distance_m: f64,
    ) -> f64 {
        let (mut count, mut around) = (0, 0.0);
        for row in self.cells.around(cell) {
            count += row.len();
            around += per_frame.sum(row);
        }
        let share = count as f64 * self.cells.area_px2() * rad2_per_px2 / TAU;
        let step = step(distance_m);
        let at = |step: usize| per_frame.sum(self.cells.count() + step..self.cells.count() + step + 1);
        let there = 0.25 * at(step.saturating_sub(1)) + 0.5 * at(step) + 0.25 * at((step + 1).min(STEPS - 1));
        let all = per_frame.sum(self.cells.count()..self.list.len());
        libm::log((SUPPOSED + around / share) / (SUPPOSED + all))
            + libm::log((SUPPOSED + there * STEPS as f64) / (SUPPOSED + all))
    }
}

/// Neighbours of the last frames by cell and step, per frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PerFrame<'a> {
    pub(super) sums: &'a [f64],
    pub(super) frames: usize,
}

impl PerFrame<'_> {
    fn sum(&self, of: core::ops::Range<usize>) -> f64 {
        self.sums[of].iter().sum::<f64>() / self.frames.max(1) as f64
    }
}

/// The step that a distance is in.
fn step(distance_m: f64) -> usize {
    let steps = libm::log(distance_m / NEAREST_M) / LOG_RANGE * STEPS as f64;
    (steps.max(0.0) as usize).min(STEPS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten by five of them.
    fn cells() -> Cells {
        Cells::new([640, 320], 64.0)
    }

    /// What a neighbour in a cell and at a distance is after frames with one in each of these.
    fn likelier(there: &[([usize; 2], f64)], frames: usize, (cell, distance_m): ([usize; 2], f64)) -> f64 {
        let mut whereabouts = Whereabouts::new(cells());
        let mut sums = vec![0.0; whereabouts.counts().len()];
        for _ in 0..frames {
            whereabouts.clear();
            there.iter().for_each(|&(cell, distance_m)| whereabouts.add(cell, distance_m, 1.0));
            sums.iter_mut().zip(whereabouts.counts()).for_each(|(sum, count)| *sum += count);
        }
        // The image sees half a sphere.
        let rad2_per_px2 = TAU / (640.0 * 320.0);
        whereabouts.log_likelier(&PerFrame { sums: &sums, frames }, (cell, rad2_per_px2), distance_m)
    }

    #[test]
    fn neighbours_are_likelier_where_they_were_and_the_surer_the_more_there_were() {
        let crowd: Vec<_> = (0..20).map(|k| ([k / 2, 2], 8.0)).collect();
        let asked = ([4, 2], 7.0);
        assert!(likelier(&crowd, 0, asked).abs() < 1e-12, "nothing is known");
        let [few, many] = [1, 20].map(|count| likelier(&crowd[20 - count..], 64, ([9, 2], 7.0)));
        assert!(0.0 < few && few < many && many < 4.0, "{few} {many}");
        let again = likelier(&crowd, 64, asked) - likelier(&crowd, 1, asked);
        assert!(again.abs() < 1e-12, "the same ones again: {again}");
        for elsewhere in [([4, 0], 8.0), ([4, 2], 0.5)] {
            let log = likelier(&crowd, 64, elsewhere);
            let least = likelier(&crowd, 64, asked) - libm::log((SUPPOSED + 60.0) / SUPPOSED);
            assert!(log < likelier(&crowd, 64, asked) - 1.0 && log > least - 2.0, "{elsewhere:?}: {log}");
        }
    }

    /// As many neighbours are believed in as there are, wherever they were: over an even image the density is what it was on average.
    #[test]
    fn neighbours_are_no_more_than_there_are() {
        let crowd: Vec<_> = (0..12).map(|k| ([3 + k % 4, 2], 2.0 + f64::from(k as u8))).collect();
        let over = |cells: core::ops::Range<usize>| {
            let each = cells.map(|k| libm::exp(likelier(&crowd, 9, ([k % 10, k / 10], 6.0))));
            each.sum::<f64>() / 50.0
        };
        let by_distance =
            |m: f64| libm::exp(likelier(&crowd, 9, ([4, 2], m)) - likelier(&crowd, 9, ([4, 2], 6.0)));
        let steps =
            (0..STEPS).map(|step| NEAREST_M * libm::exp((step as f64 + 0.5) / STEPS as f64 * LOG_RANGE));
        let mean = steps.map(by_distance).sum::<f64>() / STEPS as f64;
        assert!((over(0..50) * mean - 1.0).abs() < 0.15, "{} {mean}", over(0..50));
    }
}
