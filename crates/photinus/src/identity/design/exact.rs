//! The largest set of candidates without conflicts, by looking at all of them: branch and bound.
//!
//! What is left at a branch is split greedily into groups whose members all conflict with each other: a set has one of each group
//! at most, so that no set in the branch is larger than the number of groups (P. San Segundo, D. Rodriguez-Losada, A. Jimenez, "An
//! exact bit-parallel algorithm for the maximum clique problem", Computers & Operations Research 38, 2011, on the complement).

use alloc::vec;
use alloc::vec::Vec;

use super::conflicts::{Conflicts, first};

/// How the search ended.
pub(super) enum Outcome {
    /// No set is larger.
    Most(Vec<usize>),
    /// There were more branches than allowed; the largest set so far.
    GaveUp(Vec<usize>),
}

/// Searches all sets that are larger than `known`, looking at this many branches at most.
pub(super) fn search(conflicts: &Conflicts, known: &[usize], branches: u64) -> Outcome {
    // those with few conflicts come first, so that groups are few
    let mut order: Vec<u32> = (0..conflicts.len() as u32).collect();
    order.sort_by_key(|&v| conflicts.with(v as usize).len());
    let mut place = vec![0; order.len()];
    for (at, &v) in order.iter().enumerate() {
        place[v as usize] = at as u32;
    }
    let renamed = |v: &u32| conflicts.with(*v as usize).iter().map(|&other| place[other as usize]).collect();
    let ordered = Conflicts::of(order.iter().map(renamed).collect());
    let mut search = Search { conflicts: &ordered, left: branches, set: Vec::new(), best: Vec::new() };
    search.best = known.iter().map(|&v| place[v] as usize).collect();
    let mut all = vec![0_u64; ordered.len().div_ceil(64)];
    (0..ordered.len()).for_each(|v| all[v / 64] |= 1 << (v % 64));
    let finished = search.branch(&all);
    let best = search.best.iter().map(|&v| order[v] as usize).collect();
    if finished { Outcome::Most(best) } else { Outcome::GaveUp(best) }
}

struct Search<'a> {
    conflicts: &'a Conflicts,
    left: u64,
    set: Vec<usize>,
    best: Vec<usize>,
}

impl Search<'_> {
    /// All sets that hold `set` and further ones of `open`; `false` when there were too many branches.
    fn branch(&mut self, open: &[u64]) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        let mut open = open.to_vec();
        // a set of the groups before has no more members than there are groups
        for (v, groups) in self.grouped(&open).into_iter().rev() {
            if self.set.len() + groups <= self.best.len() {
                return true;
            }
            self.set.push(v);
            let mut rest: Vec<u64> =
                open.iter().zip(self.conflicts.row(v)).map(|(open, row)| open & !row).collect();
            rest[v / 64] &= !(1 << (v % 64));
            if rest.iter().all(|&bits| bits == 0) {
                if self.set.len() > self.best.len() {
                    self.best.clone_from(&self.set);
                }
            } else if !self.branch(&rest) {
                return false;
            }
            self.set.pop();
            open[v / 64] &= !(1 << (v % 64));
        }
        true
    }

    /// Those that are open, group by group, each with how many groups there are up to its own.
    fn grouped(&self, open: &[u64]) -> Vec<(usize, usize)> {
        let mut left = open.to_vec();
        let mut grouped = Vec::new();
        let mut groups = 0;
        while left.iter().any(|&bits| bits != 0) {
            groups += 1;
            let mut may_join = left.clone();
            while let Some(v) = first(&may_join) {
                grouped.push((v, groups));
                left[v / 64] &= !(1 << (v % 64));
                may_join.iter_mut().zip(self.conflicts.row(v)).for_each(|(bits, row)| *bits &= row);
            }
        }
        grouped
    }
}
