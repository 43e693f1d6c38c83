//! Figures 7 and 8: how brightly markers shine in every direction.

use core::f64::consts::{FRAC_PI_3, TAU};

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Ring};

use crate::{Figure, Kind, Panel, Report, ReproduceError, Role, Row, Tolerance};

/// Far enough that every marker of an airframe sees the camera in the same direction, m.
const FAR_M: f64 = 1e6;
/// Angles between the two LEDs of figure 8, deg.
const SPLAYS_DEG: [f64; 4] = [180.0, 120.0, 90.0, 60.0];

fn ring(arms: usize, leds_per_arm: usize, splay_rad: f64) -> Result<Airframe, ReproduceError> {
    let ring = Ring { arms, radius_m: 0.4, leds_per_arm, splay_rad };
    Airframe::from_ring("layout", ring).map_err(|_| ReproduceError::NoRing)
}

/// A camera far away in a direction, body frame, m.
fn camera_m(yaw_deg: f64, elevation_deg: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(yaw_deg.to_radians());
    let (sin_up, cos_up) = libm::sincos(elevation_deg.to_radians());
    Vector3::new(cos * cos_up, sin * cos_up, sin_up) * FAR_M
}

/// Both figures.
pub(crate) fn reports() -> Result<Vec<Report>, ReproduceError> {
    Ok(vec![layouts()?, lobes()?])
}

fn layouts() -> Result<Report, ReproduceError> {
    let shapes = [
        ("hexarotor, 1 LED per arm", ring(6, 1, 0.0)?, Role::Own),
        ("quadrotor, 1 LED per arm", ring(4, 1, 0.0)?, Role::Perpendicular),
        ("quadrotor, 2 LEDs per arm at 120 deg", ring(4, 2, 2.0 * FRAC_PI_3)?, Role::Inline),
    ];
    let second = |airframe: &Airframe, yaw_deg: f64, elevation_deg: f64| {
        let at_m = camera_m(yaw_deg, elevation_deg);
        let mut shares: Vec<f64> =
            (0..airframe.markers().len()).map(|marker| airframe.intensity(marker, &at_m)).collect();
        shares.sort_by(|a, b| b.total_cmp(a));
        100.0 * shares[1]
    };
    let yaws = || (0..=720).map(|step| 0.25 * f64::from(step));
    let least = |airframe: &Airframe, elevation_deg: f64| {
        yaws().map(|yaw_deg| second(airframe, yaw_deg, elevation_deg)).fold(f64::INFINITY, f64::min)
    };
    let y_label = "intensity of the second brightest (%)";
    let mut around = Panel::new(
        "A pair needs two: the second brightest marker, level",
        "direction of the camera (deg)",
        y_label,
    )
    .with_ranges([0.0, 180.0], [0.0, 110.0]);
    let mut above =
        Panel::new("The same, the least over all directions", "elevation of the camera (deg)", y_label)
            .with_ranges([0.0, 90.0], [0.0, 110.0]);
    let mut rows = Vec::new();
    for (label, airframe, role) in &shapes {
        let over_yaw = yaws().map(|yaw_deg| (yaw_deg, second(airframe, yaw_deg, 0.0))).collect();
        around = around.with(*label, Kind::Line, *role, over_yaw);
        let over_elevation =
            (0..=30).map(|step| 3.0 * f64::from(step)).map(|deg| (deg, least(airframe, deg)));
        above = above.with(*label, Kind::Line, *role, over_elevation.collect());
        let quantity = format!("least intensity of the second brightest marker, {label} (%)");
        rows.push(match *role {
            Role::Own => Row::of_paper(
                quantity,
                50.0,
                least(airframe, 0.0),
                Tolerance::Ratio(0.01),
                "Lambertian: cos 60 deg",
            ),
            Role::Perpendicular => Row::of_paper(
                quantity,
                0.0,
                least(airframe, 0.0),
                Tolerance::AtMost(1.0),
                "one marker alone from straight ahead",
            ),
            _ => Row::own(
                quantity,
                least(airframe, 0.0),
                Tolerance::AtLeast(50.0),
                "two LEDs per arm mend that",
            ),
        });
    }
    Ok(Report { figure: Figure::Layouts, panels: vec![around, above], rows })
}

fn lobes() -> Result<Report, ReproduceError> {
    // the first arm points forward; its marker is looked at from all around
    let over_yaw = |airframe: &Airframe| -> Vec<(f64, f64)> {
        let yaws = (-180..=180).map(f64::from);
        yaws.map(|yaw_deg| (yaw_deg, 100.0 * airframe.intensity(0, &camera_m(yaw_deg, 0.0)))).collect()
    };
    let single = ring(6, 1, 0.0)?;
    let mut panel = Panel::new(
        "Two Lambertian LEDs side by side",
        "angle from ahead (deg)",
        "intensity (% of one LED's)",
    )
    .with_ranges([-180.0, 180.0], [0.0, 200.0])
    .with("a single LED", Kind::Dashed, Role::Truth, over_yaw(&single));
    let mut rows = vec![Row::of_paper(
        "intensity of one LED at 60 deg (%)",
        50.0,
        100.0 * single.intensity(0, &camera_m(60.0, 0.0)),
        Tolerance::Ratio(0.01),
        "at least 50 % out to 60 deg",
    )];
    for (member, splay_deg) in SPLAYS_DEG.into_iter().enumerate() {
        let airframe = ring(4, 2, splay_deg.to_radians())?;
        panel =
            panel.with(format!("{splay_deg} deg"), Kind::Line, Role::Member(member + 1), over_yaw(&airframe));
        let ahead = 100.0 * airframe.intensity(0, &camera_m(0.0, 0.0));
        let quantity = format!("intensity ahead of two LEDs at {splay_deg} deg (%)");
        let by_hand = 200.0 * libm::cos(0.5 * splay_deg * TAU / 360.0);
        rows.push(if (splay_deg - 120.0).abs() < 1e-9 {
            Row::of_paper(quantity, 100.0, ahead, Tolerance::Ratio(0.01), "as that of a single LED")
        } else {
            Row::own(quantity, ahead, Tolerance::None, format!("2 cos({}) = {by_hand:.1} %", 0.5 * splay_deg))
        });
    }
    Ok(Report { figure: Figure::Lobes, panels: vec![panel], rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensities_are_those_of_the_paper() {
        let reports = reports().unwrap();
        let rows = reports.iter().flat_map(|report| &report.rows);
        assert_eq!(rows.clone().filter(|row| row.paper.is_some()).count(), 4);
        assert!(rows.clone().all(|row| row.is_within() != Some(false)), "{reports:?}");
    }
}
