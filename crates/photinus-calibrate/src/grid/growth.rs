//! Spots -> whole-numbered places on a lattice, followed outwards from a pair of neighbours.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::Grid;
use super::neighbours::{from_the_middle, nearest};

/// A place on the lattice.
pub(super) type Place = (i32, i32);

/// Which spot is at which place.
pub(super) type Lattice = BTreeMap<Place, usize>;

/// How far a spot may be from where it is expected, in steps of the lattice.
const REACH: f64 = 0.38;
/// Spots near the middle that are tried as a start.
const STARTS: usize = 10;
/// Lattices that are looked at further: foreign spots make a wrong one the largest now and then.
const KEPT: usize = 12;
/// How many spots less than the largest these may hold.
const SLACK: usize = 3;

/// Lattices that hold most spots, from different starts: the largest first, the smoothest of a size first, each once.
pub(super) fn largest_lattices(spots: &[Vector2<f64>], grid: &Grid) -> Vec<Lattice> {
    let near = nearest(spots, 8);
    let mut grown: Vec<(Lattice, f64)> = Vec::new();
    for &start in from_the_middle(spots).iter().take(STARTS) {
        grown.extend(bases(spots, start, &near[start]).iter().map(|&(a, b)| grow(spots, start, a, b, grid)));
        if grown.iter().any(|(lattice, _)| lattice.len() == spots.len()) {
            break;
        }
    }
    // an oblique basis holds as many spots but bends more
    grown.sort_by(|a, b| b.0.len().cmp(&a.0.len()).then(a.1.total_cmp(&b.1)));
    let largest = grown.first().map_or(0, |(lattice, _)| lattice.len());
    let mut lattices: Vec<Lattice> = Vec::new();
    for (lattice, _) in grown {
        if lattice.len() + SLACK >= largest && lattices.len() < KEPT && !lattices.contains(&lattice) {
            lattices.push(lattice);
        }
    }
    lattices
}

/// Pairs of steps from a spot to neighbours that are not in line, short ones first.
fn bases(spots: &[Vector2<f64>], start: usize, near: &[usize]) -> Vec<(Vector2<f64>, Vector2<f64>)> {
    let mut pairs = Vec::new();
    for (n, &i) in near.iter().enumerate() {
        for &j in &near[n + 1..] {
            let (a, b) = (spots[i] - spots[start], spots[j] - spots[start]);
            if a.perp(&b).abs() > 0.2 * a.norm() * b.norm() {
                pairs.push((a, b));
            }
        }
    }
    pairs
}

/// An expectation of where the spot of a place lies.
struct Expected {
    at: Vector2<f64>,
    /// The shorter step of the lattice there, px.
    step_px: f64,
    /// How much is known about it: more is better.
    support: u32,
}

/// Grows the lattice from `start` with first steps `a` and `b`, the surest place first; with the mean squared miss.
fn grow(
    spots: &[Vector2<f64>],
    start: usize,
    a: Vector2<f64>,
    b: Vector2<f64>,
    grid: &Grid,
) -> (Lattice, f64) {
    let mut growth =
        Growth { spots, lattice: Lattice::new(), taken: vec![false; spots.len()], first: [a, b] };
    growth.put((0, 0), start);
    let (mut misses, mut count) = (0.0, 0.0);
    let most = 2 * grid.columns().max(grid.rows()) as i32;
    loop {
        let mut best: Option<(f64, Place, usize)> = None;
        for place in growth.frontier() {
            if place.0.abs() > most || place.1.abs() > most {
                continue;
            }
            let Some(expected) = growth.expected(place) else { continue };
            let Some((spot, miss)) = growth.nearest_free(&expected) else { continue };
            // a miss counts less where more neighbours agree on the expectation
            let doubt = (miss + 0.05) / f64::from(expected.support);
            if miss < REACH && best.is_none_or(|(least, _, _)| doubt < least) {
                best = Some((doubt, place, spot));
            }
        }
        let Some((_, place, spot)) = best else { break };
        if let Some(expected) = growth.expected(place) {
            let miss = (spots[spot] - expected.at).norm() / expected.step_px;
            misses += miss * miss;
            count += 1.0;
        }
        growth.put(place, spot);
    }
    (growth.lattice, if count > 0.0 { misses / count } else { f64::INFINITY })
}

