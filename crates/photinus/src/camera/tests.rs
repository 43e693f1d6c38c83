//! What every model must do, and what none may: checked over all of them at once.

#![allow(clippy::float_cmp, reason = "limits pass through unchanged, to the bit")]

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector3};
use proptest::prelude::*;

use super::*;

const CENTRE: Pixel = Pixel { u: 371.25, v: 236.5 };

fn ocam(direct: &[f64]) -> Model {
    Model::OCam(OCam::new(direct, CENTRE, Matrix2::new(1.003, 0.002, -0.001, 1.0)).unwrap())
}

fn kannala_brandt(k: [f64; 4]) -> Model {
    Model::KannalaBrandt(KannalaBrandt::new([252.0, 255.0], CENTRE, k).unwrap())
}

fn pinhole(focal_px: f64, radial: [f64; 6], tangential: [f64; 2]) -> Model {
    Model::Pinhole(Pinhole::new([focal_px, focal_px + 3.0], CENTRE, radial, tangential).unwrap())
}

fn ideal(law: IdealLaw, focal_px: f64) -> Model {
    Model::Ideal(Ideal::new(law, [focal_px, focal_px + 4.0], CENTRE).unwrap())
}

fn camera(model: Model) -> Camera {
    Camera::new(model, 752, 480, None).unwrap()
}

/// One of each kind; all but pinhole, orthographic and one of the OCam kind see past 90 deg.
fn cameras() -> Vec<Camera> {
    [
        ocam(&[-259.5, 0.0, 1.63e-3, -2.33e-6, 6.6e-9]),
        ocam(&[-285.0, 0.0, 1.17e-3, -1.5e-6, 4.3e-9, 1e-13, -2e-16]),
        ocam(&[-600.0]),
        ideal(IdealLaw::Equidistant, 250.0),
        ideal(IdealLaw::Equisolid, 270.0),
        ideal(IdealLaw::Stereographic, 200.0),
        ideal(IdealLaw::Orthographic, 500.0),
        kannala_brandt([-0.03, 0.004, -0.002, 0.0003]),
        pinhole(400.0, [-0.2, 0.05, 0.001, 0.0, 0.0, 0.0], [0.001, -0.0007]),
        pinhole(400.0, [6.0, 4.0, 0.2, 6.3, 5.5, 1.2], [0.001, -0.0007]),
    ]
    .map(camera)
    .into()
}

/// A grid over the image, the optical centre first.
fn places() -> impl Iterator<Item = Pixel> {
    let grid = (0..=15)
        .flat_map(|i| (0..=10).map(move |j| Pixel::new(0.1 + 50.0 * f64::from(i), 47.0 * f64::from(j))));
    std::iter::once(CENTRE).chain(grid)
}

fn round_trip_px(camera: &Camera, pixel: Pixel) -> Option<f64> {
    let back = camera.pixel(&camera.bearing(pixel)?)?;
    Some(libm::hypot(back.u - pixel.u, back.v - pixel.v))
}

#[test]
fn every_place_in_the_field_comes_back() {
    for camera in cameras() {
        for pixel in places() {
            let error = round_trip_px(&camera, pixel).unwrap();
            assert!(error < 1e-10, "{error} px at {pixel:?} of {:?}", camera.model());
        }
    }
}

#[test]
fn what_lies_on_the_axis_looks_forward() {
    for camera in cameras() {
        assert_eq!(*camera.bearing(CENTRE).unwrap().vector(), Vector3::z());
        let forward = Bearing::new(Vector3::z()).unwrap();
        assert_eq!(camera.pixel(&forward).unwrap(), CENTRE);
        let (_, jacobian) = camera.pixel_with_jacobian(&forward).unwrap();
        let (_, inverse) = camera.bearing_with_jacobian(CENTRE).unwrap();
        let identity = jacobian * inverse;
        assert!((identity - Matrix2::identity()).norm() < 1e-12, "{identity}");
        assert!(Bearing::new(-Vector3::z()).and_then(|behind| camera.pixel(&behind)).is_none());
    }
}

