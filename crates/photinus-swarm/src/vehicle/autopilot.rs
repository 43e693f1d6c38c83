//! The autopilot: a wanted acceleration -> thrust and rates of turn, within the limits of the vehicle.
//!
//! Thrust and attitude are found as in geometric control (T. Lee, M. Leok, N. McClamroch, 2010): the thrust's direction is that of the wanted acceleration
//! plus gravity, the heading is free; the attitude is gone to in proportion to the angle that is missing. It knows the attitude that its instruments say,
//! not the true one.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{Build, Command, GRAVITY_M_S2};

/// What the autopilot is asked for, in the level frame: x along the heading, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Acceleration, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Rate of the heading, rad/s to the left.
    pub heading_rate_rad_s: f64,
}

/// An autopilot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Autopilot {
    /// Rate of turn per angle that is missing, 1/s.
    pub attitude_gain: f64,
}

impl Default for Autopilot {
    fn default() -> Self {
        Self { attitude_gain: 8.0 }
    }
}

impl Autopilot {
    /// What the rotors are asked for; `attitude` is world_from_body as the vehicle believes it.
    pub fn command(&self, build: &Build, attitude: &UnitQuaternion<f64>, wanted: &Wanted) -> Command {
        let ahead = attitude * Vector3::x();
        let heading_rad = libm::atan2(ahead.y, ahead.x);
        let level = Rotation3::from_axis_angle(&Vector3::z_axis(), heading_rad);
        let lift_m_s2 = Self::within(build, wanted.acceleration_m_s2);
        let up = level * lift_m_s2;
        let goal = upright(&up, heading_rad);
        let missing = (attitude.inverse() * goal).scaled_axis();
        let heading = attitude.inverse() * (Vector3::z() * wanted.heading_rate_rad_s);
        // thrust along the axis as it is now: what a tilt that is still missing would waste is not added
        let along = up.dot(&(attitude * Vector3::z())).max(0.0);
        Command {
            thrust_n: (build.mass_kg * along).min(build.thrust_n),
            turn_rad_s: missing * self.attitude_gain + heading,
        }
    }

    /// Acceleration of the thrust alone, within what the vehicle can: it goes up and down first, then sideways as far as tilt and thrust allow.
    fn within(build: &Build, acceleration_m_s2: Vector3<f64>) -> Vector3<f64> {
        let most = build.thrust_n / build.mass_kg;
        // a tenth of the weight is kept, so that there is a direction to tilt to
        let least = 0.1 * GRAVITY_M_S2;
        let up = (acceleration_m_s2.z + GRAVITY_M_S2).clamp(least, most.max(least));
        let side = acceleration_m_s2.xy();
        let by_tilt = up * libm::tan(build.tilt_rad);
        let by_thrust = (most * most - up * up).max(0.0).sqrt();
        let wanted = side.norm();
        let share = if wanted > 0.0 { (by_tilt.min(by_thrust) / wanted).min(1.0) } else { 0.0 };
        Vector3::new(side.x * share, side.y * share, up)
    }
}

/// The attitude whose z axis is along `up` and whose x axis has this heading.
fn upright(up: &Vector3<f64>, heading_rad: f64) -> UnitQuaternion<f64> {
    let z = up.normalize();
    let (sin, cos) = libm::sincos(heading_rad);
    // x lies in the upright plane of the heading: one that is only projected along z would turn the heading with every tilt
    let x = Vector3::new(cos, sin, -(z.x * cos + z.y * sin) / z.z).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    UnitQuaternion::from_rotation_matrix(&rotation)
}
