//! A neighbour of which less shows than could: three of its spots as any three of its markers.
//!
//! In: a group of an airframe that shows too much at once for its spots to be put in order. Out: the poses in which three
//! spots, far apart, are three markers, each with what it costs by a first look: the tilt, and how far the other spots are
//! from markers that are left. Outlines suppose that all is in sight; these do not.

use alloc::vec::Vec;

use nalgebra::{Unit, Vector3};

use crate::airframe::Airframe;
use crate::locator::Sighting;
use crate::locator::context::Context;
use crate::pose::{Pose, Symmetry, p3p_with_near_misses};

/// Most choices of three markers in an order: the time of a group is bounded.
const MOST_CHOICES: usize = 130;
/// Three spots with noise tell where the others must be to this many sigma.
const SIGMAS: f64 = 3.0;
/// A spot farther than this from every marker, nats, is none of the markers.
const FAR_NATS: f64 = 12.0;

/// Choices of three markers, one of each handful that symmetry makes equal.
#[derive(Clone, Debug)]
pub(super) struct Triples {
    airframe: Airframe,
    choices: Vec<[u16; 3]>,
}

/// A pose with what it costs, nats.
pub(super) struct Start {
    pub(super) pose: Pose,
    pub(super) nats: f64,
}

impl Triples {
    /// The choices of an airframe; none where they are too many.
    pub(super) fn of(airframe: &Airframe, symmetry: &Symmetry) -> Self {
        let markers = airframe.markers().len() as u16;
        let mut choices = Vec::new();
        if usize::from(markers).pow(3) / symmetry.turns() <= 8 * MOST_CHOICES {
            for a in 0..markers {
                for b in (0..markers).filter(|&b| b != a) {
                    for c in (0..markers).filter(|&c| c != a && c != b) {
                        choices.push([a, b, c]);
                    }
                }
            }
            choices.retain(|choice| symmetry.canonical_turn(choice) == 0);
        }
        if choices.len() > MOST_CHOICES {
            choices.clear();
        }
        Self { airframe: airframe.clone(), choices }
    }

    /// Calls `with` for every pose in which three spots of a group of at least three are markers that shine towards the
    /// camera.
    pub(super) fn each_start(
        &self,
        context: &Context<'_>,
        group: &[usize],
        tilt_sigma_rad: f64,
        mut with: impl FnMut(Start),
    ) {
        let Context { sightings, gravity, .. } = *context;
        let corners = corners(sightings, group);
        let bearings = corners.map(|spot| *sightings[spot].bearing.vector());
        for choice in &self.choices {
            let places_m = choice.map(|marker| self.airframe.markers()[usize::from(marker)].position_m);
            for solution in p3p_with_near_misses(&bearings, &places_m).iter() {
                let pose = Pose {
                    position_m: solution.translation.vector,
                    camera_from_body: solution.rotation.to_rotation_matrix(),
                };
                let camera_m = pose.camera_in_body_m();
                if choice.iter().any(|&marker| !self.airframe.is_visible(usize::from(marker), &camera_m)) {
                    continue;
                }
                let tilt = gravity.map_or(0.0, |down| tilt_nats(&pose, down, tilt_sigma_rad));
                let others = group.iter().filter(|spot| !corners.contains(spot));
                let apart = others.map(|&spot| self.apart_nats(&pose, &camera_m, choice, &sightings[spot]));
                with(Start { pose, nats: tilt + apart.sum::<f64>() });
            }
        }
    }

    /// How far a spot is from the nearest marker that is not one of `taken`.
    fn apart_nats(&self, pose: &Pose, camera_m: &Vector3<f64>, taken: &[u16; 3], sighting: &Sighting) -> f64 {
        let gap2 = |(number, marker): (usize, &crate::airframe::Marker)| {
            let free = !taken.contains(&(number as u16)) && self.airframe.is_visible(number, camera_m);
            let seen = (pose.camera_from_body * marker.position_m + pose.position_m).normalize();
            free.then(|| (seen - sighting.bearing.vector()).norm_squared())
        };
        let nearest =
            self.airframe.markers().iter().enumerate().filter_map(gap2).fold(f64::INFINITY, f64::min);
        let variance_rad2 = SIGMAS * SIGMAS * sighting.covariance_rad2.trace() / 2.0;
        (0.5 * nearest / variance_rad2.max(1e-12)).min(FAR_NATS)
    }
}

fn tilt_nats(pose: &Pose, down: &Unit<Vector3<f64>>, tilt_sigma_rad: f64) -> f64 {
    let up = -(pose.camera_from_body.inverse() * down.into_inner());
    // Upside down is as far from level as can be.
    let off = if up.z > 0.0 { up.xy().norm() } else { 2.0 - up.xy().norm() };
    0.5 * (off / tilt_sigma_rad) * (off / tilt_sigma_rad)
}

/// Three spots of a group, far apart: the farthest from its first, the farthest from that, and the one that makes the
/// largest triangle with both.
fn corners(sightings: &[Sighting], group: &[usize]) -> [usize; 3] {
    let direction = |spot: usize| sightings[spot].bearing.vector();
    let largest = |size: &dyn Fn(usize) -> f64| {
        group.iter().copied().max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(group[0])
    };
    let a = largest(&|spot| (direction(spot) - direction(group[0])).norm_squared());
    let b = largest(&|spot| (direction(spot) - direction(a)).norm_squared());
    let side = direction(b) - direction(a);
    let c = largest(&|spot| {
        if spot == a || spot == b {
            -1.0
        } else {
            (direction(spot) - direction(a)).cross(&side).norm_squared()
        }
    });
    [a, b, c]
}
