//! An observation that is explained poorly -> other ways to put it together with those around it.
//!
//! In: an observation that may be clutter, or is of a group that fits poorly. Out: handfuls of it and those next to it, the likeliest by a first
//! look, each to be weighed in full. What they leave is clutter, or another neighbour's. One that stands alone is put to the nearest group too,
//! whatever that looks like at first: what hardly shows is hardly told from afar. A look is taken once a frame; what it is worth changes as clutter
//! is known better.

use alloc::vec::Vec;
use core::ops::Range;

use super::context::Context;
use super::grouping::Groups;
use super::kinds::Kinds;

/// This many of the nearest observations are put together with one.
const NEAREST: usize = 6;
/// Most handfuls that are weighed in full.
const MOST_WEIGHED: usize = 8;
/// A handful that is this much less likely by a first look than what its observations are already, nats, is not weighed: first looks are as good.
pub(super) const POOR_GAIN: f64 = -8.0;

/// An observation and those next to it.
type Window = [Option<usize>; 1 + NEAREST];

/// What the turn of another observation has looked at, as bits of a window: itself, and all that are in both windows.
#[derive(Clone, Copy, Default)]
struct Seen {
    own: usize,
    common: usize,
}

impl Seen {
    fn has(self, handful: usize) -> bool {
        handful & self.own != 0 && handful & !self.common == 0
    }
}

/// A handful by a first look.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// Logarithm of its density as one neighbour.
    log_density: f64,
    first: usize,
    spots: usize,
}

/// The handfuls of a frame that were looked at.
#[derive(Debug)]
pub(super) struct Alternatives {
    /// The observation, and the nearest others.
    window: Vec<usize>,
    nearest: Vec<(f64, usize)>,
    handful: Vec<usize>,
    /// By observation, where its turn has been: its window, and its looks.
    windows: Vec<Option<Window>>,
    /// By observation, where its turn has been: the nearest other, however far.
    beside: Vec<Option<usize>>,
    turns: Vec<Range<usize>>,
    looks: Vec<Look>,
    members: Vec<usize>,
    /// Gain over clutter, and which look.
    chosen: Vec<(f64, usize)>,
}

impl Alternatives {
    /// Room for the handfuls of a few observations.
    pub(super) fn with_room() -> Self {
        Self {
            window: Vec::with_capacity(1 + NEAREST),
            nearest: Vec::with_capacity(2 + NEAREST),
            handful: Vec::with_capacity(64),
            windows: Vec::new(),
            beside: Vec::new(),
            turns: Vec::new(),
            looks: Vec::with_capacity(64 << NEAREST),
            members: Vec::with_capacity(64 << NEAREST),
            chosen: Vec::with_capacity(1 << NEAREST),
        }
    }

    /// Begins a frame of this many observations.
    pub(super) fn begin(&mut self, observations: usize) {
        self.windows.clear();
        self.windows.resize(observations, None);
        self.beside.clear();
        self.beside.resize(observations, None);
        self.turns.clear();
        self.turns.resize(observations, 0..0);
        self.looks.clear();
        self.members.clear();
    }

    /// Looks at the handfuls of an observation, but those that were looked at before. Returns how many it looked at.
    pub(super) fn look(&mut self, context: &Context<'_>, observation: usize, kinds: &mut Kinds) -> u32 {
        if self.windows[observation].is_some() {
            return 0;
        }
        self.open_window(context, observation, kinds);
        let most = kinds.most_visible().max(1) as u32;
        let (seen, first) = (self.seen_before(), self.looks.len());
        let mut looks = 0;
        for mask in (1usize..1 << self.window.len()).step_by(2) {
            if mask.count_ones() > most || seen.iter().any(|before| before.has(mask)) {
                continue;
            }
            looks += 1;
            self.gather(mask);
            if let Some(log_density) = kinds.log_density(context, &self.handful) {
                self.looks.push(Look { log_density, first: self.members.len(), spots: self.handful.len() });
                self.members.extend_from_slice(&self.handful);
            }
        }
        self.turns[observation] = first..self.looks.len();
        looks
    }

    /// Chooses the likeliest handfuls of an observation that was looked at: those that are not much less likely than what their observations are already,
    /// which gains as much over clutter as `held` tells.
    pub(super) fn choose(
        &mut self,
        context: &Context<'_>,
        groups: &Groups,
        observation: usize,
        held: impl Fn(&[usize]) -> f64,
    ) {
        self.chosen.clear();
        for index in self.turns[observation].clone() {
            let members = self.members(index);
            let clutter: f64 = members.iter().map(|&spot| context.clutter[spot]).sum();
            let gain = self.looks[index].log_density + context.log_neighbours - clutter;
            if gain > held(members) + POOR_GAIN {
                self.chosen.push((gain, index));
            }
        }
        self.chosen.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.chosen.truncate(MOST_WEIGHED);
        self.handful.clear();
        if let (&[_], Some(nearest)) = (groups.group_of(observation), self.beside[observation]) {
            self.handful.push(observation);
            self.handful.extend_from_slice(groups.group_of(nearest));
            self.handful.sort_unstable();
        }
    }

    /// Those that were chosen, each ascending.
    pub(super) fn chosen(&self) -> impl Iterator<Item = &[usize]> {
        let looked_at = self.chosen.iter().map(|&(_, index)| self.members(index));
        looked_at.chain((!self.handful.is_empty()).then_some(&self.handful[..]))
    }

    /// The observations of a look.
    fn members(&self, look: usize) -> &[usize] {
        let Look { first, spots, .. } = self.looks[look];
        &self.members[first..first + spots]
    }

    /// Opens the window around an observation.
    fn open_window(&mut self, context: &Context<'_>, observation: usize, kinds: &Kinds) {
        let own = &context.sightings[observation];
        let Self { window, nearest, .. } = self;
        context.near.nearest(own.bearing.vector(), 1 + NEAREST, nearest);
        nearest.retain(|&(_, index)| index != observation);
        self.beside[observation] = nearest.first().map(|&(_, index)| index);
        let reach_rad = kinds.widest_rad(own);
        let within = nearest.iter().filter(|(gap2, _)| *gap2 < reach_rad * reach_rad);
        window.clear();
        window.push(observation);
        window.extend(within.map(|&(_, index)| index));
        self.windows[observation] = Some(core::array::from_fn(|place| window.get(place).copied()));
    }

    /// What the turns of others in the window have looked at.
    fn seen_before(&self) -> [Seen; 1 + NEAREST] {
        let mut seen = [Seen::default(); 1 + NEAREST];
        for (bit, &other) in self.window.iter().enumerate().skip(1) {
            let Some(theirs) = &self.windows[other] else { continue };
            let is_theirs = |spot: &usize| theirs.contains(&Some(*spot));
            let common = self.window.iter().enumerate().filter(|(_, spot)| is_theirs(spot));
            seen[bit] = Seen { own: 1 << bit, common: common.map(|(bit, _)| 1 << bit).sum() };
        }
        seen
    }

    fn gather(&mut self, mask: usize) {
        self.handful.clear();
        self.handful.extend(
            self.window.iter().enumerate().filter(|(bit, _)| mask >> bit & 1 == 1).map(|(_, &spot)| spot),
        );
        self.handful.sort_unstable();
    }
}
