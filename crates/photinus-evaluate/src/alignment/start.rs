//! Where to begin: the clock offset at which one turn of the camera explains the bearings best. Lever arms do not matter yet.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::fit::Parameters;
use super::{Logs, Seen};

/// Offsets are tried this far around the expected one, s.
const SEARCH_S: f64 = 2.0;
const STEP_S: f64 = 0.02;
/// No more frames than this are asked.
const FRAMES: usize = 400;

/// The turn that explains the bearings, at the best clock offset.
pub(super) fn from_bearings(logs: &Logs<'_>, seen: &[Seen], near_s: f64) -> Option<Parameters> {
    let asked: Vec<&Seen> = seen.iter().step_by(seen.len().div_ceil(FRAMES)).collect();
    let steps = (SEARCH_S / STEP_S) as i32;
    let tried = (-steps..=steps).filter_map(|step| {
        let offset_s = near_s + STEP_S * f64::from(step);
        let (turn, misfit) = turn(logs, &asked, offset_s)?;
        Some((misfit, offset_s, turn))
    });
    let (_, clock_offset_s, body_from_camera) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Parameters {
        clock_offset_s,
        body_from_camera,
        camera_m: Vector3::zeros(),
        airframe_m: Vector3::zeros(),
    })
}

/// The rotation body_from_camera between two bundles of directions (Kabsch 1976; Umeyama 1991 for the sign), and one minus the mean
/// cosine of what it leaves.
fn turn(logs: &Logs<'_>, asked: &[&Seen], offset_s: f64) -> Option<(UnitQuaternion<f64>, f64)> {
    let (mut sum, mut count) = (Matrix3::zeros(), 0_u32);
    for seen in asked {
        let Some([observer, target]) = logs.at(seen.time_s + offset_s) else { continue };
        let in_body = observer.inv_mul(&target).translation.vector.try_normalize(1e-6)?;
        let in_camera = seen.neighbours.first()?.0.try_normalize(1e-6)?;
        sum += in_body * in_camera.transpose();
        count += 1;
    }
    if (count as usize) < asked.len() / 2 {
        return None;
    }
    let svd = sum.svd(true, true);
    let (u, v) = (svd.u?, svd.v_t?);
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
    let rotation = u * sign * v;
    let cosine = (rotation.transpose() * sum).trace() / f64::from(count);
    Some((UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation)), 1.0 - cosine))
}