#[test]
fn the_bearing_jacobian_is_the_derivative() {
    const STEP_PX: f64 = 1e-3;
    let mut past_90_deg = 0;
    for camera in cameras() {
        for pixel in places() {
            let (bearing, jacobian) = camera.bearing_with_jacobian(pixel).unwrap();
            assert_eq!(Some(bearing), camera.bearing(pixel));
            let at = |du: f64, dv: f64| {
                *camera.bearing(Pixel::new(pixel.u + du, pixel.v + dv)).unwrap().vector() / (2.0 * STEP_PX)
            };
            let numeric = Matrix3x2::from_columns(&[
                at(STEP_PX, 0.0) - at(-STEP_PX, 0.0),
                at(0.0, STEP_PX) - at(0.0, -STEP_PX),
            ]);
            let error = (numeric - jacobian).norm() / jacobian.norm();
            assert!(error < 1e-7, "{error} at {pixel:?} of {:?}", camera.model());
            assert!((bearing.vector().transpose() * jacobian).norm() < 1e-15);
            past_90_deg += usize::from(bearing.vector().z < 0.0);
        }
    }
    assert!(past_90_deg > 50, "{past_90_deg}");
}

#[test]
fn the_pixel_jacobian_is_the_derivative_by_direction() {
    const STEP: f64 = 1e-5;
    for camera in cameras() {
        // away from the border, so that both sides of the difference lie inside the image
        for pixel in places().filter(|p| p.u > 2.0 && p.v > 2.0 && p.u < 749.0 && p.v < 477.0) {
            let bearing = camera.bearing(pixel).unwrap();
            let (seen, jacobian) = camera.pixel_with_jacobian(&bearing).unwrap();
            assert_eq!(Some(seen), camera.pixel(&bearing));
            for axis in 0..3 {
                let at = |sign: f64| {
                    let mut moved = *bearing.vector();
                    moved[axis] += sign * STEP;
                    camera.pixel(&Bearing::new(moved).unwrap()).unwrap()
                };
                let (after, before) = (at(1.0), at(-1.0));
                let du = (after.u - before.u) / (2.0 * STEP) - jacobian[(0, axis)];
                let dv = (after.v - before.v) / (2.0 * STEP) - jacobian[(1, axis)];
                let error = libm::hypot(du, dv) / jacobian.norm();
                assert!(error < 1e-7, "{error} at {pixel:?} of {:?}", camera.model());
            }
            let along = (jacobian * bearing.vector()).norm();
            assert!(along < 1e-12 * jacobian.norm(), "{along} along the bearing");
        }
    }
}

#[test]
fn the_length_of_a_vector_does_not_matter() {
    for camera in cameras() {
        let near = camera.pixel(&Bearing::new(Vector3::new(0.1, -0.2, 0.7)).unwrap()).unwrap();
        let far = camera.pixel(&Bearing::new(Vector3::new(0.1, -0.2, 0.7) * 4096.0).unwrap()).unwrap();
        assert_eq!(near, far);
    }
}

#[test]
fn rad_per_px_is_the_worst_direction() {
    for camera in cameras() {
        let pixel = Pixel::new(60.0, 400.0);
        let (bearing, _) = camera.bearing_with_jacobian(pixel).unwrap();
        let turned = |degrees: i32| {
            let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
            let there = camera.bearing(Pixel::new(pixel.u + 1e-4 * cos, pixel.v + 1e-4 * sin)).unwrap();
            bearing.angle_to(&there) / 1e-4
        };
        let worst = (0..180).map(turned).fold(0.0, f64::max);
        assert!((camera.rad_per_px(pixel).unwrap() / worst - 1.0).abs() < 2e-4, "{worst}");
    }
}

