//! The kinds of vehicles that may be seen, taken together: a handful of observations is a neighbour of any one of them, each as likely beforehand.
//!
//! In: groups of observations. Out: how well a group is a neighbour of some kind, and a candidate for each kind that it may be.

use alloc::vec::Vec;

use super::Sighting;
use super::candidates::Candidates;
use super::context::Context;
use super::error::LocatorError;
use super::matching::Matcher;
use super::neighbour::{Distance, Located, Neighbour};
use super::posing::Poser;
use super::settings::Settings;
use crate::airframe::Airframe;
use crate::pose;

/// A group whose first look as one kind is less likely than as another by so much, nats, is not weighed as that kind.
const UNLIKE: f64 = 12.0;

/// A kind of vehicle that is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// How it is built.
    pub airframe: Airframe,
    /// How far its markers are from where the airframe has them, m per axis: takes the place of [`pose::Settings::marker_sigma_m`].
    pub marker_sigma_m: f64,
    /// Spread of power between its LEDs, sigma of its natural logarithm: takes the place of [`pose::Settings::unit_sigma`].
    pub unit_sigma: f64,
}

impl Kind {
    /// An airframe of which nothing else is known than what the settings have of all.
    pub fn new(airframe: Airframe, settings: &pose::Settings) -> Self {
        Self { airframe, marker_sigma_m: settings.marker_sigma_m, unit_sigma: settings.unit_sigma }
    }

    /// What is believed of its pose, of these settings for all kinds.
    pub fn believed(&self, settings: &pose::Settings) -> pose::Settings {
        pose::Settings { marker_sigma_m: self.marker_sigma_m, unit_sigma: self.unit_sigma, ..*settings }
    }
}

/// The kinds that are looked for.
#[derive(Debug)]
pub(super) struct Kinds {
    each: Vec<Looked>,
    /// How likely a group is each kind by a first look, for [`Self::weigh`].
    looks: Vec<Option<f64>>,
}

/// What one kind is recognised by.
#[derive(Debug)]
struct Looked {
    matcher: Matcher,
    poser: Poser,
}

