//! Directions of markers whose signals are known -> poses to begin from.
//!
//! An airframe that is upright and turned by some yaw has its place by least squares: each direction u of a marker m asks for
//! (1 - u u') (p + R m) = 0, which is linear in the place p. Every yaw of a grid is tried, and for the two directions farthest apart every pair of markers
//! that they may be; the others are the nearest that carry their signal.

use alloc::vec::Vec;

use core::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::airframe::Airframe;
use crate::pose::{Hypotheses, LogDistance, Observation, Pose, Symmetry};
use crate::ranging::Interval;

/// Yaws that are tried.
const YAWS: u32 = 24;
/// What the grid leaves of a marker's place, as a share of the airframe's radius.
const GRID: f64 = 0.1;
/// A marker shows from this intensity on, and costs so much where it does not, nats.
const SHOWS: f64 = 0.02;
const DARK_NATS: f64 = 4.0;
/// Farthest that a vehicle is looked for, in radii.
const FARTHEST_RADII: f64 = 500.0;

/// Finds poses to begin from. Keeps its room.
#[derive(Debug)]
pub(super) struct Starts {
    airframe: Airframe,
    symmetry: Symmetry,
    /// Yaws that are tried, and their range, rad: LEDs that blink alike tell it modulo the airframe's symmetry.
    yaws: u32,
    yaws_rad: f64,
    markers: Vec<Option<u16>>,
}

impl Starts {
    pub(super) fn new(airframe: &Airframe) -> Self {
        let symmetry = Symmetry::of(airframe);
        let turns = symmetry.turns_with_signals() as u32;
        let yaws = YAWS.div_ceil(turns);
        Self {
            airframe: airframe.clone(),
            symmetry,
            yaws,
            yaws_rad: TAU / f64::from(turns),
            markers: Vec::new(),
        }
    }

    /// The distances at which vehicles are looked for.
    pub(super) fn reach(&self) -> Interval {
        let radius_m = self.airframe.max_radius_m();
        Interval::new(radius_m, FARTHEST_RADII * radius_m).unwrap_or(Interval::ANY)
    }

    /// Offers the poses in which these, at least two, may be markers of an airframe that is upright against `up`, or in the image.
    pub(super) fn offer(
        &mut self,
        observations: &[Observation],
        up: Option<Unit<Vector3<f64>>>,
        hypotheses: &mut Hypotheses,
    ) {
        hypotheses.begin(observations.len());
        let Some([first, second]) = farthest_apart(observations) else { return };
        let upright = upright(observations, up);
        for step in 0..self.yaws {
            let yaw_rad = self.yaws_rad * f64::from(step) / f64::from(self.yaws);
            let attitude = upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
            for one in 0..self.airframe.markers().len() {
                for other in 0..self.airframe.markers().len() {
                    let may_be = |spot: usize, marker| self.carries(marker, observations[spot].signal);
                    if one != other && may_be(first, one) && may_be(second, other) {
                        self.try_start(observations, [(first, one), (second, other)], attitude, hypotheses);
                    }
                }
            }
        }
    }

    /// A distance of which nothing is known: even over the logarithm, as a normal distribution.
    pub(super) fn any_distance(&self) -> LogDistance {
        let reach = self.reach();
        let [near, far] = [reach.min_m(), reach.max_m()].map(libm::log);
        LogDistance { mean: 0.5 * (near + far), sigma: (far - near) / libm::sqrt(12.0) }
    }

    /// Offers the poses in which this is one marker, turned to the camera, of an airframe that is upright.
    pub(super) fn offer_lone(
        &self,
        only: &Observation,
        up: Option<Unit<Vector3<f64>>>,
        distance: LogDistance,
        hypotheses: &mut Hypotheses,
    ) {
        let may_be = |marker| self.carries(marker, only.signal);
        let airframe = (&self.airframe, &self.symmetry);
        hypotheses.suppose_one_marker(airframe, (&only.bearing, distance), up, may_be);
    }

