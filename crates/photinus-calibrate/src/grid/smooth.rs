//! Whether labelled spots lie as smoothly as any lens shows a grid: spots that are no LEDs do not.

use nalgebra::{SMatrix, SVector, Vector2};

use super::{Grid, OrderError};
use crate::adjust::Observation;

/// A spot this far from the smooth grid, in spacings, is no LED.
const STRANGER: f64 = 0.22;
/// A spot nearer than this is an LED ...
const SURE: f64 = 0.06;
/// ... and one this many times farther off than the middle one is not.
const TIMES_MEDIAN: f64 = 7.0;
/// A grid that is rougher than this after the worst spots went is no grid.
const ROUGH: f64 = 0.12;

/// Terms of a polynomial of degree four in two variables.
const TERMS: usize = 15;
/// A grid of fewer LEDs leaves the terms of degree four no room to be told.
const FEW_LEDS: usize = 30;

/// Drops spots that lie off the smooth grid, the worst first, then settles which spot is which LED.
pub(super) fn without_strangers(
    mut observations: Vec<Observation>,
    spots: &[Vector2<f64>],
    grid: &Grid,
) -> Result<Vec<Observation>, OrderError> {
    for _ in 0..6 {
        let off = off_spacings(&observations, grid);
        let worst = (0..off.len()).max_by(|&a, &b| off[a].total_cmp(&off[b]));
        match worst {
            Some(worst) if off[worst] > limit(&off) => {
                observations.remove(worst);
            }
            _ => break,
        }
    }
    let off = off_spacings(&observations, grid);
    let worst = off.iter().copied().fold(0.0, f64::max);
    if worst > limit(&off) || mean_off_spacings(&observations, grid) > ROUGH {
        return Err(OrderError::NotSmooth { off_spacings: worst });
    }
    Ok(claimed(&observations, spots, grid, limit(&off)))
}

/// How far off a spot may be, in spacings: far more than the others are.
fn limit(off: &[f64]) -> f64 {
    let mut sorted = off.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(STRANGER);
    (TIMES_MEDIAN * median).clamp(SURE, STRANGER)
}

/// Labels the one spot that lies where the smooth grid has an LED; an LED that several spots claim is left out.
fn claimed(
    observations: &[Observation],
    spots: &[Vector2<f64>],
    grid: &Grid,
    limit: f64,
) -> Vec<Observation> {
    let Some(map) = Map::of(observations, grid) else { return observations.to_vec() };
    let free: Vec<_> =
        spots.iter().filter(|spot| observations.iter().all(|seen| seen.pixel != **spot)).collect();
    let mut kept = Vec::new();
    for led in 0..grid.leds() {
        let seen = observations.iter().find(|seen| seen.led == led);
        let expected = seen.map_or(map.pixel(led), |seen| map.pixel_without(seen));
        // a spot twice as far off as the one that is there is no rival
        let own_px = seen.map_or(f64::INFINITY, |seen| (seen.pixel - expected).norm());
        let reach = (limit * map.spacing_px).min(2.0 * own_px);
        let mut claims = free.iter().filter(|spot| (**spot - expected).norm() < reach).map(|spot| **spot);
        match (seen, claims.next(), claims.next()) {
            (Some(seen), None, _) => kept.push(*seen),
            (None, Some(pixel), None) => kept.push(Observation { led, pixel }),
            _ => {}
        }
    }
    kept
}

/// Root mean square of how far the spots are from the smooth grid, in spacings.
pub(super) fn mean_off_spacings(observations: &[Observation], grid: &Grid) -> f64 {
    let off = off_spacings(observations, grid);
    (off.iter().map(|x| x * x).sum::<f64>() / off.len().max(1) as f64).sqrt()
}

/// How far each spot is from the smooth grid, in spacings, each seen against the rest (its own pull taken out).
fn off_spacings(observations: &[Observation], grid: &Grid) -> Vec<f64> {
    let Some(map) = Map::of(observations, grid) else { return vec![f64::INFINITY; observations.len()] };
    observations
        .iter()
        .map(|seen| (seen.pixel - map.pixel(seen.led)).norm() / map.others_share(seen.led) / map.spacing_px)
        .collect()
}

/// A map of degree four (of three for small grids) from the grid to the image.
struct Map<'a> {
    grid: &'a Grid,
    terms: SMatrix<f64, TERMS, 2>,
    normal: nalgebra::Cholesky<f64, nalgebra::Const<TERMS>>,
    spacing_px: f64,
}

impl<'a> Map<'a> {
    fn of(observations: &[Observation], grid: &'a Grid) -> Option<Self> {
        let mut normal = SMatrix::<f64, TERMS, TERMS>::identity() * 1e-9;
        let mut right = SMatrix::<f64, TERMS, 2>::zeros();
        for seen in observations {
            let row = terms(seen.led, grid);
            normal += row * row.transpose();
            right += row * seen.pixel.transpose();
        }
        let normal = normal.cholesky()?;
        let terms = normal.solve(&right);
        Some(Self { grid, terms, normal, spacing_px: spacing_px(observations, grid) })
    }

    fn pixel(&self, led: usize) -> Vector2<f64> {
        self.terms.transpose() * terms(led, self.grid)
    }

    /// Where the other spots expect the LED of this one.
    fn pixel_without(&self, seen: &Observation) -> Vector2<f64> {
        seen.pixel - (seen.pixel - self.pixel(seen.led)) / self.others_share(seen.led)
    }

    /// What part of a residual is left when the spot itself pulls at the map.
    fn others_share(&self, led: usize) -> f64 {
        let row = terms(led, self.grid);
        (1.0 - row.dot(&self.normal.solve(&row))).max(0.05)
    }
}

/// The polynomial's terms at an LED.
fn terms(led: usize, grid: &Grid) -> SVector<f64, TERMS> {
    let unit = |at: usize, count: usize| 2.0 * at as f64 / (count as f64 - 1.0) - 1.0;
    let (x, y) = (unit(led % grid.columns(), grid.columns()), unit(led / grid.columns(), grid.rows()));
    let fourth = if grid.leds() < FEW_LEDS { 0.0 } else { 1.0 };
    let (xx, xy, yy) = (x * x, x * y, y * y);
    let mut terms =
        [1.0, x, y, xx, xy, yy, x * xx, x * xy, x * yy, y * yy, xx * xx, xx * xy, xx * yy, xy * yy, yy * yy];
    for term in &mut terms[10..] {
        *term *= fourth;
    }
    SVector::from(terms)
}

/// The median distance between neighbours of the grid, px.
fn spacing_px(observations: &[Observation], grid: &Grid) -> f64 {
    let mut steps = Vec::new();
    for seen in observations {
        let beside = |other: &&Observation| {
            let right = other.led == seen.led + 1 && !other.led.is_multiple_of(grid.columns());
            right || other.led == seen.led + grid.columns()
        };
        steps.extend(observations.iter().filter(beside).map(|other| (other.pixel - seen.pixel).norm()));
    }
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
}
