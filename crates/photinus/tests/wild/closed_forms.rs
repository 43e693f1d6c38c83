//! Any bearings and points, for poses from known correspondences.

use std::cell::Cell;

use nalgebra::{Isometry3, Vector3};
use photinus::pose::{p3p, pnp};
use proptest::prelude::*;

use crate::any::{direction, finite_vector, with_twins};
use crate::runner;

/// To rounding, which the flattest triangles that are one magnify.
fn is_pose(pose: &Isometry3<f64>) -> bool {
    pose.translation.vector.iter().all(|number| number.is_finite())
        && (pose.rotation.coords.norm() - 1.0).abs() < 1e-6
}

#[test]
fn three_bearings_give_poses_or_none() {
    let inputs = (prop::array::uniform3(direction()), with_twins(finite_vector(), 3));
    let poses = Cell::new(0);
    let outcome = runner(4000).run(&inputs, |(bearings, mut points_m)| {
        points_m.resize(3, points_m[0]);
        let bearings = bearings.map(|bearing| *bearing.vector());
        let points_m = [points_m[0], points_m[1], points_m[2]];
        for pose in p3p(&bearings, &points_m).iter() {
            poses.set(poses.get() + 1);
            prop_assert!(is_pose(pose), "{pose}");
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    println!("{} poses", poses.get());
    assert!(poses.get() > 100);
}

#[test]
fn many_bearings_give_a_pose_or_none() {
    let inputs = (with_twins(direction(), 8), with_twins(finite_vector(), 8));
    let poses = Cell::new(0);
    let outcome = runner(4000).run(&inputs, |(bearings, mut points_m)| {
        let mut bearings: Vec<Vector3<f64>> = bearings.iter().map(|bearing| *bearing.vector()).collect();
        let count = bearings.len().min(points_m.len());
        bearings.truncate(count);
        points_m.truncate(count);
        if let Some(pose) = pnp(&bearings, &points_m) {
            poses.set(poses.get() + 1);
            prop_assert!(is_pose(&pose), "{pose}");
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    println!("{} poses", poses.get());
    assert!(poses.get() > 100);
}