#[test]
fn the_tangent_covariance_is_that_of_moved_pixels() {
    let camera = &cameras()[0];
    let (pixel, covariance_px2) = (Pixel::new(60.0, 400.0), Matrix2::new(0.04, 0.01, 0.01, 0.02));
    let covariance = camera.tangent_covariance(pixel, &covariance_px2).unwrap();
    // the four points of a square root of the covariance have its covariance
    let root = covariance_px2.cholesky().unwrap().l();
    let mean = camera.bearing(pixel).unwrap();
    let scale = 1e-3;
    let sampled =
        [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].iter().fold(Matrix3::zeros(), |sum, (a, b)| {
            let offset = (root.column(0) * *a + root.column(1) * *b) * scale;
            let there = camera.bearing(Pixel::new(pixel.u + offset.x, pixel.v + offset.y)).unwrap();
            let difference = there.vector() - mean.vector();
            sum + difference * difference.transpose() / (2.0 * scale * scale)
        });
    assert!((covariance - sampled).norm() < 1e-5 * covariance.norm());
    assert!((covariance * mean.vector()).norm() < 1e-15);
}

#[test]
fn the_image_ends_half_a_pixel_outside_its_outermost_centres() {
    for camera in cameras() {
        for (u, v) in
            [(-0.6, 100.0), (751.5, 100.0), (100.0, -0.6), (100.0, 479.5), (f64::NAN, 1.0), (1.0, f64::NAN)]
        {
            assert!(camera.bearing(Pixel::new(u, v)).is_none());
        }
        assert!(camera.bearing(Pixel::new(-0.49, 100.0)).is_some());
        assert!(camera.bearing(Pixel::new(751.49, 479.49)).is_some());
    }
}

#[test]
fn outside_a_stated_field_there_is_no_answer() {
    for whole in cameras() {
        let limit = 0.3;
        let camera = Camera::new(whole.model().clone(), 752, 480, Some(limit)).unwrap();
        assert_eq!(camera.field_limit_rad(), limit);
        assert_eq!(camera.stated_limit_rad(), Some(limit));
        let (mut inside, mut outside) = (0, 0);
        for pixel in places() {
            let bearing = whole.bearing(pixel).unwrap();
            let seen = bearing.off_axis_rad() <= limit;
            assert_eq!(camera.bearing(pixel).is_some(), seen);
            assert_eq!(camera.pixel(&bearing).is_some(), seen);
            *(if seen { &mut inside } else { &mut outside }) += 1;
        }
        assert!(inside > 1 && outside > 1);
    }
}

#[test]
fn a_field_past_the_image_is_clipped_to_its_farthest_corner() {
    for camera in cameras() {
        let clipped = Camera::new(camera.model().clone(), 752, 480, Some(3.1)).unwrap();
        assert_eq!(clipped.field_limit_rad(), camera.field_limit_rad());
        let corners = [(-0.499, -0.499), (751.499, -0.499), (-0.499, 479.499), (751.499, 479.499)];
        let angle = |(u, v)| camera.bearing(Pixel::new(u, v)).unwrap().off_axis_rad();
        let corner = corners.map(angle).into_iter().fold(0.0, f64::max);
        assert!(corner < camera.field_limit_rad() && corner > camera.field_limit_rad() - 1e-3);
    }
}

#[test]
fn a_whole_sphere_in_the_image_ends_behind_the_camera() {
    let camera = Camera::new(ideal(IdealLaw::Equidistant, 50.0), 752, 480, None).unwrap();
    assert_eq!(camera.field_limit_rad(), std::f64::consts::PI);
    assert!(camera.bearing(Pixel::new(CENTRE.u + 157.0, CENTRE.v)).unwrap().vector().z < -0.999);
    assert!(camera.bearing(Pixel::new(CENTRE.u + 158.0, CENTRE.v)).is_none());
    let hemisphere = Camera::new(ideal(IdealLaw::Orthographic, 100.0), 752, 480, None).unwrap();
    assert_eq!(hemisphere.field_limit_rad(), std::f64::consts::FRAC_PI_2);
    assert!(hemisphere.bearing(Pixel::new(CENTRE.u + 101.0, CENTRE.v)).is_none());
}

