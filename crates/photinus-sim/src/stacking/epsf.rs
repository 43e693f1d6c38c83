//! From spots to a table of the effective point spread, and back to better places of the spots, until both agree.

use nalgebra::{SMatrix, SVector};

use super::Spot;
use crate::optics::SampledSpread;

/// A table, and how well it says what the spots look like.
#[derive(Clone, Debug)]
pub struct Stacked {
    /// The table, scaled so that the light sums to 1, its rows.
    pub rows: Vec<Vec<f64>>,
    /// The same to draw with.
    pub table: SampledSpread,
    /// Spots that it was made of, where they were found to be.
    pub spots: Vec<Spot>,
    /// Root mean square of what is left of the pixels within 2 px of a spot, as a share of the spot's summit.
    pub residual: f64,
}

const ROUNDS: usize = 12;
/// Residuals farther from the mean of their node than this many sigmas are left out: a neighbour, a scratch, a mosaic.
const CLIP: f64 = 2.5;

/// Stacks spots to a table of `samples_per_px` that reaches `half_px` to every side; `None` where they do not make one.
pub fn stack(mut spots: Vec<Spot>, samples_per_px: usize, half_px: usize) -> Option<Stacked> {
    let side = 2 * samples_per_px * half_px + 1;
    let mut shares = vec![0.0; side * side];
    let mut table: Option<SampledSpread> = None;
    for round in 0..ROUNDS {
        refine(&mut shares, table.as_ref(), &spots, samples_per_px);
        if shares.iter().any(|share| !share.is_finite()) {
            return None;
        }
        let sum = shares.iter().map(|share| share.max(0.0)).sum::<f64>();
        let scale = (samples_per_px * samples_per_px) as f64 / sum;
        shares.iter_mut().for_each(|share| *share = share.max(0.0) * scale);
        let rows: Vec<Vec<f64>> = shares.chunks(side).map(<[f64]>::to_vec).collect();
        let next = SampledSpread::new(samples_per_px, &rows)?;
        // the centroid of the table is where the light is: places follow it
        let (off_u, off_v) = centroid(&shares, side, samples_per_px);
        for spot in &mut spots {
            (spot.u_px, spot.v_px) = (spot.u_px + off_u, spot.v_px + off_v);
        }
        spots.retain_mut(|spot| fit(spot, &next));
        if round + 1 < ROUNDS {
            even_out(&mut spots, |spot| &mut spot.u_px);
            even_out(&mut spots, |spot| &mut spot.v_px);
        }
        table = Some(next);
    }
    let table = table?;
    let rows = shares.chunks(side).map(<[f64]>::to_vec).collect();
    let residual = residual(&spots, &table);
    (spots.len() >= 10).then_some(Stacked { rows, table, spots, residual })
}

/// Adds to every sample the mean of what it leaves of the pixels near it, those at the sample itself counting most.
fn refine(shares: &mut [f64], table: Option<&SampledSpread>, spots: &[Spot], samples_per_px: usize) {
    let side = shares.len().isqrt();
    let middle = (side / 2) as f64;
    let mut left = Vec::new();
    for spot in spots {
        for &(u, v, value) in &spot.pixels {
            let (x_px, y_px) = (u - spot.u_px, v - spot.v_px);
            let at = [x_px, y_px].map(|px| px * samples_per_px as f64 + middle);
            if at.iter().all(|at| *at >= 0.0 && *at < (side - 1) as f64) {
                let expected = table.map_or(0.0, |table| table.share(x_px, y_px));
                left.push((at, (value - spot.level) / spot.flux - expected));
            }
        }
    }
    let mut nodes = vec![Node::default(); shares.len()];
    let add = |is_near: &dyn Fn(usize, f64) -> bool, nodes: &mut Vec<Node>| {
        for &(at, value) in &left {
            let [column, row] = at.map(f64::floor);
            let (x, y) = (at[0] - column, at[1] - row);
            let first = row as usize * side + column as usize;
            for (node, weight) in [
                (first, (1.0 - x) * (1.0 - y)),
                (first + 1, x * (1.0 - y)),
                (first + side, (1.0 - x) * y),
                (first + side + 1, x * y),
            ] {
                if is_near(node, value) {
                    nodes[node].add(weight, value);
                }
            }
        }
    };
    add(&|_, _| true, &mut nodes);
    let all = nodes.clone();
    nodes.fill(Node::default());
    add(&|node, value| all[node].is_near(value), &mut nodes);
    shares.iter_mut().zip(&nodes).for_each(|(share, node)| *share += node.mean());
}

