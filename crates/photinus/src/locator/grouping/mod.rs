//! Which spots are one neighbour.
//!
//! In: the sightings of a frame. Out: groups of them, each a neighbour, by the least total cost; what a group costs,
//! [`Kinds`] says. Three steps, the later ones for fewer and fewer spots:
//!
//! 1. [`tree`]: the trees of nearest neighbours; every neighbour that keeps its distance in the image is a branch;
//! 2. their cheapest cut into branches, from the top down, without looking into a branch that cannot be beaten;
//! 3. [`partition`]: where groups overlap in the image (side by side, one behind the other) the cheapest of all partitions
//!    of a few spots, exactly.
//!
//! Those costs are coarse. Once groups are weighed in full, the handfuls of the same few spots that may still be likelier, as far as first looks tell, are
//! their *rivals*, to be weighed in full as well.

mod partition;
mod tree;

use alloc::vec::Vec;

use nalgebra::Vector3;

use super::Sighting;
use super::candidates::Candidates;
use super::context::Context;
use super::kinds::Kinds;
use super::matching::NEIGHBOUR_NATS;
use super::memory::LOG_POWER_SIGMA;
use crate::pose::LogLight;
use partition::{Cost, MOST_PARTITIONED, Partition};
use tree::Tree;

/// Groups of this many spots tell their distance and so the light of their LEDs.
pub(super) const CLEAR_SPOTS: usize = 3;
/// Gains over clutter are cut off here, nats.
const LARGEST_GAIN: f64 = 50.0;
/// Most rounds of partitioning in one frame: the time of a frame is bounded.
const MOST_ROUNDS: usize = 12;
/// Larger groups are not taken apart spot by spot.
const LARGEST_ORDERED: usize = 6;
/// A handful may cost so much less in full than it looks, nats: of 20,000 neighbours of two or three spots in crowds of 20, nineteen in twenty cost no more
/// than 2.6 less.
const SLACK_NATS: f64 = 3.0;
/// The same of one spot alone, the others of whose markers may be in spots that are not its own, which a first look does not know: of 50 hexarotors one in 200
/// shows one marker that looks 11.5 to 12 nats worse than clutter and is a neighbour all the same.
const LONE_SLACK_NATS: f64 = 4.0;
/// A group that costs more than this, nats, may not be one: half-way from a good match to two neighbours.
const DOUBTFUL_NATS: f64 = 1.5 * NEIGHBOUR_NATS;

/// The groups of one frame, and the room to find them in.
#[derive(Debug, Default)]
pub(super) struct Groups {
    list: GroupList,
    /// Handfuls that may be right as well, and the observations among which they were looked for.
    rivals: GroupList,
    searched: GroupList,
    spare: GroupList,
    tree: Tree,
    partition: Partition,
    circles: Vec<Circle>,
    near: Vec<usize>,
    /// The group of each observation.
    of: Vec<usize>,
    /// Logarithms of the light of clear neighbours.
    powers: Vec<f64>,
    /// Logarithm of the density of each group as one neighbour, by a first look, and how likely each observation is clutter by it.
    first_looks: Vec<f64>,
    clutter: Vec<f64>,
    /// How much likelier each group is one neighbour than clutter, by that look, as a logarithm.
    gains: Vec<f64>,
}

/// Groups of spots, one after the other.
#[derive(Debug, Default)]
struct GroupList {
    members: Vec<usize>,
    ends: Vec<usize>,
    /// What each group costs.
    nats: Vec<f64>,
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

impl GroupList {
    fn clear(&mut self) {
        self.members.clear();
        self.ends.clear();
        self.nats.clear();
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn group(&self, group: usize) -> &[usize] {
        let start = if group == 0 { 0 } else { self.ends[group - 1] };
        &self.members[start..self.ends[group]]
    }

    fn push(&mut self, members: impl IntoIterator<Item = usize>, nats: f64) {
        self.members.extend(members);
        self.ends.push(self.members.len());
        self.nats.push(nats);
    }
}

impl Groups {
    /// Finds the groups of a frame's observations, and what the clear ones tell of the light of its LEDs.
    pub(super) fn sort_out(&mut self, context: &Context<'_>, kinds: &mut Kinds) -> Option<LogLight> {
        self.tree.grow(context);
        self.cut_tree(context, kinds);
        let log_power = self.log_power(context, kinds);
        let power = log_power.map(|value| LogLight { value, sigma: LOG_POWER_SIGMA });
        let context = &Context { power, ..*context };
        if power.is_some() && (0..self.list.len()).any(|group| self.is_doubtful(group)) {
            self.cut_tree(context, kinds);
        }
        self.part_overlapping(context, kinds);
        self.put_in_order();
        self.measure_circles(context.sightings, kinds);
        self.searched.clear();
        power
    }

