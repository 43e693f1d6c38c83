//! Observations -> neighbours: the frame explained as a whole, within a budget of work.
//!
//! ```text
//! groups        which observations are next to each other          grouping
//! first looks   how much of that is clutter                        matching, clutter
//! candidates    each group in full, its rivals, and other ways to   posing; grouping; alternatives
//!               put together what is doubtful
//! explanation   how likely each candidate is, all taken together    explanation, clutter
//! neighbours    the likeliest that share nothing                    telling
//! ```
//!
//! How dense clutter is and how many neighbours there are is told by the frame itself, with what [`Memory`] has of those before; where they are, by those alone. Little clutter
//! and much both bear themselves out (what is near clutter is clutter): both are tried, and what makes the frame likelier is right.

use alloc::vec::Vec;

use super::alternatives::{Alternatives, Question};
use super::candidates::Candidates;
use super::clutter::{Clutter, Counts, Surroundings};
use super::companions::Companions;
use super::context::{Context, KnownWhereabouts};
use super::explanation::Explanation;
use super::fixtures::Fixtures;
use super::grouping::{CLEAR_SPOTS, Groups};
use super::input::Input;
use super::kinds::{Kind, Kinds};
use super::memory::{Frame, Memory, Spread, Told};
use super::near::Near;
use super::neighbour::Located;
use super::number::Number;
use super::places::Places;
use super::settings::Settings;
use super::telling::Telling;
use super::whereabouts::Whereabouts;
use super::{LocatorError, Stage};
use crate::camera::{Camera, Watched};
use crate::pose::{LightSpread, LogLight, Missed, Tilting};

/// This many of the observations nearest to each are known, and as many as one neighbour shows.
const FEWEST_BESIDE: usize = 16;
/// Most first looks, each at what the one before leaves as clutter.
const LOOKS: usize = 4;
/// An observation that is likelier than this to be clutter may be another neighbour's.
const DOUBTFUL: f64 = 0.05;
/// A neighbour that is likelier than this tells the light of the LEDs.
const SURE: f64 = 0.98;
/// Rounds of looking for other ways to put observations together, each at what the one before left.
const ROUNDS: usize = 2;
/// Rounds of telling how dense clutter is from what is explained, and what is explained from that.
const CLUTTER_ROUNDS: usize = 2;
/// Asked for neighbours less likely than this, it also tells what a first look takes for clutter.
const UNLIKELY: f64 = 1e-3;
/// A group that a first look has for so much less likely than clutter, nats, is not weighed.
const UNPROMISING: f64 = -8.0;
/// A look that changes no more than this, nats, is the last.
const SMALL_GAIN: f64 = 1e-3;
/// Weighing a candidate in full is as much work as this many first looks.
const LOOKS_PER_WEIGHING: u32 = 32;

/// Explains the frames of one camera. Keeps its room.
#[derive(Debug)]
pub(super) struct Inference {
    min_probability: f64,
    budget: u32,
    /// How often a marker that must show is supposed not to.
    supposed_miss_rate: f64,
    /// How far neighbours are supposed to tilt.
    supposed_tilt_sigma_rad: f64,
    near: Near,
    kinds: Kinds,
    groups: Groups,
    memory: Memory,
    /// Where the neighbours of this frame are.
    whereabouts: Whereabouts,
    size: [usize; 2],
    with_light: bool,
    /// Clutter of what there is no work for.
    besides: Counts,
    /// Clutter that rejected regions say there is.
    beforehand: Counts,
    companions: Companions,
    fixtures: Fixtures,
    places: Places,
    /// Clutter after a first look, and with what is explained.
    first_clutter: Clutter,
    clutter: Clutter,
    candidates: Candidates,
    alternatives: Alternatives,
    promising: Vec<usize>,
    doubtful: Vec<usize>,
    explanation: Explanation,
    /// The same from the other supposition.
    other_clutter: Clutter,
    other_explanation: Explanation,
    /// Logarithms of the light of sure neighbours.
    log_powers: Vec<f64>,
    telling: Telling,
}