/// Sums of what is left about a sample of the table.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    weight: f64,
    sum: f64,
    square: f64,
}

impl Node {
    fn add(&mut self, weight: f64, value: f64) {
        self.weight += weight;
        self.sum += weight * value;
        self.square += weight * value * value;
    }

    fn mean(&self) -> f64 {
        if self.weight > 0.0 { self.sum / self.weight } else { 0.0 }
    }

    fn is_near(&self, value: f64) -> bool {
        let off = value - self.mean();
        off * off <= CLIP * CLIP * (self.square / self.weight - self.mean() * self.mean()).max(1e-18)
    }
}

/// Moves places along one axis so that they fall evenly over a pixel, if they are far from it. A lens much sharper than its
/// pixels does not tell a bent table with uneven places from a straight one with even places; many LEDs are even.
fn even_out(spots: &mut [Spot], place_px: impl Fn(&mut Spot) -> &mut f64) {
    use core::f64::consts::{PI, TAU};
    let count = spots.len() as f64;
    let mut waves = [(0.0, 0.0); 2];
    for spot in spots.iter_mut() {
        let phase = *place_px(spot);
        for (number, wave) in (1..).zip(&mut waves) {
            let (sin, cos) = libm::sincos(TAU * f64::from(number) * phase);
            *wave = (wave.0 + cos / count, wave.1 + sin / count);
        }
    }
    // even places give sums with a sigma of 1 / sqrt(2 count)
    let told = |wave: &(f64, f64)| libm::hypot(wave.0, wave.1) > 3.0 / (2.0 * count).sqrt();
    for spot in spots {
        let place = place_px(spot);
        let mut shift_px = 0.0;
        for (number, wave) in (1..).map(f64::from).zip(&waves).filter(|(_, wave)| told(wave)) {
            let (sin, cos) = libm::sincos(TAU * number * *place);
            shift_px += (wave.0 * sin - wave.1 * cos) / (PI * number);
        }
        *place += 0.5 * shift_px;
    }
}

/// Where the light of the table within 3 px of its middle is, px.
fn centroid(shares: &[f64], side: usize, samples_per_px: usize) -> (f64, f64) {
    let (middle, per_sample) = ((side / 2) as f64, 1.0 / samples_per_px as f64);
    let (mut sum, mut u, mut v) = (0.0, 0.0, 0.0);
    for (index, share) in shares.iter().enumerate() {
        let place = [(index % side) as f64 - middle, (index / side) as f64 - middle].map(|x| x * per_sample);
        if place[0].abs().max(place[1].abs()) <= 3.0 {
            (sum, u, v) = (sum + share, u + share * place[0], v + share * place[1]);
        }
    }
    (u / sum, v / sum)
}

/// Moves a spot to where the table says it is, with its light and what surrounds it; false where it does not settle.
fn fit(spot: &mut Spot, table: &SampledSpread) -> bool {
    const STEP_PX: f64 = 0.05;
    let first = (spot.u_px, spot.v_px);
    for _ in 0..4 {
        let (mut matrix, mut right) = (SMatrix::<f64, 4, 4>::zeros(), SVector::<f64, 4>::zeros());
        for &(u, v, value) in &spot.pixels {
            let (x_px, y_px) = (u - spot.u_px, v - spot.v_px);
            let share = table.share(x_px, y_px);
            let slope = |dx: f64, dy: f64| {
                let difference = table.share(x_px - dx, y_px - dy) - table.share(x_px + dx, y_px + dy);
                0.5 * spot.flux * difference / STEP_PX
            };
            let row = SVector::from([slope(STEP_PX, 0.0), slope(0.0, STEP_PX), share, 1.0]);
            // bright pixels are as uncertain as their light's shot noise, about
            let weight = 1.0 / (1.0 + (value - spot.level).max(0.0) / 30.0);
            matrix += row * row.transpose() * weight;
            right += row * (weight * (value - spot.level - spot.flux * share));
        }
        let Some(step) = matrix.cholesky().map(|factor| factor.solve(&right)) else { return false };
        spot.u_px += step[0].clamp(-0.3, 0.3);
        spot.v_px += step[1].clamp(-0.3, 0.3);
        spot.flux += step[2];
        spot.level += step[3];
    }
    let settled = libm::hypot(spot.u_px - first.0, spot.v_px - first.1) < 1.0;
    settled && spot.flux > 0.0 && spot.flux.is_finite() && spot.level.is_finite()
}

