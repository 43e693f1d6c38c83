//! How well a handful of spots looks like a view of the airframe.
//!
//! In: sightings that may be one neighbour. Out: what the claim that they are costs, in nats, and where the neighbour is
//! by the mean over all views that match, each weighted by how well it does. A view matches up to a shift, a turn and a
//! scale of the image; the scale is the distance. With gravity the turn and the elevation are known but for the tilt.

use nalgebra::{Matrix3, Unit, Vector2, Vector3};

use super::Sighting;
use super::views::{Arrangement, ELEVATION_STEP_RAD, MOST_ORDERED, Outline, Quad, Spread, Views, firmness};
use crate::airframe::Airframe;
use crate::lanes::{self, LANES, Lanes};
use crate::ranging::{BoundedBearing, DistanceBounds, Interval};

/// What a neighbour costs, nats: fewer neighbours are the better explanation.
pub(super) const NEIGHBOUR_NATS: f64 = 8.0;
/// How far the grid of views leaves a true shape from the nearest one, as a share of its size.
const GRID_ERROR: f64 = 0.04;
/// What that leaves of a place, as a share of the airframe's radius, and of the distance, as a share of it: half the
/// steps of yaw and elevation, spread evenly.
const GRID_ACROSS: f64 = 0.008;
const GRID_ALONG: f64 = 0.004;
/// Spread of the logarithms of flux that units, lobes and neighbours' own bodies add.
const LOG_FLUX_SIGMA: f64 = 0.6;
/// The same when a spot is saturated: its flux is a lower limit.
const LOG_FLUX_SIGMA_SATURATED: f64 = 1.2;
/// How far the outline of a group may be from that of a view, in slimness.
const SLIMNESS_SIGMA: f64 = 0.08;
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

    /// What a neighbour costs of which one spot is seen, nats.
    pub(super) fn lone_nats(&self) -> f64 {
        NEIGHBOUR_NATS + self.views.lone_nats
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

    /// What the claim costs that these spots, at least two, are one neighbour.
    pub(super) fn nats(
        &mut self,
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
    ) -> f64 {
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
        let mut sums = Sums::default();
        if let Some(arrangements) = self.views.arrangements(group.len()) {
            let seen = Ordered::of(&image, sightings, group);
            let best = seen.costs(&arrangements.quads, &image, self.tilt_sigma_rad, &mut self.costs);
            sums.best = Some(arrangements.all[best.arrangement].markers);
            sums.least_nats = f64::from(best.nats);
            for (four, costs) in arrangements.all.chunks(LANES).zip(&self.costs) {
                let weights = lanes::exp(Lanes::splat(best.nats) - *costs).to_array();
                for (arrangement, weight) in four.iter().zip(weights) {
                    if weight > NEGLIGIBLE {
                        sums.add(seen.place(arrangement, &image), f64::from(weight));
                    }
                }
            }
        } else {
            let spread = Spread::of(image.places.iter().copied());
            let cost = |outline: &Outline| compare(&spread, outline, &image, self.tilt_sigma_rad);
            let costs = || self.views.outlines.iter().filter_map(cost);
            sums.least_nats = costs().map(|(_, nats)| nats).fold(f64::INFINITY, f64::min);
            for (place, nats) in costs() {
                sums.add(place, libm::exp(sums.least_nats - nats));
            }
        }
        sums.finish(&image, self.radius_m, |distance_m| size_nats(sightings, group, distance_m))
    }
}

/// The places of a group in the plane that touches the sphere of directions in their middle.
struct Image<'a> {
    /// Axes of the plane in the camera frame: right, up (against gravity where it is known), ahead.
    axes: Matrix3<f64>,
    /// Places from their middle, as many as spots.
    places: &'a [Vector2<f64>],
    middle: Vector2<f64>,
    /// Root of the summed squares of the places.
    size: f64,
    /// Root mean square error of a place, per axis.
    sigma: f64,
    /// Elevation of the camera seen from a level target, with gravity, rad.
    elevation_rad: Option<f64>,
}