#[test]
fn a_model_that_folds_back_inside_the_image_needs_a_field_limit() {
    // z = -300 + 0.004 r^2 - 2e-8 r^4 turns where 6e-8 r^4 = 300 + 0.004 r^2
    let squared = (0.004 + libm::sqrt(1.6e-5 + 7.2e-5)) / 1.2e-7;
    let z = -300.0 + 0.004 * squared - 2e-8 * squared * squared;
    let folding = [
        (ocam(&[-300.0, 0.0, 0.004, 0.0, -2e-8]), libm::atan2(libm::sqrt(squared), -z)),
        (kannala_brandt([-0.2, 0.0, 0.0, 0.0]), libm::sqrt(1.0 / 0.6)),
        (pinhole(400.0, [-0.5, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0]), libm::atan(libm::sqrt(1.0 / 1.5))),
    ];
    for (model, turn) in folding {
        let refused = Camera::new(model.clone(), 752, 480, None);
        let Err(CameraError::NotMonotonic { radius_px, angle_rad }) = refused else { panic!("{refused:?}") };
        assert!((angle_rad - turn).abs() < 1e-6 && radius_px > 200.0, "{angle_rad} {radius_px}");
        assert!(Camera::new(model.clone(), 752, 480, Some(turn + 0.01)).is_err());
        let camera = Camera::new(model, 752, 480, Some(turn - 0.01)).unwrap();
        let errors: Vec<f64> = places().filter_map(|pixel| round_trip_px(&camera, pixel)).collect();
        assert!(errors.len() > 20 && errors.iter().all(|error| *error < 1e-9), "{errors:?}");
    }
}

#[test]
fn numbers_that_make_no_camera_are_refused() {
    let nan = f64::NAN;
    let straight = Matrix2::identity();
    assert!(matches!(OCam::new(&[-250.0, nan], CENTRE, straight), Err(CameraError::NotFinite { .. })));
    assert!(matches!(OCam::new(&[], CENTRE, straight), Err(CameraError::Coefficients { count: 0 })));
    assert!(matches!(OCam::new(&[-1.0; 65], CENTRE, straight), Err(CameraError::Coefficients { count: 65 })));
    assert!(matches!(OCam::new(&[250.0], CENTRE, straight), Err(CameraError::LooksBack { .. })));
    let flat = Matrix2::new(1.0, 2.0, 0.5, 1.0);
    assert!(matches!(OCam::new(&[-250.0], CENTRE, flat), Err(CameraError::Singular { .. })));
    assert!(matches!(
        OCam::new(&[-250.0], Pixel::new(nan, 0.0), straight),
        Err(CameraError::NotFinite { .. })
    ));
    for focal_px in [0.0, -3.0] {
        let refused = KannalaBrandt::new([focal_px, 200.0], CENTRE, [0.0; 4]);
        assert!(matches!(refused, Err(CameraError::FocalLength { .. })));
    }
    assert!(KannalaBrandt::new([200.0; 2], CENTRE, [0.0, f64::INFINITY, 0.0, 0.0]).is_err());
    assert!(Pinhole::new([200.0; 2], CENTRE, [0.0; 6], [nan, 0.0]).is_err());
    assert!(Ideal::new(IdealLaw::Equisolid, [nan, 1.0], CENTRE).is_err());
    assert!(matches!(OCam::new(&[-1e-200], CENTRE, straight), Err(CameraError::LooksBack { .. })));
    let steep = Model::OCam(OCam::new(&[-250.0, 0.0, 1e200], CENTRE, straight).unwrap());
    assert!(matches!(Camera::new(steep, 752, 480, Some(0.1)), Err(CameraError::NotFinite { .. })));
    let far = Model::OCam(OCam::new(&[-250.0], Pixel::new(1e300, 0.0), straight).unwrap());
    assert!(matches!(Camera::new(far, 752, 480, None), Err(CameraError::NotFinite { .. })));
    let lens = ideal(IdealLaw::Equidistant, 250.0);
    assert!(matches!(Camera::new(lens.clone(), 0, 480, None), Err(CameraError::Size { .. })));
    assert!(matches!(Camera::new(lens.clone(), 752, 40_000, None), Err(CameraError::Size { .. })));
    for limit in [0.0, -1.0, nan, 3.2] {
        let refused = Camera::new(lens.clone(), 752, 480, Some(limit));
        assert!(matches!(refused, Err(CameraError::FieldLimit { .. })));
    }
}

