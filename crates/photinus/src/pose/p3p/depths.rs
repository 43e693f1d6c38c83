//! Angles between three bearings and sides of a triangle -> the three depths.
//!
//! With l_i the depth along the unit bearing f_i, the side ij says
//!
//! ```text
//! |l_i f_i - l_j f_j|^2 = (l_i - l_j)^2 + c_ij l_i l_j = s_ij^2,    c_ij = |f_i - f_j|^2.
//! ```
//!
//! The unknowns are y = (x, p, q) with l_1 = x / e, l_2 = l_1 + p, l_3 = l_1 + q and e^2 the largest c_ij: a
//! far target, whose bearings hardly differ, then has equations with coefficients near one, where those in
//! the depths themselves cancel. Each side is a quadric y' Q_ij y = s_ij^2; two differences that lose the
//! right-hand side are two cones, and the four directions where they meet, scaled, are the solutions. The way
//! through a degenerate member of the cones' pencil is that of M. Persson and K. Nordberg, "Lambda Twist",
//! ECCV 2018; the unknowns and the splitting (see [`super::conics`]) differ.

use nalgebra::{Matrix3, Vector3};

use super::conics::meets;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Newton steps that bring a start of a few digits to rounding: one or two, more where solutions meet.
const POLISHING_STEPS: usize = 12;
/// A residual that no further step improves, in the square of the longest side.
const ROUNDING: f64 = 5e-16;
/// Solutions are one when they differ by less than this share: two that meet are no better known.
const SAME: f64 = 1e-7;
/// Largest residual of an exact solution, in the square of the longest side.
const EXACT: f64 = 1e-12;

/// Depths of the three points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    /// Depth of the first point, m.
    pub(super) first_m: f64,
    /// How much deeper the second and the third are, m.
    pub(super) beyond_m: [f64; 2],
    residual: f64,
}

impl Depths {
    /// Whether the depths solve the equations: near misses, where noise leaves no solution, do not.
    pub(super) fn is_exact(&self) -> bool {
        self.residual <= EXACT
    }
}

/// The three equations in y = (x, p, q), lengths in units of the longest side.
pub(super) struct DepthEquations {
    quadrics: [Matrix3<f64>; 3],
    squares: Vector3<f64>,
    unit_m: f64,
    /// e: x in units of the depth.
    spread: f64,
}

impl DepthEquations {
    /// The equations of the sides 12, 13 and 23; `edges_m` are the sides 12 and 13. `None` when the bearings
    /// are all equal, a side is zero or a number is not finite.
    pub(super) fn new(bearings: &[Vector3<f64>; 3], edges_m: &[Vector3<f64>; 2]) -> Option<Self> {
        let [f1, f2, f3] = bearings;
        let chords =
            Vector3::new((f2 - f1).norm_squared(), (f3 - f1).norm_squared(), (f3 - f2).norm_squared());
        let squares_m2 = Vector3::new(
            edges_m[0].norm_squared(),
            edges_m[1].norm_squared(),
            (edges_m[1] - edges_m[0]).norm_squared(),
        );
        let spread = chords.max().sqrt();
        let unit_m = squares_m2.max().sqrt();
        if !(spread > 0.0 && squares_m2.min() > 0.0 && (spread + chords.sum() + squares_m2.sum()).is_finite())
        {
            return None;
        }
        let c = chords / (spread * spread);
        // Half of c_ij in terms linear in x.
        let h = chords / (2.0 * spread);
        let across = chords.z / 2.0 - 1.0;
        #[rustfmt::skip]
        let quadrics = [
            Matrix3::new(c.x, h.x, 0.0,  h.x, 1.0, 0.0,  0.0, 0.0, 0.0),
            Matrix3::new(c.y, 0.0, h.y,  0.0, 0.0, 0.0,  h.y, 0.0, 1.0),
            Matrix3::new(c.z, h.z, h.z,  h.z, 1.0, across,  h.z, across, 1.0),
        ];
        Some(Self { quadrics, squares: squares_m2 / (unit_m * unit_m), unit_m, spread })
    }

    /// Calls `found` with each solution in front of the camera, and with the nearest real depths in place of
    /// solutions that are complex: four times at most.
    pub(super) fn solve(&self, mut found: impl FnMut(Depths)) {
        let [q12, q13, q23] = &self.quadrics;
        let [s12, s13, s23] = self.squares.into();
        let cones = [q12 * s23 - q23 * s12, q13 * s23 - q23 * s13];
        let sum = q12 + q13 + q23;
        let mut known = [Vector3::zeros(); 4];
        let mut count = 0;
        meets(&cones, |direction| {
            let length_square = self.squares.sum() / direction.dot(&(sum * direction));
            let scale = length_square.sqrt().copysign(direction.x);
            let (y, residual) = self.polished(direction * scale);
            // A complex pair may have been polished into a solution that has its own turn.
            if residual <= EXACT {
                if known[..count].iter().any(|other| (y - other).amax() < SAME * y.amax()) {
                    return;
                }
                (known[count], count) = (y, count + 1);
            }
            let first = y.x / self.spread;
            // A camera on a point, but for rounding, does not see it.
            if [first, first + y.y, first + y.z].iter().all(|&depth| depth > EXACT) {
                let beyond_m = [y.y * self.unit_m, y.z * self.unit_m];
                found(Depths { first_m: first * self.unit_m, beyond_m, residual });
            }
        });
    }

    /// Newton's method: the best point that it comes by, and the residual there.
    fn polished(&self, start: Vector3<f64>) -> (Vector3<f64>, f64) {
        let (mut y, (mut error, mut jacobian)) = (start, self.linearised(&start));
        let mut best = (y, error.norm());
        for _ in 0..POLISHING_STEPS {
            if error.norm() <= ROUNDING {
                break;
            }
            let Some(inverse) = jacobian.try_inverse() else { break };
            y -= inverse * error;
            (error, jacobian) = self.linearised(&y);
            if error.norm() < best.1 {
                best = (y, error.norm());
            }
        }
        best
    }

    /// The errors of the three equations and their derivatives by y.
    fn linearised(&self, y: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let [a, b, c] = self.quadrics.map(|quadric| quadric * y);
        let error = Vector3::new(a.dot(y), b.dot(y), c.dot(y)) - self.squares;
        let jacobian = Matrix3::from_columns(&[a, b, c]).transpose() * 2.0;
        (error, jacobian)
    }
}
