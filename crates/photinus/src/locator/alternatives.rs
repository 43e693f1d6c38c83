//! An observation that is explained poorly -> other ways to put it together with those around it.
//!
//! In: an observation that may be clutter, or is of a group that fits poorly. Out: handfuls of it and those next to it, the likeliest by a first
//! look, each to be weighed in full. What they leave is clutter, or another neighbour's. One that stands alone is put to the nearest group too,
//! whatever that looks like at first: what hardly shows is hardly told from afar. A look is taken once a frame; what it is worth changes as clutter
//! is known better.

use alloc::vec::Vec;

use super::candidates::Candidates;
use super::context::Context;
use super::explanation::Explanation;
use super::grouping::Groups;
use super::kinds::Kinds;

/// This many of the nearest observations are put together with one.
pub(super) const NEAREST: usize = 6;
/// Most handfuls that are weighed in full.
pub(super) const MOST_WEIGHED: usize = 8;
/// A handful that is this much less likely by a first look than what its observations are already, nats, is not weighed: first looks are as good.
pub(super) const POOR_GAIN: f64 = -4.0;

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
    /// The one before it of the same observation.
    before: Option<usize>,
}

/// The turn of an observation: what is next to it, and what was looked at.
#[derive(Clone, Copy, Debug)]
struct Turn {
    window: Window,
    /// The nearest other, however far.
    beside: Option<usize>,
    /// Handfuls, as bits of the window, that are neither looked at yet nor another's: a bit each.
    left: u128,
    /// The last of its looks.
    last: Option<usize>,
}

/// The handfuls of a frame that were looked at.
#[derive(Debug)]
pub(super) struct Alternatives {
    /// The observation, and the nearest others.
    window: Vec<usize>,
    handful: Vec<usize>,
    /// By observation, where its turn has been.
    turns: Vec<Option<Turn>>,
    looks: Vec<Look>,
    members: Vec<usize>,
    /// Gain over clutter, and which look.
    chosen: Vec<(f64, usize)>,
}

/// What alternatives are asked about, and what is known when they are.
pub(super) struct Question<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) groups: &'a Groups,
    pub(super) explanation: &'a Explanation,
    pub(super) candidates: &'a Candidates,
}

impl Question<'_> {
    /// Whether a handful that is at most so likely may be worth to be weighed: not much less likely than what its observations are already.
    fn is_worth(&self, handful: &[usize], log_density: f64) -> bool {
        self.context.gain(handful, log_density) > self.explanation.held(self.candidates, handful) + POOR_GAIN
    }
}

impl Alternatives {
    /// Room for the handfuls of a few observations.
    pub(super) fn with_room() -> Self {
        Self {
            window: Vec::with_capacity(1 + NEAREST),
            handful: Vec::with_capacity(64),
            turns: Vec::new(),
            looks: Vec::with_capacity(64 << NEAREST),
            members: Vec::with_capacity(64 << NEAREST),
            chosen: Vec::with_capacity(1 << NEAREST),
        }
    }

    /// Begins a frame of this many observations.
    pub(super) fn begin(&mut self, observations: usize) {
        self.turns.clear();
        self.turns.resize(observations, None);
        self.looks.clear();
        self.members.clear();
    }

    /// Looks at the handfuls of an observation, but those that were looked at before, and those that cannot be worth it whatever they look like. Returns
    /// how much work that was, in looks.
    pub(super) fn look(&mut self, asked: &Question<'_>, observation: usize, kinds: &mut Kinds) -> u32 {
        let mut turn = match self.turns[observation] {
            Some(turn) => turn,
            None => self.begin_turn(asked.context, observation, kinds),
        };
        self.window.clear();
        self.window.extend(turn.window.iter().flatten());
        let most = Most::of(asked.context, &self.window, kinds);
        let mut pairs = [None; 1 + NEAREST];
        let mut looks = 1;
        for mask in (1usize..1 << self.window.len()).step_by(2) {
            if turn.left >> mask & 1 == 0 || (most.is_poor && mask > 1) {
                continue;
            }
            self.gather(mask);
            let [mut at_most, further] = most.of_look(asked.context, mask, kinds);
            if !asked.is_worth(&self.handful, at_most) {
                continue;
            }
            // What is no neighbour with one of the others is none with more of them.
            if self.handful.len() > 2 && at_most.is_finite() {
                let mut others = (1..self.window.len()).filter(|bit| mask >> bit & 1 == 1);
                let is_poor = others.any(|bit| {
                    let pair = *pairs[bit].get_or_insert_with(|| {
                        looks += 1;
                        let mut pair = [observation, self.window[bit]];
                        pair.sort_unstable();
                        kinds.most_of_pair(asked.context, &pair)
                    });
                    at_most = at_most.min(pair + (self.handful.len() - 2) as f64 * further);
                    !asked.is_worth(&self.handful, at_most)
                });
                if is_poor {
                    continue;
                }
            }
            looks += 1;
            turn.left &= !(1 << mask);
            if let Some(log_density) = kinds.log_density(asked.context, &self.handful) {
                let (first, spots, before) = (self.members.len(), self.handful.len(), turn.last);
                turn.last = Some(self.looks.len());
                self.looks.push(Look { log_density, first, spots, before });
                self.members.extend_from_slice(&self.handful);
            }
        }
        self.turns[observation] = Some(turn);
        looks
    }

