//! Which of some goes with which of others, at the least cost.

/// For each line of a square table of costs its column, by shortest augmenting paths (Jonker and Volgenant 1987); and the cost.
pub(super) fn assign(size: usize, cost: impl Fn(usize, usize) -> f64) -> (Vec<usize>, f64) {
    let free = size;
    // Of each column the line that has it; the last column is where a line waits.
    let mut line_of = vec![free; size + 1];
    let (mut of_line, mut of_column) = (vec![0.0; size + 1], vec![0.0; size + 1]);
    for line in 0..size {
        let mut column = size;
        line_of[size] = line;
        let mut least = vec![f64::INFINITY; size];
        let mut before = vec![size; size];
        let mut done = vec![false; size + 1];
        loop {
            done[column] = true;
            let (here, mut step, mut next) = (line_of[column], f64::INFINITY, size);
            for other in (0..size).filter(|c| !done[*c]) {
                let reduced = cost(here, other) - of_line[here] - of_column[other];
                if reduced < least[other] {
                    (least[other], before[other]) = (reduced, column);
                }
                if least[other] < step {
                    (step, next) = (least[other], other);
                }
            }
            for other in 0..=size {
                if done[other] {
                    of_line[line_of[other]] += step;
                    of_column[other] -= step;
                } else if other < size {
                    least[other] -= step;
                }
            }
            column = next;
            if line_of[column] == free {
                break;
            }
        }
        while column != size {
            line_of[column] = line_of[before[column]];
            column = before[column];
        }
    }
    let mut columns = vec![0; size];
    (0..size).for_each(|column| columns[line_of[column]] = column);
    let total = columns.iter().enumerate().map(|(line, column)| cost(line, *column)).sum();
    (columns, total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute(size: usize, line: usize, used: u32, cost: &[f64]) -> f64 {
        if line == size {
            return 0.0;
        }
        let free = (0..size).filter(|c| used & (1 << c) == 0);
        free.map(|c| cost[line * size + c] + brute(size, line + 1, used | 1 << c, cost))
            .fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn the_cheapest_is_found(size in 1_usize..6, cost in proptest::collection::vec(0.0..9.0_f64, 36)) {
            let (columns, total) = assign(size, |line, column| cost[line * size + column]);
            let mut sorted = columns.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..size).collect::<Vec<_>>());
            prop_assert!((total - brute(size, 0, 0, &cost)).abs() < 1e-9);
        }
    }
}
