use nalgebra::DVector;
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;

const SIGMA_PX: f64 = 0.2;

fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
}

/// A hexarotor of 0.4 m whose LEDs should sit in a plane, and two more on a mast.
fn nominal() -> Vec<Vector3<f64>> {
    let on_arm = |arm: usize| {
        let (sin, cos) = libm::sincos(arm as f64 * std::f64::consts::FRAC_PI_3);
        Vector3::new(0.4 * cos, 0.4 * sin, 0.0)
    };
    (0..6).map(on_arm).chain([Vector3::new(0.0, 0.05, 0.2), Vector3::new(0.0, -0.05, 0.2)]).collect()
}

/// Where the LEDs truly sit: a centimetre and a half from where they should.
fn truth() -> Vec<Vector3<f64>> {
    let mut random = Pcg64::new(11, 5);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    nominal().into_iter().map(|position_m| position_m + Vector3::from_fn(|_, _| 0.015 * normal())).collect()
}

/// Photos from all around, from level to steeply above, each with LED 3 hidden unless it is one of four, and one of the others.
fn photos(count: usize, seed: u128) -> Vec<LedSighting> {
    let (camera, leds_m) = (camera(), truth());
    let mut random = Pcg64::new(seed, 6);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut sightings = Vec::new();
    for photo in 0..count {
        let (sin, cos) = libm::sincos(2.4 * photo as f64);
        let height = 0.3 + 1.4 * (photo as f64 * 0.618).fract();
        let centre_m =
            Vector3::new(cos, sin, height).normalize() * (0.8 + 0.6 * (photo as f64 * 0.414).fract());
        // It looks past the airframe, so that LEDs are seen all over the image, some past 60 deg off the axis.
        let aim = -centre_m + Vector3::new(normal(), normal(), normal()) * 0.4;
        let camera_from_body = nalgebra::Rotation3::look_at_rh(&-aim, &Vector3::new(0.1, 0.2, 1.0));
        for (led, position_m) in leds_m.iter().enumerate() {
            let is_hidden = (led == 3 && photo % 5 != 0) || led == photo % 8;
            let bearing = Bearing::new(camera_from_body * (position_m - centre_m)).unwrap();
            let pixel = camera.pixel(&bearing).filter(|_| !is_hidden);
            let noise = [normal() * SIGMA_PX, normal() * SIGMA_PX];
            if let Some(pixel) = pixel {
                let seen = Pixel::new(pixel.u + noise[0], pixel.v + noise[1]);
                sightings.extend(Sighted::new(&camera, seen, 1.0).map(|sighted| LedSighting {
                    photo,
                    led,
                    sighted,
                }));
            }
        }
    }
    sightings
}

/// The truth laid over the nominal layout as the answer is.
fn laid_truth(has_scale: bool) -> Vec<Vector3<f64>> {
    let mut truth = Adjustment::new(truth(), Vec::new(), Vec::new(), Vec::new());
    frame::align(&mut truth, &nominal(), &(0..8).collect::<Vec<_>>(), has_scale);
    truth.leds_m
}

fn errors(found: &Layout, has_scale: bool) -> DVector<f64> {
    let truth = laid_truth(has_scale);
    let error = |led: usize| found.positions_m[led].unwrap() - truth[led];
    DVector::from_iterator(24, (0..8).flat_map(|led| error(led).iter().copied().collect::<Vec<_>>()))
}

fn distance() -> KnownDistance {
    KnownDistance { leds: [0, 4], distance_m: (truth()[0] - truth()[4]).norm(), sigma_m: 5e-4 }
}

#[test]
fn leds_are_found_where_they_sit() {
    let found = calibrate(&nominal(), &photos(20, 1), &[distance()]).unwrap();
    let error = errors(&found, true);
    println!("rms {:.5} m, scatter {:.3}", error.norm() / 24f64.sqrt(), found.scatter);
    assert!(error.norm() / 24f64.sqrt() < 1.5e-3, "{error}");
    assert!((found.scatter / SIGMA_PX - 1.0).abs() < 0.15, "{}", found.scatter);
    assert!(found.outliers.is_empty() && found.photos.iter().all(Option::is_some));
    let apart_m = (found.positions_m[0].unwrap() - found.positions_m[4].unwrap()).norm();
    assert!((apart_m - distance().distance_m).abs() < 1e-9, "one distance is kept as it is: {apart_m}");
}

