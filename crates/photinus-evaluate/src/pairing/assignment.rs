//! Which of the rows goes with which of the columns, so that the sum of costs is least.
//!
//! Only pairs that are listed may be joined, and leaving a row alone costs 1: a listed pair costs less. Pairs fall into
//! islands that share nothing; each is solved by shortest augmenting paths (D. F. Crouse, "On implementing 2D
//! rectangular assignment algorithms", IEEE TAES 2016).

use std::collections::BTreeMap;

/// What it costs to leave a row alone.
const ALONE: f64 = 1.0;

/// A row and a column that may be joined, at a cost from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) row: usize,
    pub(crate) column: usize,
    pub(crate) cost: f64,
}

/// The pairs (row, column) of the cheapest assignment, by row.
pub(crate) fn assign(candidates: &[Candidate]) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> =
        islands(candidates).iter().flat_map(|island| solve(island)).collect();
    pairs.sort_unstable();
    pairs
}

/// Candidates that are linked through rows or columns, together.
fn islands(candidates: &[Candidate]) -> Vec<Vec<Candidate>> {
    let rows = candidates.iter().map(|candidate| candidate.row + 1).max().unwrap_or(0);
    let columns = candidates.iter().map(|candidate| candidate.column + 1).max().unwrap_or(0);
    let mut parent: Vec<usize> = (0..rows + columns).collect();
    let root = |parent: &mut Vec<usize>, mut node: usize| {
        while parent[node] != node {
            parent[node] = parent[parent[node]];
            node = parent[node];
        }
        node
    };
    for candidate in candidates {
        let (a, b) = (root(&mut parent, candidate.row), root(&mut parent, rows + candidate.column));
        parent[a.max(b)] = a.min(b);
    }
    let mut islands: BTreeMap<usize, Vec<Candidate>> = BTreeMap::new();
    for &candidate in candidates {
        islands.entry(root(&mut parent, candidate.row)).or_default().push(candidate);
    }
    islands.into_values().collect()
}

/// The cheapest pairs of one island.
fn solve(island: &[Candidate]) -> Vec<(usize, usize)> {
    let numbered = |of: fn(&Candidate) -> usize| {
        let mut all: Vec<usize> = island.iter().map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let (rows, columns) = (numbered(|candidate| candidate.row), numbered(|candidate| candidate.column));
    // Every row has a column of its own that stands for being left alone.
    let width = columns.len() + rows.len();
    let mut cost = vec![f64::INFINITY; rows.len() * width];
    for row in 0..rows.len() {
        cost[row * width + columns.len() + row] = ALONE;
    }
    for candidate in island {
        let (Ok(row), Ok(column)) =
            (rows.binary_search(&candidate.row), columns.binary_search(&candidate.column))
        else {
            continue;
        };
        cost[row * width + column] = candidate.cost;
    }
    let row_of_column = shortest_augmenting_paths(&cost, rows.len(), width);
    let joined = row_of_column.iter().take(columns.len()).enumerate();
    joined.filter_map(|(column, row)| row.map(|row| (rows[row], columns[column]))).collect()
}

/// The row of every column; every row has a column of finite cost that is its own.
fn shortest_augmenting_paths(cost: &[f64], rows: usize, width: usize) -> Vec<Option<usize>> {
    let mut row_of_column: Vec<Option<usize>> = vec![None; width];
    let mut column_of_row: Vec<Option<usize>> = vec![None; rows];
    let (mut row_price, mut column_price) = (vec![0.0; rows], vec![0.0; width]);
    for start in 0..rows {
        let (mut reach, mut from) = (vec![f64::INFINITY; width], vec![start; width]);
        let (mut settled, mut visited) = (vec![false; width], vec![start]);
        let (mut row, mut least) = (start, 0.0);
        let end = loop {
            for column in (0..width).filter(|&column| !settled[column]) {
                let through = least + cost[row * width + column] - row_price[row] - column_price[column];
                if through < reach[column] {
                    (reach[column], from[column]) = (through, row);
                }
            }
            let open = (0..width).filter(|&column| !settled[column]);
            let Some(nearest) = open.min_by(|&a, &b| reach[a].total_cmp(&reach[b])) else {
                return row_of_column;
            };
            (settled[nearest], least) = (true, reach[nearest]);
            match row_of_column[nearest] {
                None => break nearest,
                Some(taken_by) => {
                    visited.push(taken_by);
                    row = taken_by;
                }
            }
        };
        for &row in &visited {
            let reached = column_of_row[row].map_or(0.0, |column| reach[column]);
            row_price[row] += least - reached;
        }
        for column in (0..width).filter(|&column| settled[column]) {
            column_price[column] -= least - reach[column];
        }
        let mut column = end;
        loop {
            let row = from[column];
            row_of_column[column] = Some(row);
            let before = column_of_row[row].replace(column);
            match before {
                Some(before) if row != start => column = before,
                _ => break,
            }
        }
    }
    row_of_column
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn total(candidates: &[Candidate], pairs: &[(usize, usize)], rows: usize) -> f64 {
        let cost = |&(row, column): &(usize, usize)| {
            candidates.iter().find(|c| (c.row, c.column) == (row, column)).unwrap().cost
        };
        pairs.iter().map(cost).sum::<f64>() + (rows - pairs.len()) as f64 * ALONE
    }

    /// Every way to join the rows from `row` on.
    fn cheapest(candidates: &[Candidate], row: usize, rows: usize, taken: &mut Vec<usize>) -> f64 {
        if row == rows {
            return 0.0;
        }
        let mut least = ALONE + cheapest(candidates, row + 1, rows, taken);
        for candidate in candidates.iter().filter(|candidate| candidate.row == row) {
            if !taken.contains(&candidate.column) {
                taken.push(candidate.column);
                least = least.min(candidate.cost + cheapest(candidates, row + 1, rows, taken));
                taken.pop();
            }
        }
        least
    }

    #[test]
    fn the_nearest_is_given_up_where_both_gain() {
        let candidates = [(0, 0, 0.1), (0, 1, 0.2), (1, 0, 0.15)];
        let candidates = candidates.map(|(row, column, cost)| Candidate { row, column, cost });
        assert_eq!(assign(&candidates), [(0, 1), (1, 0)]);
        assert_eq!(assign(&[]), []);
    }

    proptest! {
        #[test]
        fn no_other_assignment_is_cheaper(
            cells in proptest::collection::vec(proptest::option::weighted(0.6, 0.0..1.0f64), 30),
        ) {
            let candidates: Vec<Candidate> = cells.iter().enumerate()
                .filter_map(|(cell, cost)| cost.map(|cost| Candidate { row: cell / 6, column: cell % 6, cost }))
                .collect();
            let pairs = assign(&candidates);
            let mut columns: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
            columns.sort_unstable();
            columns.dedup();
            prop_assert_eq!(columns.len(), pairs.len());
            let least = cheapest(&candidates, 0, 5, &mut Vec::new());
            prop_assert!((total(&candidates, &pairs, 5) - least).abs() < 1e-12);
        }
    }
}
