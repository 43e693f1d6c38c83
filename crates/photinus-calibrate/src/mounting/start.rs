//! A first rotation, from directions alone: positions count as directions from the body's origin, which the camera is near to.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{Known, Observation};

const PASSES: usize = 20;
/// An angle below this counts no more than this one does, rad.
const LEAST_RAD: f64 = 0.01;

/// The rotation body_from_camera of the least sum of angles, by reweighting Wahba's problem, which a singular value
/// decomposition solves (F. L. Markley, 1988).
pub(super) fn rotation(observations: &[Observation]) -> UnitQuaternion<f64> {
    let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = observations
        .iter()
        .map(|seen| {
            let known = match seen.known {
                Known::Direction(direction) => direction.into_inner(),
                Known::Position(position_m) => position_m.try_normalize(0.0).unwrap_or_else(Vector3::zeros),
            };
            (known, *seen.sighted.bearing().vector())
        })
        .collect();
    let mut weights = vec![1.0; pairs.len()];
    let mut rotation = Rotation3::identity();
    for _ in 0..PASSES {
        let weighted =
            pairs.iter().zip(&weights).map(|((known, seen), weight)| known * seen.transpose() * *weight);
        rotation = nearest_rotation(&weighted.sum());
        for ((known, seen), weight) in pairs.iter().zip(&mut weights) {
            let turned = rotation * seen;
            let angle_rad = libm::atan2(turned.cross(known).norm(), turned.dot(known));
            *weight = 1.0 / angle_rad.max(LEAST_RAD);
        }
    }
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// The rotation nearest to a matrix.
pub(crate) fn nearest_rotation(matrix: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = matrix.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Rotation3::identity() };
    let sign = (u.determinant() * v_t.determinant()).signum();
    // The smallest singular value is the last one: it takes the mirror.
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign));
    Rotation3::from_matrix_unchecked(u * mirror * v_t)
}