    /// Takes a first look at how well each group is one neighbour.
    pub(super) fn look(&mut self, context: &Context<'_>, kinds: &mut Kinds) {
        self.first_looks.clear();
        for group in 0..self.list.len() {
            let looked = kinds.log_density(context, self.list.group(group));
            self.first_looks.push(match looked {
                Some(log_density) => log_density,
                None if self.is_doubtful(group) => f64::NEG_INFINITY,
                None => f64::INFINITY,
            });
        }
    }

    /// Supposes that every one of this many observations is as likely clutter.
    pub(super) fn suppose(&mut self, observations: usize, share: f64) {
        self.clutter.clear();
        self.clutter.resize(observations, share);
    }

    /// Weighs that look against clutter of this density, where this many neighbours are per sr. Returns the logarithm of the density of all
    /// observations.
    pub(super) fn weigh_looks(&mut self, clutter_log_density: &[f64], log_neighbours: f64) -> f64 {
        let mut total = 0.0;
        self.gains.clear();
        for (group, look) in self.first_looks.iter().enumerate() {
            let members = self.list.group(group);
            let clutter: f64 = members.iter().map(|&spot| clutter_log_density[spot]).sum();
            let gain = (look + log_neighbours - clutter).clamp(-LARGEST_GAIN, LARGEST_GAIN);
            // A look that cannot tell promises nothing, and rules nothing out.
            self.gains.push(if look.is_finite() { gain } else { 0.0 });
            let share = 1.0 / (1.0 + libm::exp(gain));
            for &spot in members {
                self.clutter[spot] = share;
            }
            total += clutter - libm::log(share);
        }
        total
    }

    /// How much likelier a group is one neighbour than clutter, by that look, as a logarithm.
    pub(super) fn gain(&self, group: usize) -> f64 {
        self.gains[group]
    }

    /// How likely an observation is clutter, by that look.
    pub(super) fn clutter(&self, observation: usize) -> f64 {
        self.clutter[observation]
    }

