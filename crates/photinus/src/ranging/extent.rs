//! One estimate of distance for any airframe: how wide the markers that show are, on average over the views.
//!
//! For a ring of few markers the paper's two estimates say more; this one needs no ring. It is an estimate
//! with a sigma, not a bound.

use core::f64::consts::TAU;

use nalgebra::Vector3;

use crate::airframe::Airframe;

/// Yaws looked from.
const YAWS: usize = 72;
/// Elevations looked from, from the lowest to the highest.
const ELEVATIONS: usize = 9;
/// Distance looked from, in radii of the airframe: far enough that only the direction matters.
const FAR_RADII: f64 = 1e4;

/// A distance and its standard deviation over the views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Camera's centre to airframe's origin, m.
    pub distance_m: f64,
    /// One standard deviation, m: from the spread of the views, without the error of the bearings.
    pub sigma_m: f64,
}

/// The widest pair of the m brightest markers, averaged over the views.
#[derive(Clone, Copy, Debug, Default)]
struct Extent {
    weight: f64,
    half_width_m: f64,
    half_width_variance_m2: f64,
    ahead_m: f64,
}

/// How wide an airframe's markers look, by how many of them show.
#[derive(Clone, Debug)]
pub struct ExtentTable {
    /// By number of markers from 2.
    extents: Vec<Extent>,
}

impl ExtentTable {
    /// Averages over every yaw, and elevations of the line of sight in the body frame up to
    /// `max_elevation_rad` either way (clamped to a right angle). A view counts for m markers by as much as
    /// the m-th brightest is brighter than the next: the chance that a detection limit falls between the two.
    pub fn new(airframe: &Airframe, max_elevation_rad: f64) -> Self {
        let max_elevation_rad = max_elevation_rad.clamp(0.0, core::f64::consts::FRAC_PI_2);
        let mut samples = vec![Vec::new(); airframe.markers().len() - 1];
        for row in 0..ELEVATIONS {
            let elevation_rad = max_elevation_rad * (2.0 * row as f64 / (ELEVATIONS - 1) as f64 - 1.0);
            let (sin, cos) = libm::sincos(elevation_rad);
            for column in 0..YAWS {
                let (sin_yaw, cos_yaw) = libm::sincos(TAU * column as f64 / YAWS as f64);
                look_from(airframe, &Vector3::new(cos * cos_yaw, cos * sin_yaw, sin), &mut samples);
            }
        }
        Self { extents: samples.iter().map(|samples| average(samples)).collect() }
    }

    /// The distance at which `spots` markers have a widest angle of `widest_rad`, on average. `None` when so
    /// many never show, or the angle is not inside (0, pi).
    pub fn estimate(&self, spots: usize, widest_rad: f64) -> Option<Estimate> {
        let extent = self.extents.get(spots.checked_sub(2)?).filter(|extent| extent.weight > 0.0)?;
        if !(widest_rad > 0.0 && widest_rad < core::f64::consts::PI) {
            return None;
        }
        // Paper (5) with the average width and depth in place of d and v.
        let per_m = 1.0 / libm::tan(widest_rad / 2.0);
        Some(Estimate {
            distance_m: extent.half_width_m * per_m + extent.ahead_m,
            sigma_m: extent.half_width_variance_m2.sqrt() * per_m,
        })
    }
}

/// One view of so many markers.
#[derive(Clone, Copy, Debug)]
struct Sample {
    weight: f64,
    half_width_m: f64,
    ahead_m: f64,
}

