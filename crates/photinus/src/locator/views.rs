//! What an airframe can look like: its markers as a far camera sees them, from a grid of directions.
//!
//! In: an airframe. Out: for every number of spots from two up to a handful the *arrangements* which that many of its markers
//! can show, in every order, since spots come without names; and for every view its *outline*, the spread of all that
//! shows, for groups too large to be put in order. Both are in metres in the image plane of the far camera (x right,
//! y up), with "up" that of the body.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};

use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{LANES, Lanes};
use crate::pose::Symmetry;

/// Most spots that are put in order one by one.
pub(super) const MOST_ORDERED: usize = 4;
/// Most arrangements of one number of spots; an airframe that shows more is told by its outline.
const MOST_ARRANGEMENTS: usize = 6000;
/// Steps in yaw, rad, within the part of a circle after which the airframe looks the same.
const YAW_STEP_RAD: f64 = 7.5 * PI / 180.0;
/// Elevations of the camera above the body's horizon: this many, evenly up to the highest.
const ELEVATIONS: usize = 13;
const HIGHEST_RAD: f64 = 75.0 * PI / 180.0;
/// From one elevation to the next.
pub(super) const ELEVATION_STEP_RAD: f64 = 2.0 * HIGHEST_RAD / (ELEVATIONS - 1) as f64;
/// Without gravity, neighbours at the same height are the likelier ones: a weak prior on elevation, rad.
const ELEVATION_SIGMA_RAD: f64 = 40.0 * PI / 180.0;
/// Elevations so far from that which gravity tells, nats, are not compared: they cost more than any match is worth.
const FAR_NATS: f64 = 12.0;
/// What fills up a row costs too much to be chosen, nats.
const FILLING_NATS: f64 = 1e6;
/// A marker is expected to be seen when it shines at least as bright as this, 1 being straight ahead.
const BRIGHT: f64 = 0.3;
/// Below this it is not expected at all.
const DARK: f64 = 0.02;
/// Distance looked from, in radii of the airframe: only the direction matters.
const FAR_RADII: f64 = 1e4;

/// Some markers of a view, in an order.
#[derive(Clone, Debug)]
pub(super) struct Arrangement {
    /// Places from their middle, of unit size together; as many as the arrangement has.
    pub(super) shape: [Vector2<f64>; MOST_ORDERED],
    /// Root of the summed squares of the places from their middle, m.
    pub(super) size_m: f64,
    /// Their middle from the airframe's origin, m.
    pub(super) middle_m: Vector2<f64>,
    /// How much nearer to the camera than the origin each is, m.
    pub(super) ahead_m: [f64; MOST_ORDERED],
    /// Logarithms of their intensities, less the mean.
    pub(super) log_intensity: [f64; MOST_ORDERED],
    /// That mean.
    pub(super) mean_log_intensity: f64,
    /// Which markers they are after the turn that makes them the first of all their equals; as many as the arrangement has.
    pub(super) markers: [Option<u16>; MOST_ORDERED],
    /// That turn of the airframe.
    pub(super) turn: usize,
    /// Yaw of the direction to the camera in the body frame, rad.
    pub(super) yaw_rad: f64,
    /// What the markers that show but are not among them cost, nats.
    pub(super) unseen_nats: f64,
    /// Elevation of the camera above the body's horizon, rad.
    pub(super) elevation_rad: f64,
    /// Logarithm of the share of all views, without gravity.
    pub(super) log_prior: f64,
}

/// All that shows in a view, as a whole.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// How many markers.
    pub(super) markers: usize,
    /// Root mean square of the places from their middle, m.
    pub(super) size_m: f64,
    /// Shorter over longer axis of their spread, 0 to 1.
    pub(super) slimness: f64,
    /// Their middle from the airframe's origin, m.
    pub(super) middle_m: Vector2<f64>,
    /// Direction of the longer axis, rad modulo pi.
    pub(super) axis_rad: f64,
    /// How much nearer to the camera than the origin they are on average, m.
    pub(super) ahead_m: f64,
    /// Yaw and elevation of the direction to the camera in the body frame, rad.
    pub(super) yaw_rad: f64,
    pub(super) elevation_rad: f64,
    /// Logarithm of the share of all views, without gravity.
    pub(super) log_prior: f64,
}

