//! All partitions of a few spots, by dynamic programming over subsets (bit masks).

use alloc::vec::Vec;

/// Most handfuls that are handed on as rivals.
const MOST_RIVALS: usize = 4;
/// Most spots of which all partitions are tried.
pub(super) const MOST_PARTITIONED: usize = 7;

/// A few groups to be taken apart, and the cheapest way to put their spots together anew.
#[derive(Debug, Default)]
pub(super) struct Partition {
    spots: Vec<usize>,
    /// The groups that the spots come from, with how many each gave.
    taken: Vec<(usize, usize)>,
    subset: Vec<usize>,
    costs: Costs,
    /// The same, where what handfuls look like counts as well.
    likely: Costs,
    /// What each subset looks like; infinite where that is not asked, or more is known.
    looks_nats: Vec<f64>,
    /// Rivals, with what the cheapest partitions with them may cost.
    rivals: Vec<(f64, usize)>,
}

/// What a handful costs as one neighbour, nats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cost {
    /// As weighed in full.
    Known(f64),
    /// As it looks; `known` is what it costs otherwise, as clutter, infinite where it cannot be that.
    Looks { nats: f64, known: f64 },
}

/// What the subsets of some spots cost, by their bits.
#[derive(Debug, Default)]
struct Costs {
    /// As one neighbour.
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

    /// Their spots, one group after the other.
    pub(super) fn spots(&self) -> &[usize] {
        &self.spots
    }

    /// Whether this group was taken in.
    pub(super) fn took(&self, group: usize) -> bool {
        self.taken.iter().any(|&(taken, _)| taken == group)
    }

    /// Finds the cheapest partition; `false` when it is no better than the groups that there were.
    pub(super) fn improve(&mut self, mut nats: impl FnMut(&[usize]) -> f64) -> bool {
        let all = (1 << self.spots.len()) - 1;
        self.costs.clear();
        for mask in 1usize..=all {
            self.gather(mask);
            self.costs.whole_nats.push(nats(&self.subset));
        }
        self.costs.solve();
        self.costs.least[all].0 < self.nats_before() - 1e-9
    }

    /// Hands on a few handfuls of at most so many spots, ascending, whose cost is not known and which may be of the cheapest partition, the likeliest first:
    /// costs are no more than this less than they look.
    pub(super) fn each_rival(
        &mut self,
        slack_nats: f64,
        most_spots: usize,
        mut cost: impl FnMut(&[usize]) -> Cost,
        mut with: impl FnMut(&mut dyn Iterator<Item = usize>),
    ) {
        self.spots.sort_unstable();
        let all = (1usize << self.spots.len()) - 1;
        self.costs.clear();
        self.likely.clear();
        self.looks_nats.clear();
        self.looks_nats.push(f64::INFINITY);
        for mask in 1..=all {
            let mut cost_of_few = || {
                self.gather(mask);
                cost(&self.subset)
            };
            let few = mask.count_ones() as usize <= most_spots;
            let (known, looks) = match if few { cost_of_few() } else { Cost::Known(f64::INFINITY) } {
                Cost::Known(nats) => (nats, f64::INFINITY),
                Cost::Looks { nats, known } => (known, nats),
            };
            self.costs.whole_nats.push(known);
            self.likely.whole_nats.push(known.min(looks));
            self.looks_nats.push(looks);
        }
        self.costs.solve();
        self.likely.solve();
        let Self { spots, costs, likely, looks_nats, rivals, .. } = self;
        let known = costs.least[all].0;
        rivals.clear();
        for (part, looks) in looks_nats.iter().enumerate().skip(1) {
            let at_least = looks - slack_nats;
            let with_rest = at_least + likely.least[all & !part].0;
            if at_least < costs.whole_nats[part] && with_rest < known {
                rivals.push((with_rest, part));
            }
        }
        rivals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, part) in rivals.iter().take(MOST_RIVALS) {
            with(&mut members(spots, part));
        }
    }

    /// Hands on the parts of the cheapest partition, each with what it costs.
    pub(super) fn each_part(&self, mut with: impl FnMut(&mut dyn Iterator<Item = usize>, f64)) {
        let mut left = (1 << self.spots.len()) - 1;
        while left != 0 {
            let part = self.costs.least[left].1;
            with(&mut members(&self.spots, part), self.costs.whole_nats[part]);
            left &= !part;
        }
    }

    fn gather(&mut self, mask: usize) {
        self.subset.clear();
        self.subset.extend(members(&self.spots, mask));
    }

    fn nats_before(&self) -> f64 {
        let mut start = 0;
        let cost = |&(_, spots): &(usize, usize)| {
            let mask = ((1 << spots) - 1) << start;
            start += spots;
            self.costs.whole_nats[mask]
        };
        self.taken.iter().map(cost).sum()
    }
}

impl Costs {
    /// Those of no spots.
    fn clear(&mut self) {
        self.whole_nats.clear();
        self.whole_nats.push(0.0);
    }

    fn solve(&mut self) {
        self.least.clear();
        self.least.push((0.0, 0));
        for mask in 1..self.whole_nats.len() {
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
        fn rivals_are_of_partitions_that_may_be_cheaper_than_all_known(
            count in 2usize..=5,
            costs in prop::collection::vec((-20.0f64..20.0, any::<bool>()), 1 << 5),
            slack in 0.0f64..5.0,
        ) {
            let spots: Vec<usize> = (10..10 + count).collect();
            let of = |group: &[usize]| costs[group.iter().map(|spot| 1 << (spot - 10)).sum::<usize>()];
            let otherwise = |group: &[usize]| if group.len() == 1 { 0.0 } else { f64::INFINITY };
            let known = |group: &[usize]| match of(group) {
                (nats, true) => nats,
                _ => otherwise(group),
            };
            let likely = |group: &[usize]| known(group).min(of(group).0);
            let mut partition = Partition::default();
            partition.add(0, &spots);
            let cost = |group: &[usize]| match of(group) {
                (nats, true) => Cost::Known(nats),
                (nats, false) => Cost::Looks { nats, known: otherwise(group) },
            };
            let mut found = Vec::new();
            partition.each_rival(slack, count, cost, |rival| found.push(rival.collect::<Vec<_>>()));
            let cheapest_known = cheapest(&spots, &known);
            let mut rivals: Vec<(f64, Vec<usize>)> = (1usize..1 << count)
                .map(|mask| members(&spots, mask).collect::<Vec<_>>())
                .filter(|group| !of(group).1 && of(group).0 - slack < known(group))
                .map(|group| {
                    let rest: Vec<usize> = spots.iter().copied().filter(|spot| !group.contains(spot)).collect();
                    (of(&group).0 - slack + cheapest(&rest, &likely), group)
                })
                .filter(|(nats, _)| *nats < cheapest_known)
                .collect();
            rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
            prop_assert_eq!(found.len(), rivals.len().min(MOST_RIVALS));
            for (found, (_, expected)) in found.iter().zip(&rivals) {
                prop_assert_eq!(found, expected);
            }
        }

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
