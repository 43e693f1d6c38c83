//! Weighted least squares for the splines of one or more tables at once, with a prior that keeps them smooth.
//!
//! Unknown are changes of spline coefficients over their scale. The normal equations, some ten thousand by as many for each
//! table, are never written down: conjugate gradients need only their product with a vector, which is a pass over the pixels.

use super::field::Field;
use super::noise::Noise;
use super::spot::Spot;
use super::table::{COUNT, MIDDLE, PER_PX, SIDE, Shares, Table, weights};

/// How a table may differ from what it is compared with, as shares of the scale: standard deviations of samples, and of how much
/// neighbours bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Belief {
    pub(super) apart: f64,
    pub(super) bent: f64,
}

/// Steps of the conjugate gradients; rounds that follow go on from where they end.
const STEPS: usize = 12;
/// A pixel farther off than this many sigmas counts as so far off.
const CLIP: f64 = 5.0;
/// Pixels farther from a spot change nothing, px.
const REACH_PX: usize = 9;

/// Pixels of one spot: the four weights along each axis are the same for all of them.
struct Rows<const N: usize> {
    nodes: [(usize, f64); N],
    across: [f64; 4],
    down: [f64; 4],
    /// First coefficient, weight of the share, what is left of it.
    pixels: Vec<(usize, f64, f64)>,
}

/// Equations gathered from spots.
pub(super) struct Correction<'a, const N: usize> {
    scale: &'a [f64],
    apart: f64,
    bent: f64,
    tables: usize,
    rows: Vec<Rows<N>>,
    /// Data's diagonal of the normal equations.
    diagonal: Vec<f64>,
    changes: Vec<f64>,
}

impl<'a, const N: usize> Correction<'a, N> {
    /// No equations yet, for this many tables.
    pub(super) fn new(scale: &'a [f64], belief: &Belief, tables: usize) -> Self {
        Self {
            scale,
            apart: 1.0 / (belief.apart * belief.apart),
            bent: 1.0 / (belief.bent * belief.bent),
            tables,
            rows: Vec::new(),
            diagonal: vec![0.0; tables * COUNT],
            changes: vec![0.0; tables * COUNT],
        }
    }

