//! All partitions of a few spots, by dynamic programming over subsets (bit masks).

use alloc::vec::Vec;

/// Most spots of which all partitions are tried.
pub(super) const MOST_PARTITIONED: usize = 7;

/// A few groups to be taken apart, and the cheapest way to put their spots together anew.
#[derive(Debug, Default)]
pub(super) struct Partition {
    spots: Vec<usize>,
    /// The groups that the spots come from, with how many each gave.
    taken: Vec<(usize, usize)>,
    subset: Vec<usize>,
    /// What each subset costs as one neighbour.
    whole_nats: Vec<f64>,
    /// The least cost of each subset, and the part of it that holds its first spot.
    least: Vec<(f64, usize)>,
}

impl Partition {
    pub(super) fn clear(&mut self) {
        self.spots.clear();
        self.taken.clear();
    }

    /// Takes in a group.
    pub(super) fn add(&mut self, group: usize, members: &[usize]) {
        self.spots.extend_from_slice(members);
        self.taken.push((group, members.len()));
    }

    /// How many groups were taken in.
    pub(super) fn groups(&self) -> usize {
        self.taken.len()
    }

    /// How many spots they have.
    pub(super) fn spots(&self) -> usize {
        self.spots.len()
    }

    /// Whether this group was taken in.
    pub(super) fn took(&self, group: usize) -> bool {
        self.taken.iter().any(|&(taken, _)| taken == group)
    }

    /// Finds the cheapest partition; `false` when it is no better than the groups that there were.
    pub(super) fn improve(&mut self, mut nats: impl FnMut(&[usize]) -> f64) -> bool {
        let all = (1 << self.spots.len()) - 1;
        self.whole_nats.clear();
        self.whole_nats.push(0.0);
        for mask in 1usize..=all {
            self.subset.clear();
            self.subset.extend(members(&self.spots, mask));
            self.whole_nats.push(nats(&self.subset));
        }
        self.solve(all);
        self.least[all].0 < self.nats_before() - 1e-9
    }

    /// Hands on the parts of the cheapest partition, each with what it costs.
    pub(super) fn each_part(&self, mut with: impl FnMut(&mut dyn Iterator<Item = usize>, f64)) {
        let mut left = (1 << self.spots.len()) - 1;
        while left != 0 {
            let part = self.least[left].1;
            with(&mut members(&self.spots, part), self.whole_nats[part]);
            left &= !part;
        }
    }

    fn solve(&mut self, all: usize) {
        self.least.clear();
        self.least.push((0.0, 0));
        for mask in 1..=all {
            let first = mask & mask.wrapping_neg();
            let rest = mask & !first;
            let mut least = (f64::INFINITY, first);
            let mut with = rest;
            loop {
                let part = with | first;
                let nats = self.whole_nats[part] + self.least[mask & !part].0;
                if nats < least.0 {
                    least = (nats, part);
                }
                if with == 0 {
                    break;
                }
                with = (with - 1) & rest;
            }
            self.least.push(least);
        }
    }

    fn nats_before(&self) -> f64 {
        let mut start = 0;
        let cost = |&(_, spots): &(usize, usize)| {
            let mask = ((1 << spots) - 1) << start;
            start += spots;
            self.whole_nats[mask]
        };
        self.taken.iter().map(cost).sum()
    }
}

fn members(spots: &[usize], mask: usize) -> impl Iterator<Item = usize> + '_ {
    spots.iter().enumerate().filter(move |(bit, _)| mask >> bit & 1 == 1).map(|(_, &spot)| spot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The obviously right version: put the first spot with every subset of the rest.
    fn cheapest(spots: &[usize], nats: &dyn Fn(&[usize]) -> f64) -> f64 {
        let Some((&first, rest)) = spots.split_first() else { return 0.0 };
        (0..1 << rest.len()).fold(f64::INFINITY, |least, mask| {
            let mut part = vec![first];
            part.extend(members(rest, mask));
            let others: Vec<usize> = members(rest, !mask & ((1 << rest.len()) - 1)).collect();
            least.min(nats(&part) + cheapest(&others, nats))
        })
    }

    proptest! {
        #[test]
        fn the_partition_is_the_cheapest_of_all(
            count in 2usize..=MOST_PARTITIONED,
            costs in prop::collection::vec(0.0f64..20.0, 1 << MOST_PARTITIONED),
        ) {
            let spots: Vec<usize> = (10..10 + count).collect();
            let nats = |group: &[usize]| costs[group.iter().map(|spot| 1 << (spot - 10)).sum::<usize>()];
            let mut partition = Partition::default();
            partition.add(0, &spots[..1]);
            partition.add(1, &spots[1..]);
            let better = partition.improve(nats);
            let least = cheapest(&spots, &nats);
            prop_assert_eq!(better, least < nats(&spots[..1]) + nats(&spots[1..]) - 1e-9);
            let (mut total, mut seen) = (0.0, Vec::new());
            partition.each_part(|part, nats| {
                total += nats;
                seen.extend(part);
            });
            seen.sort_unstable();
            prop_assert!((total - least).abs() < 1e-9);
            prop_assert_eq!(seen, spots);
        }
    }
}
