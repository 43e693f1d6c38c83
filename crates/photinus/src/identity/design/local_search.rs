//! A large set of candidates without conflicts, by local search: add what is free, swap one for one where nothing is, shake.
//!
//! Swaps of one for one walk over sets of the same size until something becomes free (D. V. Andrade, M. G. C. Resende, R. F.
//! Werneck, "Fast local search for the maximum independent set problem", J. Heuristics 18, 2012); what was dropped stays out for
//! some steps, so that the walk does not turn back.

use alloc::vec;
use alloc::vec::Vec;

use super::Effort;
use super::conflicts::Conflicts;

/// This many steps without a larger set, and one at random comes in.
const SHAKE_AFTER: u64 = 20_000;

/// The largest set that was met. Never smaller than what taking the candidates in order gives.
pub(super) fn grow(conflicts: &Conflicts, effort: Effort) -> Vec<usize> {
    let mut search = Search::new(conflicts, effort.seed);
    let mut best = Vec::new();
    let mut since_best = 0_u64;
    let mut step = 0;
    let in_order = conflicts.len() as u64;
    while best.len() < conflicts.len() && (step < 2 * in_order || search.work < effort.work) {
        search.change(step, step < in_order);
        search.work += 1;
        step += 1;
        since_best += 1;
        if search.chosen.members.len() > best.len() {
            best.clone_from(&search.chosen.members);
            since_best = 0;
        }
        if since_best.is_multiple_of(SHAKE_AFTER) && since_best > 0 {
            search.shake(step);
        }
    }
    best.into_iter().map(|index| index as usize).collect()
}

/// A set of small numbers whose members can be drawn.
struct Members {
    members: Vec<u32>,
    /// Where each stands in `members`; `ABSENT` when it does not.
    places: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Members {
    fn new(count: usize) -> Self {
        Self { members: Vec::with_capacity(count), places: vec![ABSENT; count] }
    }

    fn has(&self, v: usize) -> bool {
        self.places[v] != ABSENT
    }

    fn insert(&mut self, v: usize) {
        if !self.has(v) {
            self.places[v] = self.members.len() as u32;
            self.members.push(v as u32);
        }
    }

    fn remove(&mut self, v: usize) {
        if !self.has(v) {
            return;
        }
        let place = self.places[v] as usize;
        self.members.swap_remove(place);
        if let Some(&moved) = self.members.get(place) {
            self.places[moved as usize] = place as u32;
        }
        self.places[v] = ABSENT;
    }
}

struct Search<'a> {
    conflicts: &'a Conflicts,
    chosen: Members,
    /// Not chosen, in conflict with nothing chosen.
    free: Members,
    /// Not chosen, in conflict with one that is chosen.
    one_off: Members,
    /// With how many that are chosen each conflicts.
    blocked_by: Vec<u32>,
    /// Until which step each stays out.
    out_until: Vec<u64>,
    random: Random,
    /// Conflicts that were followed so far.
    work: u64,
}

impl<'a> Search<'a> {
    fn new(conflicts: &'a Conflicts, seed: u64) -> Self {
        let count = conflicts.len();
        let mut free = Members::new(count);
        (0..count).for_each(|v| free.insert(v));
        Self {
            conflicts,
            chosen: Members::new(count),
            free,
            one_off: Members::new(count),
            blocked_by: vec![0; count],
            out_until: vec![0; count],
            random: Random(seed),
            work: 0,
        }
    }

    /// One step: adds, else swaps, else shakes; `in_order` takes what is free from its least number on.
    fn change(&mut self, step: u64, in_order: bool) {
        if let Some(v) = self.pick_free(in_order) {
            self.add(v);
            return;
        }
        // the first of a few draws that may come in
        for _ in 0..8 {
            let Some(v) = self.draw_one_off() else { break };
            if self.out_until[v] <= step {
                self.swap_in(v, step);
                return;
            }
        }
        self.shake(step);
    }

    fn pick_free(&mut self, in_order: bool) -> Option<usize> {
        let free = &self.free.members;
        let picked = match in_order {
            true => free.iter().min(),
            false if free.is_empty() => None,
            false => free.get(self.random.below(free.len())),
        };
        picked.map(|&v| v as usize)
    }

    fn draw_one_off(&mut self) -> Option<usize> {
        let count = self.one_off.members.len();
        (count > 0).then(|| self.one_off.members[self.random.below(count)] as usize)
    }

    /// Takes in one at random, whatever it costs.
    fn shake(&mut self, step: u64) {
        let v = self.random.below(self.conflicts.len());
        if !self.chosen.has(v) {
            self.swap_in(v, step);
        }
    }

    /// Drops what conflicts with `v` and adds it.
    fn swap_in(&mut self, v: usize, step: u64) {
        for &other in self.conflicts.with(v) {
            if self.chosen.has(other as usize) {
                self.drop_chosen(other as usize);
                self.out_until[other as usize] = step + 7 + self.random.below(10) as u64;
            }
        }
        self.add(v);
    }

    /// Chooses one that is in conflict with nothing chosen.
    fn add(&mut self, v: usize) {
        self.free.remove(v);
        self.chosen.insert(v);
        self.work += 1 + self.conflicts.with(v).len() as u64;
        for &other in self.conflicts.with(v) {
            let other = other as usize;
            self.blocked_by[other] += 1;
            match self.blocked_by[other] {
                1 => {
                    self.free.remove(other);
                    self.one_off.insert(other);
                }
                2 => self.one_off.remove(other),
                _ => {}
            }
        }
    }

    /// Lets one go that is chosen.
    fn drop_chosen(&mut self, v: usize) {
        self.chosen.remove(v);
        self.free.insert(v);
        self.work += 1 + self.conflicts.with(v).len() as u64;
        for &other in self.conflicts.with(v) {
            let other = other as usize;
            self.blocked_by[other] -= 1;
            match self.blocked_by[other] {
                0 => {
                    self.one_off.remove(other);
                    self.free.insert(other);
                }
                1 => self.one_off.insert(other),
                _ => {}
            }
        }
    }
}

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014): small, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A number from 0 up to but not `end`, which is above 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}
