//! Where to begin: the clock offsets at which one turn of the camera explains the bearings best. Lever arms do not matter yet.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::fit::Parameters;
use super::{Logs, SEARCH_S, Seen, TargetClock};

/// Offsets are tried this far around the expected one and in such steps, s: first coarsely, for vehicles need some tenths of a second to turn.
const COARSE_S: (f64, f64) = (SEARCH_S, 0.1);
const FINE_S: (f64, f64) = (0.1, 0.02);
/// No more frames than this are asked.
const FRAMES: usize = 400;

/// The turn that explains the bearings, at the best clock offsets.
pub(super) fn from_bearings(logs: &Logs<'_>, seen: &[Seen], near_s: f64) -> Option<Parameters> {
    let asked: Vec<&Seen> = seen.iter().step_by(seen.len().div_ceil(FRAMES)).collect();
    let coarse = best(logs, &asked, [near_s, logs.target_clock.near_s()], COARSE_S)?;
    best(logs, &asked, [coarse.clock_offset_s, coarse.target_clock_offset_s], FINE_S)
}

/// The best of the offsets around two, that of the frames and that of the target's log.
fn best(logs: &Logs<'_>, asked: &[&Seen], around_s: [f64; 2], search_s: (f64, f64)) -> Option<Parameters> {
    let of_target = match logs.target_clock {
        TargetClock::Shared => vec![around_s[1]],
        TargetClock::Own { .. } => steps(around_s[1], search_s).collect(),
    };
    let pairs = steps(around_s[0], search_s)
        .flat_map(|offset_s| of_target.iter().map(move |&target_s| (offset_s, target_s)));
    let tried = pairs.filter_map(|(clock_offset_s, target_clock_offset_s)| {
        let (body_from_camera, misfit) = turn(logs, asked, clock_offset_s, target_clock_offset_s)?;
        let parameters = Parameters {
            clock_offset_s,
            target_clock_offset_s,
            body_from_camera,
            camera_m: Vector3::zeros(),
            airframe_m: Vector3::zeros(),
        };
        Some((misfit, parameters))
    });
    tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, parameters)| parameters)
}

fn steps(around_s: f64, (search_s, step_s): (f64, f64)) -> impl Iterator<Item = f64> {
    let count = (search_s / step_s).round() as i32;
    (-count..=count).map(move |step| around_s + step_s * f64::from(step))
}

/// The rotation body_from_camera between two bundles of directions (Kabsch 1976; Umeyama 1991 for the sign), and one minus the mean
/// cosine of what it leaves.
fn turn(
    logs: &Logs<'_>,
    asked: &[&Seen],
    clock_offset_s: f64,
    target_clock_offset_s: f64,
) -> Option<(UnitQuaternion<f64>, f64)> {
    let (mut sum, mut count) = (Matrix3::zeros(), 0_u32);
    for seen in asked {
        let poses = logs.at(seen.time_s + clock_offset_s, target_clock_offset_s);
        let Some([observer, target]) = poses else { continue };
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
