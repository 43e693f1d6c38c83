//! Known poses come back, no solution is missed, and what has no solution has none.

use nalgebra::{Point3, Quaternion};
use proptest::prelude::*;
use proptest::strategy::ValueTree;

use super::*;

type Triple = [Vector3<f64>; 3];

fn seen(pose: &Isometry3<f64>, points_m: &Triple) -> Triple {
    points_m.map(|point_m| (pose * Point3::from(point_m)).coords.normalize())
}

fn worst_bearing(pose: &Isometry3<f64>, bearings: &Triple, points_m: &Triple) -> f64 {
    let seen = seen(pose, points_m);
    (0..3).map(|i| (seen[i] - bearings[i]).norm()).fold(0.0, f64::max)
}

/// Error of the nearest solution: of the position as a share of the distance, or the turn, rad.
fn nearest_error(solutions: &P3pSolutions, truth: &Isometry3<f64>) -> f64 {
    let error = |pose: &Isometry3<f64>| {
        let shift_m = (pose.translation.vector - truth.translation.vector).norm();
        (shift_m / truth.translation.vector.norm()).max(pose.rotation.angle_to(&truth.rotation))
    };
    solutions.iter().map(error).fold(f64::INFINITY, f64::min)
}

/// Height over the longest side.
fn flatness(points_m: &Triple) -> f64 {
    let [a, b] = [points_m[1] - points_m[0], points_m[2] - points_m[0]];
    a.cross(&b).norm() / a.norm_squared().max(b.norm_squared()).max((b - a).norm_squared())
}

/// How far the camera is from the cylinder on the circle through the points, where solutions meet: the
/// determinant of the depth equations' derivatives, rows in units of their sides.
fn distance_to_cylinder(pose: &Isometry3<f64>, points_m: &Triple) -> f64 {
    let corners = points_m.map(|point_m| (pose * Point3::from(point_m)).coords);
    let bearings = seen(pose, points_m);
    let row = |i: usize, j: usize| {
        let side = (corners[i] - corners[j]).normalize();
        let mut row = Vector3::zeros();
        (row[i], row[j]) = (bearings[i].dot(&side), -bearings[j].dot(&side));
        row.transpose()
    };
    Matrix3::from_rows(&[row(0, 1), row(0, 2), row(1, 2)]).determinant().abs()
}

prop_compose! {
    fn vector(reach: f64)(v in prop::array::uniform3(-reach..reach)) -> Vector3<f64> {
        Vector3::from(v)
    }
}

