//! Scripts: flights that the scenario writes, by truth. A leader's course, and one who hunts others.

use core::f64::consts::TAU;

use nalgebra::Vector3;
use photinus_control::Setpoint;

/// A flight that the scenario writes.
#[derive(Clone, Debug, PartialEq)]
pub enum Script {
    /// Stays where it began.
    Hover,
    /// Flies straight on, m/s in the world.
    Cruise {
        /// Its velocity.
        velocity_m_s: Vector3<f64>,
    },
    /// Flies through places, one after the other, and stays at the last.
    Way {
        /// The places, in the world, m.
        places_m: Vec<Vector3<f64>>,
        /// Its speed, m/s.
        speed_m_s: f64,
    },
    /// Flies figures of eight about where it began: x = a sin(w t), y = b sin(2 w t).
    FigureEight {
        /// Half its length and width, m.
        half_m: [f64; 2],
        /// Time for one figure, s.
        period_s: f64,
    },
    /// Flies at whoever is nearest.
    Hunt {
        /// Its speed, m/s.
        speed_m_s: f64,
    },
}

/// What a script knows.
#[derive(Clone, Copy, Debug)]
pub struct Truth<'a> {
    /// Time since the start, s.
    pub time_s: f64,
    /// Which vehicle it is.
    pub vehicle: usize,
    /// Where it began, m.
    pub start_m: Vector3<f64>,
    /// Where everybody is, m.
    pub places_m: &'a [Vector3<f64>],
}

/// How strongly a script goes back to its course, 1/s.
const BACK_1_S: f64 = 1.0;
/// A place counts as reached from so near, m.
const REACHED_M: f64 = 1.0;

impl Script {
    /// The velocity in the world, m/s, that it goes for; `reached` counts the places of a way.
    pub fn velocity_m_s(&self, truth: &Truth<'_>, reached: &mut usize) -> Vector3<f64> {
        let here_m = truth.places_m[truth.vehicle];
        match self {
            Self::Hover => (truth.start_m - here_m) * BACK_1_S,
            Self::Cruise { velocity_m_s } => {
                let goal_m = truth.start_m + velocity_m_s * truth.time_s;
                velocity_m_s + (goal_m - here_m) * BACK_1_S
            }
            Self::Way { places_m, speed_m_s } => {
                let goal_m = places_m[(*reached).min(places_m.len() - 1)];
                let left_m = goal_m - here_m;
                if left_m.norm() < REACHED_M && *reached + 1 < places_m.len() {
                    *reached += 1;
                }
                limited(left_m * BACK_1_S, *speed_m_s)
            }
            Self::FigureEight { half_m: [a, b], period_s } => {
                let omega = TAU / period_s;
                let (sin, cos) = libm::sincos(omega * truth.time_s);
                let (sin2, cos2) = libm::sincos(2.0 * omega * truth.time_s);
                let goal_m = truth.start_m + Vector3::new(a * sin, b * sin2, 0.0);
                let along = Vector3::new(a * cos, 2.0 * b * cos2, 0.0) * omega;
                along + (goal_m - here_m) * BACK_1_S
            }
            Self::Hunt { speed_m_s } => {
                let others = (0..truth.places_m.len()).filter(|&other| other != truth.vehicle);
                let nearest = others
                    .map(|other| truth.places_m[other] - here_m)
                    .min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
                nearest.map_or_else(Vector3::zeros, |way| way / way.norm().max(1e-6) * *speed_m_s)
            }
        }
    }
}

/// The set-point of a velocity in the world for a vehicle with this heading; it turns towards where it flies.
pub(crate) fn setpoint(velocity_m_s: &Vector3<f64>, heading_rad: f64) -> Setpoint {
    let (sin, cos) = libm::sincos(heading_rad);
    let level = Vector3::new(
        cos * velocity_m_s.x + sin * velocity_m_s.y,
        cos * velocity_m_s.y - sin * velocity_m_s.x,
        velocity_m_s.z,
    );
    Setpoint::velocity(level)
}

fn limited(vector: Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = vector.norm();
    if length > most { vector * (most / length) } else { vector }
}
