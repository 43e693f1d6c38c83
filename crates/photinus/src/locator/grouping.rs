//! Which spots are one neighbour.
//!
//! In: the sightings of a frame. Out: groups of them, each a neighbour, by the least total cost; what a group costs,
//! [`Matcher`] says. Three steps, the later ones for fewer and fewer spots:
//!
//! 1. the tree of nearest neighbours (single linkage): every neighbour that keeps its distance in the image is a branch;
//! 2. the cheapest cut of that tree into branches, from the top down, without looking into a branch that cannot be beaten;
//! 3. where groups overlap in the image (side by side, one behind the other), the cheapest of all partitions of a few
//!    spots, exactly.

use nalgebra::{Unit, Vector3};

use super::Sighting;
use super::matching::{IMPOSSIBLE, Matcher, NEIGHBOUR_NATS};

/// Most spots of which all partitions are tried.
const MOST_PARTITIONED: usize = 7;
/// Most rounds of that in one frame: the time of a frame is bounded.
const MOST_ROUNDS: usize = 12;
/// A group that costs more than this, nats, may not be one: half-way from a good match to two neighbours.
const DOUBTFUL_NATS: f64 = 1.5 * NEIGHBOUR_NATS;
/// Larger groups are not taken apart spot by spot.
const LARGEST_ORDERED: usize = 6;

/// The groups of one frame, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Groups {
    nearest: Vec<(f64, usize)>,
    links: Vec<(f64, usize, usize)>,
    branches: Vec<Branch>,
    roots: Vec<usize>,
    order: Vec<usize>,
    open: Vec<usize>,
    members: Vec<usize>,
    ends: Vec<usize>,
    nats: Vec<f64>,
    circles: Vec<Circle>,
    partition: Partition,
}

/// A branch of the tree: a spot, or two branches.
#[derive(Clone, Copy, Debug)]
struct Branch {
    children: Option<(usize, usize)>,
    start: usize,
    spots: usize,
    /// What it costs as one neighbour.
    whole_nats: f64,
    /// The least that it costs, whole or cut.
    nats: f64,
    looked_into: bool,
}

/// Where a group is in the image.
#[derive(Clone, Copy, Debug)]
struct Circle {
    middle: Vector3<f64>,
    radius_rad: f64,
    /// How far other spots of the same neighbour may be.
    reach_rad: f64,
    /// Whether the group is explained so poorly that its spots may belong elsewhere.
    doubtful: bool,
}

impl Groups {
    /// Finds the groups of `sightings`.
    pub(super) fn sort_out(
        &mut self,
        sightings: &[Sighting],
        gravity: Option<&Unit<Vector3<f64>>>,
        matcher: &mut Matcher,
    ) {
        self.members.clear();
        self.ends.clear();
        self.nats.clear();
        if sightings.is_empty() {
            return;
        }
        self.link_nearest(sightings);
        self.grow_tree(sightings.len());
        self.cost_from_the_top(sightings, gravity, matcher);
        self.cut();
        self.part_overlapping(sightings, gravity, matcher);
        self.put_in_order();
    }

