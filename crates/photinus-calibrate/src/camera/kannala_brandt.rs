//! A camera of any model -> one of Kannala-Brandt without shear, the fisheye model that other programs know.

use nalgebra::{DMatrix, DVector, Vector3};
use photinus::camera::{Bearing, Camera, IdealLaw, KannalaBrandt, Model, Pixel};

use super::export::{Export, ExportError, largest_off_rad, places};
use crate::adjust::Cholesky;

/// A lens farther off than this is another lens, rad.
const USELESS_RAD: f64 = 5e-3;

/// The focal length and k1 to k4.
const TERMS: usize = 5;

/// A camera of any model as one of model Kannala-Brandt without shear. Beyond the curve of the lens and the focal length of
/// either axis nothing is followed; how far that is off at most is said.
///
/// # Errors
/// [`ExportError::NoKannalaBrandt`] when the nearest is more than 5 mrad off somewhere in the field.
pub fn kannala_brandt_of(camera: &Camera) -> Result<Export, ExportError> {
    let seen: Vec<(Pixel, Bearing)> = places(camera).collect();
    let model = match camera.model() {
        Model::KannalaBrandt(lens) if lens.shear_px().abs() <= 0.0 => Some(camera.model().clone()),
        Model::Ideal(lens) if lens.law() == IdealLaw::Equidistant => {
            KannalaBrandt::new(lens.focal_px(), camera.model().centre(), [0.0; 4])
                .ok()
                .map(Model::KannalaBrandt)
        }
        _ => nearest(camera, &seen),
    };
    let nothing = ExportError::NoKannalaBrandt { max_off_rad: f64::INFINITY };
    let made = |model| {
        let limit_rad = camera.stated_limit_rad().or(Some(camera.field_limit_rad()));
        Camera::new(model, camera.width(), camera.height(), limit_rad).ok()
    };
    let followed = model.and_then(made).ok_or(nothing)?;
    match largest_off_rad(&seen, &followed) {
        max_off_rad if max_off_rad > USELESS_RAD => Err(ExportError::NoKannalaBrandt { max_off_rad }),
        max_off_rad => Ok(Export { camera: followed, max_off_rad }),
    }
}

/// The lens whose curve follows what is seen best in the image: the radius is linear in its numbers.
fn nearest(camera: &Camera, seen: &[(Pixel, Bearing)]) -> Option<Model> {
    let (centre, jacobian) = camera.pixel_with_jacobian(&Bearing::new(Vector3::z())?)?;
    let focal_px = [jacobian[(0, 0)], jacobian[(1, 1)]];
    let rays = || seen.iter().map(|(pixel, bearing)| (pixel, bearing, bearing.off_axis_rad()));
    let widest = rays().map(|(_, _, angle)| angle).fold(0.0, f64::max);
    let (mut normal, mut right) = (DMatrix::zeros(TERMS, TERMS), DVector::zeros(TERMS));
    for (pixel, bearing, angle) in rays() {
        let ray = bearing.vector();
        let across = libm::hypot(ray.x, ray.y);
        if across < 1e-9 {
            continue;
        }
        // Along the ray's own direction in the image, the radius is the sum of its terms.
        let place = [(pixel.u - centre.u) / focal_px[0], (pixel.v - centre.v) / focal_px[1]];
        let radius = (place[0] * ray.x + place[1] * ray.y) / across;
        let terms: [f64; TERMS] = std::array::from_fn(|k| libm::pow(angle / widest, (2 * k + 1) as f64));
        for i in 0..TERMS {
            right[i] += terms[i] * radius;
            for j in 0..=i {
                normal[(i, j)] += terms[i] * terms[j];
            }
        }
    }
    let weights = Cholesky::new(&normal)?.solve(&right);
    let powers: [f64; TERMS] = std::array::from_fn(|k| weights[k] / libm::pow(widest, (2 * k + 1) as f64));
    let [stretched, higher @ ..] = powers;
    let lens = KannalaBrandt::new(focal_px.map(|f| f * stretched), centre, higher.map(|k| k / stretched));
    lens.ok().map(Model::KannalaBrandt)
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;
    use photinus::camera::{Ideal, OCam, Pinhole};

    use super::*;

    const CENTRE: Pixel = Pixel { u: 370.3, v: 236.2 };

    fn camera(model: Model) -> Camera {
        Camera::new(model, 752, 480, None).unwrap()
    }

    #[test]
    fn fisheyes_are_followed_and_what_is_said_of_it_is_so() {
        let direct = [-259.5395, 0.0, 1.626945e-3, -2.328091e-6, 6.601777e-9];
        let ideal = |law| Model::Ideal(Ideal::new(law, [265.0, 266.0], CENTRE).unwrap());
        // The odd powers of an OCam polynomial bend the curve as no Kannala-Brandt lens does.
        for (model, within_rad) in [
            (ideal(IdealLaw::Equidistant), 1e-12),
            (ideal(IdealLaw::Equisolid), 1e-4),
            (ideal(IdealLaw::Stereographic), 1e-3),
            (Model::OCam(OCam::new(&direct, CENTRE, Matrix2::new(1.002, 0.0, 0.0, 1.0)).unwrap()), 4e-3),
        ] {
            let camera = camera(model);
            let export = kannala_brandt_of(&camera).unwrap();
            assert!(export.max_off_rad < within_rad, "{:?}: {}", camera.model(), export.max_off_rad);
            // Places that the fit did not take.
            for (u, v) in [(13.3, 401.7), (377.1, 9.2), (640.9, 77.7), (370.3, 236.9)] {
                let [a, b] = [&camera, &export.camera].map(|camera| camera.bearing(Pixel::new(u, v)));
                let (Some(a), Some(b)) = (a, b) else { continue };
                assert!(a.angle_to(&b) < 1.2 * export.max_off_rad + 1e-7, "at {u}, {v}");
            }
        }
    }

    #[test]
    fn a_lens_that_is_no_fisheye_is_refused_with_how_far_off_it_is() {
        let tilted = Pinhole::new([400.0; 2], CENTRE, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0], [0.02, -0.03]).unwrap();
        match kannala_brandt_of(&camera(Model::Pinhole(tilted))) {
            Err(ExportError::NoKannalaBrandt { max_off_rad }) => assert!(max_off_rad > USELESS_RAD),
            other => panic!("{other:?}"),
        }
    }
}
