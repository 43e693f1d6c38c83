//! How well a handful of spots looks like a view of the airframe.
//!
//! In: sightings that may be one neighbour. Out: what the claim that they are costs, in nats, and which of the airframe's
//! markers they may be, each with a first guess of the pose. A view matches up to a shift, a turn and a scale of the image;
//! the scale is the distance. With gravity the turn and the elevation are known but for the tilt.

mod image;
mod likeness;
mod most;
mod ordered;
mod outlined;
mod size;
mod triples;

use alloc::vec::Vec;
use core::f64::consts::TAU;

use nalgebra::Vector2;

use super::Sighting;
use super::blinking::lit;
use super::context::Context;
use super::posing::LOG_RANGE;
use super::views::{ELEVATION_STEP_RAD, Spread, Views};
use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{LANES, Lanes};
use crate::normal::ROOT_OF_TAU;
use crate::pose::{self, Hypotheses, LogDistance, POWER_RANGE, Pose, Symmetry};
use crate::ranging::{BoundedBearing, DistanceBounds, Interval};
use image::Image;
use likeness::{Handful, Likeness, Likenesses};
use most::{GRID_NATS, Most, Peak, first_light};
use ordered::Ordered;
use outlined::overlay;
use size::{plausible_m, size_nats};
use triples::Triples;

/// What a neighbour costs, nats: fewer neighbours are the better explanation.
pub(super) const NEIGHBOUR_NATS: f64 = 8.0;
/// A view that costs this much more than the best one, nats, is no first guess of a pose. Views are a coarse grid, and what
/// they cost as coarse.
const POOR_NATS: f32 = 9.0;
/// How far the grid of views leaves the logarithm of a light from the nearest one's.
const LOG_FLUX_GRID: f64 = 0.25;
/// Light alone does not rule a neighbour out.
const MOST_POWER_NATS: f64 = 30.0;
/// An outline that costs this much, nats, may be that of a neighbour that is not seen whole.
const POOR_OUTLINE_NATS: f64 = 6.0;
/// This many spots have closed forms.
const FEWEST_IN_PART: usize = 3;
/// What cannot be, nats.
pub(super) const IMPOSSIBLE: f64 = 1e9;

/// Matches groups of sightings against the views of an airframe.
#[derive(Debug)]
pub(super) struct Matcher {
    views: Views,
    triples: Triples,
    most: Most,
    bounds: DistanceBounds,
    symmetry: Symmetry,
    tilt_sigma_rad: f64,
    log_flux_sigma: f64,
    unseen_nats: f64,
    bearings: Vec<BoundedBearing>,
    places: Vec<Vector2<f64>>,
    costs: Vec<Lanes>,
    likenesses: Likenesses,
    compared: u32,
}

impl Matcher {
    pub(super) fn new(airframe: &Airframe, max_tilt_rad: f64, believed: &pose::Settings) -> Self {
        let unseen_nats: Vec<f64> =
            lit(airframe).iter().map(|lit| -libm::log(1.0 - lit * (1.0 - believed.missed))).collect();
        let grid_rad = ELEVATION_STEP_RAD / 2.0;
        let symmetry = Symmetry::of(airframe);
        let views = Views::of(airframe, &symmetry, &unseen_nats);
        let bounds = DistanceBounds::new(airframe, max_tilt_rad);
        let log_flux_sigma = libm::hypot(LOG_FLUX_GRID, believed.unit_sigma);
        let most_unseen_nats = unseen_nats.iter().copied().fold(0.0, f64::max);
        let shows = (views.most_visible, bounds.near_m());
        Self {
            most: Most::new(shows, believed, log_flux_sigma, most_unseen_nats),
            views,
            triples: Triples::of(airframe, &symmetry),
            symmetry,
            bounds,
            // The grid of views adds half a step.
            tilt_sigma_rad: libm::hypot(believed.tilt_sigma_rad, grid_rad),
            log_flux_sigma,
            unseen_nats: most_unseen_nats,
            bearings: Vec::new(),
            places: Vec::new(),
            costs: Vec::new(),
            likenesses: Likenesses::none(),
            compared: 0,
        }
    }

    /// Begins a frame: what handfuls of another looked like is forgotten.
    pub(super) fn begin(&mut self) {
        self.likenesses.forget();
        self.compared = 0;
    }