    /// The groups, each ascending, in the order of their first member.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[usize]> {
        (0..self.ends.len()).map(|group| self.group(group))
    }

    fn group(&self, group: usize) -> &[usize] {
        let start = if group == 0 { 0 } else { self.ends[group - 1] };
        &self.members[start..self.ends[group]]
    }

    /// The shortest tree that joins all bearings (Prim), its links from the shortest to the longest.
    fn link_nearest(&mut self, sightings: &[Sighting]) {
        let gap = |a: usize, b: usize| {
            (sightings[a].bearing.vector() - sightings[b].bearing.vector()).norm_squared()
        };
        self.nearest.clear();
        self.nearest.extend((0..sightings.len()).map(|spot| (gap(0, spot), 0)));
        self.links.clear();
        let mut joined = 0;
        for _ in 1..sightings.len() {
            self.nearest[joined].0 = f64::NAN;
            let outside = self.nearest.iter().enumerate().filter(|(_, (gap, _))| !gap.is_nan());
            let closest = outside.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
            let Some((spot, &(length, from))) = closest else { break };
            self.links.push((length, from, spot));
            joined = spot;
            for (other, nearest) in self.nearest.iter_mut().enumerate() {
                let length = gap(joined, other);
                if length < nearest.0 {
                    *nearest = (length, joined);
                }
            }
        }
        self.links.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    }

    fn grow_tree(&mut self, spots: usize) {
        let leaf = Branch {
            children: None,
            start: 0,
            spots: 1,
            whole_nats: IMPOSSIBLE,
            nats: IMPOSSIBLE,
            looked_into: false,
        };
        self.branches.clear();
        self.branches.resize(spots, leaf);
        self.roots.clear();
        self.roots.extend(0..spots);
        for &(_, a, b) in &self.links {
            let (a, b) = (root(&mut self.roots, a), root(&mut self.roots, b));
            let joined = self.branches.len();
            let spots = self.branches[a].spots + self.branches[b].spots;
            self.branches.push(Branch { children: Some((a, b)), spots, ..leaf });
            self.roots.push(joined);
            self.roots[a] = joined;
            self.roots[b] = joined;
        }
        // From the top down every branch gets a stretch of the order of spots.
        self.order.clear();
        self.order.resize(spots, 0);
        for branch in (0..self.branches.len()).rev() {
            let Branch { children, start, .. } = self.branches[branch];
            match children {
                Some((a, b)) => {
                    self.branches[a].start = start;
                    self.branches[b].start = start + self.branches[a].spots;
                }
                None => self.order[start] = branch,
            }
        }
    }

    fn cost_from_the_top(
        &mut self,
        sightings: &[Sighting],
        gravity: Option<&Unit<Vector3<f64>>>,
        matcher: &mut Matcher,
    ) {
        self.open.clear();
        self.open.push(self.branches.len() - 1);
        while let Some(at) = self.open.pop() {
            let branch = &mut self.branches[at];
            branch.looked_into = true;
            let Some((a, b)) = branch.children else {
                branch.whole_nats = matcher.lone_nats();
                branch.nats = branch.whole_nats;
                continue;
            };
            if branch.spots <= matcher.most_visible() {
                let group = &self.order[branch.start..branch.start + branch.spots];
                branch.whole_nats = matcher.nats(sightings, group, gravity);
                branch.nats = branch.whole_nats;
            }
            // Cut, it would be two neighbours at the least.
            if branch.whole_nats > 2.0 * NEIGHBOUR_NATS {
                self.open.extend([a, b]);
            }
        }
        for at in 0..self.branches.len() {
            let Branch { children: Some((a, b)), looked_into: true, whole_nats, .. } = self.branches[at]
            else {
                continue;
            };
            if self.branches[a].looked_into {
                self.branches[at].nats = whole_nats.min(self.branches[a].nats + self.branches[b].nats);
            }
        }
    }

    fn cut(&mut self) {
        self.open.clear();
        self.open.push(self.branches.len() - 1);
        while let Some(at) = self.open.pop() {
            let Branch { children, start, spots, whole_nats, nats, .. } = self.branches[at];
            match children {
                Some((a, b)) if nats < whole_nats => self.open.extend([b, a]),
                _ => {
                    self.members.extend_from_slice(&self.order[start..start + spots]);
                    self.ends.push(self.members.len());
                    self.nats.push(nats);
                }
            }
        }
    }

    /// Takes groups that overlap in the image apart and puts them together anew, at the least cost.
    fn part_overlapping(
        &mut self,
        sightings: &[Sighting],
        gravity: Option<&Unit<Vector3<f64>>>,
        matcher: &mut Matcher,
    ) {
        if matcher.most_visible() > LARGEST_ORDERED {
            return;
        }
        let (mut rounds, mut first) = (0, 0);
        while first < self.ends.len() && rounds < MOST_ROUNDS {
            self.measure_circles(sightings, matcher);
            self.partition.spots.clear();
            self.partition.groups.clear();
            self.gather_overlapping(first);
            if self.partition.groups.len() > 1 {
                rounds += 1;
                if self.partition.improve(sightings, gravity, matcher) {
                    self.replace_partitioned();
                    first = 0;
                    continue;
                }
            }
            first += 1;
        }
    }

    fn measure_circles(&mut self, sightings: &[Sighting], matcher: &Matcher) {
        self.circles.clear();
        for group in 0..self.ends.len() {
            let members = self.group(group);
            let direction = |&spot: &usize| sightings[spot].bearing.vector();
            let middle = members.iter().map(direction).sum::<Vector3<f64>>().normalize();
            let off = |spot: &usize| (direction(spot) - middle).norm();
            let radius_rad = members.iter().map(off).fold(0.0, f64::max);
            let doubtful = members.len() == 1 || self.nats[group] > DOUBTFUL_NATS;
            let widest = |&spot: &usize| matcher.widest_rad(&sightings[spot]);
            let reach_rad =
                if doubtful { members.iter().map(widest).fold(f64::INFINITY, f64::min) } else { 0.0 };
            self.circles.push(Circle { middle, radius_rad, reach_rad, doubtful });
        }
    }

    /// The group `first` and those that may have to do with it, the nearest first, as far as they can be partitioned.
    fn gather_overlapping(&mut self, first: usize) {
        let own = self.circles[first];
        self.open.clear();
        let near = |&other: &usize| {
            let circle = self.circles[other];
            let touch = 1.5 * (own.radius_rad + circle.radius_rad);
            let reach = if own.doubtful { touch.max(own.reach_rad) } else { touch };
            other == first || (circle.middle - own.middle).norm() < reach
        };
        self.open.extend((0..self.ends.len()).filter(near));
        let gap = |group: usize| (self.circles[group].middle - own.middle).norm_squared();
        self.open.sort_unstable_by(|&a, &b| gap(a).total_cmp(&gap(b)).then(a.cmp(&b)));
        for index in 0..self.open.len() {
            let group = self.open[index];
            let start = if group == 0 { 0 } else { self.ends[group - 1] };
            let spots = &self.members[start..self.ends[group]];
            if self.partition.spots.len() + spots.len() <= MOST_PARTITIONED {
                self.partition.spots.extend_from_slice(spots);
                self.partition.groups.push((group, spots.len()));
            }
        }
    }

    fn replace_partitioned(&mut self) {
        let (mut members, mut ends) =
            (std::mem::take(&mut self.partition.members), std::mem::take(&mut self.partition.ends));
        members.clear();
        ends.clear();
        let mut kept = 0;
        for group in 0..self.ends.len() {
            if self.partition.groups.iter().all(|&(taken, _)| taken != group) {
                members.extend_from_slice(self.group(group));
                ends.push(members.len());
                self.nats[kept] = self.nats[group];
                kept += 1;
            }
        }
        self.nats.truncate(kept);
        for &mask in &self.partition.best {
            members.extend(self.partition.spots_of(mask));
            ends.push(members.len());
            self.nats.push(self.partition.whole_nats[mask]);
        }
        self.partition.members = std::mem::replace(&mut self.members, members);
        self.partition.ends = std::mem::replace(&mut self.ends, ends);
    }

    /// Members ascending, groups in the order of their first member.
    fn put_in_order(&mut self) {
        let mut start = 0;
        self.open.clear();
        for (group, &end) in self.ends.iter().enumerate() {
            self.members[start..end].sort_unstable();
            start = end;
            self.open.push(group);
        }
        let mut order = std::mem::take(&mut self.open);
        order.sort_unstable_by_key(|&group| self.group(group)[0]);
        let (mut members, mut ends) =
            (std::mem::take(&mut self.partition.members), std::mem::take(&mut self.partition.ends));
        members.clear();
        ends.clear();
        for &group in &order {
            members.extend_from_slice(self.group(group));
            ends.push(members.len());
        }
        self.open = order;
        self.partition.members = std::mem::replace(&mut self.members, members);
        self.partition.ends = std::mem::replace(&mut self.ends, ends);
    }
}

