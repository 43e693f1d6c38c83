//! Where a robot is and how it is turned, at any time.
//!
//! World frame: x east, y north, z up, m. A multirotor pushes along its own z axis, so it leans into every acceleration:
//! its z axis is that of (acceleration + g up), its heading is chosen. A recorded flight brings its own attitude.

mod path;
mod recorded;
mod wander;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};

pub use path::Path;
pub use recorded::Recorded;
pub use wander::Wander;

/// Standard gravity, m/s^2.
const GRAVITY_M_S2: f64 = 9.806_65;

/// How a robot moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// It flies: a path, what the wind adds, and a heading.
    Flown(Flight),
    /// It was recorded.
    Recorded(Recorded),
}

/// A path with what the wind adds and where the nose points.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Where it means to be.
    pub path: Path,
    /// How the wind moves it about.
    pub wander: Wander,
    /// Heading at time 0, counter-clockwise from east, rad.
    pub heading_rad: f64,
    /// Turns in place.
    pub spins: Vec<Spin>,
}

/// Turning in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// When it begins, s.
    pub start_s: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// How many turns, counter-clockwise from above.
    pub turns: f64,
}

impl Spin {
    /// Angle turned so far, rad; it starts and ends at rest.
    fn angle_rad(&self, time_s: f64) -> f64 {
        let share = ((time_s - self.start_s) / self.duration_s).clamp(0.0, 1.0);
        core::f64::consts::TAU * self.turns * (share * share * (3.0 - 2.0 * share))
    }
}

impl Motion {
    /// The pose world_from_body at a time.
    pub fn pose(&self, time_s: f64) -> Isometry3<f64> {
        match self {
            Self::Flown(flight) => flight.pose(time_s),
            Self::Recorded(recorded) => recorded.pose(time_s),
        }
    }
}

impl Flight {
    /// Half the time over which accelerations are measured, s.
    const STEP_S: f64 = 0.02;

    fn position_m(&self, time_s: f64) -> Vector3<f64> {
        self.path.position_m(time_s) + self.wander.offset_m(time_s)
    }

    fn pose(&self, time_s: f64) -> Isometry3<f64> {
        let here_m = self.position_m(time_s);
        let around_m = self.position_m(time_s - Self::STEP_S) + self.position_m(time_s + Self::STEP_S);
        let acceleration = (around_m - 2.0 * here_m) / (Self::STEP_S * Self::STEP_S);
        let thrust = acceleration + Vector3::z() * GRAVITY_M_S2;
        let spun_rad: f64 = self.spins.iter().map(|spin| spin.angle_rad(time_s)).sum();
        let (sin, cos) = libm::sincos(self.heading_rad + spun_rad);
        Isometry3::from_parts(Translation3::from(here_m), attitude(thrust, Vector3::new(cos, sin, 0.0)))
    }
}

/// The attitude whose z axis lies along `thrust` and whose x axis points towards `ahead` as far as that allows.
fn attitude(thrust: Vector3<f64>, ahead: Vector3<f64>) -> UnitQuaternion<f64> {
    let up = thrust.normalize();
    let left = up.cross(&ahead).normalize();
    let rotation = Rotation3::from_basis_unchecked(&[left.cross(&up), left, up]);
    UnitQuaternion::from_rotation_matrix(&rotation)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, TAU};

    use super::*;

    fn flight(path: Path) -> Flight {
        Flight { path, wander: Wander::still(), heading_rad: 0.0, spins: Vec::new() }
    }

    #[test]
    fn a_robot_on_a_circle_leans_inwards_by_the_centripetal_acceleration() {
        let circle = Path::Circle {
            centre_m: Vector3::new(1.0, 2.0, 3.0),
            radius_m: 5.0,
            speed_m_s: 7.0,
            phase_rad: 0.0,
        };
        let motion = Motion::Flown(flight(circle));
        let pose = motion.pose(0.0);
        assert!((pose.translation.vector - Vector3::new(6.0, 2.0, 3.0)).norm() < 1e-12);
        let up = pose * Vector3::z();
        // v^2 / r = 9.8 m/s^2 towards the centre, as much as gravity: 45 deg
        assert!((libm::atan2(-up.x, up.z) - libm::atan(9.8 / GRAVITY_M_S2)).abs() < 1e-3, "{up}");
        assert!(up.y.abs() < 1e-9);
    }

    #[test]
    fn hovering_is_level_and_a_spin_ends_where_it_began() {
        let mut hover = flight(Path::Hover { position_m: Vector3::new(0.0, 0.0, 4.0) });
        hover.heading_rad = FRAC_PI_2;
        hover.spins.push(Spin { start_s: 2.0, duration_s: 4.0, turns: 2.0 });
        let heading = |time_s: f64| hover.pose(time_s) * Vector3::x();
        assert!((heading(1.0) - Vector3::y()).norm() < 1e-12);
        assert!((heading(4.0) - Vector3::y()).norm() < 1e-9, "a whole turn half way");
        assert!((heading(9.0) - Vector3::y()).norm() < 1e-9);
        assert!((hover.spins[0].angle_rad(3.0) - 2.0 * TAU * (0.0625 * 2.5)).abs() < 1e-12);
        assert!((hover.pose(3.3) * Vector3::z() - Vector3::z()).norm() < 1e-12);
    }
}