/// import cv2, numpy as np
/// P = np.array([[.3,-.2,1],[-1.5,.7,.6],[2,1,.1],[0,0,2]]).reshape(-1,1,3); K = np.array([[464.,0,478],[0,461,301],[0,0,1]])
/// cv2.fisheye.projectPoints(P, np.zeros(3), np.zeros(3), K, np.array([-.03,.004,-.002,.0003]))[0]
#[test]
fn kannala_brandt_agrees_with_opencv() {
    let lens =
        KannalaBrandt::new([464.0, 461.0], Pixel::new(478.0, 301.0), [-0.03, 0.004, -0.002, 0.0003]).unwrap();
    let camera = Camera::new(Model::KannalaBrandt(lens), 1100, 700, None).unwrap();
    for (ray, (u, v)) in [
        ([0.3, -0.2, 1.0], (611.1260660179694, 212.8231085714312)),
        ([2.0, 1.0, 0.1], (1070.4326254622415, 595.3011210539798)),
        ([0.0, 0.0, 2.0], (478.0, 301.0)),
    ] {
        let seen = camera.pixel(&Bearing::new(Vector3::from(ray)).unwrap()).unwrap();
        assert!(libm::hypot(seen.u - u, seen.v - v) < 1e-9, "{seen:?}");
    }
}

/// Q = np.array([[.3,-.2,1],[-.5,.4,1],[.05,.3,.8]]).reshape(-1,1,3); K as above
/// cv2.projectPoints(Q, np.zeros(3), np.zeros(3), K, np.array([-.28,.09,.001,-.0007,-.01]))[0], then
/// with np.array([.4,-.2,.001,-.0007,.03,.7,-.1,.02])
#[test]
fn pinhole_agrees_with_opencv() {
    let rays = [[0.3, -0.2, 1.0], [-0.5, 0.4, 1.0], [0.05, 0.3, 0.8]];
    for (radial, places) in [
        (
            [-0.28, 0.09, -0.01, 0.0, 0.0, 0.0],
            [
                (612.1854169759999, 212.15340343399998),
                (268.80240072000004, 467.359187276),
                (505.8523204719305, 467.3799151947409),
            ],
        ),
        (
            [0.4, -0.2, 0.03, 0.7, -0.1, 0.02],
            [
                (611.8469832634103, 212.37756714305723),
                (270.9016763458826, 465.69062509749676),
                (505.7739489285574, 466.91272620989173),
            ],
        ),
    ] {
        let lens = Pinhole::new([464.0, 461.0], Pixel::new(478.0, 301.0), radial, [0.001, -0.0007]).unwrap();
        let camera = Camera::new(Model::Pinhole(lens), 960, 600, Some(0.75)).unwrap();
        for (ray, (u, v)) in rays.iter().zip(places) {
            let seen = camera.pixel(&Bearing::new(Vector3::from(*ray)).unwrap()).unwrap();
            assert!(libm::hypot(seen.u - u, seen.v - v) < 1e-9, "{seen:?}");
        }
    }
}