fn root(roots: &mut [usize], mut branch: usize) -> usize {
    while roots[branch] != branch {
        roots[branch] = roots[roots[branch]];
        branch = roots[branch];
    }
    branch
}

/// All partitions of a few spots, by dynamic programming over subsets (bit masks).
#[derive(Debug, Default)]
struct Partition {
    spots: Vec<usize>,
    /// The groups that the spots come from, with how many each gave.
    groups: Vec<(usize, usize)>,
    group: Vec<usize>,
    whole_nats: Vec<f64>,
    least: Vec<(f64, usize)>,
    best: Vec<usize>,
    members: Vec<usize>,
    ends: Vec<usize>,
}

impl Partition {
    fn spots_of(&self, mask: usize) -> impl Iterator<Item = usize> + '_ {
        self.spots.iter().enumerate().filter(move |(bit, _)| mask >> bit & 1 == 1).map(|(_, &spot)| spot)
    }

    /// Finds the cheapest partition; `false` when it is the one that there was.
    fn improve(
        &mut self,
        sightings: &[Sighting],
        gravity: Option<&Unit<Vector3<f64>>>,
        matcher: &mut Matcher,
    ) -> bool {
        let all = (1 << self.spots.len()) - 1;
        self.whole_nats.clear();
        self.whole_nats.push(0.0);
        for mask in 1usize..=all {
            let count = mask.count_ones() as usize;
            let nats = if count == 1 {
                matcher.lone_nats()
            } else if count > matcher.most_visible() {
                IMPOSSIBLE
            } else {
                let mut group = std::mem::take(&mut self.group);
                group.clear();
                group.extend(self.spots_of(mask));
                let nats = matcher.nats(sightings, &group, gravity);
                self.group = group;
                nats
            };
            self.whole_nats.push(nats);
        }
        self.solve(all);
        let before = self.nats_before();
        let mut left = all;
        self.best.clear();
        while left != 0 {
            let part = self.least[left].1;
            self.best.push(part);
            left &= !part;
        }
        self.least[all].0 < before - 1e-9
    }

    /// The least cost of every subset, and the part in it that holds its first spot.
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
        self.groups.iter().map(cost).sum()
    }
}