    /// How many handfuls of the frame were compared with the views so far; to know one again is no work.
    pub(super) fn compared(&self) -> u32 {
        self.compared
    }

    /// Most spots that one neighbour can show.
    pub(super) fn most_visible(&self) -> usize {
        self.views.most_visible
    }

    /// How far the outermost marker is from the airframe's origin, m.
    pub(super) fn reach_m(&self) -> f64 {
        self.bounds.near_m()
    }

    /// How far apart spots of one neighbour may be when one of them looks like this, rad: as near as its size suggests.
    pub(super) fn widest_rad(&self, sighting: &Sighting) -> f64 {
        let nearest_m = match sighting.range {
            Some(range) => range.min_m(),
            None => 2.0 * plausible_m(sighting).nearest_m,
        };
        2.0 * self.bounds.near_m() / nearest_m.max(self.bounds.near_m())
    }

    /// The distances that angles and sizes of these spots allow, strictly; `None` when they cannot be one neighbour.
    pub(super) fn bounds(&mut self, context: &Context<'_>, group: &[usize]) -> Option<Interval> {
        let Context { sightings, gravity, .. } = *context;
        self.bearings.clear();
        let bounded = |&index: &usize| {
            let Sighting { bearing, bound_rad, .. } = sightings[index];
            BoundedBearing { bearing, bound_rad }
        };
        self.bearings.extend(group.iter().map(bounded));
        let by_angle = self.bounds.interval(&self.bearings, gravity)?;
        let ranges = group.iter().filter_map(|&index| sightings[index].range);
        // A marker is nearer to or farther from the camera than the airframe's origin by up to its radius.
        let reach_m = self.bounds.near_m();
        ranges.map(|range| widened(&range, reach_m)).try_fold(by_angle, |all, range| all.intersect(&range?))
    }

    /// What the size of a lone spot says of its neighbour's distance.
    pub(super) fn lone_distance(&self, sighting: &Sighting, bounds: &Interval) -> LogDistance {
        let plausible = plausible_m(sighting);
        let nearest_m = bounds.min_m().max(plausible.nearest_m.min(bounds.max_m()));
        let farthest_m = bounds.max_m().min(plausible.farthest_m.max(bounds.min_m())).max(1.01 * nearest_m);
        // Even over the logarithm of distance, neither near nor far is favoured: the mean and the mean square.
        let spread = libm::log(farthest_m / nearest_m);
        let mean_m = (farthest_m - nearest_m) / spread;
        let square_m2 = (farthest_m * farthest_m - nearest_m * nearest_m) / (2.0 * spread);
        LogDistance { mean: libm::log(mean_m), sigma: (square_m2 / (mean_m * mean_m) - 1.0).max(1e-6).sqrt() }
    }

    /// The light that an LED of a group would have straight ahead at 1 m if it is the neighbour it looks like, as a logarithm.
    pub(super) fn log_power(&mut self, context: &Context<'_>, group: &[usize]) -> Option<f64> {
        self.likeness(context, group)?.log_power(context.sightings, group)
    }

    /// What the claim costs that these spots, at least one, are one neighbour, nats.
    pub(super) fn nats(&mut self, context: &Context<'_>, group: &[usize]) -> f64 {
        if group.len() == 1 {
            return NEIGHBOUR_NATS + self.views.lone_nats;
        }
        if group.len() > self.views.most_visible {
            return IMPOSSIBLE;
        }
        let sightings = context.sightings;
        if self.views.arrangements(group.len()).is_none() {
            return self.outlined_nats(context, group).map_or(IMPOSSIBLE, |(nats, distance_m)| {
                NEIGHBOUR_NATS + nats + size_nats(sightings, group, distance_m)
            });
        }
        self.likeness(context, group).map_or(IMPOSSIBLE, |likeness| {
            NEIGHBOUR_NATS
                + likeness.views_nats
                + size_nats(sightings, group, likeness.distance_m)
                + power_nats(context, group, &likeness)
        })
    }

