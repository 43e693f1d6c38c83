//! Three bearings and the body points they belong to -> every pose that explains them, up to four.
//!
//! The depths come first (`depths`), from the angles between the bearings and the sides of the triangle; the
//! pose follows from laying the triangle of the body onto the triangle in front of the camera. Only angles
//! between bearings count, so that those past 90 deg from the axis are like any other.

mod conics;
mod depths;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use depths::{DepthEquations, Depths};

/// A triangle whose height is below this share of its longest side has no plane.
const MIN_FLATNESS: f64 = 1e-12;

/// The poses `camera_from_body` that explain three bearings: none to four, in no particular order but always
/// the same.
#[derive(Clone, Debug, PartialEq)]
pub struct P3pSolutions {
    poses: [Isometry3<f64>; 4],
    count: usize,
}

impl P3pSolutions {
    pub(super) fn none() -> Self {
        Self { poses: [Isometry3::identity(); 4], count: 0 }
    }

    fn push(&mut self, pose: Isometry3<f64>) {
        self.poses[self.count] = pose;
        self.count += 1;
    }

    /// The solutions, one after the other.
    pub fn iter(&self) -> core::slice::Iter<'_, Isometry3<f64>> {
        self.poses[..self.count].iter()
    }
}

/// Every pose `camera_from_body` that shows `points_m` (body frame, m) at `bearings` (unit vectors, camera
/// frame, any direction).
///
/// Each solution reproduces the bearings to rounding. Where two solutions meet (the camera on the cylinder
/// that stands on the circle through the points) they come as one, accurate to the root of rounding; where
/// three meet, one in fifty is missed. Bearings with noise may have none. None come from points on one line,
/// three equal bearings, or numbers that are not finite.
pub fn p3p(bearings: &[Vector3<f64>; 3], points_m: &[Vector3<f64>; 3]) -> P3pSolutions {
    poses(bearings, points_m, Depths::is_exact)
}

/// The solutions of [`p3p`], and the nearest real poses in place of those that noise has made complex.
pub(crate) fn p3p_with_near_misses(
    bearings: &[Vector3<f64>; 3],
    points_m: &[Vector3<f64>; 3],
) -> P3pSolutions {
    poses(bearings, points_m, |_| true)
}

fn poses(
    bearings: &[Vector3<f64>; 3],
    points_m: &[Vector3<f64>; 3],
    accept: impl Fn(&Depths) -> bool,
) -> P3pSolutions {
    let mut solutions = P3pSolutions::none();
    let edges_m = [points_m[1] - points_m[0], points_m[2] - points_m[0]];
    let (Some(body), Some(equations)) = (triangle_axes(&edges_m), DepthEquations::new(bearings, &edges_m))
    else {
        return solutions;
    };
    equations.solve(|depths| {
        if accept(&depths)
            && let Some(pose) = lay(&body, &points_m[0], bearings, &depths)
        {
            solutions.push(pose);
        }
    });
    solutions
}

/// The pose that lays the triangle with these axes and first corner onto the bearings at their depths.
fn lay(
    body: &Matrix3<f64>,
    first_m: &Vector3<f64>,
    bearings: &[Vector3<f64>; 3],
    depths: &Depths,
) -> Option<Isometry3<f64>> {
    let Depths { first_m: depth_m, beyond_m, .. } = *depths;
    // Differences of bearings first: far points differ by little.
    let edge = |i: usize| bearings[i] * beyond_m[i - 1] + (bearings[i] - bearings[0]) * depth_m;
    let camera = triangle_axes(&[edge(1), edge(2)])?;
    let rotation = Rotation3::from_matrix_unchecked(camera * body.transpose());
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    let translation_m = bearings[0] * depth_m - rotation * first_m;
    Some(Isometry3::from_parts(Translation3::from(translation_m), rotation))
}

/// Orthonormal axes of a triangle, given its edges from the first corner: along the first edge, in the plane
/// of both, and normal to it. `None` when the corners are on one line.
fn triangle_axes(edges: &[Vector3<f64>; 2]) -> Option<Matrix3<f64>> {
    let normal = edges[0].cross(&edges[1]);
    let area = normal.norm();
    let longest_square = edges[0].norm_squared().max(edges[1].norm_squared());
    (area > MIN_FLATNESS * longest_square && area.is_finite()).then(|| {
        let x = edges[0].normalize();
        let z = normal / area;
        Matrix3::from_columns(&[x, z.cross(&x), z])
    })
}
