//! One predicted normal distribution and the spots around -> which spots may be which markers, the likeliest ways first.
//!
//! Markers are looked for one after the other, the brightest first. What one of them tells of the pose sharpens the prediction of the next: errors of the
//! markers of one vehicle are one error. Ways that fall behind are left out (beam search), so that the work is bounded.

use alloc::vec::Vec;

use nalgebra::{Matrix2, Matrix2x6, Matrix3, Matrix3x6, Matrix6, Matrix6x2, Rotation3, Vector2, Vector3};

use super::component::{Component, YAW, pose_after};
use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::{Observation, Pose, Whitened};

/// Ways that are gone on with.
const MOST_BRANCHES: usize = 8;
/// A way that is this much less likely than the best, nats, is not.
const HOPELESS_NATS: f64 = 14.0;
/// A spot farther off than this, squared and in variances, is not the marker.
const GATE: f64 = 36.0;
/// Most spots of one vehicle.
pub(super) const MOST_SPOTS: usize = 16;
/// A marker with less light than this towards the camera is looked for only where it has more within so many standard deviations of the yaw; one with less than that may be too faint.
const DARK: f64 = 0.02;
const PERHAPS_SIGMA: f64 = 2.0;
const BRIGHT: f64 = 0.3;

/// Which spots are which markers of one vehicle, in the order in which they were found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pairs {
    list: [(u16, u16); MOST_SPOTS],
    count: usize,
}

impl Pairs {
    /// Spot and marker of each.
    pub(super) fn as_slice(&self) -> &[(u16, u16)] {
        &self.list[..self.count]
    }

    /// One more, while there is room.
    pub(super) fn push(&mut self, spot: usize, marker: usize) {
        if let Some(place) = self.list.get_mut(self.count) {
            *place = (spot as u16, marker as u16);
            self.count += 1;
        }
    }

    pub(super) fn has_spot(&self, spot: usize) -> bool {
        self.as_slice().iter().any(|&(own, _)| usize::from(own) == spot)
    }

    /// The marker that a spot is.
    pub(super) fn marker_of(&self, spot: usize) -> Option<u16> {
        self.as_slice().iter().find(|&&(own, _)| usize::from(own) == spot).map(|&(_, marker)| marker)
    }

    /// Whether the same spots are the same markers.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.count == other.count && self.as_slice().iter().all(|pair| other.as_slice().contains(pair))
    }
}

/// One way, as far as it is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub(super) pairs: Pairs,
    /// How much likelier than clutter, nats.
    pub(super) gain: f64,
    /// Where the vehicle is with these spots, to first order.
    pub(super) pose: Pose,
    /// Covariance of position, m, and attitude.
    covariance: Matrix6<f64>,
}

/// What is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    pub(super) airframe: &'a Airframe,
    pub(super) observations: &'a [Observation],
    pub(super) whitened: &'a [Whitened],
    /// How likely each marker is lit, by marker.
    pub(super) lit: &'a [f64],
    /// How rarely a bright marker is missed.
    pub(super) missed: f64,
}

/// Room for the ways of one normal distribution.
#[derive(Debug)]
pub(super) struct Branches {
    all: Vec<Branch>,
    next: Vec<Branch>,
    markers: Vec<(f64, usize)>,
}

impl Branches {
    pub(super) fn with_room(markers: usize) -> Self {
        Self {
            all: Vec::with_capacity(MOST_BRANCHES),
            next: Vec::with_capacity(MOST_BRANCHES + 1),
            markers: Vec::with_capacity(markers),
        }
    }

