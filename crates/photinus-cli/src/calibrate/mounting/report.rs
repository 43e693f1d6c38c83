//! What was found, to read.

use std::fmt;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use photinus_calibrate::mounting::Mounting;
use photinus_io::calibration::KnownSighting;

/// The text for the terminal.
pub(super) struct Told<'a> {
    pub(super) found: &'a Mounting,
    pub(super) rows: &'a [KnownSighting],
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, rows } = self;
        let [yaw, pitch, roll] = angles_deg(&found.body_from_camera);
        let sigma = sigmas(&found.rotation_covariance_rad2).map(f64::to_degrees);
        writeln!(f, "rotation   yaw {yaw:.3}°, pitch {pitch:.3}°, roll {roll:.3}°")?;
        writeln!(
            f,
            "           known to {:.3}° about the body's x, {:.3}° about y, {:.3}° about z",
            sigma.x, sigma.y, sigma.z
        )?;
        if let Some((centre_m, covariance_m2)) = found.centre {
            let sigma_m = sigmas(&covariance_m2);
            writeln!(
                f,
                "place      {:.4} ± {:.4}, {:.4} ± {:.4}, {:.4} ± {:.4} m",
                centre_m.x, sigma_m.x, centre_m.y, sigma_m.y, centre_m.z, sigma_m.z
            )?;
        }
        let is_used = |index: &usize| found.outliers.binary_search(index).is_err();
        let used: Vec<f64> =
            (0..rows.len()).filter(is_used).map(|index| residual_px(found, rows, index)).collect();
        let mean_px = used.iter().sum::<f64>() / used.len() as f64;
        let most_px = used.iter().copied().fold(0.0, f64::max);
        write!(f, "residuals  mean {mean_px:.3} px, largest {most_px:.3} px, of {} rows", used.len())?;
        for &index in &found.outliers {
            let off_px = residual_px(found, rows, index);
            write!(
                f,
                "\nnot used   line {}: {off_px:.1} px off, too far for the scatter of the others",
                rows[index].line
            )?;
        }
        Ok(())
    }
}

fn residual_px(found: &Mounting, rows: &[KnownSighting], index: usize) -> f64 {
    found.residuals[index] * rows[index].sigma_px.unwrap_or(super::SIGMA_PX)
}

/// The head of the file: what stands in it, for a person and for a scene.
pub(super) fn comment(found: &Mounting) -> String {
    let [yaw, pitch, roll] = angles_deg(&found.body_from_camera);
    format!(
        "# photinus calibrate mounting: {} observations, {} not used. The rotation is body_from_camera.\n\
         # As a scene says it: yaw_deg = {yaw:.4}, pitch_deg = {pitch:.4}, roll_deg = {roll:.4}\n",
        found.residuals.len(),
        found.outliers.len()
    )
}

fn sigmas(covariance: &Matrix3<f64>) -> Vector3<f64> {
    covariance.diagonal().map(f64::sqrt)
}

/// Yaw, pitch and roll from a camera that looks forward and stands upright, in the order in which scenes turn it, deg.
fn angles_deg(body_from_camera: &UnitQuaternion<f64>) -> [f64; 3] {
    let level = Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
    let turned = body_from_camera.to_rotation_matrix() * level.inverse();
    let m = turned.matrix();
    let yaw = libm::atan2(m[(1, 0)], m[(0, 0)]);
    let pitch = libm::atan2(-m[(2, 0)], libm::hypot(m[(0, 0)], m[(1, 0)]));
    let roll = libm::atan2(m[(2, 1)], m[(2, 2)]);
    [yaw, pitch, roll].map(f64::to_degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_that_a_scene_turns_a_camera_by() {
        let looks_left = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(
            Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0),
        ));
        let [yaw, pitch, roll] = angles_deg(&looks_left);
        assert!((yaw - 90.0).abs() < 1e-9 && pitch.abs() < 1e-9 && roll.abs() < 1e-9, "{yaw} {pitch} {roll}");
        let about_y = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.3, 0.0));
        let level = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::new(
            0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0,
        )));
        let [yaw, pitch, roll] = angles_deg(&(about_y * level));
        assert!(yaw.abs() < 1e-9 && (pitch - 0.3_f64.to_degrees()).abs() < 1e-9 && roll.abs() < 1e-9);
    }
}