    /// How far apart two markers with these signals are at most, in radii.
    pub(super) fn apart_radii(&self, one: Option<u32>, other: Option<u32>) -> f64 {
        let with = |signal: Option<u32>| {
            let markers = self.airframe.markers().iter().enumerate();
            markers.filter(move |own| self.carries(own.0, signal)).map(|own| own.1.position_m)
        };
        let apart_m = with(one).flat_map(|one_m| with(other).map(move |other_m| (other_m - one_m).norm()));
        apart_m.fold(0.0, f64::max) / self.airframe.max_radius_m()
    }

    fn carries(&self, marker: usize, signal: Option<u32>) -> bool {
        let leds = &self.airframe.markers()[marker].leds;
        signal.is_none_or(|signal| {
            leds.iter().any(|&led| self.airframe.leds()[led].signal.unwrap_or(0) == signal)
        })
    }

    fn try_start(
        &mut self,
        observations: &[Observation],
        two: [(usize, usize); 2],
        attitude: Rotation3<f64>,
        hypotheses: &mut Hypotheses,
    ) {
        self.markers.clear();
        self.markers.resize(observations.len(), None);
        two.iter().for_each(|&(spot, marker)| self.markers[spot] = Some(marker as u16));
        let Some(pose) = self.place(observations, attitude) else { return };
        for (spot, seen) in observations.iter().enumerate() {
            if self.markers[spot].is_none() {
                self.markers[spot] = self.nearest(seen, &pose);
            }
        }
        let Some(pose) = self.place(observations, attitude) else { return };
        let nats = self.nats(observations, &pose);
        hypotheses.offer(&self.markers, nats, 0, || pose);
    }

    /// The airframe's place with this attitude; `None` where it would be behind the camera, within the airframe or out of sight.
    fn place(&self, observations: &[Observation], attitude: Rotation3<f64>) -> Option<Pose> {
        let (mut normal, mut sum_m, mut ahead) = (Matrix3::zeros(), Vector3::zeros(), Vector3::zeros());
        for (seen, marker) in observations.iter().zip(&self.markers) {
            let Some(marker) = marker else { continue };
            let direction = seen.bearing.vector();
            let across = Matrix3::identity() - direction * direction.transpose();
            normal += across;
            sum_m -= across * (attitude * self.airframe.markers()[usize::from(*marker)].position_m);
            ahead += direction;
        }
        let position_m = normal.try_inverse()? * sum_m;
        let radii = position_m.norm() / self.airframe.max_radius_m();
        let is_ahead = position_m.dot(&ahead) > 0.0 && (1.0..FARTHEST_RADII).contains(&radii);
        is_ahead.then_some(Pose { position_m, camera_from_body: attitude })
    }

    /// The marker with its signal that is nearest to a direction, of those that no other has.
    fn nearest(&self, seen: &Observation, pose: &Pose) -> Option<u16> {
        let off = |marker: u16| {
            let marker_m = self.airframe.markers()[usize::from(marker)].position_m;
            let ahead = (pose.camera_from_body * marker_m + pose.position_m).normalize();
            (seen.bearing.vector() - ahead).norm_squared()
        };
        (0..self.airframe.markers().len() as u16)
            .filter(|&marker| self.carries(usize::from(marker), seen.signal))
            .filter(|&marker| !self.markers.contains(&Some(marker)))
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
    }

    /// What a pose costs by a first look.
    fn nats(&self, observations: &[Observation], pose: &Pose) -> f64 {
        let camera_m = pose.camera_in_body_m();
        let grid_rad = GRID * self.airframe.max_radius_m() / pose.position_m.norm();
        let of_spot = |(seen, marker): (&Observation, &Option<u16>)| {
            let Some(marker) = marker.map(usize::from) else { return DARK_NATS };
            let ahead = (pose.camera_from_body * self.airframe.markers()[marker].position_m
                + pose.position_m)
                .normalize();
            let variance_rad2 = 0.5 * seen.covariance_rad2.trace() + grid_rad * grid_rad;
            let off = (seen.bearing.vector() - ahead).norm_squared() / variance_rad2;
            let shows = self.airframe.intensity(marker, &camera_m) > SHOWS;
            0.5 * off + if shows { 0.0 } else { DARK_NATS }
        };
        observations.iter().zip(&self.markers).map(of_spot).sum()
    }
}

