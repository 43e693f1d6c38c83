//! One component with several summits -> parts: two markers whose light overlaps are two spots.
//!
//! In: the runs of a component. Out: the runs of its parts, or nothing when it is one. A watershed from the brightest
//! pixel down: a pixel joins the basin of its brightest neighbour; where two basins meet, the lower one stays on its own
//! only if its summit stands out of the saddle by more than noise and a mosaic of pixels that answer differently to light can
//! explain. A saturated plateau has one summit: what lies inside it is not to be seen.

use alloc::vec::Vec;

use super::runs::Run;
use super::settings::Noise;
use super::summits::{self, LANES};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;

/// A summit must stand out of the saddle by this many sigma of its pixel noise...
const PROMINENCE_SIGMAS: f64 = 6.0;
/// ...and by this share of its height above the background, wherever the threshold lies: pixels that answer by 4 % more and less
/// in turn make dips of a twelfth, and noise adds to that...
const PROMINENCE_SHARE: f64 = 0.11;
/// ...or by this share of it where the other summit is so near that a single dark pixel lies between them: a pattern repeats
/// every two pixels, and two markers so near each other have one summit.
const NEAR_PROMINENCE_SHARE: f64 = 0.125;
/// Summits nearer than this are that near, px.
const NEAR_PX: i32 = 3;
/// Fewer pixels than this hold no two summits with a saddle between them and three pixels from one to the other.
const SMALLEST_PX: u32 = 4;
/// More pixels than this are no two markers: the sun, a lit surface.
const LARGEST_PX: usize = 1 << 14;

const NONE: u16 = u16::MAX;

/// The parts of one component, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Splitter {
    summits: Vec<u8>,
    basin_at: Vec<u16>,
    value_at: Vec<u8>,
    pixels: Vec<(u8, u32)>,
    basins: Vec<Basin>,
    parts: Vec<(u16, Run)>,
}

#[derive(Clone, Copy, Debug)]
struct Basin {
    summit: u8,
    /// Where in the grid its summit is.
    at: usize,
    parent: u16,
    part: u16,
}

/// What light stands on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    /// The level of the surroundings.
    pub(super) level: u8,
    pub(super) noise: Noise,
}

impl Ground {
    /// Whether a summit stands out of a saddle beside a higher one.
    fn stands_out(&self, summit: u8, saddle: u8, is_near: bool) -> bool {
        let value = f64::from(summit);
        let sigma = (self.noise.read_dn * self.noise.read_dn + self.noise.shot * value).sqrt();
        let share = if is_near { NEAR_PROMINENCE_SHARE } else { PROMINENCE_SHARE };
        let least = share * (value - f64::from(self.level));
        value - f64::from(saddle) > least.max(PROMINENCE_SIGMAS * sigma)
    }
}

impl Splitter {
    /// Splits a component; `None` when it is one part. The runs come ordered by part, each with its part's number.
    pub(super) fn split(
        &mut self,
        frame: &FrameView<'_>,
        runs: &[Run],
        ground: Ground,
    ) -> Option<&[(u16, Run)]> {
        if !self.may_have_parts(frame, runs, ground) {
            return None;
        }
        let grid = Grid::around(runs);
        if grid.len() > LARGEST_PX {
            return None;
        }
        self.order_pixels(frame, runs, &grid);
        self.flood(&grid, ground);
        self.collect(runs, &grid)
    }

    /// Whether some summit beside the highest stands out of the darkest pixel, the lowest saddle that could be.
    fn may_have_parts(&mut self, frame: &FrameView<'_>, runs: &[Run], ground: Ground) -> bool {
        if runs.iter().map(Run::len).sum::<u32>() < SMALLEST_PX {
            return false;
        }
        self.summits.clear();
        for run in runs {
            let row = frame.row(usize::from(run.v));
            for u in (usize::from(run.start)..usize::from(run.end)).step_by(LANES) {
                let mut bits =
                    summits::find(frame, u, usize::from(run.v)) & below_bit(usize::from(run.end) - u);
                while bits != 0 {
                    self.summits.push(row[u + bits.trailing_zeros() as usize]);
                    bits &= bits - 1;
                }
            }
        }
        if self.summits.len() < 2 {
            return false;
        }
        self.summits.sort_unstable();
        self.summits.pop();
        let darkest = runs.iter().flat_map(|run| run.pixels(frame)).copied().min().unwrap_or(0);
        self.summits.iter().any(|&summit| ground.stands_out(summit, darkest, false))
    }

    fn order_pixels(&mut self, frame: &FrameView<'_>, runs: &[Run], grid: &Grid) {
        self.pixels.clear();
        for run in runs {
            let start = grid.index(run.start, run.v) as u32;
            self.pixels.extend(run.pixels(frame).iter().zip(start..).map(|(&value, at)| (value, at)));
        }
        self.pixels.sort_unstable_by_key(|&(value, at)| (u8::MAX - value, at));
    }

