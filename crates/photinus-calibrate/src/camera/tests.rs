use nalgebra::{DMatrix, Vector2};
use photinus::camera::{Bearing, Pixel};

use super::export::model_of;
use crate::lens::{Lens, LensModel};

/// A lens of each model, much like a real one.
fn lenses() -> Vec<Lens> {
    let fisheye = LensModel::kannala_brandt(2).unwrap();
    let lens = Lens::equidistant(320.0, 464.0, [509.6, 275.7]).in_model(fisheye, 1.2);
    let mut parameters = *lens.all_parameters();
    (parameters[2], parameters[3], parameters[5], parameters[6]) = (0.999, 0.001, -0.19, 0.017);
    let lens = lens.with_parameters(parameters);
    [LensModel::EQUIDISTANT, fisheye, LensModel::ocam(8).unwrap()]
        .map(|model| lens.in_model(model, 1.2))
        .to_vec()
}

#[test]
fn the_camera_sees_as_the_lens_does() {
    for lens in lenses() {
        let (model, _) = model_of(&lens).unwrap();
        let camera = photinus::camera::Camera::new(model, 960, 600, Some(1.15)).unwrap();
        for pixel in [Vector2::new(500.0, 280.0), Vector2::new(150.0, 100.0), Vector2::new(800.0, 400.0)] {
            let expected = Bearing::new(lens.bearing(&pixel, 1.2).unwrap()).unwrap();
            let found = camera.bearing(Pixel::new(pixel.x, pixel.y)).unwrap();
            assert!(found.angle_to(&expected) < 1e-9, "{}: {}", lens.model(), found.angle_to(&expected));
        }
    }
}

/// What a small change of the lens does to the camera's numbers is what the matrix says.
#[test]
fn the_numbers_of_the_camera_follow_those_of_the_lens() {
    for lens in lenses() {
        let (_, by_lens) = model_of(&lens).unwrap();
        for k in 0..lens.model().parameters() {
            let step = 1e-6;
            let moved = |sign: f64| {
                let mut parameters = *lens.all_parameters();
                parameters[k] += sign * step;
                numbers(&lens.with_parameters(parameters))
            };
            let (plus, minus) = (moved(1.0), moved(-1.0));
            for (row, (plus, minus)) in plus.iter().zip(&minus).enumerate() {
                let expected = (plus - minus) / (2.0 * step);
                let found: f64 = by_lens[(row, k)];
                assert!(
                    (found - expected).abs() <= 1e-5 * (1e-12 + expected.abs()),
                    "{} {row} {k}",
                    lens.model()
                );
            }
        }
    }
}

/// The parameters of the lens's camera in the order of its covariance.
fn numbers(lens: &Lens) -> Vec<f64> {
    match model_of(lens).unwrap().0 {
        photinus::camera::Model::OCam(lens) => {
            let (centre, s) = (lens.centre(), lens.stretch());
            let rest = [centre.u, centre.v, s.m11, s.m12, s.m21, s.m22];
            lens.direct().iter().copied().chain(rest).collect()
        }
        photinus::camera::Model::KannalaBrandt(lens) => {
            let ([fu, fv], [k1, k2, k3, k4], centre) = (lens.focal_px(), lens.k(), lens.centre());
            vec![fu, fv, k1, k2, k3, k4, centre.u, centre.v, lens.shear_px()]
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_covariance_of_the_lens_fits_its_camera() {
    for lens in lenses() {
        let (model, by_lens) = model_of(&lens).unwrap();
        let sigma =
            DMatrix::from_fn(by_lens.ncols(), by_lens.ncols(), |i, j| if i == j { 1e-8 } else { 0.0 });
        let camera = photinus::camera::Camera::new(model, 960, 600, Some(1.15)).unwrap();
        let camera = camera.with_calibration(&by_lens * sigma * by_lens.transpose()).unwrap();
        assert!(camera.calibration_covariance(Pixel::new(300.0, 200.0)).unwrap().trace() > 0.0);
    }
}
