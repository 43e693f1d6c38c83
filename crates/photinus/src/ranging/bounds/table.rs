//! What an airframe can show, over boxes of elevation and distance: filled once, by branch and bound.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector3;

use super::subsets::{PairValues, least_diameters};
use super::view::{Pair, Range, ViewBox, Views};
use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Elevations of the camera in the body frame, from straight below to straight above.
pub(super) const ROWS: usize = 24;
/// Distances, from the near limit to infinity.
const COLUMNS: usize = 20;
/// More spots than this are bounded as this many: the widest angle only grows with their number.
const MAX_SPOTS: usize = 64;

/// Boxes first looked at, side by side in yaw.
const FIRST_YAWS: usize = 4;
/// A box is split while it may hold more than this share beyond what is already seen ...
const GAIN: f64 = 0.015;
/// ... and more than this share of the airframe's reach ...
const GAIN_OF_REACH: f64 = 0.0075;
/// ... until the pairs looked at in one row and column reach this number.
const PAIR_BUDGET: usize = 4_000;

/// Bounds of distance times angle, m, over a box of camera places; `lo` above `hi` where that many markers
/// never show.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extents {
    /// Of the widest angle among the spots.
    pub(super) widest: Range,
    /// Of the narrowest angle among the spots.
    pub(super) narrowest: Range,
}

impl Extents {
    const NONE: Self = {
        let none = Range { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
        Self { widest: none, narrowest: none }
    };

    fn include(&mut self, other: &Self) {
        let hull = |a: Range, b: Range| Range { lo: a.lo.min(b.lo), hi: a.hi.max(b.hi) };
        self.widest = hull(self.widest, other.widest);
        self.narrowest = hull(self.narrowest, other.narrowest);
    }

    /// Whether this reaches beyond `seen` by enough to look closer.
    fn gains_on(&self, seen: &Self, least_gain_m: f64) -> bool {
        let gains = |range: Range, seen: Range| {
            range.hi * (1.0 - GAIN) - least_gain_m > seen.hi
                || range.lo * (1.0 + GAIN) + least_gain_m < seen.lo
        };
        gains(self.widest, seen.widest) || gains(self.narrowest, seen.narrowest)
    }

    /// Outwards by `extra_m` and by the rounding of the arithmetic that led here.
    fn widened(&self, extra_m: f64) -> Self {
        let widen = |range: Range| Range {
            lo: (range.lo * (1.0 - 1e-9) - extra_m).max(0.0),
            hi: range.hi * (1.0 + 1e-9) + extra_m,
        };
        Self { widest: widen(self.widest), narrowest: widen(self.narrowest) }
    }
}

/// A range of distances of the table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    pub(super) min_m: f64,
    pub(super) max_m: f64,
    /// Largest angle at the camera between the airframe's origin and any of its spots, rad.
    pub(super) off_origin_rad: f64,
}

impl Column {
    /// All distances.
    pub(super) const ANY: Self = Self { min_m: 0.0, max_m: f64::INFINITY, off_origin_rad: PI };
}

/// The extents by number of spots, distance and elevation.
#[derive(Clone, Debug)]
pub(super) struct Table {
    columns: Vec<Column>,
    /// By number of spots from 2, then column, then row.
    extents: Vec<Extents>,
    /// The hull over the rows: by number of spots from 2, then column.
    any_row: Vec<Extents>,
    /// The hull over these: by number of spots from 2.
    anywhere: Vec<Extents>,
}

