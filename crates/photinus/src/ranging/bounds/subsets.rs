//! Which m of n markers lie closest together: the least diameter over all subsets of each size.
//!
//! With the value of a pair growing with its angle, the least diameter is the smallest widest angle that m
//! spots can show; with a value that falls with the angle it is, mirrored, the largest narrowest angle. One
//! function does both.

use alloc::vec;
use alloc::vec::Vec;

/// Up to this many markers the least diameters are exact: 2^8 subsets.
const EXACT: usize = 8;

/// A symmetric table of pair values, by markers.
#[derive(Clone, Debug)]
pub(super) struct PairValues {
    values: Vec<f64>,
    side: usize,
}

impl PairValues {
    /// Room for `side` markers.
    pub(super) fn new(side: usize) -> Self {
        Self { values: vec![0.0; side * side], side }
    }

    pub(super) fn set(&mut self, i: usize, j: usize, value: f64) {
        self.values[i * self.side + j] = value;
        self.values[j * self.side + i] = value;
    }

    fn get(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.side + j]
    }
}

/// For each m from 2, in `least[m - 2]`: a lower bound of the least diameter (largest pair value) among the
/// m-subsets of the first `count` markers, exact up to [`EXACT`] of them. Sizes past `count` are left alone.
pub(super) fn least_diameters(values: &PairValues, count: usize, least: &mut [f64]) {
    if count <= EXACT {
        exact(values, count, least);
    } else {
        for value in least.iter_mut().take(count - 1) {
            *value = f64::NEG_INFINITY;
        }
        by_neighbours(values, count, least);
        by_disjoint_pairs(values, count, least);
    }
}

fn exact(values: &PairValues, count: usize, least: &mut [f64]) {
    let mut diameter = [f64::NEG_INFINITY; 1 << EXACT];
    for value in least.iter_mut().take(count.saturating_sub(1)) {
        *value = f64::INFINITY;
    }
    for subset in 1..1_usize << count {
        let size = subset.count_ones() as usize;
        if size < 2 {
            continue;
        }
        // Every pair misses the first member, or misses the last, or is these two.
        let (first, last) = (subset.trailing_zeros() as usize, subset.ilog2() as usize);
        let rest = diameter[subset & !(1 << first)].max(diameter[subset & !(1 << last)]);
        diameter[subset] = rest.max(values.get(first, last));
        if let Some(value) = least.get_mut(size - 2) {
            *value = value.min(diameter[subset]);
        }
    }
}

/// A subset of m that holds marker i is at least as wide as i and its (m - 1)-th nearest.
fn by_neighbours(values: &PairValues, count: usize, least: &mut [f64]) {
    let mut nearest = vec![f64::INFINITY; count - 1];
    let mut row = Vec::with_capacity(count - 1);
    for i in 0..count {
        row.clear();
        row.extend((0..count).filter(|&j| j != i).map(|j| values.get(i, j)));
        row.sort_unstable_by(f64::total_cmp);
        for (nearest, value) in nearest.iter_mut().zip(&row) {
            *nearest = nearest.min(*value);
        }
    }
    for (least, nearest) in least.iter_mut().zip(&nearest) {
        *least = least.max(*nearest);
    }
}

/// A subset that leaves out k markers keeps one of any k + 1 pairs without a common marker.
fn by_disjoint_pairs(values: &PairValues, count: usize, least: &mut [f64]) {
    let mut free: Vec<usize> = (0..count).collect();
    for left_out in 0..count / 2 {
        let mut widest = (f64::NEG_INFINITY, 0, 1);
        for a in 1..free.len() {
            for b in 0..a {
                let value = values.get(free[a], free[b]);
                if value > widest.0 {
                    widest = (value, b, a);
                }
            }
        }
        let (value, b, a) = widest;
        free.remove(a);
        free.remove(b);
        if let Some(least) = least.get_mut(count - left_out - 2) {
            *least = least.max(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a plane, spread without a pattern, and their distances.
    fn scattered(count: usize, seed: u32) -> PairValues {
        let place = |i: usize, step: f64| (i as f64 * step + f64::from(seed) * 0.37).fract();
        let mut values = PairValues::new(count);
        for i in 0..count {
            for j in 0..i {
                let (du, dv) = (place(i, 0.618) - place(j, 0.618), place(i, 0.755) - place(j, 0.755));
                values.set(i, j, libm::hypot(du, dv));
            }
        }
        values
    }

    fn brute_force(values: &PairValues, count: usize, size: usize) -> f64 {
        let diameter = |subset: usize| {
            let inside = |i: &usize| subset & (1 << i) != 0;
            let pairs = (0..count).filter(inside).flat_map(|i| (0..i).filter(inside).map(move |j| (i, j)));
            pairs.map(|(i, j)| values.get(i, j)).fold(f64::NEG_INFINITY, f64::max)
        };
        let sized = |subset: &usize| subset.count_ones() as usize == size;
        (0..1_usize << count).filter(sized).map(diameter).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn small_sets_are_exact() {
        for (count, seed) in [(2, 1), (3, 2), (5, 3), (8, 4), (8, 5)] {
            let values = scattered(count, seed);
            let mut least = vec![0.0; count - 1];
            least_diameters(&values, count, &mut least);
            for size in 2..=count {
                let expected = brute_force(&values, count, size);
                assert!((least[size - 2] - expected).abs() < 1e-15, "{size} of {count}");
            }
        }
    }

    #[test]
    fn large_sets_are_bounded_from_below_and_exact_at_both_ends() {
        for seed in 0..5 {
            let values = scattered(11, seed);
            let mut least = vec![0.0; 10];
            least_diameters(&values, 11, &mut least);
            for size in 2..=11 {
                let expected = brute_force(&values, 11, size);
                let bound = least[size - 2];
                assert!(bound <= expected && bound > 0.4 * expected, "{size}: {bound} {expected}");
            }
            assert!((least[0] - brute_force(&values, 11, 2)).abs() < 1e-15);
            assert!((least[9] - brute_force(&values, 11, 11)).abs() < 1e-15);
        }
    }
}