/// Four arrangements side by side, to be compared at once.
#[derive(Clone, Debug)]
pub(super) struct Quad {
    /// As [`Arrangement::shape`], x and y apart.
    pub(super) x: [Lanes; MOST_ORDERED],
    pub(super) y: [Lanes; MOST_ORDERED],
    pub(super) log_intensity: [Lanes; MOST_ORDERED],
    /// What the view costs in itself, nats: its rarity and the markers not seen.
    pub(super) nats: Lanes,
    pub(super) elevation_rad: Lanes,
    /// Logarithm of the power of the LEDs of a neighbour of this view, where the mean of the logarithms of its lights less twice that of its size in the
    /// image is 0, seen from afar.
    pub(super) log_power: Lanes,
    /// How firmly a tilt holds the turn of the image: the squared cosine of the elevation, seen from the side 1.
    pub(super) firmness: Lanes,
}

/// All arrangements of one number of spots, from the lowest elevation up.
#[derive(Clone, Debug, Default)]
pub(super) struct Arrangements {
    all: Vec<Arrangement>,
    /// The same, four by four of one elevation.
    quads: Vec<Quad>,
    /// Each elevation, rad, and where its quads end.
    rows: Vec<(f64, usize)>,
}

/// Arrangements of some elevations.
#[derive(Clone, Copy)]
pub(super) struct Band<'a> {
    pub(super) all: &'a [Arrangement],
    /// The same, four by four.
    pub(super) quads: &'a [Quad],
}

impl Arrangement {
    /// Logarithm of the power of its LEDs, where the mean of the logarithms of its lights less twice that of its size in the image is 0, seen from afar.
    pub(super) fn far_log_power(&self) -> f64 {
        2.0 * libm::log(self.size_m.max(1e-9)) - self.mean_log_intensity
    }
}

impl Arrangements {
    /// Those that a neighbour tilted by that much may show to a camera at this elevation, where it is known.
    pub(super) fn within(&self, elevation_rad: Option<f64>, tilt_sigma_rad: f64) -> Band<'_> {
        let reach_rad = (2.0 * FAR_NATS).sqrt() * tilt_sigma_rad;
        let rows_up_to = |most_rad: f64| self.rows.partition_point(|(row_rad, _)| *row_rad < most_rad);
        let [first, end] = match elevation_rad {
            Some(elevation_rad) => [elevation_rad - reach_rad, elevation_rad + reach_rad].map(rows_up_to),
            None => [0, self.rows.len()],
        };
        let quads_before = |row: usize| row.checked_sub(1).map_or(0, |before| self.rows[before].1);
        let [first, end] = match [first, end].map(quads_before) {
            // Where that many markers never show from there, the nearest that does is as good as any.
            [first, end] if first == end => [0, self.quads.len()],
            band => band,
        };
        Band { all: &self.all[LANES * first..LANES * end], quads: &self.quads[first..end] }
    }

    /// Fills up the last four of a row.
    fn finish_row(&mut self, elevation_rad: f64) {
        while let Some(last) = self.all.last().filter(|_| !self.all.len().is_multiple_of(LANES)) {
            self.all.push(Arrangement { unseen_nats: FILLING_NATS, ..last.clone() });
        }
        self.rows.push((elevation_rad, self.all.len() / LANES));
    }

    fn pack(&mut self) {
        let number = |four: &[Arrangement], of: &dyn Fn(&Arrangement) -> f64| {
            Lanes::new(core::array::from_fn(|lane| of(&four[lane]) as f32))
        };
        let pack = |four: &[Arrangement]| Quad {
            x: core::array::from_fn(|spot| number(four, &|a| a.shape[spot].x)),
            y: core::array::from_fn(|spot| number(four, &|a| a.shape[spot].y)),
            log_intensity: core::array::from_fn(|spot| number(four, &|a| a.log_intensity[spot])),
            nats: number(four, &|a| a.unseen_nats - a.log_prior),
            elevation_rad: number(four, &|a| a.elevation_rad),
            log_power: number(four, &Arrangement::far_log_power),
            firmness: number(four, &|a| firmness(a.elevation_rad)),
        };
        self.quads = self.all.chunks_exact(LANES).map(pack).collect();
    }
}

