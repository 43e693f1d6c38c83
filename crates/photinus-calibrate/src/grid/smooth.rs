//! Whether labelled spots lie as smoothly as any lens shows a grid: spots that are no LEDs do not.

use nalgebra::{SMatrix, SVector, Vector2};

use super::{Grid, OrderError};
use crate::adjust::Observation;

/// A spot this far from the smooth grid, in spacings, is no LED.
const STRANGER: f64 = 0.22;
/// A grid that is rougher than this after the worst spots went is no grid.
const ROUGH: f64 = 0.12;

/// Terms of a polynomial of degree three in two variables.
const TERMS: usize = 10;

/// Drops spots that lie off the smooth grid, the worst first.
pub(super) fn without_strangers(
    mut observations: Vec<Observation>,
    grid: &Grid,
) -> Result<Vec<Observation>, OrderError> {
    for _ in 0..4 {
        let off = off_spacings(&observations, grid);
        let worst = (0..off.len()).max_by(|&a, &b| off[a].total_cmp(&off[b]));
        match worst {
            Some(worst) if off[worst] > STRANGER => {
                observations.remove(worst);
            }
            _ => break,
        }
    }
    let worst = off_spacings(&observations, grid).into_iter().fold(0.0, f64::max);
    let mean = mean_off_spacings(&observations, grid);
    if worst > STRANGER || mean > ROUGH {
        return Err(OrderError::NotSmooth { off_spacings: worst });
    }
    Ok(observations)
}

/// Root mean square of how far the spots are from the smooth grid, in spacings.
pub(super) fn mean_off_spacings(observations: &[Observation], grid: &Grid) -> f64 {
    let off = off_spacings(observations, grid);
    (off.iter().map(|x| x * x).sum::<f64>() / off.len().max(1) as f64).sqrt()
}

/// How far each spot is from a cubic map of the grid, in spacings, each seen against the rest (its own pull taken out).
fn off_spacings(observations: &[Observation], grid: &Grid) -> Vec<f64> {
    let spacing = spacing_px(observations, grid);
    let terms = |led: usize| {
        let unit = |at: usize, count: usize| 2.0 * at as f64 / (count as f64 - 1.0) - 1.0;
        let (x, y) = (unit(led % grid.columns(), grid.columns()), unit(led / grid.columns(), grid.rows()));
        SVector::<f64, TERMS>::from([
            1.0,
            x,
            y,
            x * x,
            x * y,
            y * y,
            x * x * x,
            x * x * y,
            x * y * y,
            y * y * y,
        ])
    };
    let mut normal = SMatrix::<f64, TERMS, TERMS>::identity() * 1e-9;
    let mut right = SMatrix::<f64, TERMS, 2>::zeros();
    for seen in observations {
        let row = terms(seen.led);
        normal += row * row.transpose();
        right += row * seen.pixel.transpose();
    }
    let Some(cholesky) = normal.cholesky() else { return vec![f64::INFINITY; observations.len()] };
    let map = cholesky.solve(&right);
    let off = |seen: &Observation| {
        let row = terms(seen.led);
        let predicted: Vector2<f64> = map.transpose() * row;
        let leverage = row.dot(&cholesky.solve(&row));
        (seen.pixel - predicted).norm() / (1.0 - leverage).max(0.2) / spacing
    };
    observations.iter().map(off).collect()
}

/// The median distance between neighbours of the grid, px.
fn spacing_px(observations: &[Observation], grid: &Grid) -> f64 {
    let mut steps = Vec::new();
    for seen in observations {
        let beside = |other: &&Observation| {
            let right = other.led == seen.led + 1 && other.led % grid.columns() != 0;
            right || other.led == seen.led + grid.columns()
        };
        steps.extend(observations.iter().filter(beside).map(|other| (other.pixel - seen.pixel).norm()));
    }
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
}