#[test]
fn without_a_distance_the_scale_is_the_nominal_layouts() {
    let found = calibrate(&nominal(), &photos(20, 1), &[]).unwrap();
    assert!(errors(&found, false).norm() / 24f64.sqrt() < 1.5e-3);
}

#[test]
fn errors_have_the_covariance_that_is_claimed() {
    const RUNS: u128 = 16;
    for has_scale in [false, true] {
        let freedom = if has_scale { 18 } else { 17 };
        let mut mean = 0.0;
        for seed in 0..RUNS {
            let mut random = Pcg64::new(seed, 9);
            let noise: f64 = StandardNormal.sample(&mut random);
            let known = KnownDistance {
                distance_m: distance().distance_m + noise * distance().sigma_m,
                ..distance()
            };
            let distances = if has_scale { vec![known] } else { Vec::new() };
            let found = calibrate(&nominal(), &photos(14, seed), &distances).unwrap();
            let error = errors(&found, has_scale);
            let eigen = found.covariance_m2.clone().symmetric_eigen();
            let mut parts: Vec<(f64, f64)> = (0..24)
                .map(|axis| (eigen.eigenvalues[axis], eigen.eigenvectors.column(axis).dot(&error)))
                .collect();
            parts.sort_by(|a, b| b.0.total_cmp(&a.0));
            mean += parts[..freedom].iter().map(|(variance, error)| error * error / variance).sum::<f64>();
        }
        let nees = mean / (RUNS as f64 * freedom as f64);
        println!("known distance {has_scale}: normalised squared error {nees:.6} of 1");
        assert!((nees - 1.0).abs() < 0.2, "{has_scale}: {nees}");
    }
}

#[test]
fn a_wrong_label_is_left_out() {
    let mut sightings = photos(20, 2);
    let (first, second) = (4, 5);
    assert_eq!(sightings[first].photo, sightings[second].photo);
    let swapped = (sightings[first].sighted, sightings[second].sighted);
    (sightings[second].sighted, sightings[first].sighted) = swapped;
    let found = calibrate(&nominal(), &sightings, &[distance()]).unwrap();
    assert!(found.outliers.contains(&first) && found.outliers.contains(&second), "{:?}", found.outliers);
    assert!(found.outliers.len() <= 4, "{:?}", found.outliers);
    assert!(errors(&found, true).norm() / 24f64.sqrt() < 1.5e-3);
}

#[test]
fn what_tells_no_layout_is_refused_with_its_reason() {
    let (nominal, sightings) = (nominal(), photos(20, 2));
    assert!(matches!(calibrate(&nominal, &[], &[]), Err(LayoutError::TooFew { photos: 0, .. })));
    assert!(matches!(calibrate(&nominal, &photos(2, 1), &[]), Err(LayoutError::TooFew { .. })));
    assert_eq!(calibrate(&nominal[..7], &sightings, &[]), Err(LayoutError::Led { led: 7, leds: 7 }));
    let same = KnownDistance { leds: [2, 2], ..distance() };
    assert!(matches!(
        calibrate(&nominal, &sightings, &[same]),
        Err(LayoutError::Distance { leds: [2, 2], .. })
    ));
    let nan = KnownDistance { distance_m: f64::NAN, ..distance() };
    assert!(matches!(calibrate(&nominal, &sightings, &[nan]), Err(LayoutError::Distance { .. })));
    // All photos from one place: where LEDs sit along the line of sight shows in none of them.
    let again: Vec<LedSighting> = (0..8)
        .flat_map(|photo| {
            let first = photos(20, 2).into_iter().filter(|sighting| sighting.photo == 1);
            first.map(move |sighting| LedSighting { photo, ..sighting })
        })
        .collect();
    let refused = calibrate(&nominal, &again, &[]);
    assert!(
        matches!(refused, Err(LayoutError::Undetermined { .. } | LayoutError::TooFew { .. })),
        "{refused:?}"
    );
    let mut shuffled = sightings;
    let places: Vec<Sighted> = shuffled.iter().map(|sighting| sighting.sighted).collect();
    for (index, sighting) in shuffled.iter_mut().enumerate() {
        sighting.sighted = places[index * 37 % places.len()];
    }
    assert!(calibrate(&nominal, &shuffled, &[]).is_err());
}