impl<'a> Image<'a> {
    fn of(
        sightings: &[Sighting],
        group: &[usize],
        gravity: Option<&Unit<Vector3<f64>>>,
        places: &'a mut Vec<Vector2<f64>>,
    ) -> Option<Self> {
        let members = || group.iter().map(|&index| &sightings[index]);
        let sum: Vector3<f64> = members().map(|sighting| sighting.bearing.vector()).sum();
        let ahead = Unit::try_new(sum, 1e-6)?;
        let up = match gravity {
            Some(down) => -down.into_inner(),
            None => -Vector3::y(),
        };
        let across = ahead.cross(&up);
        let right =
            Unit::try_new(across, 1e-9).unwrap_or_else(|| Unit::new_normalize(ahead.cross(&Vector3::x())));
        let up = right.cross(&ahead);
        places.clear();
        for sighting in members() {
            let bearing = sighting.bearing.vector();
            let depth = bearing.dot(&ahead);
            // Spots a right angle from their middle are no neighbour that a camera could be outside of.
            if depth < 1e-3 {
                return None;
            }
            places.push(Vector2::new(bearing.dot(&right), bearing.dot(&up)) / depth);
        }
        let count = group.len() as f64;
        let middle = places.iter().sum::<Vector2<f64>>() / count;
        for place in places.iter_mut() {
            *place -= middle;
        }
        let size = places.iter().map(Vector2::norm_squared).sum::<f64>().sqrt();
        let variance = members().map(|sighting| sighting.covariance_rad2.trace() / 2.0).sum::<f64>() / count;
        (size > 0.0).then_some(Self {
            axes: Matrix3::from_columns(&[right.into_inner(), up, ahead.into_inner()]),
            places,
            middle,
            size,
            sigma: variance.sqrt(),
            elevation_rad: gravity.map(|down| libm::asin(ahead.dot(down).clamp(-1.0, 1.0))),
        })
    }

    /// Cost of an elevation and of a turn (its cosine) against the vertical; none without gravity.
    fn attitude_nats(&self, elevation_rad: f64, cos_turn: f64, tilt_sigma_rad: f64) -> f64 {
        self.elevation_rad.map_or(0.0, |expected_rad| {
            let off = elevation_rad - expected_rad;
            let turn = (1.0 - cos_turn) * firmness(elevation_rad);
            (0.5 * off * off + turn) / (tilt_sigma_rad * tilt_sigma_rad)
        })
    }

    /// The origin of an airframe whose middle of markers, `middle_m` from it and `ahead_m` nearer, is seen at `depth_m`.
    fn origin(&self, depth_m: f64, turned_middle_m: Vector2<f64>, ahead_m: f64) -> Vector3<f64> {
        let middle_m = self.middle * depth_m - turned_middle_m;
        Vector3::new(middle_m.x, middle_m.y, depth_m + ahead_m)
    }
}

/// A group to be put in order.
struct Ordered {
    count: usize,
    shape: [Vector2<f64>; MOST_ORDERED],
    log_flux: [f64; MOST_ORDERED],
    log_flux_sigma: f64,
    shape_sigma: f64,
}

impl Ordered {
    fn of(image: &Image<'_>, sightings: &[Sighting], group: &[usize]) -> Self {
        let mut ordered = Self {
            count: group.len(),
            shape: [Vector2::zeros(); MOST_ORDERED],
            log_flux: [0.0; MOST_ORDERED],
            log_flux_sigma: LOG_FLUX_SIGMA,
            shape_sigma: libm::hypot(GRID_ERROR, image.sigma / image.size),
        };
        let mut sum = 0.0;
        for (index, (&member, place)) in group.iter().zip(image.places).enumerate() {
            let spot = &sightings[member].spot;
            ordered.shape[index] = place / image.size;
            ordered.log_flux[index] = libm::log(spot.flux.max(1e-3));
            sum += ordered.log_flux[index];
            if spot.saturated_px > 0 {
                ordered.log_flux_sigma = LOG_FLUX_SIGMA_SATURATED;
            }
            if spot.flux <= 0.0 {
                // A detector that measures no light says nothing by it.
                ordered.log_flux_sigma = f64::INFINITY;
            }
        }
        for log_flux in &mut ordered.log_flux[..group.len()] {
            *log_flux -= sum / group.len() as f64;
        }
        ordered
    }

