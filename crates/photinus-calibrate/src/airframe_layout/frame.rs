//! What bearings cannot tell: origin, axes and scale. The layout is laid over the nominal one; its covariance is that of a layout laid
//! over in this way.

use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};

use super::adjust::Adjustment;
use crate::mounting::nearest_rotation;

/// Lays the `placed` LEDs over the nominal ones, with the least squares of what is left; with the scale too, unless that is known.
pub(super) fn align(
    adjustment: &mut Adjustment,
    nominal_m: &[Vector3<f64>],
    placed: &[usize],
    has_scale: bool,
) {
    let mean = |positions_m: &[Vector3<f64>]| {
        placed.iter().map(|&led| positions_m[led]).sum::<Vector3<f64>>() / placed.len() as f64
    };
    let (found_mean_m, nominal_mean_m) = (mean(&adjustment.leds_m), mean(nominal_m));
    let (mut product, mut square) = (Matrix3::zeros(), 0.0);
    for &led in placed {
        let from_mean_m = adjustment.leds_m[led] - found_mean_m;
        product += (nominal_m[led] - nominal_mean_m) * from_mean_m.transpose();
        square += from_mean_m.norm_squared();
    }
    let rotation = nearest_rotation(&product);
    let scale = if has_scale { 1.0 } else { (rotation.inverse().matrix() * product).trace() / square };
    let turn = UnitQuaternion::from_rotation_matrix(&rotation);
    let lay = |position_m: &mut Vector3<f64>| {
        *position_m = nominal_mean_m + turn * (*position_m - found_mean_m) * scale;
    };
    adjustment.leds_m.iter_mut().for_each(lay);
    for pose in adjustment.poses.iter_mut().flatten() {
        pose.body_from_camera = turn * pose.body_from_camera;
        lay(&mut pose.centre_m);
    }
}

/// What stays true, to first order, of a layout laid over the nominal one: the means agree, the sum of cross products of what is
/// found and nominal vanishes, and so does what the scale could still gain. A row each, of about unit length.
pub(super) fn constraints(
    adjustment: &Adjustment,
    nominal_m: &[Vector3<f64>],
    placed: &[usize],
    has_scale: bool,
) -> DMatrix<f64> {
    let count = placed.len() as f64;
    let nominal_mean_m = placed.iter().map(|&led| nominal_m[led]).sum::<Vector3<f64>>() / count;
    let from_mean_m = |led: usize| nominal_m[led] - nominal_mean_m;
    let size_m = placed.iter().map(|&led| from_mean_m(led).norm_squared()).sum::<f64>().sqrt();
    let mut rows = DMatrix::zeros(if has_scale { 6 } else { 7 }, 3 * placed.len());
    for (place, &led) in placed.iter().enumerate() {
        let nominal = from_mean_m(led) / size_m;
        rows.fixed_view_mut::<3, 3>(0, 3 * place).copy_from(&(Matrix3::identity() / count.sqrt()));
        rows.fixed_view_mut::<3, 3>(3, 3 * place).copy_from(&nominal.cross_matrix());
        if !has_scale {
            let found = (adjustment.leds_m[led] - nominal_mean_m) / size_m;
            rows.fixed_view_mut::<1, 3>(6, 3 * place).copy_from(&(found * 2.0 - nominal).transpose());
        }
    }
    rows
}