    /// Grows the ways in which spots are markers, the likeliest first, that of no spot among them; `signal_nats` is what it costs that a spot is a marker for what
    /// it blinks.
    pub(super) fn grow(
        &mut self,
        around: &Around<'_>,
        component: &Component,
        signal_nats: impl Fn(usize, usize) -> f64,
    ) {
        let airframe = around.airframe;
        let camera_m = component.pose.camera_in_body_m();
        let beside_rad = PERHAPS_SIGMA * component.covariance[(YAW, YAW)].sqrt();
        let beside_m = [beside_rad, -beside_rad]
            .map(|yaw_rad| Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad) * camera_m);
        self.markers.clear();
        self.markers.extend(
            (0..airframe.markers().len()).map(|marker| (airframe.intensity(marker, &camera_m), marker)),
        );
        self.markers.retain(|&(intensity, marker)| {
            let shines = |camera_m: &Vector3<f64>| airframe.intensity(marker, camera_m) > DARK;
            intensity > DARK || beside_m.iter().any(shines)
        });
        self.markers.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.all.clear();
        self.all.push(Branch {
            pairs: Pairs::default(),
            gain: 0.0,
            pose: component.pose,
            covariance: component.pose_covariance(),
        });
        for place in 0..self.markers.len() {
            let (intensity, marker) = self.markers[place];
            let lit = around.lit.get(marker).copied().unwrap_or(1.0);
            let found = match intensity {
                dark if dark <= DARK => around.missed,
                faint if faint < BRIGHT => 0.5,
                _ => 1.0 - around.missed,
            };
            let found = lit * found;
            self.look_for(around, marker, found, &signal_nats);
        }
    }

    /// The ways that grew.
    pub(super) fn grown(&self) -> &[Branch] {
        &self.all
    }

    /// Goes on with every way by one marker.
    fn look_for(
        &mut self,
        around: &Around<'_>,
        marker: usize,
        found: f64,
        signal_nats: &impl Fn(usize, usize) -> f64,
    ) {
        let Self { all, next, .. } = self;
        next.clear();
        for branch in all.iter() {
            keep(next, Branch { gain: branch.gain + libm::log(1.0 - found), ..*branch });
            let seen = Predicted::of(around.airframe, &branch.pose, &branch.covariance, marker);
            for spot in 0..around.observations.len() {
                let whitened = &around.whitened[spot];
                if branch.pairs.has_spot(spot) || seen.direction.dot(&whitened.direction) < 0.0 {
                    continue;
                }
                let Some(innovation) = seen.innovation(whitened) else { continue };
                let gain = branch.gain + innovation.log_density + libm::log(found)
                    - around.observations[spot].clutter_log_density
                    - signal_nats(spot, marker);
                if next.len() == MOST_BRANCHES && gain <= next[MOST_BRANCHES - 1].gain {
                    continue;
                }
                let mut grown = branch.followed(&innovation);
                grown.gain = gain;
                grown.pairs.push(spot, marker);
                keep(next, grown);
            }
        }
        let least = next.first().map_or(f64::NEG_INFINITY, |best| best.gain - HOPELESS_NATS);
        next.retain(|branch| branch.gain >= least);
        core::mem::swap(all, next);
    }
}

/// Puts a branch into its place among the best.
fn keep(best: &mut Vec<Branch>, branch: Branch) {
    let place = best.partition_point(|other| other.gain >= branch.gain);
    best.insert(place, branch);
    best.truncate(MOST_BRANCHES);
}

/// The direction in which a marker is expected.
pub(super) struct Predicted {
    pub(super) direction: Vector3<f64>,
    /// Its derivative by position, m, and attitude.
    pub(super) by_pose: Matrix3x6<f64>,
    /// The covariance of the pose times the derivative.
    spread: SpreadOfPose,
    covariance: Matrix3<f64>,
}

type SpreadOfPose = nalgebra::Matrix6x3<f64>;

/// What a spot says if it is a marker.
struct Innovation {
    residual: Vector2<f64>,
    gain: Matrix6x2<f64>,
    by_pose: Matrix2x6<f64>,
    log_density: f64,
}

impl Predicted {
    pub(super) fn of(airframe: &Airframe, pose: &Pose, covariance: &Matrix6<f64>, marker: usize) -> Self {
        let at_m = airframe.markers()[marker].position_m;
        let place_m = pose.camera_from_body * at_m + pose.position_m;
        let range_m = place_m.norm();
        let direction = place_m / range_m;
        let across = (Matrix3::identity() - direction * direction.transpose()) / range_m;
        let mut by_pose = Matrix3x6::zeros();
        by_pose.fixed_view_mut::<3, 3>(0, 0).copy_from(&across);
        // d(R exp(omega) p) = -R [p]x omega.
        by_pose
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-(across * pose.camera_from_body.matrix() * at_m.cross_matrix()));
        let spread = covariance * by_pose.transpose();
        Self { direction, by_pose, spread, covariance: by_pose * spread }
    }

    /// `None` where the spot is too far off.
    fn innovation(&self, seen: &Whitened) -> Option<Innovation> {
        let residual = seen.map * self.direction;
        let covariance = seen.map * self.covariance * seen.map.transpose() + Matrix2::identity();
        let inverse = covariance.try_inverse()?;
        let square = residual.dot(&(inverse * residual));
        if square.is_nan() || square >= GATE {
            return None;
        }
        let log_density = -0.5 * square
            - 0.5 * libm::log(covariance.determinant())
            - libm::log(core::f64::consts::TAU)
            - seen.log_sigmas;
        let gain = self.spread * seen.map.transpose() * inverse;
        Some(Innovation { residual, gain, by_pose: seen.map * self.by_pose, log_density })
    }
}

impl Branch {
    /// The pose as a spot has it.
    fn followed(&self, innovation: &Innovation) -> Self {
        let pose = pose_after(&self.pose, &-(innovation.gain * innovation.residual));
        let covariance = self.covariance - innovation.gain * innovation.by_pose * self.covariance;
        Self { pose, covariance: (covariance + covariance.transpose()) * 0.5, ..*self }
    }
}