    fn flood(&mut self, grid: &Grid, ground: Ground) {
        self.basin_at.clear();
        self.basin_at.resize(grid.len(), NONE);
        self.value_at.clear();
        self.value_at.resize(grid.len(), 0);
        self.basins.clear();
        for i in 0..self.pixels.len() {
            let (value, at) = self.pixels[i];
            let at = at as usize;
            // Neighbours are met in a fixed order; of equally bright ones the first takes the pixel.
            let (mut home, mut brightest, mut highest) = (NONE, 0, NONE);
            for offset in grid.neighbours() {
                let neighbour = at.wrapping_add_signed(offset);
                let near = self.basin_at[neighbour];
                if near == NONE {
                    continue;
                }
                if self.value_at[neighbour] > brightest {
                    (home, brightest) = (near, self.value_at[neighbour]);
                }
                let near = self.root(near);
                if highest == NONE {
                    highest = near;
                } else if near != highest {
                    highest = self.meet(highest, near, value, grid, ground);
                }
            }
            if home == NONE {
                home = self.basins.len() as u16;
                self.basins.push(Basin { summit: value, at, parent: home, part: NONE });
            }
            (self.basin_at[at], self.value_at[at]) = (home, value);
        }
    }

    /// Two basins meet at a saddle: the lower becomes part of the higher unless it stands out. Returns the higher.
    fn meet(&mut self, a: u16, b: u16, saddle: u8, grid: &Grid, ground: Ground) -> u16 {
        let [first, second] = [a, b].map(|basin| self.basins[usize::from(basin)]);
        let is_near = grid.distance_px2(first.at, second.at) < NEAR_PX * NEAR_PX;
        let (high, low, summit) =
            if second.summit > first.summit { (b, a, first.summit) } else { (a, b, second.summit) };
        if !ground.stands_out(summit, saddle, is_near) {
            self.basins[usize::from(low)].parent = high;
        }
        high
    }

    fn root(&self, mut basin: u16) -> u16 {
        while self.basins[usize::from(basin)].parent != basin {
            basin = self.basins[usize::from(basin)].parent;
        }
        basin
    }

    /// Numbers the basins that remain in raster order of their first pixel and cuts the runs along them.
    fn collect(&mut self, runs: &[Run], grid: &Grid) -> Option<&[(u16, Run)]> {
        if (0..self.basins.len()).filter(|&b| usize::from(self.basins[b].parent) == b).count() < 2 {
            return None;
        }
        self.parts.clear();
        let mut parts = 0;
        for run in runs {
            for u in run.start..run.end {
                let basin = usize::from(self.root(self.basin_at[grid.index(u, run.v)]));
                if self.basins[basin].part == NONE {
                    self.basins[basin].part = parts;
                    parts += 1;
                }
                let part = self.basins[basin].part;
                match self.parts.last_mut() {
                    Some((last_part, last)) if *last_part == part && last.v == run.v && last.end == u => {
                        last.end += 1;
                    }
                    _ => self.parts.push((part, Run { v: run.v, start: u, end: u + 1 })),
                }
            }
        }
        self.parts.sort_unstable_by_key(|&(part, run)| (part, run.v, run.start));
        Some(&self.parts)
    }
}

/// All bits below one.
fn below_bit(bit: usize) -> u32 {
    if bit < 32 { (1 << bit) - 1 } else { u32::MAX }
}

/// The pixels around a component, with a border of one so that every neighbour has an index.
struct Grid {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Grid {
    fn around(runs: &[Run]) -> Self {
        let left = runs.iter().map(|run| run.start).min().unwrap_or(0);
        let right = runs.iter().map(|run| run.end).max().unwrap_or(0);
        let top = runs.first().map_or(0, |run| run.v);
        let bottom = runs.last().map_or(0, |run| run.v);
        Self {
            left: usize::from(left),
            top: usize::from(top),
            width: usize::from(right - left) + 2,
            height: usize::from(bottom - top) + 3,
        }
    }

    fn len(&self) -> usize {
        self.width * self.height
    }

    fn index(&self, u: u16, v: u16) -> usize {
        (usize::from(v) - self.top + 1) * self.width + usize::from(u) - self.left + 1
    }

    /// The squared distance between two indices, px^2.
    fn distance_px2(&self, a: usize, b: usize) -> i32 {
        let du = (a % self.width) as i32 - (b % self.width) as i32;
        let dv = (a / self.width) as i32 - (b / self.width) as i32;
        du * du + dv * dv
    }

