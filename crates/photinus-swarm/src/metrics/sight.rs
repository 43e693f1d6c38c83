//! Who saw whom, and how right what was told is.

use std::collections::BTreeMap;

use super::pairing::pair;
use crate::perception::{Grade, InView, in_view, nees};
use crate::scenario::Scenario;
use crate::world::World;

#[derive(Debug)]
pub(super) struct Sight {
    frames: usize,
    connected: usize,
    largest: f64,
    could: usize,
    did: usize,
    leader_could: usize,
    leader_did: usize,
    with_somebody: Vec<usize>,
    alone: Vec<usize>,
    longest_alone: usize,
    last_track: BTreeMap<(usize, usize), u64>,
    pub(super) square_error_m2: Vec<f64>,
    pub(super) range_error: Vec<f64>,
    pub(super) nees: Vec<f64>,
    pub(super) bounds: usize,
    pub(super) bounds_broken: usize,
    pub(super) switches: usize,
    pub(super) named: usize,
    pub(super) named_wrong: usize,
    pub(super) phantoms: usize,
    pub(super) told: usize,
    views: Vec<InView>,
}

/// Shares of time and of pairs.
pub(super) struct Shares {
    pub(super) connected: f64,
    pub(super) largest_part: f64,
    pub(super) contact: Option<f64>,
    pub(super) with_anybody: Option<f64>,
    pub(super) with_leader: Option<f64>,
    pub(super) longest_alone_s: f64,
}

impl Sight {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let count = scenario.vehicles.len();
        Self {
            frames: 0,
            connected: 0,
            largest: 0.0,
            could: 0,
            did: 0,
            leader_could: 0,
            leader_did: 0,
            with_somebody: vec![0; count],
            alone: vec![0; count],
            longest_alone: 0,
            last_track: BTreeMap::new(),
            square_error_m2: Vec::new(),
            range_error: Vec::new(),
            nees: Vec::new(),
            bounds: 0,
            bounds_broken: 0,
            switches: 0,
            named: 0,
            named_wrong: 0,
            phantoms: 0,
            told: 0,
            views: Vec::new(),
        }
    }

    pub(super) fn take(&mut self, world: &World) {
        let count = world.robots().len();
        let moment = world.moment();
        let mut graph = Graph::new(count);
        self.frames += 1;
        for observer in 0..count {
            let mut views = std::mem::take(&mut self.views);
            in_view(&moment, observer, &mut views);
            let targets = self.take_tells(world, observer);
            targets.iter().for_each(|&target| graph.join(observer, target));
            let told = |view: &&InView| targets.contains(&view.target);
            self.could += views.len();
            self.did += views.iter().filter(told).count();
            if observer == 1 && views.iter().any(|view| view.target == 0) {
                self.leader_could += 1;
                self.leader_did += usize::from(targets.contains(&0));
            }
            self.alone[observer] = if targets.is_empty() { self.alone[observer] + 1 } else { 0 };
            self.with_somebody[observer] += usize::from(!targets.is_empty());
            if world.robots()[observer].sees() {
                self.longest_alone = self.longest_alone.max(self.alone[observer]);
            }
            self.views = views;
        }
        let largest = graph.largest();
        self.connected += usize::from(largest == count);
        self.largest += largest as f64 / count as f64;
    }

    /// The vehicles that a vehicle was told of, each compared with the truth.
    fn take_tells(&mut self, world: &World, observer: usize) -> Vec<usize> {
        let seen = &world.robots()[observer].seen;
        let paired = pair(world, observer);
        self.told += seen.len();
        self.phantoms += seen.len() - paired.len();
        for pair in &paired {
            let told = &seen[pair.seen];
            let distance_m = pair.truth_m.norm();
            if let Some(place) = &told.position_m {
                self.square_error_m2.push((place.mean - pair.truth_m).norm_squared());
                self.range_error.push((place.mean.norm() / distance_m - 1.0).abs());
                // what claims to be exact has no covariance to compare it with
                if world.grade() != Grade::Perfect {
                    self.nees.extend(nees(place, &pair.truth_m));
                }
            }
            if told.age_s <= 0.0 {
                self.bounds += 1;
                // the last bit of a sum is no violation
                let bounds = told.distance.bounds;
                let slack_m = 1e-9 * distance_m;
                let held = bounds.min_m() <= distance_m + slack_m && bounds.max_m() >= distance_m - slack_m;
                self.bounds_broken += usize::from(!held);
            }
            let before = self.last_track.insert((observer, pair.target), told.track);
            self.switches += usize::from(before.is_some_and(|before| before != told.track));
            if let Some(name) = told.identity {
                self.named += 1;
                self.named_wrong += usize::from(name as usize != pair.target);
            }
        }
        paired.iter().map(|pair| pair.target).collect()
    }

    pub(super) fn shares(&self, scenario: &Scenario) -> Shares {
        let frames = self.frames.max(1) as f64;
        let of = |part: usize, whole: usize| (whole > 0).then(|| part as f64 / whole as f64);
        let mean = self.with_somebody.iter().sum::<usize>() as f64 / frames / self.with_somebody.len() as f64;
        Shares {
            connected: self.connected as f64 / frames,
            largest_part: self.largest / frames,
            contact: of(self.did, self.could),
            with_anybody: (self.with_somebody.len() > 1).then_some(mean),
            with_leader: of(self.leader_did, self.leader_could),
            longest_alone_s: self.longest_alone as f64 * scenario.period_s(),
        }
    }
}

/// Who is linked with whom.
pub(super) struct Graph(Vec<usize>);

impl Graph {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    pub(super) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    fn root(&self, mut of: usize) -> usize {
        while self.0[of] != of {
            of = self.0[of];
        }
        of
    }

    /// How many the largest part holds.
    pub(super) fn largest(&self) -> usize {
        let mut sizes = vec![0; self.0.len()];
        (0..self.0.len()).for_each(|of| sizes[self.root(of)] += 1);
        sizes.into_iter().max().unwrap_or(0)
    }
}
