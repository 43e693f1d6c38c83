//! How well a handful of spots looks like a view of the airframe.
//!
//! In: sightings that may be one neighbour. Out: what the claim that they are costs, in nats, and where the neighbour is
//! by the mean over all views that match, each weighted by how well it does. A view matches up to a shift, a turn and a
//! scale of the image; the scale is the distance. With gravity the turn and the elevation are known but for the tilt.

mod image;
mod mean;
mod ordered;
mod outlined;
mod size;

use nalgebra::{Matrix3, Unit, Vector2, Vector3};

use super::Sighting;
use super::views::{ELEVATION_STEP_RAD, MOST_ORDERED, Outline, Spread, Views};
use crate::airframe::Airframe;
use crate::lanes::{self, LANES, Lanes};
use crate::ranging::{BoundedBearing, DistanceBounds, Interval};
use image::Image;
use mean::Mean;
use ordered::Ordered;
use outlined::compare;
use size::{plausible_m, size_nats};

/// What a neighbour costs, nats: fewer neighbours are the better explanation.
pub(super) const NEIGHBOUR_NATS: f64 = 8.0;
/// Views with this share of the best one's weight do not count: all of them together are a percent or two.
const NEGLIGIBLE: f32 = 1e-3;
/// What cannot be, nats.
pub(super) const IMPOSSIBLE: f64 = 1e9;

/// Matches groups of sightings against the views of an airframe.
#[derive(Debug)]
pub(super) struct Matcher {
    views: Views,
    bounds: DistanceBounds,
    tilt_sigma_rad: f64,
    radius_m: f64,
    bearings: Vec<BoundedBearing>,
    places: Vec<Vector2<f64>>,
    costs: Vec<Lanes>,
}

/// What a match found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Match {
    /// What the claim that these spots are one neighbour costs, nats.
    pub(super) nats: f64,
    /// Where the airframe's origin is, camera frame, m.
    pub(super) mean_m: Vector3<f64>,
    /// Covariance of it, m^2: over the views, and from the errors of the bearings.
    pub(super) covariance_m2: Matrix3<f64>,
    /// The markers that the spots are in the best view, where they were put in order.
    pub(super) markers: Option<[usize; MOST_ORDERED]>,
}

impl Matcher {
    pub(super) fn new(airframe: &Airframe, max_tilt_rad: f64) -> Self {
        let grid_rad = ELEVATION_STEP_RAD / 2.0;
        Self {
            views: Views::of(airframe),
            bounds: DistanceBounds::new(airframe, max_tilt_rad),
            // The tilt limit is taken for two sigma; the grid of views adds half a step.
            tilt_sigma_rad: libm::hypot(max_tilt_rad / 2.0, grid_rad),
            radius_m: airframe.max_radius_m(),
            bearings: Vec::new(),
            places: Vec::new(),
            costs: Vec::new(),
        }
    }

    /// Most spots that one neighbour can show.
    pub(super) fn most_visible(&self) -> usize {
        self.views.most_visible
    }

    /// How far apart spots of one neighbour may be when one of them looks like this, rad: as near as its size suggests.
    pub(super) fn widest_rad(&self, sighting: &Sighting) -> f64 {
        let nearest_m = match sighting.range {
            Some(range) => range.min_m(),
            None => 2.0 * plausible_m(sighting).nearest_m,
        };
        2.0 * self.bounds.near_m() / nearest_m.max(self.bounds.near_m())
    }

    /// The nearest distance of a neighbour, m.
    pub(super) fn near_m(&self) -> f64 {
        self.bounds.near_m()
    }

    /// The distances that angles and sizes of these spots allow, strictly; `None` when they cannot be one neighbour.
    pub(super) fn bounds(
        &mut self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
    ) -> Option<Interval> {
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

    /// What the claim costs that these spots, at least one, are one neighbour, nats.
    pub(super) fn nats(
        &mut self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
    ) -> f64 {
        if group.len() == 1 {
            return NEIGHBOUR_NATS + self.views.lone_nats;
        }
        if group.len() > self.views.most_visible || self.bounds(sightings, group, gravity).is_none() {
            return IMPOSSIBLE;
        }
        let Some(image) = Image::of(sightings, group, gravity, &mut self.places) else { return IMPOSSIBLE };
        let Some(arrangements) = self.views.arrangements(group.len()) else {
            return self.match_views(sightings, group, gravity).map_or(IMPOSSIBLE, |found| found.nats);
        };
        let seen = Ordered::of(&image, sightings, group);
        let best = seen.costs(&arrangements.quads, &image, self.tilt_sigma_rad, &mut self.costs);
        let weight = self
            .costs
            .iter()
            .fold(Lanes::ZERO, |sum, &four| sum + lanes::exp(Lanes::splat(best.nats) - four));
        let distance_m = seen.place(&arrangements.all[best.arrangement], &image).norm();
        let views = f64::from(best.nats) - libm::log(f64::from(lanes::sum(weight)));
        NEIGHBOUR_NATS + views + size_nats(sightings, group, distance_m)
    }

    /// Matches a group of at least two spots; `None` when no view looks like it.
    pub(super) fn match_views(
        &mut self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
    ) -> Option<Match> {
        let image = Image::of(sightings, group, gravity, &mut self.places)?;
        let mut mean = Mean::default();
        if let Some(arrangements) = self.views.arrangements(group.len()) {
            let seen = Ordered::of(&image, sightings, group);
            let best = seen.costs(&arrangements.quads, &image, self.tilt_sigma_rad, &mut self.costs);
            mean.best = Some(arrangements.all[best.arrangement].markers);
            mean.least_nats = f64::from(best.nats);
            for (four, costs) in arrangements.all.chunks(LANES).zip(&self.costs) {
                let weights = lanes::exp(Lanes::splat(best.nats) - *costs).to_array();
                for (arrangement, weight) in four.iter().zip(weights) {
                    if weight > NEGLIGIBLE {
                        mean.add(seen.place(arrangement, &image), f64::from(weight));
                    }
                }
            }
        } else {
            let spread = Spread::of(image.places.iter().copied());
            let cost = |outline: &Outline| compare(&spread, outline, &image, self.tilt_sigma_rad);
            let costs = || self.views.outlines.iter().filter_map(cost);
            mean.least_nats = costs().map(|(_, nats)| nats).fold(f64::INFINITY, f64::min);
            for (place, nats) in costs() {
                mean.add(place, libm::exp(mean.least_nats - nats));
            }
        }
        mean.finish(&image, self.radius_m, |distance_m| size_nats(sightings, group, distance_m))
    }
}

fn widened(range: &Interval, reach_m: f64) -> Option<Interval> {
    Interval::new((range.min_m() - reach_m).max(0.0), range.max_m() + reach_m)
}
