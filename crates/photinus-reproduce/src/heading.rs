//! Heading from bearing: both positions known by satellite (RTK, 10 mm), the bearing of the neighbour tells where the camera
//! looks, and does not drift as a compass does.

use nalgebra::{Point3, Vector3};
use photinus::camera::Bearing;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::statistics::{mean, rms, slope};
use crate::view::Seen;
use crate::{Figure, Kind, Panel, Report, Rig, Role, Row, Tolerance};

/// Noise of a position along each axis, m: the paper's receivers reach +- 10 mm.
const POSITION_SIGMA_M: f64 = 0.01;
/// How far a compass walks at random, rad per root of a second: 10 deg in 120 s. The paper calls its drift severe and gives no
/// number.
const COMPASS_WALK_RAD: f64 = 0.016;
/// Noise of a compass reading, rad.
const COMPASS_SIGMA_RAD: f64 = 0.017;
/// The mean over this much of the time is shown, too, s.
const SMOOTHED_S: f64 = 1.0;

pub(crate) fn report(rig: &Rig, seen: &[Seen]) -> Report {
    let mut random = Pcg64::new(17, 18);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let (mut from_bearing, mut compass) = (Vec::new(), Vec::new());
    let (mut walked_rad, mut last_s) = (0.0, seen.first().map_or(0.0, |seen| seen.time_s));
    for seen in seen {
        walked_rad += COMPASS_WALK_RAD * (seen.time_s - last_s).max(0.0).sqrt() * normal();
        last_s = seen.time_s;
        compass.push((seen.time_s, (walked_rad + COMPASS_SIGMA_RAD * normal()).to_degrees()));
        let mut noise_m = || Vector3::new(normal(), normal(), normal()) * POSITION_SIGMA_M;
        let (here_m, there_m) = (noise_m(), noise_m());
        if let Some(error_rad) = error_rad(rig, seen, there_m - here_m) {
            from_bearing.push((seen.time_s, error_rad.to_degrees()));
        }
    }
    let smoothed = smoothed(&from_bearing);
    let ends = [seen.first(), seen.last()].map(|seen| seen.map_or(0.0, |seen| seen.time_s.round()));
    let of = |errors: &[(f64, f64)]| rms(errors.iter().map(|error| error.1));
    let per_minute = slope(&from_bearing) * 60.0;
    Report {
        figure: Figure::Heading,
        panels: vec![
            Panel::new("Error of the observer's heading", "time (s)", "heading error (deg)")
                .with_ranges(ends, [-15.0, 15.0])
                .with("compass that drifts (assumed)", Kind::Line, Role::Perpendicular, compass.clone())
                .with("from bearing, each frame", Kind::Points, Role::Bound, from_bearing.clone())
                .with("from bearing, mean over 1 s", Kind::Line, Role::Own, smoothed.clone())
                .with_level("", 0.0),
        ],
        rows: vec![
            Row::own(
                "heading error from bearing, rms (deg)",
                of(&from_bearing),
                Tolerance::AtMost(2.0),
                "each frame by itself; 10 mm at 4 m are 0.2 deg, half an arm at 11 m is 1 deg",
            ),
            Row::own(
                "heading error from bearing, mean over 1 s, rms (deg)",
                of(&smoothed),
                Tolerance::AtMost(1.0),
                "",
            ),
            Row::of_paper(
                "drift of heading from bearing (deg per minute)",
                0.0,
                per_minute.abs(),
                Tolerance::AtMost(0.1),
                "\"does not drift\"",
            ),
            Row::own(
                "heading error of a drifting compass, rms (deg)",
                of(&compass),
                Tolerance::None,
                "assumed: a random walk of 10 deg in 120 s and 1 deg of noise; the paper says severe and gives no number",
            ),
        ],
    }
}

/// How far off the heading is that follows from a frame and from positions whose difference is off by `off_m` (world), rad.
fn error_rad(rig: &Rig, seen: &Seen, off_m: Vector3<f64>) -> Option<f64> {
    let (scene, found) = (rig.scene(), seen.own.neighbour?);
    let world_from_camera = scene.observer.pose(seen.time_s) * scene.cameras[0].body_from_camera;
    let way_m =
        world_from_camera * Point3::from(seen.position_m) - world_from_camera * Point3::origin() + off_m;
    let heading_rad = azimuth_rad(&way_m) + bearing_azimuth_rad(seen, &found.bearing);
    let ahead = world_from_camera * Vector3::z();
    Some(wrapped_rad(heading_rad - azimuth_rad(&ahead)))
}

/// Counter-clockwise from east, as seen from above, rad.
fn azimuth_rad(world: &Vector3<f64>) -> f64 {
    libm::atan2(world.y, world.x)
}

/// How far to the right of the optical axis a bearing points, in the level plane, rad.
fn bearing_azimuth_rad(seen: &Seen, bearing: &Bearing) -> f64 {
    let down = seen.gravity.into_inner();
    let ahead = Vector3::z() - down * down.z;
    let right = down.cross(&ahead);
    libm::atan2(bearing.vector().dot(&right), bearing.vector().dot(&ahead))
}

fn wrapped_rad(angle_rad: f64) -> f64 {
    libm::atan2(libm::sin(angle_rad), libm::cos(angle_rad))
}

/// The mean over each stretch of time.
fn smoothed(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let stretch = |point: &(f64, f64)| (point.0 / SMOOTHED_S) as i64;
    let stretches = points.chunk_by(|a, b| stretch(a) == stretch(b));
    stretches.map(|points| (mean(points.iter().map(|p| p.0)), mean(points.iter().map(|p| p.1)))).collect()
}

#[cfg(test)]
mod tests {
    use photinus::ranging::Interval;
    use photinus_sim::Simulator;

    use super::*;
    use crate::rig::tests::rig;
    use crate::view::{Observer, OwnNeighbour};

    #[test]
    fn an_exact_bearing_gives_the_heading_and_a_metre_aside_turns_it() {
        let rig = rig();
        let rendered = Simulator::new(rig.scene(), 0).unwrap().frame(700);
        let mut seen = Observer::new(&rig, &[]).unwrap().look(&rendered).unwrap();
        let (bearing, bounds) = (Bearing::new(seen.position_m).unwrap(), Interval::new(0.0, 9.0).unwrap());
        seen.own.neighbour = Some(OwnNeighbour { bearing, estimate_m: None, bounds, paper_m: None });
        assert!(error_rad(&rig, &seen, Vector3::zeros()).unwrap().abs() < 1e-9);
        let north_rad = error_rad(&rig, &seen, Vector3::y()).unwrap();
        assert!((north_rad - 1.0 / seen.distance_m()).abs() < 0.02, "{north_rad}, to the left is positive");
    }

    #[test]
    fn a_mean_is_that_of_its_second() {
        let points = [(0.1, 1.0), (0.9, 3.0), (1.2, 5.0)];
        assert_eq!(smoothed(&points), [(0.5, 2.0), (1.2, 5.0)]);
    }
}
