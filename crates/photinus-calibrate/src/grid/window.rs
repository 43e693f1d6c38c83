//! Where in a lattice the grid is.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::growth::{Lattice, Place};
use super::{Grid, OrderError};
use crate::adjust::Observation;

/// Changes of basis that turn an oblique lattice upright: a grid seen from the side has its second or third neighbour of one line
/// nearer than the first of the next.
fn bases() -> impl Iterator<Item = [Place; 2]> {
    const STEEPEST: i32 = 3;
    let across = (-STEEPEST..=STEEPEST).map(|k| [(1, k), (0, 1)]);
    let down = (-STEEPEST..=STEEPEST).filter(|k| *k != 0).map(|k| [(1, 0), (k, 1)]);
    across.chain(down)
}

/// One way to lay the grid into the lattice.
struct Reading {
    observations: Vec<Observation>,
}

/// Lays the grid into the lattice where it covers most spots.
pub(super) fn place(
    spots: &[Vector2<f64>],
    lattice: &Lattice,
    grid: &Grid,
    needed: usize,
) -> Result<Vec<Observation>, OrderError> {
    let mut read: Vec<Reading> = Vec::new();
    for basis in bases() {
        read.extend(readings(spots, &changed(lattice, basis), grid));
    }
    let covered = read.iter().map(|reading| reading.observations.len()).max().unwrap_or(0);
    if let Some((columns, rows)) = other_size(lattice, grid, covered) {
        return Err(OrderError::OtherSize { columns, rows });
    }
    if covered < needed {
        return Err(OrderError::NoLattice { found: spots.len(), lattice: covered, needed });
    }
    // an oblique reading leaves a corner of the true grid out at either end
    if 100 * covered < 85 * lattice.len() {
        return Err(OrderError::Outside { lattice: lattice.len(), covered });
    }
    // an oblique reading bends far more than the upright one, which may hold a foreign spot less
    read.retain(|reading| 100 * reading.observations.len() >= 85 * covered);
    let roughness = |reading: &Reading| super::smooth::mean_off_spacings(&reading.observations, grid);
    let rough: Vec<f64> = read.iter().map(roughness).collect();
    let least = rough.iter().copied().fold(f64::INFINITY, f64::min);
    let smooth = read.into_iter().zip(&rough).filter(|(_, rough)| **rough <= 3.0 * least + 0.01);
    let mut alike: Vec<Reading> = smooth.map(|(reading, _)| reading).collect();
    let most = alike.iter().map(|reading| reading.observations.len()).max().unwrap_or(0);
    alike.retain(|reading| reading.observations.len() == most);
    match alike.pop() {
        Some(reading) if alike.is_empty() => Ok(reading.observations),
        _ => Err(OrderError::Ambiguous { ways: alike.len() + 1 }),
    }
}

/// The lattice in another basis.
fn changed(lattice: &Lattice, [(a, b), (c, d)]: [Place; 2]) -> Lattice {
    lattice.iter().map(|(&(i, j), &spot)| ((a * i + c * j, b * i + d * j), spot)).collect()
}

/// The size of a lattice that is full and not the grid's; `covered` is what the grid covers of it.
fn other_size(lattice: &Lattice, grid: &Grid, covered: usize) -> Option<(usize, usize)> {
    let is_full = |(columns, rows, count): &(usize, usize, usize)| {
        *rows >= 3 && 100 * count >= 97 * columns * rows && 10 * count >= 9 * lattice.len()
    };
    let extents = bases().map(|basis| extent(&changed(lattice, basis))).filter(is_full);
    let (columns, rows, count) = extents.max_by_key(|(_, _, count)| *count)?;
    let is_other = (columns, rows) != (grid.columns().max(grid.rows()), grid.columns().min(grid.rows()));
    (is_other && (covered < count || covered + 3 <= grid.leds())).then_some((columns, rows))
}

/// The readings of an upright lattice that cover most spots, unmirrored, each once for all turns of the grid.
fn readings(spots: &[Vector2<f64>], lattice: &Lattice, grid: &Grid) -> Vec<Reading> {
    let mut found: Vec<Reading> = Vec::new();
    let shapes = [(grid.columns(), grid.rows(), false), (grid.rows(), grid.columns(), true)];
    let shapes = &shapes[..if grid.columns() == grid.rows() { 1 } else { 2 }];
    for &(wide, high, transposed) in shapes {
        for window in windows(lattice, wide as i32, high as i32) {
            let inside = |&(i, j): &Place| {
                (window.0..window.0 + wide as i32).contains(&i)
                    && (window.1..window.1 + high as i32).contains(&j)
            };
            let labelled: Vec<(usize, usize, usize)> = lattice
                .iter()
                .filter(|(place, _)| inside(place))
                .map(|(&(i, j), &spot)| {
                    let (i, j) = ((i - window.0) as usize, (j - window.1) as usize);
                    let (column, row) = if transposed { (j, i) } else { (i, j) };
                    (column, row, spot)
                })
                .collect();
            let mirrored = handedness(spots, &labelled) < 0.0;
            let observation = |&(column, row, spot): &(usize, usize, usize)| {
                let column = if mirrored { grid.columns() - 1 - column } else { column };
                Observation { led: row * grid.columns() + column, pixel: spots[spot] }
            };
            found.push(Reading { observations: labelled.iter().map(observation).collect() });
        }
    }
    let most = found.iter().map(|reading| reading.observations.len()).max().unwrap_or(0);
    found.retain(|reading| reading.observations.len() == most);
    found
}

/// Corners of the windows of a size that cover most places.
fn windows(lattice: &Lattice, wide: i32, high: i32) -> Vec<Place> {
    let ends = |of: fn(&Place) -> i32| {
        let values = lattice.keys().map(of);
        (values.clone().min().unwrap_or(0), values.max().unwrap_or(0))
    };
    let ((left, right), (top, bottom)) = (ends(|place| place.0), ends(|place| place.1));
    let mut best = (0, Vec::new());
    for i in (left - wide + 1).min(left)..=right {
        for j in (top - high + 1).min(top)..=bottom {
            let count = lattice
                .keys()
                .filter(|place| (i..i + wide).contains(&place.0) && (j..j + high).contains(&place.1))
                .count();
            if count > best.0 {
                best = (count, Vec::new());
            }
            if count == best.0 {
                best.1.push((i, j));
            }
        }
    }
    best.1
}

/// Positive where columns, then rows turn like u, then v.
fn handedness(spots: &[Vector2<f64>], labelled: &[(usize, usize, usize)]) -> f64 {
    let mut sum = 0.0;
    for &(column, row, spot) in labelled {
        let next = |column: usize, row: usize| {
            labelled
                .iter()
                .find(|other| (other.0, other.1) == (column, row))
                .map(|other| spots[other.2] - spots[spot])
        };
        if let (Some(right), Some(down)) = (next(column + 1, row), next(column, row + 1)) {
            sum += right.perp(&down);
        }
    }
    sum
}

/// Longer and shorter side of the lattice, counting lines with at least two spots, and how many spots are where these cross.
fn extent(lattice: &Lattice) -> (usize, usize, usize) {
    let lines = |of: fn(&Place) -> i32| {
        let mut counts = BTreeMap::new();
        for place in lattice.keys() {
            *counts.entry(of(place)).or_insert(0) += 1;
        }
        counts.retain(|_, count| *count >= 2);
        counts
    };
    let (a, b) = (lines(|place| place.0), lines(|place| place.1));
    let crossings = lattice.keys().filter(|(i, j)| a.contains_key(i) && b.contains_key(j)).count();
    (a.len().max(b.len()), a.len().min(b.len()), crossings)
}