/// The two that are the farthest apart.
fn farthest_apart(observations: &[Observation]) -> Option<[usize; 2]> {
    let pairs =
        (0..observations.len()).flat_map(|one| (one + 1..observations.len()).map(move |other| [one, other]));
    let along = |[one, other]: &[usize; 2]| {
        observations[*one].bearing.vector().dot(observations[*other].bearing.vector())
    };
    pairs.min_by(|a, b| along(a).total_cmp(&along(b)))
}

/// An attitude whose z is up.
fn upright(observations: &[Observation], up: Option<Unit<Vector3<f64>>>) -> Rotation3<f64> {
    let up = up.map_or(-Vector3::y(), Unit::into_inner);
    let ahead: Vector3<f64> = observations.iter().map(|seen| *seen.bearing.vector()).sum();
    let level = |towards: Vector3<f64>| (towards - up * towards.dot(&up)).try_normalize(1e-3);
    let towards = level(ahead)
        .or_else(|| level(Vector3::z()))
        .unwrap_or_else(|| (Vector3::x() - up * up.x).normalize());
    Rotation3::from_basis_unchecked(&[towards, up.cross(&towards), up])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{Led, Lobe};
    use crate::camera::Bearing;
    use proptest::prelude::*;

    /// Four arms with a pair of LEDs each, which blink its signal.
    fn pairs() -> Airframe {
        let led = |number: u32| {
            let arm = f64::from(number / 2) * TAU / 4.0 + TAU / 8.0;
            let beside = if number.is_multiple_of(2) { -0.03 } else { 0.03 };
            let (sin, cos) = libm::sincos(arm);
            let (outward, along) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0));
            Led {
                position_m: outward * 0.3 + along * beside,
                axis: Unit::new_normalize(outward),
                lobe: Lobe::Lambertian,
                power: 1.0,
                signal: Some(number / 2),
            }
        };
        Airframe::new("pairs", (0..8).map(led).collect()).unwrap()
    }

    fn seen(airframe: &Airframe, marker: usize, pose: &Pose) -> Observation {
        let place_m = pose.camera_from_body * airframe.markers()[marker].position_m + pose.position_m;
        Observation {
            bearing: Bearing::new(place_m).unwrap(),
            covariance_rad2: Matrix3::identity() * 1e-8,
            log_light: None,
            resolution_rad: 0.0,
            signal: airframe.leds()[airframe.markers()[marker].leds[0]].signal,
            clutter_log_density: 0.0,
        }
    }

    proptest! {
        /// All markers that show, and who they are: the cheapest assignment is the true one, and its start is as near as the grid.
        #[test]
        fn the_true_assignment_is_the_cheapest(yaw_rad in 0.0..TAU, x_m in -3.0..3.0_f64, y_m in -1.0..1.0_f64, z_m in 2.0..9.0_f64) {
            let airframe = pairs();
            let up = Unit::new_normalize(-Vector3::y());
            let upright = Rotation3::from_basis_unchecked(&[Vector3::z(), up.cross(&Vector3::z()), up.into_inner()]);
            let pose = Pose {
                position_m: Vector3::new(x_m, y_m, z_m),
                camera_from_body: upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad),
            };
            let camera_m = pose.camera_in_body_m();
            let shown: Vec<usize> =
                (0..8).filter(|&marker| airframe.intensity(marker, &camera_m) > 0.2).collect();
            prop_assume!(shown.len() >= 4);
            let observations: Vec<Observation> = shown.iter().map(|&marker| seen(&airframe, marker, &pose)).collect();
            let mut starts = Starts::new(&airframe);
            let mut hypotheses = Hypotheses::with_room(observations.len());
            starts.offer(&observations, Some(up), &mut hypotheses);
            prop_assert!(!hypotheses.is_empty());
            let near = (0..hypotheses.len()).any(|index| {
                let markers: Vec<_> = hypotheses.markers(index).iter().map(|own| own.map(usize::from)).collect();
                let truth: Vec<_> = shown.iter().map(|&marker| Some(marker)).collect();
                markers == truth
            });
            prop_assert!(near);
        }
    }
}