impl Table {
    pub(super) fn of(airframe: &Airframe) -> Self {
        let near_m = 1.02 * airframe.max_radius_m() + 0.05;
        let reach_m = airframe.markers().iter().map(|m| m.position_m.norm() + m.spread_m).fold(0.0, f64::max);
        let spread_m = airframe.markers().iter().map(|m| m.spread_m).fold(0.0, f64::max);
        // Finer towards infinity in inverse distance, where relative extents change by reach / distance.
        let inverse_m = |edge: usize| (edge as f64 / COLUMNS as f64).powi(2) / near_m;
        let sizes = airframe.markers().len().min(MAX_SPOTS) - 1;
        let mut search = Search::new(airframe, sizes);
        let sector_rad = Range { lo: 0.0, hi: TAU / airframe.turns() as f64 };
        let mirrored = airframe.is_mirrored();
        let mut columns = Vec::with_capacity(COLUMNS);
        let mut extents = vec![Extents::NONE; sizes * COLUMNS * ROWS];
        let mut any_row = vec![Extents::NONE; sizes * COLUMNS];
        let mut anywhere = vec![Extents::NONE; sizes];
        for index in 0..COLUMNS {
            let inverse_m = Range { lo: inverse_m(index), hi: inverse_m(index + 1) };
            let min_m = 1.0 / inverse_m.hi;
            let column =
                Column { min_m, max_m: 1.0 / inverse_m.lo, off_origin_rad: angle_within(reach_m, min_m) };
            // A spot's centre is up to the spread off its marker's mean position.
            let extra_m = 2.0 * min_m * angle_within(spread_m, min_m - airframe.max_radius_m());
            columns.push(column);
            for row in 0..if mirrored { ROWS / 2 } else { ROWS } {
                let elevation_rad = row_elevations_rad(row);
                let found = search.run(ViewBox { yaw_rad: sector_rad, elevation_rad, inverse_m });
                for (size, found) in found.iter().enumerate() {
                    let widened = found.widened(extra_m);
                    let rows = &mut extents[(size * COLUMNS + index) * ROWS..][..ROWS];
                    rows[row] = widened;
                    if mirrored {
                        rows[ROWS - 1 - row] = widened;
                    }
                    any_row[size * COLUMNS + index].include(&widened);
                    anywhere[size].include(&widened);
                }
            }
        }
        Self { columns, extents, any_row, anywhere }
    }

    pub(super) fn near_m(&self) -> f64 {
        self.columns[COLUMNS - 1].min_m
    }

    /// For this many spots, 2 or more: the extents at any place of the camera.
    pub(super) fn anywhere(&self, spots: usize) -> &Extents {
        &self.anywhere[self.size(spots)]
    }

    /// For this many spots, 2 or more: each column with any of these distances, the farthest first, with its extents in any row and by row.
    pub(super) fn of_spots(
        &self,
        spots: usize,
        distances_m: &Range,
    ) -> impl DoubleEndedIterator<Item = (&Column, &Extents, &[Extents])> {
        let first = self.columns.partition_point(|column| column.min_m > distances_m.hi);
        let end = self.columns.partition_point(|column| column.max_m >= distances_m.lo).max(first);
        let columns = self.size(spots) * COLUMNS + first..self.size(spots) * COLUMNS + end;
        let by_row = self.extents[columns.start * ROWS..columns.end * ROWS].chunks_exact(ROWS);
        let each = self.columns[first..end].iter().zip(&self.any_row[columns]).zip(by_row);
        each.map(|((column, any_row), by_row)| (column, any_row, by_row))
    }

    /// The place of this number of spots.
    fn size(&self, spots: usize) -> usize {
        spots.min(self.anywhere.len() + 1) - 2
    }
}

fn row_elevations_rad(row: usize) -> Range {
    let edge_rad = |edge: usize| PI * (edge as f64 / ROWS as f64) - FRAC_PI_2;
    Range { lo: edge_rad(row), hi: edge_rad(row + 1) }
}

/// Largest angle between two points up to `apart_m` apart, one of them at least `distance_m` away, rad.
fn angle_within(apart_m: f64, distance_m: f64) -> f64 {
    if apart_m < distance_m { libm::asin(apart_m / distance_m) } else { PI }
}