    fn neighbours(&self) -> [isize; 8] {
        let row = self.width as isize;
        [-row, -1, 1, row, -row - 1, 1 - row, row - 1, row + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DARK: Ground = Ground { level: 0, noise: Noise { read_dn: 0.45, shot: 0.03 } };

    fn runs_of(rows: &[&[u8]]) -> (Vec<u8>, Vec<Run>) {
        let pixels = rows.concat();
        let runs = rows.iter().enumerate().filter(|(_, row)| row.iter().any(|&p| p > 0)).map(|(v, row)| {
            let start = row.iter().position(|&p| p > 0).unwrap() as u16;
            let end = row.iter().rposition(|&p| p > 0).unwrap() as u16 + 1;
            Run { v: v as u16, start, end }
        });
        let runs = runs.collect();
        (pixels, runs)
    }

    fn parts(rows: &[&[u8]]) -> usize {
        let (pixels, runs) = runs_of(rows);
        let frame = FrameView::packed(&pixels, rows[0].len(), rows.len()).unwrap();
        let mut splitter = Splitter::default();
        splitter.split(&frame, &runs, DARK).map_or(1, |parts| usize::from(parts.last().unwrap().0) + 1)
    }

    #[test]
    fn two_markers_three_pixels_apart_are_two() {
        assert_eq!(parts(&[&[200, 90, 90, 200]]), 2);
        assert_eq!(
            parts(&[&[40, 90, 60, 60, 90, 40], &[90, 250, 120, 120, 250, 90], &[40, 90, 60, 60, 90, 40],]),
            2
        );
    }

    #[test]
    fn noise_and_a_dented_plateau_do_not_split() {
        assert_eq!(parts(&[&[100, 98, 97, 100]]), 1);
        assert_eq!(parts(&[&[255, 40, 255], &[255, 255, 255]]), 1);
        assert_eq!(parts(&[&[255, 255, 255, 255, 255]]), 1);
    }

    #[test]
    fn a_flat_plateau_is_one_part_without_any_noise() {
        let pixels = [255, 0, 255, 255, 255, 255];
        let frame = FrameView::packed(&pixels, 3, 2).unwrap();
        let runs = [(0, 0, 1), (0, 2, 3), (1, 0, 3)].map(|(v, start, end)| Run { v, start, end });
        let silent = Ground { noise: Noise { read_dn: 0.0, shot: 0.0 }, level: 0 };
        assert!(Splitter::default().split(&frame, &runs, silent).is_none());
    }

    #[test]
    fn the_fainter_of_two_keeps_its_own_side() {
        let (pixels, runs) =
            runs_of(&[&[40, 90, 60, 40, 60, 40], &[90, 250, 110, 60, 140, 60], &[40, 90, 60, 40, 60, 40]]);
        let frame = FrameView::packed(&pixels, 6, 3).unwrap();
        let mut splitter = Splitter::default();
        let parts = splitter.split(&frame, &runs, DARK).unwrap();
        let areas = [0, 1]
            .map(|part| parts.iter().filter(|(p, _)| *p == part).map(|(_, run)| run.len()).sum::<u32>());
        assert!(areas[1] >= 8, "{areas:?}");
    }

    #[test]
    fn every_pixel_belongs_to_one_part() {
        let (pixels, runs) = runs_of(&[&[30, 200, 60, 60, 180, 40], &[20, 60, 30, 30, 90, 40]]);
        let frame = FrameView::packed(&pixels, 6, 2).unwrap();
        let mut splitter = Splitter::default();
        let parts = splitter.split(&frame, &runs, DARK).unwrap();
        assert_eq!(parts.iter().map(|(_, run)| run.len()).sum::<u32>(), 12);
        assert!(parts.is_sorted_by_key(|(part, run)| (*part, run.v, run.start)));
    }

    proptest! {
        #[test]
        fn what_has_parts_is_never_passed_over(
            width in 4usize..20, height in 3usize..12, level in 0u8..60, levels in 2u8..9,
            pixels in prop::collection::vec(any::<u8>(), 20 * 12), shot in 0.0..2.0,
        ) {
            let pixels: Vec<u8> = pixels[..width * height].iter().map(|p| 60 + p % levels * (190 / levels)).collect();
            let frame = FrameView::packed(&pixels, width, height).unwrap();
            let runs: Vec<Run> = (0..height as u16).map(|v| Run { v, start: 0, end: width as u16 }).collect();
            let ground = Ground { level, noise: Noise { read_dn: 0.3, shot } };
            let mut splitter = Splitter::default();
            let grid = Grid::around(&runs);
            splitter.order_pixels(&frame, &runs, &grid);
            splitter.flood(&grid, ground);
            let parts = splitter.collect(&runs, &grid).map(<[_]>::to_vec);
            prop_assert_eq!(splitter.split(&frame, &runs, ground).map(<[_]>::to_vec), parts);
        }
    }
}