prop_compose! {
    /// A pose in any direction and attitude, near and far.
    fn pose()(
        towards in vector(1.0).prop_filter("a direction", |v| v.norm() > 0.1),
        log_distance in -0.5..4.0_f64,
        turn in prop::array::uniform4(-1.0..1.0_f64).prop_filter("a turn", |q| q.iter().any(|x| x.abs() > 0.1)),
    ) -> Isometry3<f64> {
        let [x, y, z, w] = turn;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(Translation3::from(towards.normalize() * libm::exp(log_distance)), rotation)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, max_global_rejects: 1 << 20, ..ProptestConfig::default() })]

    #[test]
    fn the_true_pose_is_among_the_solutions(
        truth in pose(),
        points_m in prop::array::uniform3(vector(1.0)),
    ) {
        prop_assume!(flatness(&points_m) > 0.05 && distance_to_cylinder(&truth, &points_m) > 1e-4);
        let solutions = p3p(&seen(&truth, &points_m), &points_m);
        let error = nearest_error(&solutions, &truth);
        prop_assert!(error < 1e-9, "{error:e}");
    }

    #[test]
    fn every_solution_reproduces_its_bearings(
        bearings in prop::array::uniform3(vector(1.0)),
        points_m in prop::array::uniform3(vector(1.0)),
    ) {
        prop_assume!(flatness(&points_m) > 0.05);
        let bearings = bearings.map(|bearing| bearing.normalize());
        let solutions = p3p(&bearings, &points_m);
        for pose in solutions.iter() {
            let worst = worst_bearing(pose, &bearings, &points_m);
            prop_assert!(worst < 1e-9, "{worst:e}");
            prop_assert!((pose.rotation.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn order_and_units_do_not_matter(
        truth in pose(),
        points_m in prop::array::uniform3(vector(1.0)),
        scale in prop::sample::select(vec![1e-6, 1e-3, 1e3, 1e6]),
    ) {
        prop_assume!(flatness(&points_m) > 0.05 && distance_to_cylinder(&truth, &points_m) > 1e-3);
        let bearings = seen(&truth, &points_m);
        let solutions = p3p(&bearings, &points_m);
        let permuted = p3p(&[2, 0, 1].map(|i| bearings[i]), &[2, 0, 1].map(|i| points_m[i]));
        prop_assert_eq!(solutions.iter().len(), permuted.iter().len());
        let scaled = p3p(&bearings, &points_m.map(|point_m| point_m * scale));
        prop_assert_eq!(solutions.iter().len(), scaled.iter().len());
        let mut larger = truth;
        larger.translation.vector *= scale;
        prop_assert!(nearest_error(&scaled, &larger) < 1e-9);
    }

    /// Whole numbers make right angles, equal sides and cameras above corners, where coefficients vanish.
    #[test]
    fn symmetric_views_come_back(
        camera in prop::array::uniform3(-3..=3),
        corners in prop::array::uniform3(prop::array::uniform3(-2..=2)),
    ) {
        let points_m = corners.map(|corner| Vector3::from(corner.map(f64::from)));
        let truth = Isometry3::translation(-f64::from(camera[0]), -f64::from(camera[1]), -f64::from(camera[2]));
        prop_assume!(camera != [0; 3] && !corners.contains(&camera) && flatness(&points_m) > 0.05);
        prop_assume!(distance_to_cylinder(&truth, &points_m) > 1e-6);
        let error = nearest_error(&p3p(&seen(&truth, &points_m), &points_m), &truth);
        prop_assert!(error < 1e-9, "{error:e}");
    }

    #[test]
    fn any_numbers_give_finite_poses(
        bearings in prop::array::uniform3(prop::array::uniform3(any::<f64>())),
        points_m in prop::array::uniform3(prop::array::uniform3(any::<f64>())),
    ) {
        for pose in p3p_with_near_misses(&bearings.map(Vector3::from), &points_m.map(Vector3::from)).iter() {
            prop_assert!(pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|x| x.is_finite()));
        }
    }
}

/// Depths that Newton's method finds from a dense grid of starts in the equations as they stand in the
/// textbook.
fn depths_by_brute_force(bearings: &Triple, points_m: &Triple) -> Vec<Vector3<f64>> {
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let longest_m = pairs.iter().map(|&(i, j)| (points_m[i] - points_m[j]).norm()).fold(0.0, f64::max);
    let smallest = pairs.iter().map(|&(i, j)| (bearings[i] - bearings[j]).norm()).fold(2.0, f64::min);
    let reach_m = 2.0 * longest_m / smallest.min(1.0);
    let mut found: Vec<Vector3<f64>> = Vec::new();
    for start in 0..1000 {
        let step = |n: i32| (f64::from(n % 10) + 0.5) / 10.0 * reach_m;
        let mut depths = Vector3::new(step(start), step(start / 10), step(start / 100));
        for _ in 0..40 {
            let mut error = Vector3::zeros();
            let mut jacobian = Matrix3::zeros();
            for (row, &(i, j)) in pairs.iter().enumerate() {
                let side = bearings[i] * depths[i] - bearings[j] * depths[j];
                error[row] = side.norm_squared() - (points_m[i] - points_m[j]).norm_squared();
                jacobian[(row, i)] = 2.0 * side.dot(&bearings[i]);
                jacobian[(row, j)] = -2.0 * side.dot(&bearings[j]);
            }
            let Some(inverse) = jacobian.try_inverse() else { break };
            let change = inverse * error;
            depths -= change;
            if change.norm() < 1e-13 * depths.norm() {
                let known = found.iter().any(|other| (other - depths).norm() < 1e-6 * depths.norm());
                if depths.min() > 1e-9 && !known {
                    found.push(depths);
                }
                break;
            }
        }
    }
    found
}

#[test]
fn no_solution_is_missed() {
    let mut rng = proptest::test_runner::TestRunner::deterministic();
    let mut by_count = [0; 5];
    for _ in 0..60 {
        let (truth, points_m) = loop {
            let (pose, points_m) = (pose(), prop::array::uniform3(vector(1.0)));
            let draw = (pose, points_m).new_tree(&mut rng).unwrap().current();
            if flatness(&draw.1) > 0.1 && draw.0.translation.vector.norm() < 4.0 {
                break draw;
            }
        };
        let bearings = seen(&truth, &points_m);
        let solutions = p3p(&bearings, &points_m);
        let expected = depths_by_brute_force(&bearings, &points_m);
        by_count[solutions.iter().len()] += 1;
        assert!(!expected.is_empty());
        for depths in expected {
            let nearest = solutions
                .iter()
                .map(|pose| {
                    let ours = points_m.map(|point_m| (pose * Point3::from(point_m)).coords.norm());
                    (Vector3::from(ours) - depths).norm() / depths.norm()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6, "{nearest:e} of {depths:?}");
        }
    }
    assert!(by_count[1] > 3 && by_count[2] > 3 && by_count[4] > 3, "{by_count:?}");
}

/// Here the separate root of the cubic is infinite but for rounding.
#[test]
fn two_degenerate_cones_make_no_difference() {
    let points_m =
        [Vector3::new(1.0, 2.0, -1.0), Vector3::new(-2.0, 1.0, -1.0), Vector3::new(-1.0, 0.0, 0.0)];
    let truth = Isometry3::translation(0.0, -3.0, 0.0);
    assert!(nearest_error(&p3p(&seen(&truth, &points_m), &points_m), &truth) < 1e-9);
}

#[test]
fn level_ring_and_frontal_ring_come_back_at_any_distance() {
    let corner = |i: f64| Vector3::new(0.4 * libm::cos(i), 0.4 * libm::sin(i), 0.0);
    for distance_m in [1.0, 5.0, 15.0, 100.0] {
        for yaw in 0..40 {
            let yaw_rad = 0.1 + f64::from(yaw) * 0.15;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
            let edge_on = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), core::f64::consts::FRAC_PI_2);
            for tilt in [UnitQuaternion::identity(), edge_on] {
                let behind = Translation3::new(0.5, 0.1, -distance_m);
                let truth = Isometry3::from_parts(behind, tilt * turn);
                let points_m = [corner(0.0), corner(2.0), corner(4.0)];
                let error = nearest_error(&p3p(&seen(&truth, &points_m), &points_m), &truth);
                assert!(error < 1e-8, "{error:e} at {distance_m} m, yaw {yaw_rad}");
            }
        }
    }
}

#[test]
fn on_the_cylinder_solutions_are_one_and_good_to_the_root_of_rounding() {
    let points_m = [Vector3::new(0.4, 0.0, 0.0), Vector3::new(-0.3, 0.2, 0.0), Vector3::new(0.1, -0.4, 0.0)];
    let circle = [points_m[1] - points_m[0], points_m[2] - points_m[0]];
    let gram = nalgebra::Matrix2::from_fn(|i, j| circle[i].dot(&circle[j]));
    let half = nalgebra::Vector2::new(gram.m11, gram.m22) / 2.0;
    let weights = gram.try_inverse().unwrap() * half;
    let centre = points_m[0] + circle[0] * weights.x + circle[1] * weights.y;
    let radius_m = (centre - points_m[0]).norm();
    for step in 0..100 {
        let (sin, cos) = libm::sincos(0.02 + 0.0628 * f64::from(step));
        let camera_m = centre + Vector3::new(radius_m * cos, radius_m * sin, 1.0);
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.2, 0.1 * f64::from(step)));
        let truth = Isometry3::from_parts(Translation3::from(rotation * -camera_m), rotation);
        let solutions = p3p(&seen(&truth, &points_m), &points_m);
        let error = nearest_error(&solutions, &truth);
        assert!(error < 1e-5, "{error:e} at step {step}");
        for (i, pose) in solutions.iter().enumerate() {
            let mut others = solutions.iter().take(i);
            let alike =
                |other: &Isometry3<f64>| (other.to_homogeneous() - pose.to_homogeneous()).norm() < 4e-8;
            assert!(!others.any(alike), "one solution twice at step {step}");
        }
    }
}