impl Kinds {
    pub(super) fn new(kinds: &[Kind], settings: &Settings) -> Result<Self, LocatorError> {
        if kinds.is_empty() {
            return Err(LocatorError::NoKind);
        }
        let looked = |(number, kind): (usize, &Kind)| {
            let (airframe, believed) = (&kind.airframe, kind.believed(&settings.pose));
            Ok(Looked {
                poser: Poser::new(airframe, believed, (number, kinds.len()))?,
                matcher: Matcher::new(airframe, settings.max_tilt_rad, &believed),
            })
        };
        let each = kinds.iter().enumerate().map(looked).collect::<Result<_, LocatorError>>()?;
        Ok(Self { each, looks: Vec::with_capacity(kinds.len()) })
    }

    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        self.each.iter_mut().for_each(|kind| kind.matcher.begin());
    }

    /// How many first looks at a handful the frame took so far.
    pub(super) fn looks(&self) -> u32 {
        self.each.iter().map(|kind| kind.matcher.compared()).sum()
    }

    /// Most spots that one neighbour can show.
    pub(super) fn most_visible(&self) -> usize {
        self.each.iter().map(|kind| kind.matcher.most_visible()).max().unwrap_or(0)
    }

    /// How far apart spots of one neighbour may be when one of them looks like this, rad: as near as its size suggests.
    pub(super) fn widest_rad(&self, sighting: &Sighting) -> f64 {
        self.each.iter().map(|kind| kind.matcher.widest_rad(sighting)).fold(0.0, f64::max)
    }

    /// What the claim costs that these spots, at least one, are one neighbour of some kind, nats.
    pub(super) fn nats(&mut self, context: &Context<'_>, group: &[usize]) -> f64 {
        self.each.iter_mut().map(|kind| kind.matcher.nats(context, group)).fold(f64::INFINITY, f64::min)
    }

    /// The light that an LED of a group would have straight ahead at 1 m if it is the neighbour it looks like, as a logarithm. Of several kinds nobody tells
    /// it: as another kind the group is at another distance with other LEDs, and its own guess would confirm itself.
    pub(super) fn log_power(&mut self, context: &Context<'_>, group: &[usize]) -> Option<f64> {
        match self.each.as_mut_slice() {
            [only] => only.matcher.log_power(context, group),
            _ => None,
        }
    }

    /// A first look at how likely a handful is one neighbour of any kind, as [`Matcher::log_density`] has it of one.
    pub(super) fn log_density(&mut self, context: &Context<'_>, group: &[usize]) -> Option<f64> {
        match self.each.as_mut_slice() {
            [only] => only.matcher.log_density(context, group),
            several => {
                self.looks.clear();
                self.looks.extend(several.iter_mut().map(|kind| kind.matcher.log_density(context, group)));
                let best = likeliest(&self.looks)?;
                let sum: f64 = self.looks.iter().flatten().map(|look| libm::exp(look - best)).sum();
                Some(best + libm::log(sum / self.looks.len() as f64))
            }
        }
    }

    /// The same look in any light, as [`Matcher::log_density_in_any_light`] has it, as the kind that it looks most like.
    pub(super) fn log_density_in_any_light(&mut self, context: &Context<'_>, group: &[usize]) -> f64 {
        let look = |kind: &mut Looked| kind.matcher.log_density_in_any_light(context, group);
        self.each.iter_mut().map(look).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The most that [`Self::log_density`] can be, and how much less for each spot fewer, as [`Matcher::most_of_look`] has it of one kind.
    pub(super) fn most_of_look(
        &self,
        context: &Context<'_>,
        spots: usize,
        widest2_rad2: f64,
        is_lit: bool,
    ) -> [f64; 2] {
        let each = self.each.iter();
        let looks = each.map(|kind| kind.matcher.most_of_look(context, spots, widest2_rad2, is_lit));
        looks.fold([f64::NEG_INFINITY; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    }

    /// The most that a look at two spots and others can have of these two, as any kind.
    pub(super) fn most_of_pair(&mut self, context: &Context<'_>, pair: &[usize]) -> f64 {
        let most = |kind: &mut Looked| kind.matcher.most_of_pair(context, pair);
        self.each.iter_mut().map(most).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The most that a full look can make of a group of at least two, as any kind.
    pub(super) fn most_in_full(&self, context: &Context<'_>, group: &[usize]) -> f64 {
        let most = |kind: &Looked| kind.matcher.most_in_full(context, group);
        self.each.iter().map(most).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Widens the bounds of neighbours to those of every kind that they may be: no probability rules a kind out of a strict bound.
    pub(super) fn widen_bounds(&mut self, context: &Context<'_>, located: &mut Located) {
        if self.each.len() == 1 {
            return;
        }
        for Neighbour { sightings, distance: Distance { bounds, .. }, .. } in &mut located.neighbours {
            let of_kinds = self.each.iter_mut().filter_map(|kind| kind.matcher.bounds(context, sightings));
            *bounds = of_kinds.fold(*bounds, |all, own| all.hull(&own));
        }
    }

    /// Adds the candidates that a group, ascending, is: one of each kind that it may be, where `has_work` for it.
    pub(super) fn weigh(
        &mut self,
        context: &Context<'_>,
        group: &[usize],
        candidates: &mut Candidates,
        mut has_work: impl FnMut() -> bool,
    ) {
        if self.each.len() > 1 {
            self.log_density(context, group);
        }
        let likeliest = likeliest(&self.looks);
        for (number, Looked { matcher, poser }) in self.each.iter_mut().enumerate() {
            // What a look cannot tell it does not rule out.
            let look = self.looks.get(number).copied().flatten();
            let is_unlike = look.zip(likeliest).is_some_and(|(look, best)| look < best - UNLIKE);
            if !is_unlike && group.len() <= matcher.most_visible().max(1) && has_work() {
                poser.weigh(context, group, matcher, candidates);
            }
        }
        candidates.note(group);
    }
}

fn likeliest(looks: &[Option<f64>]) -> Option<f64> {
    looks.iter().copied().flatten().reduce(f64::max)
}
