//! How the group flies: order, extension, formation.

use nalgebra::Vector3;

use crate::scenario::Scenario;
use crate::world::World;

/// One who is slower than this has no direction, m/s.
const STILL_M_S: f64 = 0.05;

#[derive(Debug)]
pub(super) struct Shape {
    wanted_m: Vec<Vector3<f64>>,
    pub(super) order: Vec<f64>,
    pub(super) extension_m: Vec<f64>,
    pub(super) speed_m_s: Vec<f64>,
    formation_m: Vec<f64>,
    /// Mean square velocity against the group's, m^2/s^2.
    stirring_m2_s2: Vec<f64>,
}

impl Shape {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            wanted_m: scenario.formation.clone(),
            order: Vec::new(),
            extension_m: Vec::new(),
            speed_m_s: Vec::new(),
            formation_m: Vec::new(),
            stirring_m2_s2: Vec::new(),
        }
    }

    pub(super) fn frames(&self) -> usize {
        self.speed_m_s.len()
    }

    pub(super) fn take(&mut self, world: &World) {
        let count = world.robots().len() as f64;
        let places: Vec<Vector3<f64>> = world.robots().iter().map(|robot| robot.state.position_m).collect();
        let velocities = || world.robots().iter().map(|robot| robot.state.velocity_m_s);
        self.order.push(velocities().map(direction).sum::<Vector3<f64>>().norm() / count);
        self.speed_m_s.push(velocities().map(|velocity| velocity.norm()).sum::<f64>() / count);
        self.extension_m.push(extension_m(&places));
        if !self.wanted_m.is_empty() {
            self.formation_m.push(formation_error_m(&places[..self.wanted_m.len()], &self.wanted_m));
            let velocities: Vec<Vector3<f64>> = velocities().take(self.wanted_m.len()).collect();
            self.stirring_m2_s2.push(extension_m(&velocities).powi(2));
        }
    }

    /// Mean error from frame `last` on, and the time from which on it stays within twice that.
    pub(super) fn formation(&self, last: usize, period_s: f64) -> (Option<f64>, Option<f64>) {
        let Some(error_m) = super::mean(self.formation_m.get(last..).unwrap_or(&[])) else {
            return (None, None);
        };
        let outside = self.formation_m.iter().rposition(|&now_m| now_m > 2.0 * error_m);
        (Some(error_m), Some(outside.map_or(0.0, |frame| (frame + 1) as f64 * period_s)))
    }

    /// Root of the mean square velocity of those in the formation against that of all of it, from frame `last` on, m/s.
    pub(super) fn oscillation_m_s(&self, last: usize) -> Option<f64> {
        super::mean(self.stirring_m2_s2.get(last..)?).map(f64::sqrt)
    }
}

fn direction(velocity: Vector3<f64>) -> Vector3<f64> {
    let speed = velocity.norm();
    if speed > STILL_M_S { velocity / speed } else { Vector3::zeros() }
}

fn centre(places: &[Vector3<f64>]) -> Vector3<f64> {
    places.iter().sum::<Vector3<f64>>() / places.len() as f64
}

/// Root of the mean square distance from the centre, m.
pub(super) fn extension_m(places: &[Vector3<f64>]) -> f64 {
    let middle = centre(places);
    (places.iter().map(|place| (place - middle).norm_squared()).sum::<f64>() / places.len() as f64).sqrt()
}

/// Root of the mean square distance from the wanted places, after the best shift and the best turn about the vertical, m. The turn follows from the sums of
/// products and cross products along the ground (the planar case of W. Kabsch, 1976).
pub(super) fn formation_error_m(places: &[Vector3<f64>], wanted: &[Vector3<f64>]) -> f64 {
    let (here, there) = (centre(places), centre(wanted));
    let (mut dot, mut cross, mut square) = (0.0, 0.0, 0.0);
    for (place, goal) in places.iter().zip(wanted) {
        let (p, w) = (place - here, goal - there);
        dot += w.x * p.x + w.y * p.y;
        cross += w.x * p.y - w.y * p.x;
        square += p.norm_squared() + w.norm_squared() - 2.0 * w.z * p.z;
    }
    ((square - 2.0 * libm::hypot(dot, cross)).max(0.0) / places.len() as f64).sqrt()
}
