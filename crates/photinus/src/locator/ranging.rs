//! Spots of one neighbour -> how far away it is and where.
//!
//! In: the sightings of one group. Out: the neighbour, but for which sightings are its members. The bounds are strict; the
//! estimate is the mean over the views that match and never lies outside them.

use nalgebra::{Matrix3, Unit, Vector3};

use super::matching::{Match, Matcher};
use super::views::MOST_ORDERED;
use super::{Distance, Neighbour, Position, Sighting};
use crate::airframe::Airframe;
use crate::camera::Bearing;
use crate::ranging::{AdjacentPair, Estimate, Interval};

/// Ranges groups of one kind of airframe.
#[derive(Debug)]
pub(super) struct Ranger {
    pair: Option<AdjacentPair>,
    /// The place of each marker in the ring, where the airframe is one.
    place_in_ring: Vec<usize>,
    radius_m: f64,
}

impl Ranger {
    pub(super) fn new(airframe: &Airframe) -> Self {
        let pair = airframe.ring().map(|ring| AdjacentPair::of(&ring));
        let count = airframe.markers().len() as f64;
        let centre_m =
            airframe.markers().iter().map(|marker| marker.position_m).sum::<Vector3<f64>>() / count;
        let yaw_rad = |marker: usize| {
            let from_centre_m = airframe.markers()[marker].position_m - centre_m;
            libm::atan2(from_centre_m.y, from_centre_m.x)
        };
        let mut order: Vec<usize> = (0..airframe.markers().len()).collect();
        order.sort_by(|&a, &b| yaw_rad(a).total_cmp(&yaw_rad(b)));
        let mut place_in_ring = vec![0; order.len()];
        for (place, marker) in order.into_iter().enumerate() {
            place_in_ring[marker] = place;
        }
        Self { pair, place_in_ring, radius_m: airframe.max_radius_m() }
    }

    /// The neighbour that these sightings are.
    pub(super) fn range(
        &self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
        matcher: &mut Matcher,
    ) -> Neighbour {
        let any = Interval::new(matcher.near_m(), f64::INFINITY);
        let bounds = matcher.bounds(sightings, group, gravity).or(any);
        let bounds = bounds.expect("from the near limit to infinity is an interval");
        let found = if group.len() < 2 { None } else { matcher.match_views(sightings, group, gravity) };
        let Some(found) = found else {
            return self.lone(&sightings[group[0]], bounds);
        };
        let direction = found.mean_m.normalize();
        let distance_m = found.mean_m.norm().clamp(bounds.min_m(), bounds.max_m());
        let sigma_m = direction.dot(&(found.covariance_m2 * direction)).sqrt();
        let paper = self.paper(sightings, group, &found);
        Neighbour {
            bearing: Bearing::new(direction).unwrap_or(sightings[group[0]].bearing),
            distance: Distance {
                estimate: Some(Estimate { distance_m, sigma_m }),
                bounds,
                perpendicular_m: paper.and_then(|(pair, alpha_rad)| pair.perpendicular_m(alpha_rad)),
                inline_m: paper.and_then(|(pair, alpha_rad)| pair.inline_m(alpha_rad)),
            },
            position: Some(Position { mean_m: direction * distance_m, covariance_m2: found.covariance_m2 }),
            first_member: 0,
            members: group.len(),
        }
    }

    /// A lone spot tells a direction, and by its size a range.
    fn lone(&self, sighting: &Sighting, bounds: Interval) -> Neighbour {
        let estimate = bounds.max_m().is_finite().then(|| {
            // Even over the logarithm of distance: neither near nor far is favoured.
            let distance_m = (bounds.min_m() * bounds.max_m()).sqrt();
            let log_sigma = libm::log(bounds.max_m() / bounds.min_m()) / 12f64.sqrt();
            Estimate { distance_m, sigma_m: distance_m * log_sigma }
        });
        let direction = *sighting.bearing.vector();
        let position = estimate.map(|Estimate { distance_m, sigma_m }| {
            let along = direction * direction.transpose();
            // The marker sits up to a radius beside the airframe's origin.
            let beside_m2 = (self.radius_m * self.radius_m) / 3.0;
            Position {
                mean_m: direction * distance_m,
                covariance_m2: along * (sigma_m * sigma_m)
                    + (Matrix3::identity() - along) * beside_m2
                    + sighting.covariance_rad2 * (distance_m * distance_m),
            }
        });
        let distance = Distance { estimate, bounds, perpendicular_m: None, inline_m: None };
        Neighbour { bearing: sighting.bearing, distance, position, first_member: 0, members: 1 }
    }

    /// The widest angle between two markers that are neighbours in the ring, for the paper's two estimates.
    fn paper(&self, sightings: &[Sighting], group: &[usize], found: &Match) -> Option<(AdjacentPair, f64)> {
        let (pair, markers) = (self.pair?, found.markers?);
        let count = group.len().min(MOST_ORDERED);
        let angles = (0..count).flat_map(|i| (0..i).map(move |j| (i, j))).filter_map(|(i, j)| {
            let (a, b) = (self.place_in_ring[markers[i]], self.place_in_ring[markers[j]]);
            let apart = a.abs_diff(b);
            let adjacent = apart == 1 || apart == self.place_in_ring.len() - 1;
            adjacent.then(|| sightings[group[i]].bearing.angle_to(&sightings[group[j]].bearing))
        });
        angles.reduce(f64::max).map(|alpha_rad| (pair, alpha_rad))
    }
}
