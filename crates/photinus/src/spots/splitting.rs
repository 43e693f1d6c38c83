//! One component with several summits -> parts: two markers whose light overlaps are two spots.
//!
//! In: the runs of a component. Out: the runs of its parts, or nothing when it is one. A watershed from the brightest
//! pixel down: a pixel joins the basin of its brightest neighbour; where two basins meet, the lower one stays on its own
//! only if its summit stands out of the saddle by more than noise and a share of its height can explain. A saturated
//! plateau has one summit: what lies inside it is not to be seen.

use super::runs::Run;
use super::settings::Noise;
use crate::frame::FrameView;

/// A summit must stand out of the saddle by this many sigma of its pixel noise...
const PROMINENCE_SIGMAS: f64 = 6.0;
/// ...and by this share of its height above the component's darkest pixel.
const PROMINENCE_SHARE: f64 = 0.125;
/// Fewer pixels than this hold no two summits with a saddle between them and three pixels from one to the other.
const SMALLEST_PX: u32 = 4;
/// More pixels than this are no two markers: the sun, a lit surface.
const LARGEST_PX: usize = 1 << 14;

const NONE: u16 = u16::MAX;

/// The parts of one component, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Splitter {
    basin_at: Vec<u16>,
    value_at: Vec<u8>,
    pixels: Vec<(u8, u32)>,
    basins: Vec<Basin>,
    parts: Vec<(u16, Run)>,
}

#[derive(Clone, Copy, Debug)]
struct Basin {
    summit: u8,
    parent: u16,
    part: u16,
}

impl Splitter {
    /// Splits a component; `None` when it is one part. The runs come ordered by part, each with its part's number.
    pub(super) fn split(
        &mut self,
        frame: &FrameView<'_>,
        runs: &[Run],
        noise: Noise,
    ) -> Option<&[(u16, Run)]> {
        if !has_several_summits(frame, runs) {
            return None;
        }
        let grid = Grid::around(runs);
        if grid.len() > LARGEST_PX {
            return None;
        }
        self.order_pixels(frame, runs, &grid);
        self.flood(&grid, noise);
        self.collect(runs, &grid)
    }

    fn order_pixels(&mut self, frame: &FrameView<'_>, runs: &[Run], grid: &Grid) {
        self.pixels.clear();
        for run in runs {
            let start = grid.index(run.start, run.v) as u32;
            self.pixels.extend(run.pixels(frame).iter().zip(start..).map(|(&value, at)| (value, at)));
        }
        self.pixels.sort_unstable_by_key(|&(value, at)| (u8::MAX - value, at));
    }

    fn flood(&mut self, grid: &Grid, noise: Noise) {
        self.basin_at.clear();
        self.basin_at.resize(grid.len(), NONE);
        self.value_at.clear();
        self.value_at.resize(grid.len(), 0);
        self.basins.clear();
        let darkest = self.pixels.last().map_or(0, |&(value, _)| value);
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
                    highest = self.meet(highest, near, value, darkest, noise);
                }
            }
            if home == NONE {
                home = self.basins.len() as u16;
                self.basins.push(Basin { summit: value, parent: home, part: NONE });
            }
            (self.basin_at[at], self.value_at[at]) = (home, value);
        }
    }

    /// Two basins meet at a saddle: the lower becomes part of the higher unless it stands out. Returns the higher.
    fn meet(&mut self, a: u16, b: u16, saddle: u8, darkest: u8, noise: Noise) -> u16 {
        let (high, low) = if self.basins[usize::from(b)].summit > self.basins[usize::from(a)].summit {
            (b, a)
        } else {
            (a, b)
        };
        let summit = f64::from(self.basins[usize::from(low)].summit);
        let sigma = (noise.read_dn * noise.read_dn + noise.shot * summit).sqrt();
        let share = PROMINENCE_SHARE * (summit - f64::from(darkest));
        if summit - f64::from(saddle) <= share.max(PROMINENCE_SIGMAS * sigma) {
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

/// Whether more than one pixel is as high as its neighbours and higher than those before it in raster order: a single
/// summit, also a plateau without dents, has one such pixel.
fn has_several_summits(frame: &FrameView<'_>, runs: &[Run]) -> bool {
    if runs.iter().map(Run::len).sum::<u32>() < SMALLEST_PX {
        return false;
    }
    let mut summits = 0;
    for run in runs {
        let v = usize::from(run.v);
        let above = v.checked_sub(1).map(|v| frame.row(v));
        let here = frame.row(v);
        let below = (v + 1 < frame.height()).then(|| frame.row(v + 1));
        for u in usize::from(run.start)..usize::from(run.end) {
            let value = here[u];
            let (first, last) = (u.saturating_sub(1), (u + 1).min(here.len() - 1));
            let highest =
                |row: Option<&[u8]>| row.map_or(0, |row| row[first..=last].iter().fold(0, |h, &p| p.max(h)));
            let left = if u > 0 { here[u - 1] } else { 0 };
            if value > left && value >= here[last] && value >= highest(below) && value > highest(above) {
                summits += 1;
                if summits > 1 {
                    return true;
                }
            }
        }
    }
    false
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

    fn neighbours(&self) -> [isize; 8] {
        let row = self.width as isize;
        [-row, -1, 1, row, -row - 1, 1 - row, row - 1, row + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        splitter
            .split(&frame, &runs, Noise::default())
            .map_or(1, |parts| usize::from(parts.last().unwrap().0) + 1)
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
        let silent = Noise { read_dn: 0.0, shot: 0.0 };
        assert!(Splitter::default().split(&frame, &runs, silent).is_none());
    }

    #[test]
    fn the_fainter_of_two_keeps_its_own_side() {
        let (pixels, runs) =
            runs_of(&[&[40, 90, 60, 40, 60, 40], &[90, 250, 110, 60, 140, 60], &[40, 90, 60, 40, 60, 40]]);
        let frame = FrameView::packed(&pixels, 6, 3).unwrap();
        let mut splitter = Splitter::default();
        let parts = splitter.split(&frame, &runs, Noise::default()).unwrap();
        let areas = [0, 1]
            .map(|part| parts.iter().filter(|(p, _)| *p == part).map(|(_, run)| run.len()).sum::<u32>());
        assert!(areas[1] >= 8, "{areas:?}");
    }

    #[test]
    fn every_pixel_belongs_to_one_part() {
        let (pixels, runs) = runs_of(&[&[30, 200, 60, 60, 180, 40], &[20, 60, 30, 30, 90, 40]]);
        let frame = FrameView::packed(&pixels, 6, 2).unwrap();
        let mut splitter = Splitter::default();
        let parts = splitter.split(&frame, &runs, Noise::default()).unwrap();
        assert_eq!(parts.iter().map(|(_, run)| run.len()).sum::<u32>(), 12);
        assert!(parts.is_sorted_by_key(|(part, run)| (*part, run.v, run.start)));
    }
}
