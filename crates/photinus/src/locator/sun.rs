//! Where the sun is, as place, time and heading tell before anything is seen (paper, V.A): a bright point there is likely the sun.

use core::f64::consts::{PI, TAU};

use nalgebra::{Unit, Vector3};

use crate::camera::Bearing;
use crate::normal;

/// How likely the sun shows as a spot: clouds, filters and the image's border hide it, and a detector rejects what glares.
const SHOWS: f64 = 0.5;
/// Nothing is known of the attitude of a camera to better than this, rad.
const LEAST_SIGMA_RAD: f64 = 1e-3;

/// The sun, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    towards: Unit<Vector3<f64>>,
    up: Unit<Vector3<f64>>,
    elevation_sigma_rad: f64,
    heading_sigma_rad: f64,
}

impl Sun {
    /// The sun in a direction, and up, both in the camera frame. Its elevation is as sure as the camera's tilt, its azimuth as the camera's heading,
    /// standard deviations in rad; a heading that is not known is off by infinity, and the sun anywhere at its elevation.
    pub fn new(
        towards: Unit<Vector3<f64>>,
        up: Unit<Vector3<f64>>,
        elevation_sigma_rad: f64,
        heading_sigma_rad: f64,
    ) -> Self {
        // What is no sigma says nothing; the comparison fails for what is no number.
        let sigma = |sigma: f64| if sigma >= 0.0 { sigma.max(LEAST_SIGMA_RAD) } else { f64::INFINITY };
        Self {
            towards,
            up,
            elevation_sigma_rad: sigma(elevation_sigma_rad),
            heading_sigma_rad: sigma(heading_sigma_rad),
        }
    }

    /// Its direction.
    pub fn towards(&self) -> Unit<Vector3<f64>> {
        self.towards
    }

    /// How many suns are seen in a direction, per sr: a normal distribution in elevation, one in azimuth.
    pub(super) fn per_sr(&self, bearing: &Bearing) -> f64 {
        let [there, sun] = [bearing.vector(), &self.towards].map(|direction| self.elevation_rad(direction));
        let elevation = density(there - sun, self.elevation_sigma_rad, PI);
        let azimuth = density(self.azimuth_rad(bearing.vector()), self.heading_sigma_rad, TAU);
        SHOWS * elevation * azimuth / libm::cos(there).max(self.elevation_sigma_rad.min(1.0))
    }

    fn elevation_rad(&self, direction: &Vector3<f64>) -> f64 {
        libm::asin(direction.dot(&self.up).clamp(-1.0, 1.0))
    }

    /// The angle about the vertical from the sun to a direction.
    fn azimuth_rad(&self, direction: &Vector3<f64>) -> f64 {
        let level = |vector: &Vector3<f64>| vector - self.up.into_inner() * vector.dot(&self.up);
        let (sun, there) = (level(&self.towards), level(direction));
        libm::atan2(sun.cross(&there).dot(&self.up), sun.dot(&there))
    }
}

/// The density of an angle that is off by this much, per rad; as wide as the whole `range`, it is even over it.
fn density(off_rad: f64, sigma_rad: f64, range_rad: f64) -> f64 {
    if range_rad <= normal::ROOT_OF_TAU * sigma_rad {
        return 1.0 / range_rad;
    }
    normal::density(off_rad / sigma_rad, sigma_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction(azimuth_rad: f64, elevation_rad: f64) -> Unit<Vector3<f64>> {
        let (sin, cos) = libm::sincos(elevation_rad);
        let (sin_azimuth, cos_azimuth) = libm::sincos(azimuth_rad);
        Unit::new_normalize(Vector3::new(cos * cos_azimuth, cos * sin_azimuth, sin))
    }

    /// The integral over the sphere, by a grid of azimuth and elevation.
    fn suns(sun: &Sun) -> f64 {
        let (across, along) = (720, 360);
        let cell = (TAU / f64::from(across)) * (PI / f64::from(along));
        let mut sum = 0.0;
        for row in 0..along {
            let elevation = -PI / 2.0 + (f64::from(row) + 0.5) * PI / f64::from(along);
            for column in 0..across {
                let azimuth = f64::from(column) * TAU / f64::from(across);
                let bearing = Bearing::new(direction(azimuth, elevation).into_inner()).unwrap();
                sum += sun.per_sr(&bearing) * libm::cos(elevation) * cell;
            }
        }
        sum
    }

    #[test]
    fn there_is_half_a_sun_whatever_is_known_of_the_heading() {
        for elevation_rad in [0.1, 0.7] {
            for heading_sigma_rad in [0.1, 0.3, f64::INFINITY, f64::NAN] {
                let sun = Sun::new(direction(0.4, elevation_rad), Vector3::z_axis(), 0.04, heading_sigma_rad);
                let all = suns(&sun);
                assert!((all - SHOWS).abs() < 0.01 * SHOWS, "{elevation_rad} {heading_sigma_rad}: {all}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_sun_is_densest_where_it_is_and_nowhere_no_number(
            azimuth in 0.0..TAU, elevation in -1.5f64..1.5, other in 0.0..TAU, high in -1.57f64..1.57,
            sigma in prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), 0.01..0.2f64],
        ) {
            let sun = Sun::new(direction(azimuth, elevation), Vector3::z_axis(), sigma, sigma);
            let per_sr = |of: Unit<Vector3<f64>>| sun.per_sr(&Bearing::new(of.into_inner()).unwrap());
            prop_assert!(per_sr(direction(other, high)).is_finite());
            let nearer = direction(azimuth, elevation);
            let farther = direction(azimuth + 0.3, elevation);
            prop_assert!(per_sr(nearer) >= per_sr(farther));
        }
    }
}