    /// How many groups are neighbours, by that look.
    pub(super) fn neighbours(&self) -> f64 {
        (0..self.list.len()).map(|group| 1.0 - self.clutter[self.list.group(group)[0]]).sum()
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// A group, ascending; groups are in the order of their first member.
    pub(super) fn group(&self, group: usize) -> &[usize] {
        self.list.group(group)
    }

    /// Finds the handfuls of a group and of those that it touches which may be right and are no candidates; one spot alone only where it may gain more than
    /// `poor_gain` over clutter. Returns how many looks that took.
    pub(super) fn find_rivals(
        &mut self,
        (group, poor_gain): (usize, f64),
        context: &Context<'_>,
        kinds: &mut Kinds,
        candidates: &Candidates,
    ) -> u32 {
        self.rivals.clear();
        self.gather_around(group);
        if !self.is_anew() {
            return 0;
        }
        let Self { partition, rivals, .. } = self;
        let (looks, most_visible) = (kinds.looks(), kinds.most_visible());
        let cost = |handful: &[usize]| {
            // One spot alone may be clutter as well.
            let at_most = if handful.len() == 1 { 0.0 } else { f64::INFINITY };
            let cost = |log_density: f64| at_most.min(-context.gain(handful, log_density));
            match candidates.log_density(handful) {
                Some(log_density) => Cost::Known(cost(log_density)),
                None if candidates.was_weighed(handful) => Cost::Known(at_most),
                None => match kinds.log_density(context, handful) {
                    Some(look)
                        if handful.len() > 1 || context.gain(handful, look) + LONE_SLACK_NATS > poor_gain =>
                    {
                        Cost::Looks { nats: cost(look), known: at_most }
                    }
                    _ => Cost::Known(at_most),
                },
            }
        };
        partition.each_rival(SLACK_NATS, most_visible, cost, |handful| rivals.push(handful, 0.0));
        kinds.looks() - looks
    }

    /// Whether the groups that were gathered are not among those gathered before in search of rivals.
    fn is_anew(&mut self) -> bool {
        let own = &mut self.near;
        own.clear();
        own.extend_from_slice(self.partition.spots());
        own.sort_unstable();
        let is_known = (0..self.searched.len()).any(|other| {
            let other = self.searched.group(other);
            own.iter().all(|spot| other.binary_search(spot).is_ok())
        });
        if !is_known {
            self.searched.push(own.iter().copied(), 0.0);
        }
        !is_known
    }

    /// The handfuls that were found, each ascending.
    pub(super) fn rivals(&self) -> impl Iterator<Item = &[usize]> {
        (0..self.rivals.len()).map(|rival| self.rivals.group(rival))
    }

    /// The group of an observation, ascending.
    pub(super) fn group_of(&self, observation: usize) -> &[usize] {
        self.list.group(self.of[observation])
    }

    fn cut_tree(&mut self, context: &Context<'_>, kinds: &mut Kinds) {
        self.list.clear();
        self.tree.cost(|group| kinds.nats(context, group));
        self.tree.cut(|group, nats| self.list.push(group.iter().copied(), nats));
    }

    /// What the clear neighbours of the frame tell of its LEDs' light: the median of their logarithms.
    fn log_power(&mut self, context: &Context<'_>, kinds: &mut Kinds) -> Option<f64> {
        self.powers.clear();
        for group in 0..self.list.len() {
            if self.list.group(group).len() >= CLEAR_SPOTS && !self.is_doubtful(group) {
                self.powers.extend(kinds.log_power(context, self.list.group(group)));
            }
        }
        self.powers.sort_unstable_by(f64::total_cmp);
        self.powers.get(self.powers.len() / 2).copied()
    }

    fn is_doubtful(&self, group: usize) -> bool {
        self.list.group(group).len() == 1 || self.list.nats[group] > DOUBTFUL_NATS
    }

    /// Takes groups that overlap in the image apart and puts them together anew, at the least cost.
    fn part_overlapping(&mut self, context: &Context<'_>, kinds: &mut Kinds) {
        if kinds.most_visible() > LARGEST_ORDERED {
            return;
        }
        let (mut rounds, mut first) = (0, 0);
        self.measure_circles(context.sightings, kinds);
        while first < self.list.len() && rounds < MOST_ROUNDS {
            self.gather_around(first);
            let mut parted = false;
            if self.partition.groups() > 1 {
                rounds += 1;
                parted = self.partition.improve(|group| kinds.nats(context, group));
            }
            if parted {
                self.replace_partitioned();
                self.measure_circles(context.sightings, kinds);
                first = 0;
            } else {
                first += 1;
            }
        }
    }

    fn measure_circles(&mut self, sightings: &[Sighting], kinds: &Kinds) {
        self.circles.clear();
        for group in 0..self.list.len() {
            let members = self.list.group(group);
            let direction = |&spot: &usize| sightings[spot].bearing.vector();
            let middle = members.iter().map(direction).sum::<Vector3<f64>>().normalize();
            let off = |spot: &usize| (direction(spot) - middle).norm();
            let radius_rad = members.iter().map(off).fold(0.0, f64::max);
            let doubtful = self.is_doubtful(group);
            let widest = |&spot: &usize| kinds.widest_rad(&sightings[spot]);
            let reach_rad =
                if doubtful { members.iter().map(widest).fold(f64::INFINITY, f64::min) } else { 0.0 };
            self.circles.push(Circle { middle, radius_rad, reach_rad, doubtful });
        }
    }

    /// The group `first` and those that may have to do with it, the nearest first, as far as they can be partitioned.
    fn gather_around(&mut self, first: usize) {
        let own = self.circles[first];
        let gap = |group: usize| (self.circles[group].middle - own.middle).norm();
        let is_near = |&other: &usize| {
            let touch = 1.5 * (own.radius_rad + self.circles[other].radius_rad);
            let reach = if own.doubtful { touch.max(own.reach_rad) } else { touch };
            other == first || gap(other) < reach
        };
        self.near.clear();
        self.near.extend((0..self.list.len()).filter(is_near));
        self.near.sort_unstable_by(|&a, &b| gap(a).total_cmp(&gap(b)).then(a.cmp(&b)));
        self.partition.clear();
        for &group in &self.near {
            let members = self.list.group(group);
            if self.partition.spots().len() + members.len() <= MOST_PARTITIONED {
                self.partition.add(group, members);
            }
        }
    }

    fn replace_partitioned(&mut self) {
        self.spare.clear();
        for group in 0..self.list.len() {
            if !self.partition.took(group) {
                self.spare.push(self.list.group(group).iter().copied(), self.list.nats[group]);
            }
        }
        self.partition.each_part(|members, nats| self.spare.push(members, nats));
        core::mem::swap(&mut self.list, &mut self.spare);
    }

    /// Members ascending, groups in the order of their first member.
    fn put_in_order(&mut self) {
        let mut start = 0;
        for &end in &self.list.ends {
            self.list.members[start..end].sort_unstable();
            start = end;
        }
        self.near.clear();
        self.near.extend(0..self.list.len());
        self.near.sort_unstable_by_key(|&group| self.list.group(group)[0]);
        self.spare.clear();
        for &group in &self.near {
            self.spare.push(self.list.group(group).iter().copied(), self.list.nats[group]);
        }
        core::mem::swap(&mut self.list, &mut self.spare);
        self.of.clear();
        self.of.resize(self.list.members.len(), 0);
        for group in 0..self.list.len() {
            for &member in self.list.group(group) {
                self.of[member] = group;
            }
        }
    }
}