    /// Takes the pixels of spots: `wrong` is by how much tables may still be wrong, `nodes` which of them make up a place.
    pub(super) fn gather(
        &mut self,
        spots: &[Spot<'_>],
        field: &Field,
        noise: &Noise,
        wrong: f64,
        nodes: impl Fn([f64; 2]) -> [(usize, f64); N],
    ) {
        let mut shares = Shares::default();
        for spot in spots.iter().filter(|spot| spot.is_used) {
            let (first_column, across) = first(-spot.u);
            let (first_row, down) = first(-spot.v);
            let nodes = nodes(spot.place_px());
            let mut pixels = Vec::new();
            spot.each_pixel(field.at(spot.place_px()), noise, REACH_PX, &mut shares, |pixel| {
                let column = first_column + PER_PX as isize * pixel.column;
                let row = first_row + PER_PX as isize * pixel.row;
                let inside = |at: isize| at >= 0 && at + 3 < SIDE as isize;
                if !(inside(column) && inside(row)) {
                    return;
                }
                let most = CLIP * (1.0 / pixel.weight + wrong * wrong * spot.light * spot.light).sqrt();
                let left = pixel.left.clamp(-most, most);
                let weight = pixel.weight * spot.light * spot.light;
                pixels.push((row as usize * SIDE + column as usize, weight, left / spot.light));
            });
            let rows = Rows { nodes, across, down, pixels };
            self.add_diagonal(&rows);
            self.rows.push(rows);
        }
    }

    fn add_diagonal(&mut self, rows: &Rows<N>) {
        let (across, down) = (rows.across.map(|w| w * w), rows.down.map(|w| w * w));
        for &(first, weight, _) in &rows.pixels {
            each_of_16(first, &across, &down, |sample, square| {
                let scaled = square * self.scale[sample] * self.scale[sample] * weight;
                for (node, near) in rows.nodes {
                    self.diagonal[node * COUNT + sample] += near * near * scaled;
                }
            });
        }
    }

    /// Finds the changes of tables that are compared with `mean`.
    pub(super) fn solve(&mut self, tables: &[&Table], mean: &Table) {
        let mut now = vec![0.0; self.tables * COUNT];
        for (node, table) in tables.iter().enumerate() {
            for (sample, now) in now[node * COUNT..][..COUNT].iter_mut().enumerate() {
                let apart = table.coefficient(sample) - mean.coefficient(sample);
                *now = if self.scale[sample] > 0.0 { apart / self.scale[sample] } else { 0.0 };
            }
        }
        let mut left = self.pulled();
        let held = self.held(&now);
        left.iter_mut().zip(&held).for_each(|(left, held)| *left -= held);
        let eased = |left: &[f64], diagonal: &[f64], prior: f64| -> Vec<f64> {
            left.iter().zip(diagonal).map(|(left, data)| left / (data + prior)).collect()
        };
        let prior = self.apart + 20.0 * self.bent;
        let mut step = eased(&left, &self.diagonal, prior);
        let mut height = dot(&left, &step);
        for _ in 0..STEPS {
            let through = self.product(&step);
            let along = dot(&step, &through);
            if !(along > 0.0 && height > 0.0) {
                break;
            }
            let length = height / along;
            self.changes.iter_mut().zip(&step).for_each(|(change, step)| *change += length * step);
            left.iter_mut().zip(&through).for_each(|(left, through)| *left -= length * through);
            let next = eased(&left, &self.diagonal, prior);
            let next_height = dot(&left, &next);
            let ratio = next_height / height;
            step.iter_mut().zip(&next).for_each(|(step, next)| *step = next + ratio * *step);
            height = next_height;
        }
    }

    /// Changes a table.
    pub(super) fn apply(&self, node: usize, table: &mut Table, noise: &Noise) {
        let changes = self.changes[node * COUNT..][..COUNT].iter().zip(self.scale);
        table.change(&changes.map(|(change, scale)| change * scale).collect::<Vec<_>>());
        table.settle_in(noise);
    }

    /// How far tables lie apart from their mean, as the evidence has it (D. MacKay, Neural Computation 4, 1992): the mean
    /// square of the differences, each counted as far as data tell it.
    pub(super) fn apart(&self, tables: &[Table], mean: &Table) -> f64 {
        let (mut squares, mut told) = (0.0, 0.0);
        for (node, table) in tables.iter().enumerate() {
            for (sample, &scale) in self.scale.iter().enumerate().filter(|(_, scale)| **scale > 0.0) {
                let apart = (table.coefficient(sample) - mean.coefficient(sample)) / scale;
                squares += apart * apart;
                let data = self.diagonal[node * COUNT + sample];
                told += data / (data + self.apart + 20.0 * self.bent);
            }
        }
        (squares / f64::max(told, 1.0)).sqrt()
    }

    /// What pixels pull at the coefficients.
    fn pulled(&self) -> Vec<f64> {
        let mut pulled = vec![0.0; self.tables * COUNT];
        for rows in &self.rows {
            for &(first, weight, left) in &rows.pixels {
                self.spread_out(rows, first, weight * left, &mut pulled);
            }
        }
        self.scaled(pulled)
    }

    /// The normal matrix times a vector.
    fn product(&self, vector: &[f64]) -> Vec<f64> {
        let coefficients: Vec<f64> =
            vector.iter().enumerate().map(|(index, value)| value * self.scale[index % COUNT]).collect();
        let mut product = vec![0.0; self.tables * COUNT];
        for rows in &self.rows {
            for &(first, weight, _) in &rows.pixels {
                let of = |(node, near): (usize, f64)| {
                    near * gathered(&coefficients[node * COUNT..][..COUNT], first, rows)
                };
                let share: f64 = rows.nodes.into_iter().map(of).sum();
                self.spread_out(rows, first, weight * share, &mut product);
            }
        }
        let mut product = self.scaled(product);
        product.iter_mut().zip(&self.held(vector)).for_each(|(sum, held)| *sum += held);
        product
    }

    fn spread_out(&self, rows: &Rows<N>, first: usize, value: f64, onto: &mut [f64]) {
        for (node, near) in rows.nodes {
            let table = &mut onto[node * COUNT..][..COUNT];
            for (b, down) in rows.down.iter().enumerate() {
                let value = near * value * down;
                let line = &mut table[first + b * SIDE..][..4];
                line.iter_mut().zip(&rows.across).for_each(|(sum, across)| *sum += across * value);
            }
        }
    }

    fn scaled(&self, mut vector: Vec<f64>) -> Vec<f64> {
        vector.iter_mut().enumerate().for_each(|(index, value)| *value *= self.scale[index % COUNT]);
        vector
    }

    /// What the prior holds back: differences, and second differences along both axes.
    fn held(&self, vector: &[f64]) -> Vec<f64> {
        let mut held: Vec<f64> = vector.iter().map(|value| self.apart * value).collect();
        for node in 0..self.tables {
            let (table, held) = (&vector[node * COUNT..][..COUNT], &mut held[node * COUNT..][..COUNT]);
            for row in 1..SIDE - 1 {
                for column in 1..SIDE - 1 {
                    let sample = row * SIDE + column;
                    for step in [1, SIDE] {
                        let bend = table[sample - step] - 2.0 * table[sample] + table[sample + step];
                        let pull = self.bent * bend;
                        held[sample - step] += pull;
                        held[sample] -= 2.0 * pull;
                        held[sample + step] += pull;
                    }
                }
            }
        }
        held
    }
}

/// The share that a table of coefficients gives a pixel.
fn gathered<const N: usize>(table: &[f64], first: usize, rows: &Rows<N>) -> f64 {
    let line = |b: usize| -> f64 {
        let four = &table[first + b * SIDE..][..4];
        four.iter().zip(&rows.across).map(|(share, across)| share * across).sum()
    };
    rows.down.iter().enumerate().map(|(b, down)| down * line(b)).sum()
}

/// The first of four coefficients for an offset along an axis, and their weights.
fn first(offset_px: f64) -> (isize, [f64; 4]) {
    let at = offset_px * PER_PX as f64 + MIDDLE as f64;
    (at.floor() as isize - 1, weights(at - at.floor()).0)
}

#[inline]
fn each_of_16(first: usize, across: &[f64; 4], down: &[f64; 4], mut take: impl FnMut(usize, f64)) {
    for (b, down) in down.iter().enumerate() {
        for (a, across) in across.iter().enumerate() {
            take(first + b * SIDE + a, down * across);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