impl Inference {
    pub(super) fn new(camera: &Camera, kinds: &[Kind], settings: &Settings) -> Result<Self, LocatorError> {
        let size = [camera.width(), camera.height()];
        // A larger budget finds its room as it goes.
        let most = (settings.budget.min(Settings::DEFAULT_BUDGET) / LOOKS_PER_WEIGHING) as usize;
        let with_light = settings.pose.use_brightness;
        let clutter = Clutter::new(size, with_light);
        let besides = Counts::of(size);
        let whereabouts = Whereabouts::new(*besides.cells());
        Ok(Self {
            min_probability: settings.min_probability,
            budget: settings.budget,
            supposed_miss_rate: settings.pose.missed,
            supposed_tilt_sigma_rad: settings.pose.tilt_sigma_rad,
            near: Near::default(),
            kinds: Kinds::new(kinds, settings)?,
            groups: Groups::default(),
            memory: Memory::new(besides.len(), whereabouts.counts().len()),
            whereabouts,
            size,
            with_light,
            besides,
            beforehand: Counts::of(size),
            companions: Companions::new(),
            fixtures: Fixtures::new(with_light),
            places: Places::default(),
            first_clutter: Clutter::new(size, with_light),
            clutter,
            candidates: Candidates::with_room(most),
            alternatives: Alternatives::with_room(),
            promising: Vec::new(),
            doubtful: Vec::new(),
            explanation: Explanation::with_room(most),
            other_clutter: Clutter::new(size, with_light),
            other_explanation: Explanation::with_room(most),
            log_powers: Vec::with_capacity(most),
            telling: Telling::with_room(most),
        })
    }

    /// Forgets what frames told of the power of LEDs and of clutter.
    pub(super) fn forget(&mut self) {
        self.memory.forget();
        self.fixtures.forget();
    }

    /// This many observations of a frame are explained, its first.
    pub(super) fn most(&self) -> usize {
        (self.budget / 2) as usize
    }

    /// Tells the neighbours behind the observations of `located`.
    pub(super) fn explain(&mut self, located: &mut Located, watched: Watched<'_>, input: &mut Input<'_>) {
        let all = core::mem::take(&mut located.sightings);
        let (sightings, besides) = all.split_at(all.len().min(self.most()));
        self.besides.count(besides);
        self.beforehand.expect(&located.rejected);
        let mut near = core::mem::take(&mut self.near);
        near.sort(sightings, self.kinds.most_visible().max(FEWEST_BESIDE));
        let miss_rate = self.memory.miss_rate(self.supposed_miss_rate);
        located.miss_rate = Some(miss_rate);
        let tilt_sigma_rad = self.memory.tilt_sigma_rad(self.supposed_tilt_sigma_rad);
        located.tilt_sigma_rad = Some(tilt_sigma_rad);
        let light_times = self.memory.light_times();
        located.light_times = Some(light_times);
        let context = Context {
            sightings,
            near: &near,
            gravity: input.gravity,
            watched,
            power: None,
            detection_limit: located.detection_limit,
            miss_rate,
            tilt_sigma_rad,
            light_times,
            clutter: &[],
            log_neighbours: 0.0,
            known: None,
        };
        self.kinds.begin();
        let of_frame = self.groups.sort_out(&context, &mut self.kinds);
        self.companions.find(sightings, self.size, self.with_light);
        self.fixtures.find(sightings);
        let frame_px = (self.size[0] * self.size[1]) as f64;
        let cells = (self.besides.cells(), frame_px);
        self.places.find(sightings, cells, &self.fixtures, input.sun, self.with_light);
        let number = Number::of(&self.memory);
        self.look(&context, &number);
        input.tell(Stage::Grouping);
        let context = Context { power: self.memory.power().or(of_frame), ..context };
        let mut work = Work { left: self.budget };
        self.weigh_groups(&context, &number, &mut work);
        self.alternatives.begin(sightings.len());
        self.doubtful.clear();
        for round in 0..ROUNDS {
            self.doubt(&context, &number, round);
            self.look_for_others(&context, &number, round, &mut work);
            self.settle(&number);
        }
        self.fixtures.remember(sightings, |spot| self.explanation.clutter(spot));
        let power = self.power(&context);
        self.find_whereabouts();
        let (tilting, light_spread) = spreads(&self.candidates, &self.explanation);
        let of_clutter = |spot: usize| self.explanation.clutter(spot);
        let counts = self.clutter.counts_to_remember(self.places.each(), &self.besides, of_clutter);
        self.memory.remember(Frame {
            clutter: counts,
            neighbours: self.explanation.neighbours(),
            whereabouts: self.whereabouts.counts(),
            power,
            missed: missed(&self.candidates, &self.explanation),
            tilting,
            light_spread,
        });
        located.is_complete = work.left > 0 && besides.is_empty();
        self.telling.tell(
            &self.candidates,
            &self.explanation,
            (self.min_probability, sightings.len()),
            located,
        );
        self.kinds.widen_bounds(&context, located);
        located.sightings = all;
        self.near = near;
        input.tell(Stage::Posing);
    }

