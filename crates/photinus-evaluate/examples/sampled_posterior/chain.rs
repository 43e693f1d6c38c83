//! A random walk that visits poses as often as they are likely: plain Metropolis.
//!
//! A pose is walked in a yaw, a tilt, and what is left of the position when that at which the two markers would be seen best
//! in that attitude is taken off: the valley of distance against yaw is straight in these. Taking it off moves no volume, so
//! that the density needs no factor for it. Now and then a leap goes to any yaw and any pair of markers. The first spot is
//! always marker 0: the other names are turns of the airframe.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use crate::model::Model;

/// Standard deviations of a step: yaw and tilt, rad.
const YAW_RAD: f64 = 0.12;
const TILT_RAD: f64 = 0.06;
/// Share of the steps that are leaps.
const LEAPS: f64 = 0.2;
/// Share of the walk that is thrown away.
const BURN_IN: f64 = 0.1;

#[derive(Clone, Copy)]
struct State {
    second: usize,
    yaw_rad: f64,
    tilt_rad: [f64; 2],
    rest_m: Vector3<f64>,
    log_density: f64,
    position_m: Vector3<f64>,
}

/// Walks so many steps and returns every position after the burn-in.
pub(crate) fn walk(model: &Model<'_>, steps: usize, rng: &mut Pcg64) -> Vec<Vector3<f64>> {
    let unit = Uniform::new(0.0, 1.0).expect("a range");
    let normal = |rng: &mut Pcg64| -> f64 { StandardNormal.sample(rng) };
    let step_m = rest_step_m(model);
    let markers = model.airframe.markers().len();
    let at = |second, yaw_rad, tilt_rad, rest_m| State::at(model, second, yaw_rad, tilt_rad, rest_m);
    let mut here = at(1, 0.0, [0.0; 2], Vector3::zeros());
    let mut samples = Vec::with_capacity(steps);
    for _ in 0..steps {
        let leap = !here.log_density.is_finite() || unit.sample(rng) < LEAPS;
        let there = if leap {
            let second = 1 + (unit.sample(rng) * (markers - 1) as f64) as usize;
            at(second, TAU * unit.sample(rng), here.tilt_rad, here.rest_m)
        } else {
            let tilt_rad = here.tilt_rad.map(|tilt| tilt + TILT_RAD * normal(rng));
            let off = Vector3::from_fn(|_, _| normal(rng));
            at(here.second, here.yaw_rad + YAW_RAD * normal(rng), tilt_rad, here.rest_m + step_m * off)
        };
        if libm::log(unit.sample(rng)) < there.log_density - here.log_density {
            here = there;
        }
        samples.push(here.position_m);
    }
    samples.split_off((steps as f64 * BURN_IN) as usize)
}

impl State {
    fn at(model: &Model<'_>, second: usize, yaw_rad: f64, tilt_rad: [f64; 2], rest_m: Vector3<f64>) -> Self {
        let tilt = Vector3::new(tilt_rad[0], tilt_rad[1], 0.0);
        let camera_from_body =
            level(model) * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad) * Rotation3::new(tilt);
        let position_m = triangulated_m(model, &camera_from_body, second) + rest_m;
        let angle_rad = tilt.norm().max(1e-9);
        // The area of the sphere of directions that a step in tilt covers.
        let area = libm::log(libm::sin(angle_rad) / angle_rad);
        let log_density = model.log_density(&position_m, &camera_from_body, [0, second]) + area;
        Self { second, yaw_rad, tilt_rad, rest_m, log_density, position_m }
    }
}

/// An upright body, in the camera frame.
fn level(model: &Model<'_>) -> Rotation3<f64> {
    let up = model.up.into_inner();
    let left = up.cross(&Vector3::z()).normalize();
    Rotation3::from_basis_unchecked(&[left.cross(&up), left, up])
}

/// Where the body is when both markers are as near to their lines of sight as can be.
fn triangulated_m(model: &Model<'_>, camera_from_body: &Rotation3<f64>, second: usize) -> Vector3<f64> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (seen, marker) in model.seen.iter().zip([0, second]) {
        let across = Matrix3::identity() - seen.direction * seen.direction.transpose();
        normal += across;
        right -= across * (camera_from_body * model.airframe.markers()[marker].position_m);
    }
    normal.cholesky().map_or(Vector3::zeros(), |factor| factor.solve(&right))
}

/// How far a step goes: as far as a third of a milliradian makes of the position, across and along.
fn rest_step_m(model: &Model<'_>) -> Matrix3<f64> {
    let [a, b] = [0, 1].map(|spot| model.seen[spot].direction);
    let (ahead, beside) = ((a + b).normalize(), (a - b).normalize());
    let distance_m = 0.5 * (model.bounds.min_m() + model.bounds.max_m());
    let across_m = 3e-4 * distance_m;
    let along_m = across_m / a.angle(&b);
    Matrix3::from_columns(&[ahead * along_m, beside * across_m, ahead.cross(&beside) * across_m])
}
