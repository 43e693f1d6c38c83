//! What is told of airframe and camera is off by a factor.

use photinus::airframe::{Airframe, AirframeError, Led};
use photinus::camera::{Camera, CameraError, Ideal, KannalaBrandt, Model, OCam, Pinhole};

/// An airframe larger by a factor.
pub(super) fn airframe(airframe: &Airframe, factor: f64) -> Result<Airframe, AirframeError> {
    let larger = |led: &Led| Led { position_m: led.position_m * factor, ..led.clone() };
    Airframe::new(airframe.name(), airframe.leds().iter().map(larger).collect())
}

/// A camera whose focal length is longer by a factor: what was seen at a radius is seen at the radius times the factor.
pub(super) fn camera(camera: &Camera, factor: f64) -> Result<Camera, CameraError> {
    let longer = |focal_px: [f64; 2]| focal_px.map(|px| px * factor);
    let model = match camera.model() {
        Model::Ideal(lens) => Model::Ideal(Ideal::new(lens.law(), longer(lens.focal_px()), lens.centre())?),
        Model::KannalaBrandt(lens) => {
            let (focal_px, shear_px) = (longer(lens.focal_px()), factor * lens.shear_px());
            Model::KannalaBrandt(KannalaBrandt::with_shear(focal_px, lens.centre(), lens.k(), shear_px)?)
        }
        Model::Pinhole(lens) => {
            let focal_px = longer(lens.focal_px());
            Model::Pinhole(Pinhole::new(focal_px, lens.centre(), lens.radial(), lens.tangential())?)
        }
        Model::OCam(lens) => {
            // z(r) becomes f z(r / f): term i times f^(1 - i)
            let powers = core::iter::successors(Some(factor), |power| Some(power / factor));
            let direct: Vec<f64> =
                lens.direct().iter().zip(powers).map(|(term, power)| term * power).collect();
            Model::OCam(OCam::new(&direct, lens.centre(), lens.stretch())?)
        }
    };
    let told = Camera::new(model, camera.width(), camera.height(), camera.stated_limit_rad())?;
    match camera.parameter_covariance() {
        Some(covariance) => told.with_calibration(covariance.clone()),
        None => Ok(told),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;
    use photinus::airframe::Ring;
    use photinus::camera::{IdealLaw, Pixel};

    use super::*;

    #[test]
    fn every_radius_of_every_model_is_longer_by_the_factor() {
        let centre = Pixel::new(320.0, 240.0);
        let stretch = Matrix2::new(1.001, 0.002, -0.001, 1.0);
        let models = [
            Model::Ideal(Ideal::new(IdealLaw::Equidistant, [260.0, 262.0], centre).unwrap()),
            Model::Ideal(Ideal::new(IdealLaw::Stereographic, [260.0, 262.0], centre).unwrap()),
            Model::KannalaBrandt(
                KannalaBrandt::with_shear([260.0, 262.0], centre, [0.01, -0.003, 1e-4, 0.0], 0.5).unwrap(),
            ),
            Model::Pinhole(
                Pinhole::new([400.0, 401.0], centre, [-0.1, 0.01, 0.0, 0.0, 0.0, 0.0], [1e-4, 2e-4]).unwrap(),
            ),
            Model::OCam(OCam::new(&[-260.0, 0.0, 1.2e-3, -3e-7], centre, stretch).unwrap()),
        ];
        for model in models {
            let true_camera = Camera::new(model, 640, 480, None).unwrap();
            let told = camera(&true_camera, 1.02).unwrap();
            for (du, dv) in [(0.0, 0.0), (100.0, 0.0), (-70.0, 120.0), (30.0, -200.0)] {
                let seen = true_camera.bearing(Pixel::new(320.0 + du, 240.0 + dv)).unwrap();
                let as_told = told.bearing(Pixel::new(320.0 + 1.02 * du, 240.0 + 1.02 * dv)).unwrap();
                assert!(seen.angle_to(&as_told) < 1e-9, "{true_camera:?} at {du} {dv}");
            }
        }
    }

    #[test]
    fn a_ring_stays_a_ring() {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        let told = airframe(&Airframe::from_ring("hexa", ring).unwrap(), 1.02).unwrap();
        assert!((told.ring().unwrap().radius_m - 0.408).abs() < 1e-12);
        assert_eq!(
            (told.name(), told.leds()[3].axis),
            ("hexa", Airframe::from_ring("hexa", ring).unwrap().leds()[3].axis)
        );
    }
}
