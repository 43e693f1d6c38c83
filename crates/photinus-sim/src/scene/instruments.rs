//! What the observer measures of itself, and what goes wrong with its recording.

use photinus_io::Result;

use super::read::Reader;
use super::table::{GravityTable, GyroTable, OdometryTable, RecordingTable};
use crate::instruments::{Gravity, Gyro, Odometry};
use crate::recording::Recording;

impl Reader<'_> {
    pub(super) fn gyro(&self, table: &GyroTable) -> Result<Gyro> {
        let check = &self.check;
        let rate_rad_s = |name: &str, value| check.within(&format!("gyro.{name}"), value, (0.0, 100.0));
        Ok(Gyro {
            rate_hz: check.rate("gyro.rate_hz", table.rate_hz)?,
            noise_rad_s: rate_rad_s("noise_rad_s", table.noise_rad_s)?,
            bias_rad_s: rate_rad_s("bias_rad_s", table.bias_rad_s)?,
            bias_walk_rad_s: rate_rad_s("bias_walk_rad_s", table.bias_walk_rad_s)?,
        })
    }

    pub(super) fn gravity(&self, table: &GravityTable) -> Result<Gravity> {
        let angle = |name: &str, value_deg: f64| {
            self.check.within(&format!("gravity.{name}"), value_deg, (0.0, 90.0)).map(f64::to_radians)
        };
        Ok(Gravity {
            noise_rad: angle("noise_deg", table.noise_deg)?,
            bias_rad: angle("bias_deg", table.bias_deg)?,
        })
    }

    pub(super) fn odometry(&self, table: &OdometryTable) -> Result<Odometry> {
        let check = &self.check;
        let within = |name: &str, value, most| check.within(&format!("odometry.{name}"), value, (0.0, most));
        Ok(Odometry {
            rate_hz: check.rate("odometry.rate_hz", table.rate_hz)?,
            place_walk_m: within("place_walk_m", table.place_walk_m, 100.0)?,
            heading_walk_rad: within("heading_walk_deg", table.heading_walk_deg, 180.0)?.to_radians(),
            tilt_noise_rad: within("tilt_noise_deg", table.tilt_noise_deg, 90.0)?.to_radians(),
            velocity_noise_m_s: within("velocity_noise_m_s", table.velocity_noise_m_s, 100.0)?,
        })
    }

    /// Frames that are late must not come after the next one.
    pub(super) fn recording(&self, table: &RecordingTable, rate_hz: f64) -> Result<Recording> {
        let check = &self.check;
        Ok(Recording {
            lost: check.share("recording.lost", table.lost)?,
            late: check.share("recording.late", table.late)?,
            late_by_s: check.within("recording.late_by_s", table.late_by_s, (0.0, 0.999 / rate_hz))?,
            swapped: check.share("recording.swapped", table.swapped)?,
        })
    }
}
