//! A spot as the estimator takes it: a direction, whitened, and how brightly it shines.

use nalgebra::{Matrix2x3, Matrix3, Vector3};

use crate::camera::Bearing;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::LogLight;

/// Variances of a direction are taken between these, rad^2: nothing is known to better than a millionth of a radian, and a
/// sphere is no wider.
const LEAST_RAD2: f64 = 1e-12;
const MOST_RAD2: f64 = 10.0;

/// What one spot says about a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Direction in the camera frame.
    pub bearing: Bearing,
    /// Covariance of the direction, rad^2, tangent to the sphere.
    pub covariance_rad2: Matrix3<f64>,
    /// Logarithm of its light, in units of any kind that are the same for all spots of the frame; `None` where unknown.
    pub log_light: Option<LogLight>,
    /// Two markers so far apart are told apart half of the time, rad; 0 where all are.
    pub resolution_rad: f64,
    /// Which of the airframe's signals it was seen to blink, where that was decoded.
    pub signal: Option<u32>,
    /// Logarithm of the density of such a spot as clutter, per sr and per unit of the logarithm of its light where that is known: what it is
    /// worth to be no marker.
    pub clutter_log_density: f64,
}

/// A direction with the map that makes its error one of unit covariance: e = map (u - direction).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitened {
    pub(crate) direction: Vector3<f64>,
    pub(crate) map: Matrix2x3<f64>,
    /// Half the logarithm of the covariance's determinant: the density's normaliser but for 2 pi.
    pub(crate) log_sigmas: f64,
    /// Mean variance over its two axes, rad^2.
    pub(crate) variance_rad2: f64,
}

impl Whitened {
    /// `extra_rad2` is what is added to the variance along both axes.
    pub(crate) fn of(observation: &Observation, extra_rad2: f64) -> Self {
        let direction = *observation.bearing.vector();
        let [across, along] = tangent_basis(&direction);
        let covariance = &observation.covariance_rad2;
        let extra_rad2 = extra_rad2 + LEAST_RAD2;
        // What is no covariance must not become an error that is no number.
        let variance = |axis: &Vector3<f64>| {
            let told = axis.dot(&(covariance * axis));
            extra_rad2 + if told.is_nan() { MOST_RAD2 } else { told.clamp(0.0, MOST_RAD2) }
        };
        let (xx, yy) = (variance(&across), variance(&along));
        let most = (xx * yy).sqrt();
        let xy = across.dot(&(covariance * along)).min(most).max(-most);
        // The inverse of the Cholesky factor of [[xx, xy], [xy, yy]].
        let first = xx.sqrt();
        let below = xy / first;
        let second = (yy - below * below).max(1e-3 * yy).sqrt();
        let row = across / first;
        let map = Matrix2x3::from_rows(&[row.transpose(), ((along - row * below) / second).transpose()]);
        Self { direction, map, log_sigmas: libm::log(first * second), variance_rad2: 0.5 * (xx + yy) }
    }
}

/// Two unit vectors that span the plane across a direction.
fn tangent_basis(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let aside = if direction.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let across = direction.cross(&aside).normalize();
    [across, direction.cross(&across)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_makes_the_covariance_one() {
        let bearing = Bearing::new(Vector3::new(0.3, -0.5, 0.4)).unwrap();
        let [across, along] = tangent_basis(bearing.vector());
        let jacobian = nalgebra::Matrix3x2::from_columns(&[across + 0.5 * along, 0.3 * along]) * 1e-3;
        let covariance_rad2 = jacobian * jacobian.transpose();
        let observation = Observation {
            bearing,
            covariance_rad2,
            log_light: None,
            resolution_rad: 0.0,
            signal: None,
            clutter_log_density: 0.0,
        };
        let whitened = Whitened::of(&observation, 0.0);
        let white = whitened.map * covariance_rad2 * whitened.map.transpose();
        assert!((white - nalgebra::Matrix2::identity()).norm() < 1e-4, "{white}");
        assert!((whitened.map * bearing.vector()).norm() < 1e-9);
        assert!((whitened.log_sigmas - libm::log(0.3e-6)).abs() < 1e-4);
    }
}