    /// Takes a first look at each group, and tells from that how dense clutter is.
    fn look(&mut self, context: &Context<'_>, number: &Number) {
        let Self { groups, first_clutter, besides, beforehand, companions, places, memory, kinds, .. } = self;
        let frame = Surroundings { places: places.each(), besides, beforehand, companions, memory };
        groups.look(context, kinds);
        let mut supposed = |share: f64| {
            groups.suppose(context.sightings.len(), share);
            let mut gain = f64::NAN;
            for _ in 0..LOOKS {
                let before = gain;
                first_clutter.measure(&frame, groups, |spot| groups.clutter(spot));
                let log_neighbours = number.log_density(groups.neighbours());
                let as_measured = groups.weigh_looks(first_clutter.log_density(), log_neighbours);
                gain = as_measured - number.excess(groups.neighbours(), log_neighbours);
                if (gain - before).abs() < SMALL_GAIN {
                    break;
                }
            }
            gain - first_clutter.excess(&frame, |spot| groups.clutter(spot))
        };
        let [much, little] = [1.0, 0.0].map(&mut supposed);
        if much > little {
            supposed(1.0);
        }
    }

    /// Weighs the groups that may be neighbours by a first look, the likeliest first, and then their rivals.
    fn weigh_groups(&mut self, context: &Context<'_>, number: &Number, work: &mut Work) {
        let Self { groups, memory, first_clutter, candidates, promising, kinds, budget, .. } = self;
        let known = Some(known(&self.whereabouts, memory, &self.places));
        let log_neighbours = number.log_density(groups.neighbours());
        let context = Context { clutter: first_clutter.log_density(), log_neighbours, known, ..*context };
        candidates.clear();
        promising.clear();
        let poor_gain = if self.min_probability > UNLIKELY { UNPROMISING } else { f64::NEG_INFINITY };
        promising.extend((0..groups.len()).filter(|&group| groups.gain(group) > poor_gain));
        promising.sort_unstable_by(|&a, &b| groups.gain(b).total_cmp(&groups.gain(a)).then(a.cmp(&b)));
        for &group in promising.iter() {
            kinds.weigh(&context, groups.group(group), candidates, || work.weigh());
        }
        for &group in promising.iter() {
            // Half of the work is kept for what a first look does not take for a neighbour.
            if work.left < *budget / 2 {
                break;
            }
            work.look(groups.find_rivals((group, poor_gain), &context, kinds, candidates));
            for rival in groups.rivals() {
                kinds.weigh(&context, rival, candidates, || work.weigh());
            }
        }
        self.explanation.suppose(context.sightings.len(), |spot| groups.clutter(spot));
        self.explanation.explain(&self.candidates, context.clutter, |_| log_neighbours);
    }

