//! An observation that is explained poorly -> other ways to put it together with those around it.
//!
//! In: an observation that may be clutter, or is of a group that fits poorly. Out: handfuls of it and those next to it, the likeliest by a first
//! look, each to be weighed in full. What they leave is clutter, or another neighbour's. One that stands alone is put to the nearest group too,
//! whatever that looks like at first: what hardly shows is hardly told from afar.

use super::context::Context;
use super::grouping::Groups;
use super::matching::Matcher;

/// So many of the nearest observations are put together with one.
const NEAREST: usize = 6;
/// Most handfuls that are weighed in full.
const MOST_WEIGHED: usize = 8;
/// A handful that is so much less likely than clutter by a first look, nats, is not weighed: first looks are as good.
const POOR_GAIN: f64 = -8.0;

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

/// Room to look for other handfuls in.
#[derive(Debug)]
pub(super) struct Alternatives {
    /// The observation, and the nearest others.
    window: Vec<usize>,
    nearest: Vec<(f64, usize)>,
    handful: Vec<usize>,
    /// The windows of those whose turn has been in this round.
    windows: Vec<Option<Window>>,
    /// Gain over clutter by a first look, and which of the window.
    looked_at: Vec<(f64, usize)>,
}

impl Alternatives {
    /// Room for the handfuls of one observation.
    pub(super) fn with_room() -> Self {
        Self {
            window: Vec::with_capacity(1 + NEAREST),
            nearest: Vec::with_capacity(512),
            handful: Vec::with_capacity(64),
            windows: Vec::new(),
            looked_at: Vec::with_capacity(1 << NEAREST),
        }
    }

    /// Begins a round with a frame of so many observations.
    pub(super) fn begin(&mut self, observations: usize) {
        self.windows.clear();
        self.windows.resize(observations, None);
    }

    /// Looks at the handfuls of an observation, but those that were looked at in the turn of another; hands on the likeliest, each ascending. Returns
    /// how many it looked at.
    pub(super) fn around(
        &mut self,
        context: &Context<'_>,
        groups: &Groups,
        observation: usize,
        matcher: &mut Matcher,
        mut with: impl FnMut(&[usize], &mut Matcher),
    ) -> u32 {
        let nearest = self.open_window(context, observation, matcher);
        self.looked_at.clear();
        let most = matcher.most_visible().max(1) as u32;
        let seen = self.seen_before();
        let mut looks = 0;
        for mask in (1usize..1 << self.window.len()).step_by(2) {
            if mask.count_ones() > most || seen.iter().any(|before| before.has(mask)) {
                continue;
            }
            looks += 1;
            self.gather(mask);
            let Some(log_density) = matcher.log_density(context, &self.handful) else { continue };
            let clutter: f64 = self.handful.iter().map(|&spot| context.clutter[spot]).sum();
            let gain = log_density + context.log_neighbours - clutter;
            if gain > POOR_GAIN {
                self.looked_at.push((gain, mask));
            }
        }
        self.looked_at.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for index in 0..self.looked_at.len().min(MOST_WEIGHED) {
            self.gather(self.looked_at[index].1);
            with(&self.handful, matcher);
        }
        if let (&[_], Some(nearest)) = (groups.group_of(observation), nearest) {
            self.handful.clear();
            self.handful.push(observation);
            self.handful.extend_from_slice(groups.group_of(nearest));
            self.handful.sort_unstable();
            if self.handful.len() <= most as usize {
                with(&self.handful, matcher);
            }
        }
        looks
    }

    /// Opens the window around an observation; returns the one nearest to it.
    fn open_window(&mut self, context: &Context<'_>, observation: usize, matcher: &Matcher) -> Option<usize> {
        let own = &context.sightings[observation];
        let reach_rad = matcher.widest_rad(own);
        let Self { window, nearest, .. } = self;
        let others = context.sightings.iter().enumerate().filter(|(index, _)| *index != observation);
        let gaps =
            others.map(|(index, other)| ((other.bearing.vector() - own.bearing.vector()).norm(), index));
        let first = gaps.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.clear();
        nearest.extend(gaps.filter(|(gap, _)| *gap < reach_rad));
        nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        window.clear();
        window.push(observation);
        window.extend(nearest.iter().take(NEAREST).map(|&(_, index)| index));
        self.windows[observation] = Some(core::array::from_fn(|place| window.get(place).copied()));
        first.map(|(_, index)| index)
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