    /// What each arrangement costs: its misfit in shape and in light, its attitude, and what it costs in itself. Returns
    /// the least of them.
    fn costs(&self, quads: &[Quad], image: &Image<'_>, tilt_sigma_rad: f64, costs: &mut Vec<Lanes>) -> Best {
        let splat = |number: f64| Lanes::splat(number as f32);
        let x: [Lanes; MOST_ORDERED] = std::array::from_fn(|spot| splat(self.shape[spot].x));
        let y: [Lanes; MOST_ORDERED] = std::array::from_fn(|spot| splat(self.shape[spot].y));
        let log_flux: [Lanes; MOST_ORDERED] = std::array::from_fn(|spot| splat(self.log_flux[spot]));
        let per_shape = splat(0.5 / (self.shape_sigma * self.shape_sigma));
        let per_light = splat(0.5 / (self.log_flux_sigma * self.log_flux_sigma));
        let tilt = 1.0 / (tilt_sigma_rad * tilt_sigma_rad);
        let (per_turn, per_elevation) = image.elevation_rad.map_or((0.0, 0.0), |_| (tilt, 0.5 * tilt));
        let (per_turn, per_elevation) = (splat(per_turn), splat(per_elevation));
        let elevation_rad = splat(image.elevation_rad.unwrap_or(0.0));
        costs.clear();
        costs.extend(quads.iter().map(|quad| {
            // Places as complex numbers: the best turn and scale is the sum of conj(w) z, its size tells how much they agree.
            let [mut dot, mut cross, mut light] = [Lanes::ZERO; 3];
            for spot in 0..self.count {
                dot += quad.x[spot] * x[spot] + quad.y[spot] * y[spot];
                cross += quad.x[spot] * y[spot] - quad.y[spot] * x[spot];
                let off = log_flux[spot] - quad.log_intensity[spot];
                light += off * off;
            }
            let agreement = dot * dot + cross * cross;
            let cos_turn = dot / (agreement + Lanes::splat(1e-12)).sqrt();
            let off = quad.elevation_rad - elevation_rad;
            lanes::positive(Lanes::ONE - agreement) * per_shape
                + light * per_light
                + (Lanes::ONE - cos_turn) * quad.firmness * per_turn
                + off * off * per_elevation
                + quad.nats
        }));
        let least = costs.iter().fold(Lanes::splat(f32::INFINITY), |least, &four| least.fast_min(four));
        let nats = least.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let of_best = costs.iter().flat_map(|four| four.to_array()).position(|cost| cost <= nats);
        Best { nats, arrangement: of_best.unwrap_or(0) }
    }

    /// The place of the airframe if the spots are these markers: first as from afar, then with each marker as much larger
    /// in the image as it is nearer.
    fn place(&self, arrangement: &Arrangement, image: &Image<'_>) -> Vector3<f64> {
        let Arrangement { shape, size_m, middle_m, ahead_m, .. } = arrangement;
        let count = self.count as f64;
        let mut depth_m = f64::INFINITY;
        let mut place = Vector3::zeros();
        for _ in 0..ROUNDS_OF_PERSPECTIVE {
            // Nearer than a few radii perspective is no correction any more, and the match none that counts.
            let larger: [f64; MOST_ORDERED] = ahead_m.map(|ahead_m| 1.0 / (1.0 - ahead_m / depth_m).max(0.3));
            let markers =
                || shape.iter().zip(larger).take(self.count).map(|(w, larger)| w * (size_m * larger));
            let middle = markers().sum::<Vector2<f64>>() / count;
            let (mut dot, mut cross, mut square) = (0.0, 0.0, 0.0);
            for (w, z) in markers().zip(&self.shape) {
                let w = w - middle;
                dot += w.x * z.x + w.y * z.y;
                cross += w.x * z.y - w.y * z.x;
                square += w.norm_squared();
            }
            // A match that is hardly one still gives a place, at most a thousand times as far as it looks.
            let agreement = f64::sqrt(dot * dot + cross * cross).max(1e-3 * square.sqrt());
            let turn = Vector2::new(dot, cross) / agreement;
            depth_m = square / (agreement * image.size);
            let mean_larger = larger.iter().take(self.count).sum::<f64>() / count;
            let beside_m =
                (image.middle * depth_m - turned(middle, turn)) / mean_larger - turned(*middle_m, turn);
            place = Vector3::new(beside_m.x, beside_m.y, depth_m);
        }
        place
    }
}

/// Rounds until perspective is accounted for: each leaves the share radius over distance of the error before.
const ROUNDS_OF_PERSPECTIVE: usize = 3;

/// The arrangement that costs least.
struct Best {
    nats: f32,
    arrangement: usize,
}

/// Views with this share of the best one's weight do not count: all of them together are a percent or two.
const NEGLIGIBLE: f32 = 1e-3;
/// An outline so far off is no match, nats.
const FAR_NATS: f64 = 30.0;