/// Branch and bound over the camera places of one row and column, for every number of spots at once.
struct Search<'a> {
    airframe: &'a Airframe,
    /// The pairs of markers i > j, at i (i - 1) / 2 + j.
    pairs: Vec<Pair>,
    sizes: usize,
    visible: Vec<usize>,
    far_values: PairValues,
    near_values: PairValues,
    least: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(airframe: &'a Airframe, sizes: usize) -> Self {
        let places: Vec<Vector3<f64>> = airframe.markers().iter().map(|marker| marker.position_m).collect();
        let pair = |i: usize, j: usize| Pair::new(&places[i], &places[j]);
        let count = places.len();
        Self {
            airframe,
            pairs: (1..count).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| pair(i, j)).collect(),
            sizes,
            visible: Vec::with_capacity(count),
            far_values: PairValues::new(count),
            near_values: PairValues::new(count),
            least: vec![0.0; sizes],
        }
    }

    /// Bounds over the whole of `place`, by number of spots from 2.
    fn run(&mut self, place: ViewBox) -> Vec<Extents> {
        if self.sizes == 0 {
            return Vec::new(); // one marker shows no angle
        }
        let reach_m = self.airframe.max_radius_m();
        let mut found = vec![Extents::NONE; self.sizes];
        let mut seen = vec![Extents::NONE; self.sizes];
        let mut open = vec![place];
        while open.len() < FIRST_YAWS {
            open = open.iter().flat_map(|place| place.split_yaw()).collect();
        }
        let mut budget = PAIR_BUDGET;
        let mut bounds = Vec::new();
        while !open.is_empty() {
            bounds.clear();
            bounds.resize(open.len() * self.sizes, Extents::NONE);
            for (place, bounds) in open.iter().zip(bounds.chunks_exact_mut(self.sizes)) {
                let shown = self.extents(&place.cover(), bounds);
                budget = budget.saturating_sub(shown * shown / 2);
                let mut middle = vec![Extents::NONE; self.sizes];
                self.extents(&place.middle(), &mut middle);
                seen.iter_mut().zip(&middle).for_each(|(seen, middle)| seen.include(middle));
            }
            let mut next = Vec::new();
            for (place, bounds) in open.iter().zip(bounds.chunks_exact(self.sizes)) {
                let gains =
                    |(bounds, seen): (&Extents, &Extents)| bounds.gains_on(seen, GAIN_OF_REACH * reach_m);
                if budget > 0 && place.is_coarse(reach_m) && bounds.iter().zip(&seen).any(gains) {
                    next.extend(place.split(reach_m));
                } else {
                    found.iter_mut().zip(bounds).for_each(|(found, bounds)| found.include(bounds));
                }
            }
            open = next;
        }
        found
    }

    /// Bounds over `views` into `bounds`, by number of spots from 2; returns how many markers may show.
    fn extents(&mut self, views: &Views, bounds: &mut [Extents]) -> usize {
        self.visible.clear();
        self.visible.extend((0..self.airframe.markers().len()).filter(|&m| views.can_see(self.airframe, m)));
        let shown = self.visible.len();
        if shown < 2 {
            return shown;
        }
        let mut all = Range { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
        for a in 1..shown {
            for b in 0..a {
                let (i, j) = (self.visible[a], self.visible[b]);
                let cot = self.pairs[i * (i - 1) / 2 + j].cot_per_m(views);
                // The cotangent falls with the angle: its low end is the wide angle.
                self.far_values.set(a, b, -cot.hi);
                self.near_values.set(a, b, cot.lo);
                all = Range { lo: all.lo.min(cot.lo), hi: all.hi.max(cot.hi) };
            }
        }
        // Any pair is the widest or the narrowest at most: other spots can only add to either.
        let (widest_hi, narrowest_lo) = (views.max_extent_m(all.lo), views.min_extent_m(all.hi));
        least_diameters(&self.far_values, shown, &mut self.least);
        for (bounds, least) in bounds.iter_mut().zip(&self.least).take(shown - 1) {
            bounds.widest = Range { lo: views.min_extent_m(-least), hi: widest_hi };
        }
        least_diameters(&self.near_values, shown, &mut self.least);
        for (bounds, least) in bounds.iter_mut().zip(&self.least).take(shown - 1) {
            bounds.narrowest = Range { lo: narrowest_lo, hi: views.max_extent_m(*least) };
        }
        shown
    }
}