fn residual(spots: &[Spot], table: &SampledSpread) -> f64 {
    let summit = table.share(0.0, 0.0);
    let (mut square, mut count) = (0.0, 0.0);
    for spot in spots {
        for &(u, v, value) in &spot.pixels {
            let (x_px, y_px) = (u - spot.u_px, v - spot.v_px);
            if libm::hypot(x_px, y_px) < 2.0 {
                let left = (value - spot.level) / spot.flux - table.share(x_px, y_px);
                (square, count) = (square + (left / summit).powi(2), count + 1.0);
            }
        }
    }
    (square / f64::max(count, 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::{Photo, Wanted, find};
    use super::*;
    use crate::optics::{Aberrations, Gaussian, PointLight, PointSpread};
    use crate::sensor::{Charge, NoiseTable, hash};

    #[test]
    fn a_rendered_point_spread_comes_back_from_its_spots() {
        for sigma_px in [0.35, 0.8] {
            let parts =
                vec![Gaussian { share: 0.8, sigma_px }, Gaussian { share: 0.2, sigma_px: 2.0 * sigma_px }];
            let coma = Aberrations { axis_coma_px: [0.3, 0.1], ..Default::default() };
            let spread = PointSpread::new(parts, 0.0).unwrap().with_aberrations(coma).unwrap();
            let noise = NoiseTable::new();
            let uniform = |n: u64| (hash(n) >> 11) as f64 / (1_u64 << 53) as f64;
            let (mut spots, mut truth) = (Vec::new(), Vec::new());
            for photo in 0..2_u64 {
                let mut charge = Charge::new(320, 256);
                for index in 0..80_u64 {
                    let number = 1000 * photo + 3 * index;
                    let (u_px, v_px) = (
                        16.0 + 32.0 * (index % 10) as f64 + uniform(number),
                        16.0 + 32.0 * (index / 10) as f64 + uniform(number + 1),
                    );
                    let light = PointLight { u_px, v_px, electrons: 1000.0, ..Default::default() };
                    truth.push((photo, u_px, v_px));
                    spread.draw(
                        &PointLight { electrons: 1000.0 * (0.5 + uniform(number + 2)), ..light },
                        &mut charge,
                    );
                }
                let levels = (0..256).flat_map(|v| {
                    let row: Vec<f64> = charge.row(v).iter().map(|&e| f64::from(e)).collect();
                    let noise = (0..5).flat_map(|run| *noise.run(photo, 5 * v as u64 + run));
                    row.into_iter().zip(noise.collect::<Vec<_>>()).map(|(e, n)| 20.0 + e + 0.5 * f64::from(n))
                });
                let photo = Photo::new(levels.collect(), 320).unwrap();
                spots.extend(find(&photo, &Wanted { half_px: 6, least: 30.0, most: 1e4 }));
            }
            assert!(spots.len() > 150, "{}", spots.len());
            let stacked = stack(spots, 4, 5).unwrap();
            assert!(stacked.residual < 0.01, "{}", stacked.residual);
            // what a pixel gets at an offset, by drawing the true spread without noise; its centroid is at its coma
            let share = |x_px: f64, y_px: f64| {
                let mut charge = Charge::new(21, 21);
                let (u_px, v_px) = (10.0 - x_px - 0.3, 10.0 - y_px - 0.1);
                spread.draw(&PointLight { u_px, v_px, electrons: 1e6, ..Default::default() }, &mut charge);
                f64::from(charge.at(10, 10)) / 1e6
            };
            let summit = share(0.0, 0.0);
            let (mut square, mut worst, mut count) = (0.0, 0.0_f64, 0.0);
            for i in -14..=14 {
                for j in -14..=14 {
                    let (x_px, y_px) = (f64::from(i) * 0.21, f64::from(j) * 0.21);
                    let error = (stacked.table.share(x_px, y_px) - share(x_px, y_px)) / summit;
                    square += error * error;
                    worst = worst.max(error.abs());
                    count += 1.0;
                }
            }
            let rms = f64::sqrt(square / count);
            assert!(rms < 0.012 && worst < 0.06, "sigma {sigma_px} px: {rms} {worst} of the summit");
        }
    }
}