    /// Finds the observations that may be something else than they seem, or might before, the brightest first.
    fn doubt(&mut self, context: &Context<'_>, number: &Number, round: usize) {
        let Self { doubtful, explanation, groups, candidates, first_clutter, .. } = self;
        let sightings = context.sightings;
        doubtful.extend((0..sightings.len()).filter(|&spot| explanation.clutter(spot) > DOUBTFUL));
        if round == 0 {
            let log_neighbours = number.log_density(groups.neighbours());
            let context = Context { clutter: first_clutter.log_density(), log_neighbours, ..*context };
            for members in (0..groups.len()).map(|group| groups.group(group)) {
                if candidates.is_doubtful(&context, members) {
                    doubtful.extend_from_slice(members);
                }
            }
        }
        let light = |spot: usize| sightings[spot].log_light.map_or(0.0, |LogLight { value, .. }| value);
        doubtful.sort_unstable_by(|&a, &b| light(b).total_cmp(&light(a)).then(a.cmp(&b)));
        doubtful.dedup();
    }

    /// Weighs other ways to put together what is doubtful.
    fn look_for_others(&mut self, context: &Context<'_>, number: &Number, round: usize, work: &mut Work) {
        let (clutter, neighbours) = match round {
            0 => (&self.first_clutter, self.groups.neighbours()),
            _ => (&self.clutter, self.explanation.neighbours()),
        };
        let log_neighbours = number.log_density(neighbours);
        let known = Some(known(&self.whereabouts, &self.memory, &self.places));
        let context = Context { clutter: clutter.log_density(), log_neighbours, known, ..*context };
        let Self { alternatives, doubtful, groups, kinds, candidates, explanation, .. } = self;
        explanation.hold(candidates);
        for &spot in doubtful.iter() {
            if work.left == 0 {
                break;
            }
            let asked = Question { context: &context, groups, explanation, candidates };
            work.look(alternatives.look(&asked, spot, kinds));
            alternatives.choose(&asked, spot, kinds);
            for handful in alternatives.chosen() {
                if !candidates.was_weighed(handful) {
                    kinds.weigh(&context, handful, candidates, || work.weigh());
                }
            }
        }
    }

    /// What neighbours that are sure tell of the light of the frame's LEDs: the median of their logarithms, as they look whatever power was known before. A
    /// first look at how observations lie beside each other is not sure: it takes a lamp that goes along with a neighbour for its marker time and again. Two
    /// spots tell it only where no neighbour shows three.
    fn power(&mut self, context: &Context<'_>) -> Option<Told> {
        let Self { log_powers, candidates, explanation, kinds, .. } = self;
        for fewest in [CLEAR_SPOTS, 2] {
            log_powers.clear();
            for index in (0..candidates.len()).filter(|&index| explanation.probability(index) > SURE) {
                let members = candidates.members(index);
                if members.len() >= fewest {
                    log_powers.extend(kinds.log_power(context, members));
                }
            }
            if !log_powers.is_empty() {
                log_powers.sort_unstable_by(f64::total_cmp);
                let log_power = log_powers[log_powers.len() / 2];
                let is_clear = fewest == CLEAR_SPOTS;
                let spread = Spread::of(log_powers).filter(|_| is_clear);
                return Some(Told { log_power, is_clear, spread });
            }
        }
        None
    }

    /// Counts where the neighbours are.
    fn find_whereabouts(&mut self) {
        let Self { whereabouts, candidates, explanation, places, .. } = self;
        whereabouts.clear();
        for index in 0..candidates.len() {
            let distance = candidates.get(index).distance.estimate;
            if let (Some(distance), [first, ..]) = (distance, candidates.members(index)) {
                let cell = places.each()[*first].cell;
                whereabouts.add(cell, distance.distance_m, explanation.probability(index));
            }
        }
    }

