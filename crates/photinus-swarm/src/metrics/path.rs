//! Where a vehicle said that it would be: set-points told and limits -> a path with how far it may be from each place of it.
//!
//! This walks the path of `docs/safety.md` in steps of its own, so that it shares nothing with the layer that it checks.

use std::collections::VecDeque;

use nalgebra::Vector3;
use photinus_control::safety::Limits;

/// Length of a step, s.
const STEP_S: f64 = 0.005;

/// The last path that a vehicle was bound to, in the world.
#[derive(Clone, Debug)]
pub(super) struct Path {
    told: VecDeque<(Vector3<f64>, f64)>,
    /// Places, m, and when each is reached after the decision, s.
    places: Vec<(Vector3<f64>, f64)>,
}

impl Path {
    /// Of one who stands.
    pub(super) fn of_resting(place_m: Vector3<f64>) -> Self {
        Self { told: VecDeque::new(), places: vec![(place_m, 0.0)] }
    }

    /// Another acceleration was told, m/s^2 in the world.
    pub(super) fn tell(&mut self, acceleration_m_s2: Vector3<f64>, now_s: f64, limits: &Limits) {
        self.told.push_back((acceleration_m_s2, now_s));
        // of those that are due the newest is flown
        while self.told.get(1).is_some_and(|(_, told_s)| told_s + limits.delay_s <= now_s) {
            self.told.pop_front();
        }
    }

    /// The vehicle is bound anew: from where it is, with what it takes for its velocity, it flies all that was told and then brakes.
    pub(super) fn renew(
        &mut self,
        place_m: Vector3<f64>,
        velocity_m_s: Vector3<f64>,
        now_s: f64,
        limits: &Limits,
    ) {
        let (mut place_m, mut velocity_m_s, mut after_s) = (place_m, velocity_m_s, 0.0);
        self.places.clear();
        self.places.push((place_m, after_s));
        let told_for_s = limits.delay_s + limits.period_s;
        loop {
            let acceleration_m_s2 = if after_s < told_for_s {
                let is_due =
                    |(_, told_s): &&(Vector3<f64>, f64)| told_s + limits.delay_s <= now_s + after_s + 1e-9;
                self.told
                    .iter()
                    .rev()
                    .find(is_due)
                    .map_or(Vector3::zeros(), |(acceleration, _)| *acceleration)
            } else if velocity_m_s.norm() > limits.braking_m_s2 * STEP_S {
                velocity_m_s * (-limits.braking_m_s2 / velocity_m_s.norm())
            } else {
                return;
            };
            place_m += velocity_m_s * STEP_S + acceleration_m_s2 * (0.5 * STEP_S * STEP_S);
            velocity_m_s += acceleration_m_s2 * STEP_S;
            after_s += STEP_S;
            self.places.push((place_m, after_s));
        }
    }

    /// How far a place is off the path, beyond what the error of the own velocity explains, m.
    pub(super) fn off_m(&self, place_m: &Vector3<f64>, limits: &Limits) -> f64 {
        let off =
            |(on, after_s): &(Vector3<f64>, f64)| (place_m - on).norm() - limits.velocity_error_m_s * after_s;
        self.places.iter().map(off).fold(f64::INFINITY, f64::min).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Told to speed up at 2 m/s, in closed form: 0.1 s at 2 m/s, 0.05 s at 3 m/s^2, then braking from 2.15 m/s at 2 m/s^2.
    #[test]
    fn a_path_ends_where_braking_ends_and_grows_by_the_error_of_the_velocity() {
        let limits = Limits {
            delay_s: 0.1,
            period_s: 0.05,
            braking_m_s2: 2.0,
            velocity_error_m_s: 0.1,
            ..Limits::small_multirotor()
        };
        let mut path = Path::of_resting(Vector3::zeros());
        assert!((path.off_m(&Vector3::y(), &limits) - 1.0).abs() < 1e-12);
        path.tell(Vector3::x() * 3.0, 7.0, &limits);
        path.renew(Vector3::zeros(), Vector3::x() * 2.0, 7.0, &limits);
        let end_m = 0.2 + 0.1 + 0.5 * 3.0 * 0.05 * 0.05 + 2.15 * 2.15 / 4.0;
        let stands_s = 0.15 + 2.15 / 2.0;
        // beyond the end by 1 m, and aside of its beginning by 0.2 m
        let beyond_m = path.off_m(&(Vector3::x() * (end_m + 1.0)), &limits);
        assert!((beyond_m - (1.0 - 0.1 * stands_s)).abs() < 0.01, "{beyond_m}");
        assert!((path.off_m(&Vector3::new(-0.2, 0.0, 0.0), &limits) - 0.2).abs() < 0.01);
        assert!(path.off_m(&(Vector3::x() * end_m), &limits) <= 0.0);
    }
}
