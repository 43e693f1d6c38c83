//! What an autopilot says of its own motion -> gravity, rates and velocities in the body frame of Photinus, on the clock of the frames.

use mavlink::dialects::common::{
    ATTITUDE_QUATERNION_DATA, GLOBAL_POSITION_INT_DATA, HIGHRES_IMU_DATA, LOCAL_POSITION_NED_DATA, MavFrame,
    ODOMETRY_DATA,
};
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};
use photinus_run::motion::Velocity;

use super::{Own, frd, ned, ned_from_frd};
use crate::clock_offset::ClockOffset;

/// An attitude as it was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude {
    /// On the clock of the frames, s.
    pub time_s: f64,
    /// The attitude enu_from_flu.
    pub enu_from_body: UnitQuaternion<f64>,
    /// Rate of turn in the body frame FLU, rad/s.
    pub turn_rad_s: Vector3<f64>,
}

impl Attitude {
    /// Direction of gravity (down) in the body frame FLU.
    #[must_use]
    pub fn down(&self) -> Unit<Vector3<f64>> {
        self.enu_from_body.inverse() * -Vector3::z_axis()
    }
}

/// A rate of turn as it was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// On the clock of the frames, s.
    pub time_s: f64,
    /// In the body frame FLU, rad/s.
    pub turn_rad_s: Vector3<f64>,
}

/// A velocity over the ground as it was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// On the clock of the frames, s.
    pub time_s: f64,
    /// In the body frame FLU.
    pub velocity: Velocity,
}

/// What a message of an attitude says; `None` where its numbers are no attitude.
pub(super) fn attitude(
    data: &ATTITUDE_QUATERNION_DATA,
    clock: &mut ClockOffset,
    arrived_s: f64,
) -> Option<Attitude> {
    let parts = [data.q1, data.q2, data.q3, data.q4].map(f64::from);
    let [w, x, y, z] = parts;
    let rates = Vector3::new(data.rollspeed, data.pitchspeed, data.yawspeed).cast::<f64>();
    let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    // false for NaN, too
    let is_turn = (length - 1.0).abs() < 0.01 && rates.iter().all(|rate| rate.is_finite());
    is_turn.then(|| Attitude {
        time_s: clock.hear(f64::from(data.time_boot_ms) * 1e-3, arrived_s),
        enu_from_body: ned_from_frd(&UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))),
        turn_rad_s: frd(&rates),
    })
}

/// What a message of an IMU says; `None` where it has no gyro, or its numbers are not finite.
pub(super) fn turn(data: &HIGHRES_IMU_DATA, clock: &mut ClockOffset, arrived_s: f64) -> Option<Turn> {
    use mavlink::dialects::common::HighresImuUpdatedFlags as Updated;
    let gyro = Updated::HIGHRES_IMU_UPDATED_XGYRO
        | Updated::HIGHRES_IMU_UPDATED_YGYRO
        | Updated::HIGHRES_IMU_UPDATED_ZGYRO;
    let rates = Vector3::new(data.xgyro, data.ygyro, data.zgyro).cast::<f64>();
    let is_rate = data.fields_updated.contains(gyro) && rates.iter().all(|rate| rate.is_finite());
    is_rate.then(|| Turn {
        time_s: clock.hear(data.time_usec as f64 * 1e-6, arrived_s),
        turn_rad_s: frd(&rates),
    })
}

/// What a message of a place says of the velocity, with the attitude that was heard last; `None` where its numbers are not finite.
pub(super) fn speed(
    data: &LOCAL_POSITION_NED_DATA,
    attitude: &Attitude,
    clock: &mut ClockOffset,
    arrived_s: f64,
) -> Option<Speed> {
    let of_world = ned(&Vector3::new(data.vx, data.vy, data.vz).cast::<f64>());
    let time_s = clock.hear(f64::from(data.time_boot_ms) * 1e-3, arrived_s);
    let velocity = Velocity::new(attitude.enu_from_body.inverse() * of_world, None);
    of_world.norm().is_finite().then_some(Speed { time_s, velocity })
}

/// What a message of an odometry says of the velocity; `None` where that is not told in the body's axes, or not finite.
pub(super) fn odometry(data: &ODOMETRY_DATA, clock: &mut ClockOffset, arrived_s: f64) -> Option<Speed> {
    let velocity_m_s = frd(&Vector3::new(data.vx, data.vy, data.vz).cast::<f64>());
    let is_told = data.child_frame_id == MavFrame::MAV_FRAME_BODY_FRD && velocity_m_s.norm().is_finite();
    // The upper triangle by rows of the covariance of velocity and rates; unknown where the first is NaN.
    let variances = Vector3::from([0, 6, 11].map(|place| f64::from(data.velocity_covariance[place])));
    let velocity = Velocity::with_variances(velocity_m_s, variances);
    is_told.then(|| Speed { time_s: clock.hear(data.time_usec as f64 * 1e-6, arrived_s), velocity })
}

/// Where the own vehicle is, with the attitude that was heard last.
pub(super) fn own(data: &GLOBAL_POSITION_INT_DATA, attitude: &Attitude) -> Own {
    Own {
        latitude_rad: (f64::from(data.lat) * 1e-7).to_radians(),
        longitude_rad: (f64::from(data.lon) * 1e-7).to_radians(),
        altitude_m: f64::from(data.alt) * 1e-3,
        velocity_ned_m_s: Vector3::new(data.vx, data.vy, data.vz).cast::<f64>() * 1e-2,
        enu_from_body: attitude.enu_from_body,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level, and looking so far to the right of north: enu_from_flu.
    fn level(heading_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(0.0, 0.0, core::f64::consts::FRAC_PI_2 - heading_rad)
    }

    #[test]
    fn a_level_vehicle_feels_gravity_below_and_one_that_leans_to_the_right_on_its_right() {
        let heard = |roll_rad: f64, heading_rad: f64| {
            let turn = UnitQuaternion::from_euler_angles(roll_rad, 0.0, heading_rad);
            let [q1, q2, q3, q4] = [turn.w, turn.i, turn.j, turn.k].map(|part| part as f32);
            let data = ATTITUDE_QUATERNION_DATA {
                q1,
                q2,
                q3,
                q4,
                rollspeed: 1.0,
                pitchspeed: 2.0,
                yawspeed: 3.0,
                ..Default::default()
            };
            attitude(&data, &mut ClockOffset::default(), 10.0).unwrap()
        };
        assert!((heard(0.0, 1.0).down().into_inner() + Vector3::z()).norm() < 1e-6);
        // Right is against y.
        let leaning = heard(0.3, -2.0);
        assert!(
            (leaning.down().into_inner() - Vector3::new(0.0, -libm::sin(0.3), -libm::cos(0.3))).norm() < 1e-6
        );
        assert_eq!(leaning.turn_rad_s, Vector3::new(1.0, -2.0, -3.0));
        assert!(heard(0.0, 0.7).enu_from_body.angle_to(&level(0.7)) < 1e-6);
        for wrong in [f32::NAN, 0.0, 3.0] {
            let data = ATTITUDE_QUATERNION_DATA { q1: wrong, ..Default::default() };
            assert_eq!(attitude(&data, &mut ClockOffset::default(), 0.0), None);
        }
    }
}
