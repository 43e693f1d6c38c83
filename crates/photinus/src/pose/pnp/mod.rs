//! Four and more bearings and the body points they belong to -> the best pose.
//!
//! Four points far from one another make four triangles. The triangle with the [`p3p`](super::p3p()) pose
//! that explains all bearings best gives the starts, all of its poses: a flat far target and its mirror image
//! look nearly alike, and noise may hide which is better until both are refined, on the sphere. The error of a
//! bearing is the chord to where the point is seen, |p/|p| - f|: the angle for small errors, and largest, not
//! zero, for the opposite direction.

#[cfg(test)]
mod tests;

use core::array;

use nalgebra::{Isometry3, Matrix3, Matrix6, Translation3, UnitQuaternion, Vector3, Vector6};

use super::p3p::{P3pSolutions, p3p_with_near_misses};
use crate::solve::{Descent, descend, step};

const MAX_STEPS: u32 = 30;

/// The pose `camera_from_body` with the least sum of squared errors between `bearings` (unit vectors, camera
/// frame, any direction) and the directions to `points_m` (body frame, m), to which they belong in their
/// order.
///
/// Works for points in a plane and in space. `None` for fewer than four points, lists of different lengths,
/// points on one line, equal bearings, or numbers that are not finite.
pub fn pnp(bearings: &[Vector3<f64>], points_m: &[Vector3<f64>]) -> Option<Isometry3<f64>> {
    if bearings.len() < 4 || bearings.len() != points_m.len() {
        return None;
    }
    let view = View::new(bearings, points_m);
    let mut best = None;
    let mut least = f64::INFINITY;
    for start in view.starts().iter() {
        if let Some((pose, cost)) = descend(&view, *start, MAX_STEPS)
            && cost < least
        {
            (best, least) = (Some(pose), cost);
        }
    }
    best
}

/// Bearings and the points they belong to.
struct View<'a> {
    bearings: &'a [Vector3<f64>],
    points_m: &'a [Vector3<f64>],
    /// What turns are about, which keeps them apart from shifts.
    centroid_m: Vector3<f64>,
}

impl<'a> View<'a> {
    fn new(bearings: &'a [Vector3<f64>], points_m: &'a [Vector3<f64>]) -> Self {
        let centroid_m = points_m.iter().sum::<Vector3<f64>>() / points_m.len() as f64;
        Self { bearings, points_m, centroid_m }
    }

    /// The poses of the best of the triangles between four far points.
    fn starts(&self) -> P3pSolutions {
        let corners = self.corners();
        let mut best = P3pSolutions::none();
        let mut least = f64::INFINITY;
        for left_out in 0..4 {
            let triangle: [usize; 3] = array::from_fn(|i| corners[(left_out + 1 + i) % 4]);
            let poses = p3p_with_near_misses(
                &triangle.map(|i| self.bearings[i]),
                &triangle.map(|i| self.points_m[i]),
            );
            let cost = poses.iter().map(|pose| self.chords(pose)).fold(f64::INFINITY, f64::min);
            if cost < least {
                (best, least) = (poses, cost);
            }
        }
        best
    }

    /// Four points far apart: the farthest from the middle, the farthest from that, the one that makes the
    /// largest triangle with both, and the one farthest from the three.
    fn corners(&self) -> [usize; 4] {
        let points = self.points_m;
        let a = self.largest(|p| (p - self.centroid_m).norm_squared());
        let b = self.largest(|p| (p - points[a]).norm_squared());
        let c = self.largest(|p| (p - points[a]).cross(&(points[b] - points[a])).norm_squared());
        let nearest = |p: &Vector3<f64>, corners: [usize; 3]| {
            corners.map(|i| (p - points[i]).norm_squared()).into_iter().fold(f64::INFINITY, f64::min)
        };
        let d = self.largest(|p| nearest(p, [a, b, c]));
        [a, b, c, d]
    }

    fn largest(&self, measure: impl Fn(&Vector3<f64>) -> f64) -> usize {
        let mut best = (0, f64::NEG_INFINITY);
        for (i, point) in self.points_m.iter().enumerate() {
            let size = measure(point);
            if size > best.1 {
                best = (i, size);
            }
        }
        best.0
    }

    /// Sum of the squared chords between the bearings and where the pose shows the points.
    fn chords(&self, pose: &Isometry3<f64>) -> f64 {
        let chord = |(bearing, point_m): (&Vector3<f64>, &Vector3<f64>)| {
            let p = pose.rotation * point_m + pose.translation.vector;
            (p / p.norm() - bearing).norm_squared()
        };
        self.bearings.iter().zip(self.points_m).map(chord).sum()
    }

    /// J'J and J'e of the chords e by a turn (rad) about the centroid and a shift (m), both in the camera
    /// frame. With p the point, u = p/|p| and r from the centroid to the point, de = (I - u u')/|p| dp and
    /// dp = turn x r + shift.
    fn normal_equations(&self, pose: &Isometry3<f64>) -> (Matrix6<f64>, Vector6<f64>) {
        let (mut by_turn, mut mixed, mut by_shift) = (Matrix3::zeros(), Matrix3::zeros(), Matrix3::zeros());
        let (mut turn, mut shift) = (Vector3::zeros(), Vector3::zeros());
        let centre = pose.rotation * self.centroid_m + pose.translation.vector;
        for (bearing, point_m) in self.bearings.iter().zip(self.points_m) {
            let arm = pose.rotation * (point_m - self.centroid_m);
            let p = centre + arm;
            let distance = p.norm();
            let u = p / distance;
            let weight = (Matrix3::identity() - u * u.transpose()) / (distance * distance);
            let pull = (u * u.dot(bearing) - bearing) / distance;
            let cross = arm.cross_matrix();
            let turned = cross * weight;
            by_turn -= turned * cross;
            mixed += turned;
            by_shift += weight;
            turn += arm.cross(&pull);
            shift += pull;
        }
        let mut normal = Matrix6::zeros();
        normal.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_turn);
        normal.fixed_view_mut::<3, 3>(0, 3).copy_from(&mixed);
        normal.fixed_view_mut::<3, 3>(3, 0).copy_from(&mixed.transpose());
        normal.fixed_view_mut::<3, 3>(3, 3).copy_from(&by_shift);
        (normal, Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z))
    }
}

impl Descent for View<'_> {
    type Place = Isometry3<f64>;
    type Normal = (Matrix6<f64>, Vector6<f64>);

    fn cost(&self, pose: &Isometry3<f64>) -> Option<f64> {
        Some(self.chords(pose)).filter(|cost| cost.is_finite())
    }

    fn normal(&self, pose: &Isometry3<f64>) -> Option<Self::Normal> {
        Some(self.normal_equations(pose))
    }

    fn stepped(
        &self,
        pose: &Isometry3<f64>,
        (normal, gradient): &Self::Normal,
        damping: f64,
    ) -> Option<Isometry3<f64>> {
        step(normal, &-gradient, damping).map(|step| turned(pose, &self.centroid_m, &step))
    }
}

/// The pose after a turn about the body's point `centroid_m` and a shift, both in the camera frame.
fn turned(pose: &Isometry3<f64>, centroid_m: &Vector3<f64>, step: &Vector6<f64>) -> Isometry3<f64> {
    let [turn, shift] = [0, 3].map(|i| step.fixed_rows::<3>(i).into_owned());
    let mut rotation = UnitQuaternion::from_scaled_axis(turn) * pose.rotation;
    rotation.renormalize();
    let centre = pose.rotation * centroid_m + pose.translation.vector + shift;
    Isometry3::from_parts(Translation3::from(centre - rotation * centroid_m), rotation)
}
