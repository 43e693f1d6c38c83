use nalgebra::{Unit, Vector2, Vector6};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;
use crate::sighted::Sighted;

fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
}

/// A camera that looks to the side and down, a little off the body's origin.
fn truth() -> Pose {
    Pose {
        body_from_camera: UnitQuaternion::new(Vector3::new(-1.3, 0.9, -0.8)),
        centre_m: Vector3::new(0.12, -0.05, 0.08),
    }
}

/// What the camera sees at places spread over its image, with noise of `sigma_px`, and what is known of it.
fn observations(count: usize, sigma_px: f64, seed: u128, far: bool) -> Vec<Observation> {
    let (camera, truth) = (camera(), truth());
    let mut random = Pcg64::new(seed, 7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    (0..count)
        .map(|index| {
            let spread = |step: f64| (index as f64 * step).fract();
            let pixel = Pixel::new(40.0 + 670.0 * spread(0.618), 40.0 + 400.0 * spread(0.7549));
            let ray = truth.body_from_camera * camera.bearing(pixel).unwrap().vector();
            let known = match far {
                true => Known::Direction(Unit::new_normalize(ray)),
                false => Known::Position(truth.centre_m + ray * (0.7 + 2.0 * spread(0.414))),
            };
            let seen = Pixel::new(pixel.u + sigma_px * normal(), pixel.v + sigma_px * normal());
            Observation { sighted: Sighted::new(&camera, seen, 1.0).unwrap(), known }
        })
        .collect()
}

fn turn(found: &Mounting) -> Vector3<f64> {
    (truth().body_from_camera * found.body_from_camera.inverse()).scaled_axis()
}

#[test]
fn derivatives_are_those_of_differences() {
    for seen in [observations(3, 5.0, 1, true)[2], observations(3, 5.0, 1, false)[2]] {
        let pose = truth().moved(&Vector6::new(0.1, -0.2, 0.1, 0.05, 0.1, -0.1));
        let (_, jacobian) = pose.residual(&seen).unwrap();
        for unknown in 0..6 {
            let step = Vector6::ith(unknown, 1e-6);
            let at = |step: &Vector6<f64>| -> Vector2<f64> { pose.moved(step).residual(&seen).unwrap().0 };
            let difference = (at(&step) - at(&-step)) / 2e-6;
            let error = (difference - jacobian.column(unknown)).norm();
            assert!(error < 1e-5 * jacobian.norm(), "{unknown}: {difference} {jacobian}");
        }
    }
}

#[test]
fn without_noise_it_is_the_truth() {
    let far = calibrate(&observations(12, 0.0, 1, true)).unwrap();
    assert!(turn(&far).norm() < 1e-9 && far.centre.is_none());
    let near = calibrate(&observations(12, 0.0, 1, false)).unwrap();
    assert!(turn(&near).norm() < 1e-9 && (near.centre.unwrap().0 - truth().centre_m).norm() < 1e-9);
}

#[test]
fn errors_have_the_covariance_that_is_claimed() {
    const RUNS: u128 = 400;
    let count = 24;
    let (mut rotations, mut places) = (0.0, 0.0);
    for seed in 0..RUNS {
        let far = calibrate(&observations(count, 0.4, seed, true)).unwrap();
        let error = turn(&far);
        rotations += error.dot(&(far.rotation_covariance_rad2.try_inverse().unwrap() * error)) / RUNS as f64;
        let (centre_m, covariance_m2) =
            calibrate(&observations(count, 0.4, seed, false)).unwrap().centre.unwrap();
        let error = centre_m - truth().centre_m;
        places += error.dot(&(covariance_m2.try_inverse().unwrap() * error)) / RUNS as f64;
    }
    // the sigma is itself estimated: the mean of n F(3, m) is 3 m / (m - 2)
    let expected = |freedom: f64| 3.0 * freedom / (freedom - 2.0);
    assert!((rotations / expected(45.0) - 1.0).abs() < 0.15, "{rotations}");
    assert!((places / expected(42.0) - 1.0).abs() < 0.15, "{places}");
}

#[test]
fn what_contradicts_the_others_is_left_out() {
    for far in [true, false] {
        let mut seen = observations(20, 0.3, 3, far);
        let wrong = observations(20, 0.3, 3, far);
        for (index, other) in [(2, 9), (7, 16), (11, 4)] {
            seen[index].known = wrong[other].known;
        }
        let found = calibrate(&seen).unwrap();
        assert_eq!(found.outliers, [2, 7, 11], "{found:?}");
        assert!(turn(&found).norm() < 3e-3 && (0.1..0.6).contains(&found.scatter), "{found:?}");
    }
}

#[test]
fn what_tells_no_mounting_is_refused_with_its_reason() {
    let good = observations(20, 0.3, 3, true);
    assert_eq!(calibrate(&good[..2]), Err(MountingError::TooFew { given: 2, needed: 3 }));
    let camera = camera();
    let alike: Vec<Observation> = (0..10)
        .map(|index| {
            let pixel = Pixel::new(300.0 + 0.2 * f64::from(index), 200.0);
            let ray = truth().body_from_camera * camera.bearing(Pixel::new(300.0, 200.0)).unwrap().vector();
            let known = Known::Direction(Unit::new_normalize(ray));
            Observation { sighted: Sighted::new(&camera, pixel, 1.0).unwrap(), known }
        })
        .collect();
    assert!(matches!(calibrate(&alike), Err(MountingError::Alike { .. })), "{:?}", calibrate(&alike));
    let mut far_away = observations(12, 0.5, 3, false);
    for seen in &mut far_away {
        let Known::Position(position_m) = &mut seen.known else { unreachable!() };
        *position_m = truth().centre_m + (*position_m - truth().centre_m) * 4000.0;
    }
    assert!(
        matches!(calibrate(&far_away), Err(MountingError::PlaceUnknown { .. })),
        "{:?}",
        calibrate(&far_away)
    );
    let shuffled: Vec<Observation> =
        (0..20).map(|index| Observation { known: good[index * 7 % 20].known, ..good[index] }).collect();
    assert!(
        matches!(calibrate(&shuffled), Err(MountingError::DoNotFit { .. } | MountingError::Alike { .. })),
        "{:?}",
        calibrate(&shuffled)
    );
}