/// The same for a group as a whole: its size and slimness against those of all that a view shows.
fn compare(
    spread: &Spread,
    outline: &Outline,
    image: &Image<'_>,
    tilt_sigma_rad: f64,
) -> Option<(Vector3<f64>, f64)> {
    let missing = outline.markers.checked_sub(image.places.len())?;
    let off = (spread.slimness - outline.slimness) / SLIMNESS_SIGMA;
    let misfit = 0.5 * off * off;
    if misfit > FAR_NATS || outline.size_m <= 0.0 {
        return None;
    }
    let (sin, cos) = libm::sincos(spread.axis_rad - outline.axis_rad);
    let attitude = image.attitude_nats(outline.elevation_rad, cos.abs(), tilt_sigma_rad);
    let nats = misfit + attitude - outline.log_prior + super::views::UNSEEN_NATS * missing as f64;
    // The axis is known but for half a turn: with the less likely half the middle would be on the other side.
    let turn = if cos < 0.0 { Vector2::new(-cos, -sin) } else { Vector2::new(cos, sin) };
    let depth_m = outline.size_m / spread.size;
    Some((image.origin(depth_m, turned(outline.middle_m, turn), outline.ahead_m), nats))
}

fn turned(place: Vector2<f64>, turn: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(turn.x * place.x - turn.y * place.y, turn.y * place.x + turn.x * place.y)
}

/// Weighted sums over views, of places in the axes of the image; weights are relative to the best view.
#[derive(Default)]
struct Sums {
    weight: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    least_nats: f64,
    best: Option<[usize; MOST_ORDERED]>,
}

impl Sums {
    fn add(&mut self, place: Vector3<f64>, weight: f64) {
        self.weight += weight;
        self.first += weight * place;
        self.second += weight * place * place.transpose();
    }

    fn finish(self, image: &Image<'_>, radius_m: f64, size_nats: impl Fn(f64) -> f64) -> Option<Match> {
        if self.weight <= 0.0 {
            return None;
        }
        let mean = self.first / self.weight;
        let spread = self.second / self.weight - mean * mean.transpose();
        let (depth_m, count) = (mean.z, image.places.len() as f64);
        // The grid of views leaves a rest: of the markers' places, and of their size and so of the distance.
        let across_m = libm::hypot(depth_m * image.sigma / count.sqrt(), GRID_ACROSS * radius_m);
        let along_m = depth_m * libm::hypot(image.sigma / image.size, GRID_ALONG);
        let noise =
            Matrix3::from_diagonal(&Vector3::new(across_m, across_m, along_m).map(|sigma| sigma * sigma));
        Some(Match {
            nats: NEIGHBOUR_NATS + self.least_nats - libm::log(self.weight) + size_nats(mean.norm()),
            mean_m: image.axes * mean,
            covariance_m2: image.axes * (spread + noise) * image.axes.transpose(),
            markers: self.best,
        })
    }
}

/// What it costs that spots of these sizes are at a distance, where no curve of spot sizes is known.
fn size_nats(sightings: &[Sighting], group: &[usize], distance_m: f64) -> f64 {
    const SIGMA: f64 = 0.3;
    let members = || group.iter().map(|&index| &sightings[index]).filter(|sighting| sighting.range.is_none());
    let nats = |sighting: &Sighting| {
        let plausible = plausible_m(sighting);
        let beyond = (plausible.nearest_m / distance_m).max(distance_m / plausible.farthest_m);
        let off = libm::log(beyond.max(1.0)) / SIGMA;
        0.5 * off * off
    };
    members().map(nats).sum::<f64>() / members().count().max(1) as f64
}

/// Distances at which a spot of this size is nothing out of the ordinary.
///
/// For the camera of the paper (13) puts a spot of S pixels at sqrt(31.5 / S) m; other cameras, exposures and thresholds
/// differ, by less than four times either way in all that is known.
fn plausible_m(sighting: &Sighting) -> Plausible {
    let area_px = f64::from(sighting.spot.area_px);
    Plausible {
        nearest_m: 0.25 * (31.5 / (area_px + 0.5)).sqrt(),
        farthest_m: 4.0 * (31.5 / (area_px - 1.0).max(0.05)).sqrt(),
    }
}

struct Plausible {
    nearest_m: f64,
    farthest_m: f64,
}

fn widened(range: &Interval, reach_m: f64) -> Option<Interval> {
    Interval::new((range.min_m() - reach_m).max(0.0), range.max_m() + reach_m)
}
