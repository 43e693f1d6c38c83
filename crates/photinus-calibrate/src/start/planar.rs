//! The pose of a flat board from bearings, in closed form.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Matrix3, Rotation3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};

use crate::adjust::View;
use crate::lens::Lens;

/// Just short of straight behind.
const FARTHEST_RAD: f64 = 3.1;

/// The pose that turns the flat board into the bearings of a view: the linear solution of v x (H b) = 0, b = (x, y, 1),
/// whose sign is that of v . (H b), so that LEDs past 90 deg are as good as others. `None` when it is not determined.
pub(crate) fn planar_pose(lens: &Lens, board_m: &[Vector3<f64>], view: &View) -> Option<Isometry3<f64>> {
    let size_m = board_m.iter().map(|place| place.norm()).fold(0.0, f64::max);
    let limit_rad = lens.rises_to_rad(FARTHEST_RAD);
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    let mut seen = Vec::new();
    for observation in &view.observations {
        let Some(bearing) = lens.bearing(&observation.pixel, limit_rad) else { continue };
        let place = board_m[observation.led] / size_m;
        let b = Vector3::new(place.x, place.y, 1.0);
        let cross = bearing.cross_matrix();
        for row in 0..3 {
            // the row of v x (H b), with H column by column
            let equation = SVector::<f64, 9>::from_fn(|k, _| cross[(row, k % 3)] * b[k / 3]);
            normal += equation * equation.transpose();
        }
        seen.push((bearing, b));
    }
    if seen.len() < 6 {
        return None;
    }
    let eigen = normal.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let mut h = Matrix3::from_column_slice(eigen.eigenvectors.column(least).as_slice());
    let forward: f64 = seen.iter().map(|(bearing, b)| bearing.dot(&(h * b))).sum();
    if forward < 0.0 {
        h = -h;
    }
    let scale = 0.5 * (h.column(0).norm() + h.column(1).norm());
    if scale.is_nan() || scale <= 1e-9 {
        return None;
    }
    h /= scale;
    let (x, y) = (h.column(0).into_owned(), h.column(1).into_owned());
    let svd = Matrix3::from_columns(&[x, y, x.cross(&y)]).svd(true, true);
    let (u, v) = (svd.u?, svd.v_t?);
    let sign = (u * v).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v;
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    let shift = h.column(2) * size_m;
    let pose = Isometry3::from_parts(Translation3::from(shift), rotation);
    pose.translation.vector.iter().all(|x| x.is_finite()).then_some(pose)
}

/// The other pose in which a flat board looks nearly the same: tilted the other way about the line of sight.
pub(crate) fn other_fold(pose: &Isometry3<f64>) -> Option<Isometry3<f64>> {
    let sight = nalgebra::Unit::try_new(pose.translation.vector, 1e-9)?;
    let about_sight = UnitQuaternion::from_axis_angle(&sight, PI);
    let about_board = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI);
    Some(Isometry3::from_parts(pose.translation, about_sight * pose.rotation * about_board))
}