/// Adds to `samples`, by number of markers from 2, the widest pair seen from `direction`.
fn look_from(airframe: &Airframe, direction: &Vector3<f64>, samples: &mut [Vec<Sample>]) {
    let camera_m = direction * (FAR_RADII * airframe.max_radius_m());
    let lit = |marker: usize| (airframe.intensity(marker, &camera_m), airframe.markers()[marker].position_m);
    let mut bright: Vec<(f64, Vector3<f64>)> = (0..airframe.markers().len()).map(lit).collect();
    bright.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut widest = Sample { weight: 0.0, half_width_m: 0.0, ahead_m: 0.0 };
    for last in 1..bright.len() {
        let (intensity, place_m) = bright[last];
        for (_, other_m) in &bright[..last] {
            let half_width_m = (place_m - other_m).cross(direction).norm() / 2.0;
            if half_width_m >= widest.half_width_m {
                let ahead_m = (place_m + other_m).dot(direction) / 2.0;
                widest = Sample { weight: 0.0, half_width_m, ahead_m };
            }
        }
        let next = bright.get(last + 1).map_or(0.0, |next| next.0);
        samples[last - 1].push(Sample { weight: intensity - next, ..widest });
    }
}

fn average(samples: &[Sample]) -> Extent {
    let weight: f64 = samples.iter().map(|sample| sample.weight).sum();
    if weight <= 0.0 {
        return Extent::default();
    }
    let mean = |of: &dyn Fn(&Sample) -> f64| {
        samples.iter().map(|sample| sample.weight * of(sample)).sum::<f64>() / weight
    };
    let half_width_m = mean(&|sample| sample.half_width_m);
    Extent {
        weight,
        half_width_m,
        half_width_variance_m2: mean(&|sample| (sample.half_width_m - half_width_m).powi(2)),
        ahead_m: mean(&|sample| sample.ahead_m),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{Led, Lobe, Ring};
    use nalgebra::Unit;

    fn hexarotor() -> Airframe {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        Airframe::from_ring("hexarotor", ring).unwrap()
    }

    #[test]
    fn two_lamps_seen_broadside_are_known_exactly() {
        let lamp = |y: f64| Led {
            position_m: Vector3::new(0.0, 0.0, y),
            axis: Unit::new_unchecked(Vector3::x()),
            lobe: Lobe::Omni,
            signal: None,
        };
        let pole = Airframe::new("pole", vec![lamp(-0.5), lamp(0.5)]).unwrap();
        let table = ExtentTable::new(&pole, 0.0);
        let angle_rad = 2.0 * libm::atan2(0.5, 8.0);
        let estimate = table.estimate(2, angle_rad).unwrap();
        assert!((estimate.distance_m - 8.0).abs() < 1e-9, "{estimate:?}");
        assert!(estimate.sigma_m < 1e-6);
    }

    #[test]
    fn sigma_is_the_spread_over_the_views_of_three_markers() {
        let (airframe, distance_m) = (hexarotor(), 10.0);
        let table = ExtentTable::new(&airframe, 0.3);
        let (mut square, mut count) = (0.0, 0.0);
        for step in 0..360 {
            let (sin, cos) = libm::sincos(f64::from(step).to_radians());
            let camera_m = Vector3::new(cos, sin, 0.05 * sin) * distance_m;
            let rays: Vec<_> = airframe
                .visible(camera_m)
                .map(|marker| (airframe.markers()[marker].position_m - camera_m).normalize())
                .collect();
            if rays.len() != 3 {
                continue;
            }
            let angle = |i: usize, j: usize| rays[i].angle(&rays[j]);
            let widest_rad = angle(0, 1).max(angle(0, 2)).max(angle(1, 2));
            let estimate = table.estimate(3, widest_rad).unwrap();
            square += ((estimate.distance_m - distance_m) / estimate.sigma_m).powi(2);
            count += 1.0;
        }
        let normalized = square / count;
        assert!(count > 200.0 && (0.3..3.0).contains(&normalized), "{normalized} over {count}");
    }

    #[test]
    fn angles_and_numbers_of_spots_that_cannot_be_give_nothing() {
        let table = ExtentTable::new(&hexarotor(), 0.3);
        for spots in [0, 1, 6, 7, usize::MAX] {
            assert_eq!(table.estimate(spots, 0.1), None, "{spots}");
        }
        for angle_rad in [0.0, -1.0, f64::NAN, 4.0] {
            assert_eq!(table.estimate(2, angle_rad), None);
        }
    }
}