    /// What the outline of a group costs, nats, as a whole or as a part of what could be seen, and the distance at which it fits best, m.
    fn outlined_nats(&mut self, context: &Context<'_>, group: &[usize]) -> Option<(f64, f64)> {
        self.bounds(context, group)?;
        let image = Image::of(context, group, &mut self.places)?;
        let whole = outlined_nats(&self.views, &image, self.tilt_sigma_rad, self.unseen_nats);
        let part = match whole {
            Some((nats, _)) if nats < POOR_OUTLINE_NATS => None,
            _ => self.partly_seen_nats(context, group),
        };
        whole.into_iter().chain(part).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// What a group of at least two looks like, worked out once a frame; `None` where it cannot be one neighbour, or too many show to be put in order.
    fn likeness(&mut self, context: &Context<'_>, group: &[usize]) -> Option<Likeness> {
        self.views.arrangements(group.len())?;
        let handful = Handful::of(group)?;
        if let Some(known) = self.likenesses.of(&handful) {
            return known;
        }
        self.compared += 1;
        let likeness = self.compare(context, handful.spots());
        self.likenesses.keep(handful, likeness);
        likeness
    }

    /// Compares a group with the views.
    fn compare(&mut self, context: &Context<'_>, group: &[usize]) -> Option<Likeness> {
        self.bounds(context, group)?;
        let image = Image::of(context, group, &mut self.places)?;
        let arrangements = self.views.arrangements(group.len())?;
        let seen = Ordered::of(&image, context.sightings, group, self.log_flux_sigma);
        let best = seen.costs(arrangements, &image, self.tilt_sigma_rad, &mut self.costs);
        let lit = group.iter().filter(|&&spot| context.sightings[spot].log_light.is_some()).count();
        let log_peak = log_peak_of_places(&self.views, &seen, &image, self.tilt_sigma_rad)
            - lit.saturating_sub(1) as f64 * seen.log_light_width()
            - libm::log(LOG_RANGE);
        Some(Likeness::of(&seen, &image, &best, &self.costs, (log_peak, lit > 0)))
    }

    /// A first look at how likely a handful is one neighbour: the logarithm of its density, as [`crate::pose::Posterior::log_evidence`] has it but from the
    /// grid of views; `None` where it cannot be one, or too many show to be put in order.
    ///
    /// Of the places of k spots four numbers are the neighbour's own (two of direction, distance and turn); the others are off the grid by its error.
    pub(super) fn log_density(&mut self, context: &Context<'_>, group: &[usize]) -> Option<f64> {
        if group.len() == 1 {
            return Some(-libm::log(POWER_RANGE) - self.lone_nats(context, group[0]));
        }
        if group.len() > self.views.most_visible {
            return None;
        }
        let likeness = self.likeness(context, group)?;
        Some(
            log_density_of_views(context, &likeness)
                - power_nats(context, group, &likeness)
                - size_nats(context.sightings, group, likeness.distance_m),
        )
    }

    /// The most that a look at two spots and others can have of these two, before the others add to it: as likely as all views together have them, at
    /// whatever distance. The view that two look most like may be much nearer than the one that they are seen in with others, and their power speaks
    /// against that one alone.
    pub(super) fn most_of_pair(&mut self, context: &Context<'_>, pair: &[usize]) -> f64 {
        let likeness = self.likeness(context, pair);
        likeness.map_or(f64::NEG_INFINITY, |likeness| log_density_of_views(context, &likeness))
    }

    /// The same look at the most that a full one can make of it, whatever the lights of the handful, of at least two: what hardly shows is hardly told by its
    /// light. Nothing where it cannot be one neighbour, and infinite where too many show to be put in order.
    pub(super) fn log_density_in_any_light(&mut self, context: &Context<'_>, group: &[usize]) -> f64 {
        if group.len() > self.views.most_visible || self.bounds(context, group).is_none() {
            return f64::NEG_INFINITY;
        }
        let Some(arrangements) = self.views.arrangements(group.len()) else { return f64::INFINITY };
        let Some(image) = Image::of(context, group, &mut self.places) else { return f64::NEG_INFINITY };
        let seen = Ordered::of(&image, context.sightings, group, f64::INFINITY);
        let best = seen.costs(arrangements, &image, self.tilt_sigma_rad, &mut self.costs);
        let log_peak =
            log_peak_of_places(&self.views, &seen, &image, self.tilt_sigma_rad) - libm::log(LOG_RANGE);
        let likeness = Likeness::of(&seen, &image, &best, &self.costs, (log_peak, false));
        likeness.log_density + self.most.log_light(context, group) + GRID_NATS
    }

    /// The most that [`Self::log_density`] can be for so many spots, the farthest apart at this squared gap, and how much less it is for each spot fewer;
    /// infinite where too many show to be put in order.
    pub(super) fn most_of_look(
        &self,
        context: &Context<'_>,
        spots: usize,
        widest2_rad2: f64,
        is_lit: bool,
    ) -> [f64; 2] {
        let peak = self.most.peak_of_look(widest2_rad2, is_lit);
        [self.most_with(context, spots, widest2_rad2, peak), self.most.further(peak)]
    }

    /// The most that a full look can make of a group of at least two; infinite where too many show to be put in order.
    pub(super) fn most_in_full(&self, context: &Context<'_>, group: &[usize]) -> f64 {
        let direction = |spot: usize| context.sightings[spot].bearing.vector();
        let gaps = group.iter().enumerate().flat_map(|(place, &a)| {
            group[..place].iter().map(move |&b| (direction(a) - direction(b)).norm_squared())
        });
        let widest2_rad2 = gaps.fold(0.0, f64::max);
        let peaks = group.iter().map(|&spot| self.most.peak(&context.sightings[spot], widest2_rad2.sqrt()));
        self.most_with(context, group.len(), widest2_rad2, peaks.fold(Peak::NONE, Peak::max))
    }

    fn most_with(&self, context: &Context<'_>, spots: usize, widest2_rad2: f64, peak: Peak) -> f64 {
        if spots <= self.views.most_visible && self.views.arrangements(spots).is_none() {
            return f64::INFINITY;
        }
        self.most.log_density(context, spots, widest2_rad2, peak)
    }

    /// What it costs that a spot's other markers are not seen, nats: nothing where it is hardly seen itself, all where it is e times as bright.
    fn lone_nats(&self, context: &Context<'_>, spot: usize) -> f64 {
        let light = context.sightings[spot].log_light.zip(context.detection_limit);
        let brighter = light.map_or(1.0, |(light, limit)| light.value - limit.value);
        self.views.lone_nats * brighter.clamp(0.0, 1.0)
    }

    /// What it costs that a group is some of the markers of a view, nats, and the distance at which it fits best, m.
    fn partly_seen_nats(&self, context: &Context<'_>, group: &[usize]) -> Option<(f64, f64)> {
        if !self.may_be_a_part(group) {
            return None;
        }
        let missing = self.views.most_visible - group.len();
        let mut best: Option<(f64, f64)> = None;
        self.triples.each_start(context, group, self.tilt_sigma_rad, |start| {
            if best.is_none_or(|(nats, _)| start.nats < nats) {
                best = Some((start.nats, start.pose.position_m.norm()));
            }
        });
        best.map(|(nats, distance_m)| (nats + self.unseen_nats * missing as f64, distance_m))
    }

    /// Whether a group has closed forms and may show less than a view has.
    fn may_be_a_part(&self, group: &[usize]) -> bool {
        (FEWEST_IN_PART..self.views.most_visible).contains(&group.len())
    }

    /// Which markers the spots of a group of at least two may be.
    pub(super) fn hypotheses(&mut self, context: &Context<'_>, group: &[usize], hypotheses: &mut Hypotheses) {
        let Context { sightings, gravity, .. } = *context;
        hypotheses.begin(group.len());
        let Some(image) = Image::of(context, group, &mut self.places) else { return };
        let Some(arrangements) = self.views.arrangements(group.len()) else {
            let spread = Spread::of(image.places.iter().copied());
            for outline in &self.views.outlines {
                let Some(fit) = overlay(&spread, outline, &image, self.tilt_sigma_rad, self.unseen_nats)
                else {
                    continue;
                };
                let half = image.attitude_nats(outline.elevation_rad, -1.0, self.tilt_sigma_rad)
                    - image.attitude_nats(outline.elevation_rad, 1.0, self.tilt_sigma_rad);
                for (turn, nats) in [(fit.turn, 0.0), (-fit.turn, half)] {
                    let place_m = image.origin_m(outline.size_m / spread.size, turn, outline);
                    let pose = image.pose(&place_m, turn, outline.yaw_rad, outline.elevation_rad);
                    hypotheses.offer_loose(pose, fit.nats + nats);
                }
            }
            if self.may_be_a_part(group) {
                self.triples.each_start(context, group, self.tilt_sigma_rad, |start| {
                    hypotheses.offer_loose(start.pose, start.nats);
                });
            }
            return;
        };
        let seen = Ordered::of(&image, sightings, group, self.log_flux_sigma);
        let best = seen.costs(arrangements, &image, self.tilt_sigma_rad, &mut self.costs);
        for (four, costs) in best.among.chunks_exact(LANES).zip(&self.costs) {
            for (arrangement, nats) in four.iter().zip(costs.to_array()) {
                if nats > best.nats + POOR_NATS {
                    continue;
                }
                // With gravity the tilt tells above from below; without it both are ways to look. A marker that shows and is not seen is another.
                let below = u8::from(gravity.is_none() && arrangement.elevation_rad < 0.0);
                let branch = below + 2 * u8::from(arrangement.unseen_nats > 0.5 * self.unseen_nats);
                let named = &arrangement.markers[..group.len()];
                let signals = group.iter().map(|&member| sightings[member].signal);
                let nats = f64::from(nats) + self.symmetry.least_signal_nats(signals, named);
                hypotheses.offer(named, nats, branch, || {
                    let (place_m, turn) = seen.place(arrangement, &image);
                    let pose = image.pose(&place_m, turn, arrangement.yaw_rad, arrangement.elevation_rad);
                    let camera_from_body = pose.camera_from_body * self.symmetry.turn(arrangement.turn);
                    Pose { camera_from_body, ..pose }
                });
            }
        }
    }
}

/// What the outline of all spots costs, nats, and the distance at which it fits best, m.
fn outlined_nats(
    views: &Views,
    image: &Image<'_>,
    tilt_sigma_rad: f64,
    unseen_nats: f64,
) -> Option<(f64, f64)> {
    let spread = Spread::of(image.places.iter().copied());
    let fits = || {
        views
            .outlines
            .iter()
            .filter_map(|outline| overlay(&spread, outline, image, tilt_sigma_rad, unseen_nats))
    };
    let best = fits().min_by(|a, b| a.nats.total_cmp(&b.nats))?;
    let weight: f64 = fits().map(|fit| libm::exp(best.nats - fit.nats)).sum();
    Some((best.nats - libm::log(weight), best.place_m.norm()))
}

/// Logarithm of the density of the places of spots that are as a view has them.
fn log_peak_of_places(views: &Views, seen: &Ordered, image: &Image<'_>, tilt_sigma_rad: f64) -> f64 {
    // Views have the shares that they have without gravity, which tells their elevation to within the tilt.
    let (turn_sigma_rad, of_elevation) = match image.elevation_rad {
        Some(elevation_rad) => {
            let width = ROOT_OF_TAU * tilt_sigma_rad / ELEVATION_STEP_RAD;
            (tilt_sigma_rad, -views.log_prior_of_elevation(elevation_rad) - libm::log(width))
        }
        None => (TAU.sqrt(), 0.0),
    };
    let count = image.places.len() as f64;
    of_elevation
        - (count - 2.0) * libm::log(TAU * seen.variance(image))
        - libm::log(count)
        - 2.0 * libm::log(image.size)
        - 0.5 * libm::log(TAU * turn_sigma_rad * turn_sigma_rad)
}

/// The part of a look that does not depend on how far away a group is.
fn log_density_of_views(context: &Context<'_>, likeness: &Likeness) -> f64 {
    likeness.log_density + if likeness.is_lit { first_light(context) } else { 0.0 }
}

/// What it costs that spots of this light are so far away, nats.
fn power_nats(context: &Context<'_>, group: &[usize], likeness: &Likeness) -> f64 {
    let own = likeness.log_power_of_views(context.sightings, group);
    let Some((known, own)) = context.power.zip(own) else { return 0.0 };
    let sigma = libm::hypot(known.sigma, own.sigma);
    let off = (own.value - known.value) / sigma;
    (0.5 * off * off).min(MOST_POWER_NATS) + libm::log(sigma / known.sigma)
}

fn widened(range: &Interval, reach_m: f64) -> Option<Interval> {
    Interval::new((range.min_m() - reach_m).max(0.0), range.max_m() + reach_m)
}
