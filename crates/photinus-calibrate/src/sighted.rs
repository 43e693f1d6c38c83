//! Something seen: a direction with the pixels that an error of it would be.
//!
//! A residual is the turn from what was seen to what was predicted (the logarithm on the sphere), taken to the image by the
//! derivative of the camera: pixels, and yet no plane is involved, so it holds past 90 deg and grows all the way to the opposite
//! direction.

use nalgebra::{Matrix2, Matrix2x3, Vector2, Vector3};
use photinus::camera::{Bearing, Camera, Pixel};

/// A place in an image as a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighted {
    bearing: Bearing,
    /// Pixels over their sigma, by a small turn of the bearing; zero along it.
    sigmas_from_turn: Matrix2x3<f64>,
}

/// A turn is small below this: its length and its sine are the same to the last digits.
const SMALL: f64 = 1e-6;

impl Sighted {
    /// What `camera` sees at `pixel`, either coordinate known to `sigma_px`; `None` outside the field, and for a sigma that is not
    /// above 0.
    pub fn new(camera: &Camera, pixel: Pixel, sigma_px: f64) -> Option<Self> {
        let (bearing, jacobian) = camera.bearing_with_jacobian(pixel)?;
        let squares: Matrix2<f64> = jacobian.transpose() * jacobian;
        let pixels_from_turn = squares.try_inverse()? * jacobian.transpose();
        let is_sigma = sigma_px.is_finite() && sigma_px > 0.0;
        is_sigma.then(|| Self { bearing, sigmas_from_turn: pixels_from_turn / sigma_px })
    }

    /// The direction seen, in the camera frame.
    pub fn bearing(&self) -> &Bearing {
        &self.bearing
    }

    /// How far a point at `point` (camera frame, any unit) is from what was seen, in sigmas along the image's axes, with the
    /// derivative by the point. `None` for a point in the camera's centre.
    pub fn residual(&self, point: &Vector3<f64>) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        let distance = point.norm();
        if !(distance.is_finite() && distance > 0.0) {
            return None;
        }
        let predicted = point / distance;
        let seen = self.bearing.vector();
        let cosine = seen.dot(&predicted);
        let across = predicted - seen * cosine;
        let sine = across.norm();
        let angle = libm::atan2(sine, cosine);
        let (stretch, slope) = match sine < SMALL {
            true => (1.0, Vector3::zeros()),
            false => {
                // d(angle / sine): by the sine along `across`, by the cosine along `seen`
                let by_sine = (cosine * sine - angle) / (sine * sine);
                (angle / sine, across * (by_sine / sine) - seen)
            }
        };
        let image = self.sigmas_from_turn * across;
        let by_direction = self.sigmas_from_turn * stretch + image * slope.transpose();
        let along = by_direction * predicted;
        let by_point = (by_direction - along * predicted.transpose()) / distance;
        Some((image * stretch, by_point))
    }
}

#[cfg(test)]
mod tests {
    use photinus::camera::{Ideal, IdealLaw, Model};

    use super::*;

    fn camera() -> Camera {
        let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(375.5, 239.5)).unwrap();
        Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
    }

    #[test]
    fn a_residual_is_the_pixels_between_two_places() {
        let camera = camera();
        for (u, v) in [(380.0, 240.0), (700.0, 300.0), (20.0, 400.0)] {
            let seen = Sighted::new(&camera, Pixel::new(u, v), 0.5).unwrap();
            let beside = camera.bearing(Pixel::new(u + 0.02, v - 0.01)).unwrap();
            let (residual, _) = seen.residual(&(beside.vector() * 3.7)).unwrap();
            assert!((residual - Vector2::new(0.04, -0.02)).norm() < 1e-4, "{residual}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let seen = Sighted::new(&camera(), Pixel::new(600.0, 100.0), 0.3).unwrap();
        let ahead = seen.bearing().vector() * 2.0;
        for aside in
            [Vector3::new(1e-4, 0.0, 2e-4), Vector3::new(0.3, -0.4, 0.2), Vector3::new(-2.0, 1.0, -3.0)]
        {
            let point = ahead + aside;
            let (_, jacobian) = seen.residual(&point).unwrap();
            for axis in 0..3 {
                let step = Vector3::ith(axis, 1e-6);
                let (after, before) =
                    (seen.residual(&(point + step)).unwrap().0, seen.residual(&(point - step)).unwrap().0);
                let difference = (after - before) / 2e-6;
                let error = (difference - jacobian.column(axis)).norm();
                assert!(error < 1e-5 * jacobian.norm(), "{aside:?}: {difference} {jacobian}");
            }
        }
    }

    #[test]
    fn what_lies_behind_is_far_off() {
        let seen = Sighted::new(&camera(), Pixel::new(500.0, 300.0), 1.0).unwrap();
        let aside = Vector3::new(0.01, 0.0, 0.0);
        let (residual, _) = seen.residual(&(aside - seen.bearing().vector())).unwrap();
        assert!(residual.norm() > 500.0, "{residual}");
        assert!(seen.residual(&Vector3::zeros()).is_none());
        assert!(seen.residual(&Vector3::new(f64::NAN, 0.0, 1.0)).is_none());
        assert!(Sighted::new(&camera(), Pixel::new(5000.0, 300.0), 1.0).is_none());
        assert!(Sighted::new(&camera(), Pixel::new(500.0, 300.0), f64::NAN).is_none());
    }
}
