//! Known poses come back, noise costs what it must and no more, and what has no pose has none.

use proptest::prelude::*;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;

struct Draw(Pcg64);

impl Draw {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }

    fn pose(&mut self, distance_m: f64) -> Isometry3<f64> {
        let towards = Translation3::from(self.vector().normalize() * distance_m);
        Isometry3::from_parts(towards, UnitQuaternion::from_scaled_axis(self.vector() * 2.0))
    }

    /// Bearings that err by `sigma_rad` along both axes across them.
    fn seen(
        &mut self,
        pose: &Isometry3<f64>,
        points_m: &[Vector3<f64>],
        sigma_rad: f64,
    ) -> Vec<Vector3<f64>> {
        let exact = directions(pose, points_m);
        exact.iter().map(|view| (view + self.vector() * sigma_rad).normalize()).collect()
    }

    fn points_m(&mut self, count: usize, flat: bool) -> Vec<Vector3<f64>> {
        let height = if flat { 0.0 } else { 1.0 };
        (0..count).map(|_| self.vector().component_mul(&Vector3::new(1.0, 1.0, height))).collect()
    }
}

fn directions(pose: &Isometry3<f64>, points_m: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    points_m.iter().map(|p| (pose.rotation * p + pose.translation.vector).normalize()).collect()
}

#[test]
fn exact_bearings_give_the_pose() {
    let mut draw = Draw(Pcg64::new(1, 1));
    for case in 0..4000 {
        let (count, flat) = ([4, 5, 6, 35][case % 4], case % 8 < 4);
        let (truth, points_m) = (draw.pose([0.8, 3.0, 30.0][case % 3]), draw.points_m(count, flat));
        let pose = pnp(&draw.seen(&truth, &points_m, 0.0), &points_m).unwrap();
        let shift_m = (pose.translation.vector - truth.translation.vector).norm();
        let turn_rad = pose.rotation.angle_to(&truth.rotation);
        assert!(shift_m < 1e-7 && turn_rad < 1e-7, "{shift_m:e} m, {turn_rad:e} rad, {count} points");
    }
}

#[test]
fn three_of_four_points_may_be_on_a_line() {
    let mut draw = Draw(Pcg64::new(6, 1));
    let line = [-0.2, 0.0, 0.2].map(|x| Vector3::new(x, 0.0, 0.0));
    let points_m = [line[0], line[1], line[2], Vector3::new(0.0, 0.5, 0.0)];
    for _ in 0..100 {
        let truth = draw.pose(3.0);
        let pose = pnp(&draw.seen(&truth, &points_m, 0.0), &points_m).unwrap();
        assert!((pose.to_homogeneous() - truth.to_homogeneous()).norm() < 1e-7);
    }
}

/// Of the 2 n errors the pose takes up six: the cost of the truth is above that of the estimate by 6 sigma^2
/// on average, neither less (an estimate that is not the best) nor more.
#[test]
fn noise_moves_the_pose_by_what_six_unknowns_take() {
    let mut draw = Draw(Pcg64::new(2, 1));
    let sigma_rad = 1e-5;
    for (count, flat) in [(4, false), (4, true), (6, true), (12, false)] {
        let trials = 1000;
        let mut taken = 0.0;
        for _ in 0..trials {
            let (truth, points_m) = (draw.pose(3.0), draw.points_m(count, flat));
            let bearings = draw.seen(&truth, &points_m, sigma_rad);
            let view = View::new(&bearings, &points_m);
            let pose = pnp(&bearings, &points_m).unwrap();
            taken += (view.chords(&truth) - view.chords(&pose)) / (sigma_rad * sigma_rad);
        }
        // chi-square of 6: 3.5 of its sigmas.
        let mean = taken / f64::from(trials);
        assert!((mean - 6.0).abs() < 3.5 * (12.0 / f64::from(trials)).sqrt(), "{mean}, {count} points");
    }
}

#[test]
fn truth_never_explains_noisy_bearings_better() {
    let mut draw = Draw(Pcg64::new(3, 1));
    for case in 0..2000 {
        let (count, flat) = ([4, 6, 20][case % 3], case % 2 == 0);
        let (truth, points_m) = (draw.pose([2.0, 5.0, 15.0][case / 6 % 3]), draw.points_m(count, flat));
        let bearings = draw.seen(&truth, &points_m, 1e-3);
        let view = View::new(&bearings, &points_m);
        let pose = pnp(&bearings, &points_m).unwrap();
        assert!(view.chords(&pose) <= view.chords(&truth), "{case}: {count} points");
    }
}

#[test]
fn normal_equations_are_those_of_finite_differences() {
    let mut draw = Draw(Pcg64::new(4, 1));
    for _ in 0..50 {
        let (pose, points_m) = (draw.pose(2.5), draw.points_m(5, false));
        let bearings = draw.seen(&pose, &points_m, 0.05);
        let view = View::new(&bearings, &points_m);
        let errors = |step: &Vector6<f64>| {
            let pose = turned(&pose, &view.centroid_m, step);
            let seen = directions(&pose, &points_m);
            nalgebra::SMatrix::<f64, 15, 1>::from_fn(|i, _| seen[i / 3][i % 3] - bearings[i / 3][i % 3])
        };
        let mut jacobian = nalgebra::SMatrix::<f64, 15, 6>::zeros();
        for k in 0..6 {
            let mut step = Vector6::zeros();
            step[k] = 1e-6;
            jacobian.set_column(k, &((errors(&step) - errors(&-step)) / 2e-6));
        }
        let (normal, gradient) = view.normal_equations(&pose);
        let expected = jacobian.transpose() * jacobian;
        assert!((normal - expected).norm() < 1e-8 * (1.0 + expected.norm()), "{normal} {expected}");
        assert!((gradient - jacobian.transpose() * errors(&Vector6::zeros())).norm() < 1e-8);
    }
}

#[test]
fn what_has_no_pose_has_none() {
    let mut draw = Draw(Pcg64::new(5, 1));
    let (truth, points_m) = (draw.pose(3.0), draw.points_m(5, false));
    let bearings = draw.seen(&truth, &points_m, 0.0);
    assert!(pnp(&bearings, &points_m).is_some());
    assert_eq!(pnp(&bearings[..3], &points_m[..3]), None);
    assert_eq!(pnp(&bearings, &points_m[..4]), None);
    assert_eq!(pnp(&[], &[]), None);
    let line: Vec<_> = (0..5).map(|i| Vector3::new(0.1, 0.2, 0.3) * f64::from(i)).collect();
    assert_eq!(pnp(&draw.seen(&truth, &line, 0.0), &line), None);
    assert_eq!(pnp(&bearings, &[points_m[0]; 5]), None);
    assert_eq!(pnp(&[bearings[0]; 5], &points_m), None);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut broken = points_m.clone();
        broken[2].y = bad;
        assert_eq!(pnp(&bearings, &broken), None);
        let mut broken = bearings.clone();
        broken[4].z = bad;
        assert_eq!(pnp(&broken, &points_m), None);
    }
}

proptest! {
    #[test]
    fn any_numbers_give_a_finite_pose_or_none(
        numbers in prop::collection::vec(prop::array::uniform6(any::<f64>()), 4..7),
    ) {
        let vector = |n: &[f64]| Vector3::from_column_slice(n);
        let bearings: Vec<_> = numbers.iter().map(|n| vector(&n[..3])).collect();
        let points_m: Vec<_> = numbers.iter().map(|n| vector(&n[3..])).collect();
        if let Some(pose) = pnp(&bearings, &points_m) {
            prop_assert!(pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|x| x.is_finite()));
        }
    }
}