/// Seen from above or below, a tilt turns the image by more.
pub(super) fn firmness(elevation_rad: f64) -> f64 {
    let cos = libm::cos(elevation_rad).max(0.2);
    cos * cos
}

/// Everything that an airframe can look like.
#[derive(Clone, Debug)]
pub(super) struct Views {
    /// By number of spots, from two; empty where outlines serve.
    arrangements: [Arrangements; MOST_ORDERED - 1],
    pub(super) outlines: Vec<Outline>,
    /// Most markers that show at once.
    pub(super) most_visible: usize,
    /// Logarithm of how many views of an elevation there are, less that of the weight of all views.
    log_share: f64,
    /// What it costs that one marker is seen and no other bright one, all views in which some show taken together, nats.
    pub(super) lone_nats: f64,
}

struct Seen {
    marker: usize,
    place_m: Vector2<f64>,
    ahead_m: f64,
    intensity: f64,
}

impl Seen {
    /// What it costs that it is not seen, nats, where one that is bright costs this much, by marker.
    fn unseen_nats(&self, of_bright: &[f64]) -> f64 {
        of_bright[self.marker] * (self.intensity / BRIGHT).min(1.0)
    }
}

impl Views {
    /// What `airframe` can look like, where a bright marker that is not seen costs `unseen_nats`, by marker.
    pub(super) fn of(airframe: &Airframe, symmetry: &Symmetry, unseen_nats: &[f64]) -> Self {
        let sector_rad = TAU / symmetry.turns() as f64;
        let yaws = (sector_rad / YAW_STEP_RAD).ceil().max(1.0) as usize;
        let mut views = Self {
            arrangements: Default::default(),
            outlines: Vec::new(),
            most_visible: 0,
            log_share: 0.0,
            lone_nats: 0.0,
        };
        let [mut total, mut showing, mut alone] = [0.0; 3];
        for row in 0..ELEVATIONS {
            let elevation_rad = row as f64 * ELEVATION_STEP_RAD - HIGHEST_RAD;
            let log_prior = log_prior(elevation_rad);
            for column in 0..yaws {
                let yaw_rad = sector_rad * column as f64 / yaws as f64;
                let seen = look(airframe, yaw_rad, elevation_rad);
                views.most_visible = views.most_visible.max(seen.len());
                showing += libm::exp(log_prior) * f64::from(u8::from(!seen.is_empty()));
                alone += libm::exp(log_prior) * alone_share(&seen, unseen_nats);
                if seen.len() >= 2 {
                    total += libm::exp(log_prior);
                    views.add(&seen, symmetry, [yaw_rad, elevation_rad], log_prior, unseen_nats);
                }
            }
            views.arrangements.iter_mut().for_each(|arrangements| arrangements.finish_row(elevation_rad));
        }
        let log_total = libm::log(total);
        views.log_share = libm::log(yaws as f64) - log_total;
        views.lone_nats = if alone > 0.0 { libm::log(showing / alone).max(0.0) } else { 0.0 };
        views.finish(log_total);
        views
    }

    /// Logarithm of the share of all views, without gravity, that are of an elevation, per step of elevations.
    pub(super) fn log_prior_of_elevation(&self, elevation_rad: f64) -> f64 {
        log_prior(elevation_rad.clamp(-HIGHEST_RAD, HIGHEST_RAD)) + self.log_share
    }

    /// The arrangements of `spots` markers; `None` where only outlines tell.
    pub(super) fn arrangements(&self, spots: usize) -> Option<&Arrangements> {
        let arrangements = self.arrangements.get(spots.checked_sub(2)?)?;
        (!arrangements.all.is_empty()).then_some(arrangements)
    }

