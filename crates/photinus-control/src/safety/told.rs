//! What a vehicle was told and has not flown yet.

use nalgebra::{Rotation3, Vector3};

use super::Limits;
use super::commitment::Underway;

/// Set-points and how long ago they were told, s, the oldest first; the oldest is the one that is flown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Told {
    setpoints: Vec<(Vector3<f64>, f64)>,
}

impl Told {
    /// Time passes, and the level frame turns: the accelerations are those of its axes of now.
    pub(super) fn pass(&mut self, level_from_before: &Rotation3<f64>, dt_s: f64, delay_s: f64) {
        for (acceleration, age_s) in &mut self.setpoints {
            *acceleration = level_from_before * *acceleration;
            *age_s += dt_s;
        }
        // Of those that are due, the newest is flown.
        let due = self.setpoints.iter().filter(|(_, age_s)| *age_s >= delay_s).count();
        self.setpoints.drain(..due.saturating_sub(1));
    }

    /// Another set-point, told now.
    pub(super) fn tell(&mut self, acceleration: Vector3<f64>) {
        self.setpoints.push((acceleration, 0.0));
    }

    /// What they do until the next set-point is flown, from a velocity on, m/s.
    pub(super) fn carry_out(&self, underway: &mut Underway, velocity: Vector3<f64>, limits: &Limits) {
        underway.begin(velocity);
        let mut now_s = 0.0;
        let mut flown = Vector3::zeros();
        for (acceleration, age_s) in &self.setpoints {
            let due_s = limits.delay_s - age_s;
            if due_s > now_s {
                underway.accelerate(flown, due_s - now_s);
                now_s = due_s;
            }
            flown = *acceleration;
        }
        if now_s < limits.delay_s {
            underway.accelerate(flown, limits.delay_s - now_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_underway_is_flown_in_its_order() {
        let limits = Limits { delay_s: 0.1, ..Limits::small_multirotor() };
        let mut told = Told::default();
        for k in 1..=5 {
            told.pass(&Rotation3::identity(), 0.04, limits.delay_s);
            told.tell(Vector3::x() * f64::from(k));
        }
        told.pass(&Rotation3::identity(), 0.04, limits.delay_s);
        // Told 0.12, 0.08 and 0.04 s ago: 3 is flown for 0.02 s more, then 4 and 5 for 0.04 s each.
        let mut underway = Underway::default();
        told.carry_out(&mut underway, Vector3::zeros(), &limits);
        assert!((underway.velocity().x - (3.0 * 0.02 + (4.0 + 5.0) * 0.04)).abs() < 1e-12);
    }
}