    /// Chooses the likeliest handfuls of an observation that was looked at: those that are not much less likely than what their observations are already.
    pub(super) fn choose(&mut self, asked: &Question<'_>, observation: usize, kinds: &mut Kinds) {
        self.chosen.clear();
        self.handful.clear();
        let Some(Turn { last, beside, .. }) = self.turns[observation] else { return };
        let mut next = last;
        while let Some(index) = next {
            let members = self.members(index);
            if asked.is_worth(members, self.looks[index].log_density) {
                self.chosen.push((asked.context.gain(members, self.looks[index].log_density), index));
            }
            next = self.looks[index].before;
        }
        self.chosen.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.chosen.truncate(MOST_WEIGHED);
        if let (&[_], Some(nearest)) = (asked.groups.group_of(observation), beside) {
            self.handful.push(observation);
            self.handful.extend_from_slice(asked.groups.group_of(nearest));
            self.handful.sort_unstable();
            let most = kinds.most_in_full(asked.context, &self.handful);
            // A look says little of what only joins at a pinch.
            let is_worth = asked.is_worth(&self.handful, most) && {
                let look = kinds.log_density_in_any_light(asked.context, &self.handful);
                asked.is_worth(&self.handful, look)
            };
            if !is_worth {
                self.handful.clear();
            }
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
    fn begin_turn(&mut self, context: &Context<'_>, observation: usize, kinds: &Kinds) -> Turn {
        let reach_rad = kinds.widest_rad(&context.sightings[observation]);
        let nearest = || context.near.beside(observation).take(NEAREST);
        let within = nearest().filter(|(gap2, _)| *gap2 < reach_rad * reach_rad);
        self.window.clear();
        self.window.push(observation);
        self.window.extend(within.map(|(_, index)| index));
        let window = core::array::from_fn(|place| self.window.get(place).copied());
        let (most, seen) = (kinds.most_visible().max(1) as u32, self.seen_before());
        let is_own = |mask: &usize| mask.count_ones() <= most && !seen.iter().any(|before| before.has(*mask));
        let left =
            (1usize..1 << self.window.len()).step_by(2).filter(is_own).fold(0, |left, mask| left | 1 << mask);
        Turn { window, beside: nearest().next().map(|(_, index)| index), left, last: None }
    }

    /// What the turns of others in the window have looked at.
    fn seen_before(&self) -> [Seen; 1 + NEAREST] {
        let mut seen = [Seen::default(); 1 + NEAREST];
        for (bit, &other) in self.window.iter().enumerate().skip(1) {
            let Some(Turn { window: theirs, .. }) = &self.turns[other] else { continue };
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

/// The most that looks at the handfuls of a window can be worth, before any is taken.
struct Most {
    /// By handful, as bits of the window: its largest squared gap.
    widest2_rad2: [f64; 1 << (1 + NEAREST)],
    /// Whether all observations have a light.
    is_lit: bool,
    /// Whether none with a second observation is worth a look.
    is_poor: bool,
}

impl Most {
    fn of(context: &Context<'_>, window: &[usize], kinds: &Kinds) -> Self {
        let is_lit = window.iter().all(|&spot| context.sightings[spot].log_light.is_some());
        let mut most = Self { widest2_rad2: [0.0; 1 << (1 + NEAREST)], is_lit, is_poor: true };
        let [own, nearest, ..] = *window else { return most };
        let gap2_rad2 = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|spot| context.sightings[spot].bearing.vector());
            (a - b).norm_squared()
        };
        let least = window[1..].iter().map(|&spot| context.clutter[spot]).fold(f64::INFINITY, f64::min);
        most.is_poor = (2..=window.len().min(kinds.most_visible())).all(|spots| {
            let clutter = context.clutter[own] + (spots - 1) as f64 * least;
            let [look, _] = kinds.most_of_look(context, spots, gap2_rad2(own, nearest), is_lit);
            look + context.log_neighbours - clutter <= POOR_GAIN
        });
        if !most.is_poor {
            for last in 1..window.len() {
                for rest in 1usize..1 << last {
                    let first = rest.trailing_zeros() as usize;
                    let (without, before) = (rest & (rest - 1), 1 << last);
                    // Of the last with the others, those but the first were seen to.
                    let to_others = if without == 0 { 0.0 } else { most.widest2_rad2[before | without] };
                    let to_first = gap2_rad2(window[last], window[first]);
                    most.widest2_rad2[before | rest] = to_others.max(to_first).max(most.widest2_rad2[rest]);
                }
            }
        }
        most
    }

    /// The logarithm of the most that the density of a handful can be by a look, and how much less for each observation fewer.
    fn of_look(&self, context: &Context<'_>, handful: usize, kinds: &Kinds) -> [f64; 2] {
        match handful.count_ones() as usize {
            1 => [f64::INFINITY, 0.0],
            spots => kinds.most_of_look(context, spots, self.widest2_rad2[handful], self.is_lit),
        }
    }
}
