//! A doubtful group -> other ways to put its observations together with those around it.
//!
//! In: the groups of a frame, and one of them that is explained poorly or hardly better than clutter. Out: handfuls of its observations and of those
//! near it, the likeliest by a first look, each to be weighed in full. What they leave is clutter, or another neighbour's.

use super::context::Context;
use super::grouping::Groups;
use super::matching::Matcher;

/// Most observations of which all handfuls are looked at.
const MOST_LOOKED_AT: usize = 7;
/// Most handfuls that are weighed in full.
const MOST_WEIGHED: usize = 14;
/// A handful that is so much less likely than clutter by a first look, nats, is not weighed: first looks are as good.
const POOR_GAIN: f64 = -4.0;

/// Room to look for other handfuls in.
#[derive(Debug, Default)]
pub(super) struct Alternatives {
    window: Vec<usize>,
    handful: Vec<usize>,
    /// Gain over clutter by a first look, and which of the window.
    looked_at: Vec<(f64, usize)>,
}

impl Alternatives {
    /// Looks at the handfuls around a group; hands on the likeliest, each ascending. Returns how many it looked at.
    pub(super) fn around(
        &mut self,
        context: &Context<'_>,
        groups: &mut Groups,
        group: usize,
        matcher: &mut Matcher,
        mut with: impl FnMut(&[usize], &mut Matcher),
    ) -> usize {
        self.window.clear();
        self.window.extend_from_slice(groups.group(group));
        let own = self.window.len();
        if own > MOST_LOOKED_AT {
            self.without_one(matcher, with);
            return own;
        }
        let reach_rad = self.window.iter().map(|&spot| matcher.widest_rad(&context.sightings[spot])).fold(f64::INFINITY, f64::min);
        groups.each_near(context.sightings, group, reach_rad, |others| {
            if self.window.len() + others.len() <= MOST_LOOKED_AT {
                self.window.extend_from_slice(others);
            }
        });
        self.look(context, own, matcher);
        for index in 0..self.looked_at.len() {
            self.gather(self.looked_at[index].1);
            with(&self.handful, matcher);
        }
        (1 << self.window.len()) - 1
    }

    /// All but one of a group that is too large to be looked at in every handful.
    fn without_one(&mut self, matcher: &mut Matcher, mut with: impl FnMut(&[usize], &mut Matcher)) {
        let Self { window, handful, .. } = self;
        for &left in window.iter() {
            handful.clear();
            handful.extend(window.iter().copied().filter(|&spot| spot != left));
            handful.sort_unstable();
            with(handful, matcher);
        }
    }

    /// Looks at every handful of the window that has one of its first `own` observations.
    fn look(&mut self, context: &Context<'_>, own: usize, matcher: &mut Matcher) {
        self.looked_at.clear();
        for mask in 1usize..1 << self.window.len() {
            if mask & ((1 << own) - 1) == 0 {
                continue;
            }
            self.gather(mask);
            let Some(log_density) = matcher.log_density(context, &self.handful) else { continue };
            let clutter: f64 = self.handful.iter().map(|&spot| context.clutter[spot]).sum();
            if log_density + context.log_neighbours - clutter > POOR_GAIN {
                self.looked_at.push((log_density - clutter, mask));
            }
        }
        self.looked_at.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.looked_at.truncate(MOST_WEIGHED);
    }

    fn gather(&mut self, mask: usize) {
        self.handful.clear();
        self.handful.extend(self.window.iter().enumerate().filter(|(bit, _)| mask >> bit & 1 == 1).map(|(_, &spot)| spot));
        self.handful.sort_unstable();
    }
}