struct Growth<'a> {
    spots: &'a [Vector2<f64>],
    lattice: Lattice,
    taken: Vec<bool>,
    first: [Vector2<f64>; 2],
}

const SIDES: [Place; 4] = [(1, 0), (-1, 0), (0, 1), (0, -1)];

impl Growth<'_> {
    fn put(&mut self, place: Place, spot: usize) {
        self.lattice.insert(place, spot);
        self.taken[spot] = true;
    }

    fn spot(&self, place: Place) -> Option<Vector2<f64>> {
        self.lattice.get(&place).map(|&spot| self.spots[spot])
    }

    /// Empty places next to the lattice.
    fn frontier(&self) -> std::collections::BTreeSet<Place> {
        let beside = self.lattice.keys().flat_map(|&(i, j)| SIDES.map(|(di, dj)| (i + di, j + dj)));
        beside.filter(|place| !self.lattice.contains_key(place)).collect()
    }

    /// Where the spot of a place should be, the mean of what its neighbours say.
    fn expected(&self, place: Place) -> Option<Expected> {
        let (mut sum, mut weights, mut support) = (Vector2::zeros(), 0.0, 0);
        let mut step_px = f64::INFINITY;
        for (di, dj) in SIDES {
            let back = |n: i32| (place.0 - n * di, place.1 - n * dj);
            let Some(near) = self.spot(back(1)) else { continue };
            let (at, weight, step) = match (self.spot(back(2)), self.spot(back(3))) {
                // straight on, bending as before
                (Some(second), Some(third)) => {
                    let (step, before) = (near - second, second - third);
                    (near + step + (step - before) * 0.6, 4.0, step.norm())
                }
                (Some(second), None) => (near + (near - second), 2.0, (near - second).norm()),
                (None, _) => match self.beside(back(1), (di, dj)) {
                    Some(step) => (near + step, 2.0, step.norm()),
                    None => {
                        let step = self.first[0] * f64::from(di) + self.first[1] * f64::from(dj);
                        (near + step, 0.5, step.norm())
                    }
                },
            };
            sum += at * weight;
            weights += weight;
            support += 1 + u32::from(weight > 1.0) + u32::from(weight > 2.0);
            step_px = step_px.min(step);
            if let Some(across) = self.step_across(back(1), (dj, di)) {
                step_px = step_px.min(across);
            }
            // the parallelogram with a neighbour to the side closes at the place, too
            for side in [1, -1] {
                let (si, sj) = (dj * side, di * side);
                let corner = (back(1).0 + si, back(1).1 + sj);
                if let (Some(corner), Some(beside)) =
                    (self.spot(corner), self.spot((place.0 + si, place.1 + sj)))
                {
                    sum += (near + beside - corner) * 2.0;
                    weights += 2.0;
                    support += 1;
                }
            }
        }
        (weights > 0.0 && step_px > 0.0).then(|| Expected { at: sum / weights, step_px, support })
    }

    /// The same step on a line next to that of `from`.
    fn beside(&self, from: Place, (di, dj): Place) -> Option<Vector2<f64>> {
        [1, -1].into_iter().find_map(|side| {
            let start = (from.0 + dj * side, from.1 + di * side);
            Some(self.spot((start.0 + di, start.1 + dj))? - self.spot(start)?)
        })
    }

    /// The length of the step across the direction of growth at a place.
    fn step_across(&self, from: Place, (di, dj): Place) -> Option<f64> {
        let here = self.spot(from)?;
        let there = [1, -1].into_iter().find_map(|side| self.spot((from.0 + di * side, from.1 + dj * side)));
        Some(match there {
            Some(there) => (there - here).norm(),
            None => (self.first[0] * f64::from(di) + self.first[1] * f64::from(dj)).norm(),
        })
    }

    /// The free spot nearest to an expectation, and how far off it is in steps.
    fn nearest_free(&self, expected: &Expected) -> Option<(usize, f64)> {
        let distance = |spot: usize| (self.spots[spot] - expected.at).norm();
        let free = (0..self.spots.len()).filter(|&spot| !self.taken[spot]);
        let nearest = free.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
        Some((nearest, distance(nearest) / expected.step_px))
    }
}