    fn add(
        &mut self,
        seen: &[Seen],
        symmetry: &Symmetry,
        towards: [f64; 2],
        log_prior: f64,
        unseen_nats: &[f64],
    ) {
        let all_unseen_nats: f64 = seen.iter().map(|seen| seen.unseen_nats(unseen_nats)).sum();
        self.outlines.push(outline(seen, towards, log_prior));
        for (spots, arrangements) in (2..).zip(&mut self.arrangements) {
            let arrangements = &mut arrangements.all;
            if arrangements.len() > MOST_ARRANGEMENTS {
                continue;
            }
            each_order(seen.len(), spots, &mut |order| {
                if arrangements.len() <= MOST_ARRANGEMENTS {
                    let unseen_nats = all_unseen_nats
                        - order.iter().map(|&index| seen[index].unseen_nats(unseen_nats)).sum::<f64>();
                    arrangements.push(arrange(seen, order, symmetry, unseen_nats, towards, log_prior));
                }
            });
        }
    }

    fn finish(&mut self, log_total: f64) {
        for arrangements in &mut self.arrangements {
            if arrangements.all.len() > MOST_ARRANGEMENTS {
                arrangements.all.clear();
                arrangements.rows.clear();
            }
            for arrangement in &mut arrangements.all {
                arrangement.log_prior -= log_total;
            }
            arrangements.pack();
        }
        for outline in &mut self.outlines {
            outline.log_prior -= log_total;
        }
    }
}

/// Logarithm of how likely an elevation is without gravity, but for a factor.
fn log_prior(elevation_rad: f64) -> f64 {
    let share = elevation_rad / ELEVATION_SIGMA_RAD;
    libm::log(libm::cos(elevation_rad)) - 0.5 * share * share
}

/// How likely it is that one marker of a view is seen and no other bright one; some markers hardly show, so that it may add up to more than 1.
fn alone_share(seen: &[Seen], unseen_nats: &[f64]) -> f64 {
    let nats = |seen: &Seen| seen.unseen_nats(unseen_nats);
    let all: f64 = seen.iter().map(nats).sum();
    seen.iter().map(|seen| libm::exp(nats(seen) - all)).sum()
}

/// The markers that show from a direction.
fn look(airframe: &Airframe, yaw_rad: f64, elevation_rad: f64) -> Vec<Seen> {
    let [right, up, towards_camera] = view_axes(yaw_rad, elevation_rad);
    let camera_m = towards_camera * (FAR_RADII * airframe.max_radius_m());
    let see = |marker: usize| {
        let position_m = airframe.markers()[marker].position_m;
        Seen {
            marker,
            place_m: Vector2::new(position_m.dot(&right), position_m.dot(&up)),
            ahead_m: position_m.dot(&towards_camera),
            intensity: airframe.intensity(marker, &camera_m),
        }
    };
    (0..airframe.markers().len()).map(see).filter(|seen| seen.intensity > DARK).collect()
}

/// Right and up in the image of a far camera, and the direction to it, in the body frame.
pub(super) fn view_axes(yaw_rad: f64, elevation_rad: f64) -> [Vector3<f64>; 3] {
    let (sin, cos) = libm::sincos(elevation_rad);
    let (sin_yaw, cos_yaw) = libm::sincos(yaw_rad);
    let towards_camera = Vector3::new(cos * cos_yaw, cos * sin_yaw, sin);
    let right = Vector3::new(-sin_yaw, cos_yaw, 0.0);
    [right, towards_camera.cross(&right), towards_camera]
}

/// Calls `with` for every choice of `count` out of `of`, in every order.
fn each_order(of: usize, count: usize, with: &mut impl FnMut(&[usize])) {
    fn extend(of: usize, count: usize, chosen: &mut Vec<usize>, with: &mut impl FnMut(&[usize])) {
        if chosen.len() == count {
            return with(chosen);
        }
        for next in 0..of {
            if !chosen.contains(&next) {
                chosen.push(next);
                extend(of, count, chosen, with);
                chosen.pop();
            }
        }
    }
    // More than a dozen markers at once exceed the limit on arrangements from three spots up in any case.
    if of >= count && (count == 2 || of <= 12) {
        extend(of, count, &mut Vec::with_capacity(count), with);
    }
}