    /// Explains the frame by its candidates, with clutter and neighbours as dense as the explanation itself has them.
    fn settle(&mut self, number: &Number) {
        let much = self.suppose(number, None);
        core::mem::swap(&mut self.explanation, &mut self.other_explanation);
        core::mem::swap(&mut self.clutter, &mut self.other_clutter);
        let little = self.suppose(number, Some(0.0));
        if much > little {
            core::mem::swap(&mut self.explanation, &mut self.other_explanation);
            core::mem::swap(&mut self.clutter, &mut self.other_clutter);
        }
    }

    /// Explains the frame from the supposition that each observation is as likely clutter, or as a first look has it. Returns the logarithm of how likely
    /// the frame then is.
    fn suppose(&mut self, number: &Number, share: Option<f64>) -> f64 {
        let Self { explanation, clutter, groups, candidates, companions, places, memory, .. } = self;
        let (besides, beforehand) = (&self.besides, &self.beforehand);
        let frame = Surroundings { places: places.each(), besides, beforehand, companions, memory };
        let supposed = |spot| share.unwrap_or(groups.clutter(spot));
        clutter.measure(&frame, groups, supposed);
        explanation.suppose(places.each().len(), supposed);
        let mut in_frame = groups.neighbours();
        let mut density = number.log_density(in_frame);
        for round in 0..=CLUTTER_ROUNDS {
            if round > 0 {
                clutter.measure(&frame, groups, |spot| explanation.clutter(spot));
                in_frame = explanation.neighbours();
                density = number.log_density(in_frame);
            }
            let one_more = |own: f64| density + number.one_more(in_frame - own);
            explanation.explain(candidates, clutter.log_density(), one_more);
        }
        let in_frame = explanation.neighbours();
        explanation.log_density(clutter.log_density())
            - clutter.excess(&frame, |spot| explanation.clutter(spot))
            - number.excess(in_frame, density)
            - number.excess_of_one_more(in_frame)
    }
}

/// The markers that must show of what is explained, and those of them that do not.
fn missed(candidates: &Candidates, explanation: &Explanation) -> Missed {
    let mut all = Missed::default();
    for index in 0..candidates.len() {
        let Missed { expected, missed } = candidates.get(index).missed;
        all.expected += explanation.probability(index) * expected;
        all.missed += explanation.probability(index) * missed;
    }
    all
}

/// How far those tilt that surely explain the frame, and how far their light is from what their airframe says.
fn spreads(candidates: &Candidates, explanation: &Explanation) -> (Tilting, LightSpread) {
    let (mut tilting, mut light) = (Tilting::default(), LightSpread::default());
    for index in (0..candidates.len()).filter(|&index| explanation.probability(index) > SURE) {
        let own = candidates.get(index);
        tilting.degrees += own.tilting.degrees;
        tilting.squares_rad2 += own.tilting.squares_rad2;
        light.degrees += own.light_spread.degrees;
        light.squares += own.light_spread.squares;
    }
    (tilting, light)
}

/// Work that is left for a frame, in first looks. Counted, not timed: the same frame is given up at the same place everywhere.
struct Work {
    left: u32,
}

impl Work {
    /// Takes the work of this many first looks.
    fn look(&mut self, looks: u32) {
        self.left = self.left.saturating_sub(looks);
    }

    /// Takes the work of weighing a candidate in full; `false` where that much is not left.
    fn weigh(&mut self) -> bool {
        let enough = self.left >= LOOKS_PER_WEIGHING;
        self.look(LOOKS_PER_WEIGHING);
        enough
    }
}

/// What frames before told of where neighbours are.
fn known<'a>(whereabouts: &'a Whereabouts, memory: &'a Memory, places: &'a Places) -> KnownWhereabouts<'a> {
    KnownWhereabouts { whereabouts, per_frame: memory.whereabouts(), places: places.each() }
}