#[test]
fn degenerate_inputs_have_no_solution() {
    let bearings =
        [[0.1, 0.0, 1.0], [0.0, 0.1, 1.0], [-0.1, -0.1, 1.0]].map(|f| Vector3::from(f).normalize());
    let points_m = [Vector3::new(0.4, 0.0, 0.0), Vector3::new(-0.3, 0.2, 0.1), Vector3::new(0.1, -0.4, 0.0)];
    assert!(p3p(&bearings, &points_m).iter().len() > 0);
    let [a, b, c] = points_m;
    for line in [[a, a, b], [a, b, b], [b, a, b], [a, a, a], [a, b, a + (b - a) * 2.0], [a, b, (a + b) / 2.0]]
    {
        assert_eq!(p3p(&bearings, &line).iter().len(), 0, "{line:?}");
    }
    assert_eq!(p3p(&[bearings[0]; 3], &points_m).iter().len(), 0);
    for bad in [f64::NAN, f64::INFINITY] {
        let broken = Vector3::new(0.1, bad, 0.2);
        assert_eq!(p3p(&bearings, &[a, broken, c]).iter().len(), 0);
        assert_eq!(p3p(&[bearings[0], bearings[1], broken], &points_m).iter().len(), 0);
    }
}

#[test]
fn two_equal_bearings_see_along_a_side() {
    let truth = Isometry3::from_parts(Translation3::new(0.2, -0.3, 2.0), UnitQuaternion::identity());
    let near_m = Vector3::new(0.1, 0.2, 0.1);
    let behind_m = truth.inverse_transform_vector(&(truth * Point3::from(near_m)).coords) * 0.2;
    let points_m = [near_m, near_m + behind_m, Vector3::new(-0.4, 0.3, 0.0)];
    let bearings = seen(&truth, &points_m);
    assert!((bearings[0] - bearings[1]).norm() < 1e-15);
    assert!(nearest_error(&p3p(&bearings, &points_m), &truth) < 1e-9);
}

#[test]
fn noise_that_leaves_no_solution_leaves_a_near_miss() {
    // A flat triangle seen tall.
    let points_m = [Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.5, 0.01, 0.0)];
    let bearing = |x: f64, y: f64| Vector3::new(x, y, 1.0).normalize();
    let bearings = [bearing(-0.1, 0.0), bearing(0.1, 0.0), bearing(0.0, 0.05)];
    assert_eq!(p3p(&bearings, &points_m).iter().len(), 0);
    let misses = p3p_with_near_misses(&bearings, &points_m);
    assert!(misses.iter().any(|pose| worst_bearing(pose, &bearings, &points_m) < 0.1));
}