fn arrange(
    seen: &[Seen],
    order: &[usize],
    symmetry: &Symmetry,
    unseen_nats: f64,
    [yaw_rad, elevation_rad]: [f64; 2],
    log_prior: f64,
) -> Arrangement {
    let count = order.len() as f64;
    let chosen = || order.iter().map(|&index| &seen[index]);
    let middle_m = chosen().map(|seen| seen.place_m).sum::<Vector2<f64>>() / count;
    let size_m = chosen().map(|seen| (seen.place_m - middle_m).norm_squared()).sum::<f64>().sqrt();
    let mean_log = chosen().map(|seen| libm::log(seen.intensity)).sum::<f64>() / count;
    let mut arrangement = Arrangement {
        shape: [Vector2::zeros(); MOST_ORDERED],
        size_m,
        middle_m,
        ahead_m: [0.0; MOST_ORDERED],
        log_intensity: [0.0; MOST_ORDERED],
        mean_log_intensity: mean_log,
        markers: [None; MOST_ORDERED],
        turn: 0,
        unseen_nats,
        yaw_rad,
        elevation_rad,
        log_prior,
    };
    let mut names = [0; MOST_ORDERED];
    for (index, seen) in chosen().enumerate() {
        // Markers one behind the other have no shape; they match nothing.
        arrangement.shape[index] = (seen.place_m - middle_m) / size_m.max(1e-9);
        arrangement.log_intensity[index] = libm::log(seen.intensity) - mean_log;
        arrangement.ahead_m[index] = seen.ahead_m;
        names[index] = seen.marker as u16;
    }
    arrangement.turn = symmetry.canonical_turn(&names[..order.len()]);
    for (marker, name) in arrangement.markers.iter_mut().zip(&names[..order.len()]) {
        *marker = Some(symmetry.turned(arrangement.turn, *name));
    }
    arrangement
}

fn outline(seen: &[Seen], [yaw_rad, elevation_rad]: [f64; 2], log_prior: f64) -> Outline {
    let count = seen.len() as f64;
    let middle_m = seen.iter().map(|seen| seen.place_m).sum::<Vector2<f64>>() / count;
    let spread = Spread::of(seen.iter().map(|seen| seen.place_m - middle_m));
    Outline {
        markers: seen.len(),
        size_m: spread.size,
        slimness: spread.slimness,
        middle_m,
        axis_rad: spread.axis_rad,
        ahead_m: seen.iter().map(|seen| seen.ahead_m).sum::<f64>() / count,
        yaw_rad,
        elevation_rad,
        // Markers that shine away are seen from less far: the view counts by how bright it is.
        log_prior: log_prior + libm::log(seen.iter().map(|seen| seen.intensity).sum::<f64>() / count),
    }
}

/// Size and shape of a cloud of places around zero.
pub(super) struct Spread {
    /// Root mean square.
    pub(super) size: f64,
    /// Shorter over longer axis.
    pub(super) slimness: f64,
    /// Direction of the longer axis, rad modulo pi.
    pub(super) axis_rad: f64,
}

impl Spread {
    pub(super) fn of(places: impl Iterator<Item = Vector2<f64>>) -> Self {
        let (mut count, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0);
        for place in places {
            count += 1.0;
            xx += place.x * place.x;
            xy += place.x * place.y;
            yy += place.y * place.y;
        }
        let half_sum = (xx + yy) / 2.0;
        let half_difference = libm::hypot((xx - yy) / 2.0, xy);
        let (long, short) = (half_sum + half_difference, (half_sum - half_difference).max(0.0));
        Self {
            size: ((xx + yy) / f64::max(count, 1.0)).sqrt(),
            slimness: if long > 0.0 { (short / long).sqrt() } else { 0.0 },
            axis_rad: libm::atan2(2.0 * xy, xx - yy) / 2.0,
        }
    }
}
