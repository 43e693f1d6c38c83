//! A gyro's rates -> how the camera turned between two frames.

use nalgebra::{Rotation3, Vector3};

use super::look::Turned;

/// Rates of a gyro that are this far apart, s, say nothing of what is between.
const LONGEST_GAP_S: f64 = 0.1;
/// What a gyro of a flight controller is off by for long, rad/s per axis: half a degree per second.
const BIAS_RAD_S: f64 = 0.01;

/// How the camera turned from one time to another by a gyro's `rates` (time, s, and rad/s in the camera's own frame; in the order of time, straight lines in
/// between); `None` where they do not reach over the interval, or are too far apart.
pub fn turned(rates: &[(f64, Vector3<f64>)], from_s: f64, to_s: f64) -> Option<Turned> {
    let first = rates.partition_point(|rate| rate.0 <= from_s).checked_sub(1)?;
    let mut camera_from_before = Rotation3::identity();
    let mut now_s = from_s;
    for pair in rates[first..].windows(2) {
        let [(begin_s, begin), (end_s, end)] = [pair[0], pair[1]];
        let length_s = end_s - begin_s;
        if length_s > LONGEST_GAP_S {
            return None;
        }
        let until_s = end_s.min(to_s);
        // The rate in the middle, for the time that it lasts.
        let share = (0.5 * (now_s + until_s) - begin_s) / length_s;
        let rate = begin + (end - begin) * share;
        // A direction that stands in the world turns against the camera.
        camera_from_before = Rotation3::new(-rate * (until_s - now_s)) * camera_from_before;
        now_s = until_s;
        if now_s >= to_s {
            let sigma_rad = BIAS_RAD_S * (to_s - from_s);
            return Some(Turned { now_from_before: camera_from_before, sigma_rad });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera that pans about a fixed axis: what it looked at moves the other way.
    #[test]
    fn a_pan_moves_what_is_seen_the_other_way() {
        let about_down = Vector3::new(0.0, 1.0, 0.0);
        let rates: Vec<_> = (0..50).map(|k| (f64::from(k) * 0.01, about_down)).collect();
        let turn = turned(&rates, 0.1, 0.3).unwrap();
        // Turned to the right by 0.2 rad, what was ahead is on the left.
        let ahead = turn.now_from_before * Vector3::z();
        assert!((ahead - Vector3::new(-libm::sin(0.2), 0.0, libm::cos(0.2))).norm() < 1e-12, "{ahead}");
        assert!(turned(&rates, -0.1, 0.3).is_none() && turned(&rates, 0.3, 0.6).is_none());
        assert!(turned(&[(0.0, about_down), (1.0, about_down)], 0.1, 0.2).is_none());
    }

    /// Against the attitude itself, of a camera that turns about changing axes.
    #[test]
    fn rates_of_an_attitude_give_its_turn() {
        let world_from_camera = |t: f64| {
            Rotation3::new(Vector3::new(0.3 * libm::sin(3.0 * t), 0.0, 0.0))
                * Rotation3::new(Vector3::new(0.0, 2.0 * t, 0.2 * libm::cos(5.0 * t)))
        };
        let step = 1e-5;
        let rate = |t: f64| {
            let turn = world_from_camera(t - step).inverse() * world_from_camera(t + step);
            turn.scaled_axis() / (2.0 * step)
        };
        let rates: Vec<_> = (0..400).map(|k| f64::from(k) * 0.0025).map(|t| (t, rate(t))).collect();
        for (from, to) in [(0.1, 0.1166), (0.5013, 0.5347), (0.2, 0.9)] {
            let told = turned(&rates, from, to).unwrap().now_from_before;
            let truth = world_from_camera(to).inverse() * world_from_camera(from);
            assert!((told.inverse() * truth).angle() < 1e-4 * (to - from), "{from} {to}");
        }
    }
}