fn any_model() -> impl Strategy<Value = Model> {
    let centre = (300.0..450.0_f64, 180.0..300.0_f64).prop_map(|(u, v)| Pixel::new(u, v));
    let small = |size: f64| -size..size;
    let ocam =
        (200.0..700.0_f64, small(0.3), small(0.1), small(0.05), small(0.02), small(0.02), centre.clone())
            .prop_map(|(f, a2, a3, a4, c, d, centre)| {
                let direct = [-f, 0.0, a2 / f, a3 / (f * f), a4 / (f * f * f)];
                let stretch = Matrix2::new(1.0 + c, d, -0.5 * d, 1.0 - 0.3 * c);
                Model::OCam(OCam::new(&direct, centre, stretch).unwrap())
            });
    let laws = [IdealLaw::Equidistant, IdealLaw::Equisolid, IdealLaw::Stereographic, IdealLaw::Orthographic];
    let ideal = (0..4_usize, 150.0..700.0_f64, 0.9..1.1_f64, centre.clone()).prop_map(
        move |(law, f, aspect, centre)| Model::Ideal(Ideal::new(laws[law], [f, f * aspect], centre).unwrap()),
    );
    let k = [small(0.05), small(0.02), small(0.005), small(0.002)];
    let fisheye = (150.0..700.0_f64, k, centre.clone()).prop_map(|(f, k, centre)| {
        Model::KannalaBrandt(KannalaBrandt::new([f, f * 1.01], centre, k).unwrap())
    });
    let k = [small(0.3), small(0.1), small(0.03), small(0.1), small(0.05), small(0.01)];
    let pinhole = (300.0..900.0_f64, k, [small(0.005), small(0.005)], centre)
        .prop_map(|(f, k, p, centre)| Model::Pinhole(Pinhole::new([f, f * 0.99], centre, k, p).unwrap()));
    prop_oneof![ocam, ideal, fisheye, pinhole]
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 1 << 20, ..ProptestConfig::default() })]

    #[test]
    fn what_is_seen_comes_back(model in any_model(), u in 0.0..751.0_f64, v in 0.0..479.0_f64) {
        // some random models fold back: those are refused, which other tests look at
        let Ok(camera) = Camera::new(model, 752, 480, None) else { return Err(TestCaseError::reject("folds back")) };
        let pixel = Pixel::new(u, v);
        if let Some((bearing, jacobian)) = camera.bearing_with_jacobian(pixel) {
            prop_assert!((bearing.vector().norm() - 1.0).abs() < 1e-14);
            prop_assert!(bearing.off_axis_rad() <= camera.field_limit_rad() + 1e-12);
            let (back, inverse) = camera.pixel_with_jacobian(&bearing).expect("what is seen is seen");
            let error = libm::hypot(back.u - u, back.v - v);
            // a lens near its fold magnifies rounding
            let gain = (jacobian * inverse).norm().max(inverse.norm() / 700.0);
            prop_assert!(error < 1e-9 * gain.max(1.0), "{error} px");
            prop_assert!((inverse * jacobian - Matrix2::identity()).norm() < 1e-9 * gain.max(1.0));
        } else {
            let whole_sphere = camera.field_limit_rad() >= 1.5;
            prop_assert!(whole_sphere, "no answer inside the image");
        }
    }

    #[test]
    fn any_direction_has_a_sound_answer_or_none(model in any_model(), x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
        let Ok(camera) = Camera::new(model, 752, 480, None) else { return Err(TestCaseError::reject("folds back")) };
        let Some(bearing) = Bearing::new(Vector3::new(x, y, z)) else { return Ok(()) };
        if let Some(pixel) = camera.pixel(&bearing) {
            let back = camera.bearing(pixel).expect("a place in the image and the field");
            prop_assert!(back.angle_to(&bearing) < 1e-10);
        }
    }

    #[test]
    fn wild_numbers_never_panic(
        numbers in prop::collection::vec(prop_oneof![any::<f64>(), -1e3..1e3_f64], 12),
        limit in prop::option::of(any::<f64>()),
        width_px in 0..2000_usize,
    ) {
        let n = &numbers;
        let centre = Pixel::new(n[0], n[1]);
        let models = [
            OCam::new(&n[2..8], centre, Matrix2::new(n[8], n[9], n[10], n[11])).map(Model::OCam),
            KannalaBrandt::new([n[2], n[3]], centre, [n[4], n[5], n[6], n[7]]).map(Model::KannalaBrandt),
            Pinhole::new([n[2], n[3]], centre, [n[4], n[5], n[6], n[7], n[8], n[9]], [n[10], n[11]]).map(Model::Pinhole),
            Ideal::new(IdealLaw::Stereographic, [n[2], n[3]], centre).map(Model::Ideal),
        ];
        for model in models.into_iter().flatten() {
            if let Ok(camera) = Camera::new(model, width_px, 480, limit) {
                for pixel in places() {
                    if let Some((bearing, jacobian)) = camera.bearing_with_jacobian(pixel) {
                        prop_assert!(bearing.vector().iter().all(|x| x.is_finite()));
                        prop_assert!(!jacobian.iter().any(|x| x.is_nan()));
                        let _ = camera.pixel_with_jacobian(&bearing);
                    }
                }
            }
        }
    }
}
