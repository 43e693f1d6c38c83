//! The trees of nearest neighbours (single linkage), and their cheapest cut. What is unlikely a marker is as far away as it is unlikely: it joins last.

use alloc::vec::Vec;

use crate::locator::context::Context;
use crate::locator::matching::{IMPOSSIBLE, NEIGHBOUR_NATS};

/// Trees over the sightings of a frame: spots are leaves, every branch joins the two that are nearest.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// By how much the square of a distance to each spot is longer: one over the probability that it is a marker.
    doubts: Vec<f64>,
    /// From the shortest to the longest.
    links: Vec<(f64, usize, usize)>,
    /// Branches that are part of no other.
    tops: Vec<usize>,
    branches: Vec<Branch>,
    roots: Vec<usize>,
    /// The spots, so that those of a branch are together.
    order: Vec<usize>,
    open: Vec<usize>,
}

/// A spot, or two branches.
#[derive(Clone, Copy, Debug)]
struct Branch {
    children: Option<(usize, usize)>,
    start: usize,
    spots: usize,
    /// What it costs as one neighbour.
    whole_nats: f64,
    /// The least that it costs, whole or cut.
    nats: f64,
    looked_at: bool,
}

const LEAF: Branch =
    Branch { children: None, start: 0, spots: 1, whole_nats: IMPOSSIBLE, nats: IMPOSSIBLE, looked_at: false };

impl Tree {
    /// Grows the trees of a frame's observations.
    pub(super) fn grow(&mut self, context: &Context<'_>) {
        self.link_nearest(context);
        self.join(context.sightings.len());
        self.order_spots(context.sightings.len());
    }

    /// Asks what branches cost as one neighbour, from the top down. A branch that costs less than two neighbours must is
    /// not looked into.
    pub(super) fn cost(&mut self, mut whole_nats: impl FnMut(&[usize]) -> f64) {
        self.open.clear();
        self.open.extend(self.tops.iter().rev());
        while let Some(at) = self.open.pop() {
            let branch = &mut self.branches[at];
            branch.looked_at = true;
            branch.whole_nats = whole_nats(&self.order[branch.start..branch.start + branch.spots]);
            branch.nats = branch.whole_nats;
            if let Some((a, b)) = branch.children
                && branch.whole_nats > 2.0 * NEIGHBOUR_NATS
            {
                self.open.extend([a, b]);
            }
        }
        for at in 0..self.branches.len() {
            let Branch { children: Some((a, b)), looked_at: true, whole_nats, .. } = self.branches[at] else {
                continue;
            };
            if self.branches[a].looked_at {
                self.branches[at].nats = whole_nats.min(self.branches[a].nats + self.branches[b].nats);
            }
        }
    }

    /// Hands on the branches of the cheapest cut, each with what it costs.
    pub(super) fn cut(&mut self, mut with: impl FnMut(&[usize], f64)) {
        self.open.clear();
        self.open.extend(self.tops.iter().rev());
        while let Some(at) = self.open.pop() {
            let Branch { children, start, spots, whole_nats, nats, .. } = self.branches[at];
            match children {
                Some((a, b)) if nats < whole_nats => self.open.extend([b, a]),
                _ => with(&self.order[start..start + spots], nats),
            }
        }
    }

    /// Links every spot to those nearest to it.
    fn link_nearest(&mut self, context: &Context<'_>) {
        let Self { doubts, links, .. } = self;
        let Context { sightings, near, .. } = *context;
        doubts.clear();
        doubts.extend(
            sightings.iter().map(|sighting| 1.0 + libm::exp(-sighting.spot.marker_log_odds.max(-20.0))),
        );
        links.clear();
        for spot in 0..sightings.len() {
            links.extend(near.beside(spot).map(|(gap2, other)| {
                (gap2 * doubts[spot] * doubts[other], spot.min(other), spot.max(other))
            }));
        }
        links.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    }

    /// Joins what links join, the shortest first (Kruskal).
    fn join(&mut self, spots: usize) {
        self.branches.clear();
        self.branches.resize(spots, LEAF);
        self.roots.clear();
        self.roots.extend(0..spots);
        for &(_, a, b) in &self.links {
            let (a, b) = (root(&mut self.roots, a), root(&mut self.roots, b));
            if a == b {
                continue;
            }
            let joined = self.branches.len();
            let spots = self.branches[a].spots + self.branches[b].spots;
            self.branches.push(Branch { children: Some((a, b)), spots, ..LEAF });
            self.roots.push(joined);
            self.roots[a] = joined;
            self.roots[b] = joined;
        }
        self.tops.clear();
        self.tops.extend((0..self.branches.len()).filter(|&branch| self.roots[branch] == branch));
    }

    /// From the top down every branch gets a stretch of the order of spots.
    fn order_spots(&mut self, spots: usize) {
        self.order.clear();
        self.order.resize(spots, 0);
        let mut start = 0;
        for &top in &self.tops {
            self.branches[top].start = start;
            start += self.branches[top].spots;
        }
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
}

fn root(roots: &mut [usize], mut branch: usize) -> usize {
    while roots[branch] != branch {
        roots[branch] = roots[roots[branch]];
        branch = roots[branch];
    }
    branch
}
