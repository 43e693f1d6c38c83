//! Covariances as results tell them -> covariances as ROS wants them: six by six, about fixed axes of the header's frame.
//!
//! Results tell an attitude's covariance of a small rotation r in the neighbour's body: camera_from_body = R exp(r) = exp(R r) R, so that
//! about the camera's axes the same rotation is R r, with covariance R S R^T, and with the position p covaries as cov(p, r) R^T.

use nalgebra::{Matrix3 as M3, Quaternion, UnitQuaternion, Vector3 as V};

use crate::ros::{Matrix3, Matrix6};

/// Variance of an angle of which nothing is known, rad^2: that of one evenly spread over the circle.
const UNKNOWN_RAD2: f64 = core::f64::consts::PI * core::f64::consts::PI / 3.0;
/// No number that is told is surer than this, so that no covariance is zero: a micrometre, a microradian.
const LEAST: f64 = 1e-12;

/// The 6x6 of a pose: x, y, z, then turns about fixed x, y, z. `attitude` is camera_from_body as x, y, z, w with its covariance in the body;
/// `cross` the covariance of the position (rows) with that rotation (columns).
#[must_use]
pub fn pose_covariance(
    position_m2: &Matrix3,
    attitude: Option<([f64; 4], &Matrix3)>,
    cross_m_rad: Option<&Matrix3>,
) -> Matrix6 {
    let matrix = |rows: &Matrix3| M3::from_fn(|row, column| rows[row][column]);
    let (turns, cross) = match attitude {
        None => (M3::from_diagonal_element(UNKNOWN_RAD2), M3::zeros()),
        Some(([x, y, z, w], body_rad2)) => {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_rotation_matrix();
            let cross = cross_m_rad.map_or_else(M3::zeros, |cross| matrix(cross) * turn.inverse());
            (turn * matrix(body_rad2) * turn.inverse(), cross)
        }
    };
    let position = matrix(position_m2);
    let mut all = [[0.0; 6]; 6];
    for row in 0..3 {
        for column in 0..3 {
            all[row][column] = position[(row, column)];
            // Rounding leaves the two halves of a product apart: what is told is symmetric to the bit.
            all[row + 3][column + 3] = 0.5 * (turns[(row, column)] + turns[(column, row)]);
            all[row][column + 3] = cross[(row, column)];
            all[column + 3][row] = cross[(row, column)];
        }
        all[row][row] = all[row][row].max(LEAST);
        all[row + 3][row + 3] = all[row + 3][row + 3].max(LEAST);
    }
    all
}

/// The covariance of a unit vector towards a position: what of the position's is across it, over the distance squared. It is of rank 2.
#[must_use]
pub fn bearing_covariance(position_m: [f64; 3], position_m2: &Matrix3) -> Matrix3 {
    let position = V::from(position_m);
    let across = across(&position);
    let seen =
        across * M3::from_fn(|row, column| position_m2[row][column]) * across / position.norm_squared();
    rows(&(seen + across * LEAST))
}

/// The covariance of a unit vector of which only a bound is known: evenly within it.
pub(super) fn bounded_covariance(bearing: [f64; 3], bound_rad: f64) -> Matrix3 {
    // A disc's variance along each axis is a quarter of its radius squared.
    rows(&(across(&V::from(bearing)) * (bound_rad * bound_rad / 4.0).max(LEAST)))
}

/// Takes away what is along a vector.
fn across(along: &V<f64>) -> M3<f64> {
    let ahead = along.try_normalize(0.0).unwrap_or_default();
    M3::identity() - ahead * ahead.transpose()
}

fn rows(matrix: &M3<f64>) -> Matrix3 {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| 0.5 * (matrix[(row, column)] + matrix[(column, row)])))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix6 as M6, Rotation3, Vector6};
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    fn normal6(random: &mut Pcg64) -> Vector6<f64> {
        Vector6::from_fn(|_, _| <StandardNormal as Distribution<f64>>::sample(&StandardNormal, random))
    }

    #[test]
    fn it_is_that_of_many_poses_about_fixed_axes() {
        let mut random = Pcg64::new(3, 5);
        let root = M6::from_fn(|row, column| {
            let size = if row < 3 { 0.1 } else { 0.01 };
            let normal: f64 = StandardNormal.sample(&mut random);
            if column > row { 0.0 } else { size * (normal + if row == column { 2.0 } else { 0.0 }) }
        });
        let told = root * root.transpose();
        let block = |row: usize, column: usize| {
            let part = told.fixed_view::<3, 3>(row, column).into_owned();
            [0, 1, 2].map(|row| [0, 1, 2].map(|column| part[(row, column)]))
        };
        let mean = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.3);
        let xyzw = <[f64; 4]>::from(mean.into_inner().coords);
        let claimed = pose_covariance(&block(0, 0), Some((xyzw, &block(3, 3))), Some(&block(0, 3)));
        let (count, mut seen) = (200_000, M6::zeros());
        for _ in 0..count {
            let off = root * normal6(&mut random);
            let turned = mean.to_rotation_matrix() * Rotation3::new(off.fixed_rows::<3>(3).into_owned());
            // What turns the mean into it, about the camera's own axes.
            let between =
                UnitQuaternion::from_rotation_matrix(&(turned * mean.to_rotation_matrix().inverse()));
            let mut pose = off;
            pose.fixed_rows_mut::<3>(3).copy_from(&between.scaled_axis());
            seen += pose * pose.transpose() / f64::from(count);
        }
        for row in 0..6 {
            for column in 0..6 {
                let scale = (seen[(row, row)] * seen[(column, column)]).sqrt();
                let off = (claimed[row][column] - seen[(row, column)]).abs() / scale;
                assert!(off < 0.015, "{row} {column}: {off}");
                assert!((claimed[row][column] - claimed[column][row]).abs() <= 0.0);
            }
        }
    }

    #[test]
    fn the_covariance_of_a_bearing_is_that_of_many_positions() {
        let (mut random, mean) = (Pcg64::new(1, 1), V::new(1.0, -2.0, 4.0));
        let root = nalgebra::Matrix3::new(0.02, 0.0, 0.0, 0.01, 0.03, 0.0, -0.02, 0.01, 0.05);
        let claimed = bearing_covariance(mean.into(), &rows(&(root * root.transpose())));
        let (count, mut seen) = (200_000, M3::zeros());
        for _ in 0..count {
            let off = (mean + root * normal6(&mut random).fixed_rows::<3>(0)).normalize() - mean.normalize();
            seen += off * off.transpose() / f64::from(count);
        }
        for (row, column) in (0..9).map(|place| (place / 3, place % 3)) {
            let off = (claimed[row][column] - seen[(row, column)]).abs();
            assert!(off < 0.02 * seen.trace(), "{row} {column}: {off}");
        }
    }

    #[test]
    fn nothing_is_surer_than_a_micrometre_and_an_unknown_attitude_is_wide() {
        let covariance = pose_covariance(&[[0.0; 3]; 3], None, None);
        for (axis, row) in covariance.iter().enumerate() {
            assert!(row[axis] > 0.0);
            assert!(axis < 3 || row[axis] > 3.0);
        }
    }
}
