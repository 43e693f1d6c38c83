//! Two cones a' y = 0 through the origin -> the directions where they meet, up to four.
//!
//! A member of their pencil with determinant zero (a cubic in the pencil's parameter) is a pair of planes,
//! and each plane meets the other members in two directions.

use nalgebra::{Matrix3, Vector3};

#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Calls `found` with a vector along each direction where y' A y = y' B y = 0 for symmetric A and B. Pairs of
/// complex directions come as the real one between them. Four calls at most.
pub(super) fn meets(cones: &[Matrix3<f64>; 2], mut found: impl FnMut(Vector3<f64>)) {
    let [a, b] = cones;
    let (adjugate_a, adjugate_b) = (adjugate(a), adjugate(b));
    let cubic = [
        a.column(0).dot(&adjugate_a.column(0)),
        adjugate_a.dot(b),
        adjugate_b.dot(a),
        b.column(0).dot(&adjugate_b.column(0)),
    ];
    // The larger of the outer coefficients leads, so that one root is in [-1, 1].
    let (near, far, root) = if cubic[3].abs() >= cubic[0].abs() {
        (a, b, separate_root(cubic))
    } else {
        (b, a, separate_root([cubic[3], cubic[2], cubic[1], cubic[0]]))
    };
    let degenerate = near + far * root;
    // A member unlike the degenerate one: the root may be huge.
    let other = if root.abs() > 1.0 { near } else { far };
    match Planes::of(&degenerate) {
        Planes::Real(normals) => normals.iter().for_each(|normal| cut(normal, other, &mut found)),
        Planes::Complex { common } => found(common),
    }
}

/// The columns of the adjugate of a symmetric matrix, which is symmetric too.
fn adjugate(m: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [m.column(0), m.column(1), m.column(2)];
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

/// The real root of c0 + c1 r + c2 r^2 + c3 r^3 that is farthest from the mean of the roots, hence from the
/// other two: it stays put where those are double. 0 when the leading coefficient is 0: it is the larger
/// of c0 and c3.
fn separate_root([c0, c1, c2, c3]: [f64; 4]) -> f64 {
    if c3 == 0.0 {
        return 0.0;
    }
    // t^3 + 3 p t + 2 q with r = t - mean.
    let (b, c, d) = (c2 / c3, c1 / c3, c0 / c3);
    let mean = b / 3.0;
    let p = c / 3.0 - mean * mean;
    let q = mean * mean * mean + (d - mean * c) / 2.0;
    let discriminant = q * q + p * p * p;
    let t = if discriminant >= 0.0 {
        let u = libm::cbrt(q.abs() + discriminant.sqrt());
        if u > 0.0 { p / u - u } else { 0.0 }
    } else {
        let third_rad = libm::acos((q.abs() / (-p * (-p).sqrt())).min(1.0)) / 3.0;
        -2.0 * (-p).sqrt() * libm::cos(third_rad)
    };
    let root = t.copysign(-q) - mean;
    let newton = |r: f64| {
        let slope = (3.0 * c3 * r + 2.0 * c2) * r + c1;
        let value = ((c3 * r + c2) * r + c1) * r + c0;
        if slope == 0.0 { r } else { r - value / slope }
    };
    newton(newton(root))
}

/// What a symmetric matrix of rank 2 is as a cone.
enum Planes {
    /// Two planes, by their normals.
    Real([Vector3<f64>; 2]),
    /// Two complex planes: one line in common is real.
    Complex { common: Vector3<f64> },
}

impl Planes {
    /// With N = m n' + n m', the adjugate is -(m x n)(m x n)', and N + [m x n]_x = 2 n m' shows the normals
    /// as a column and a row (J. Richter-Gebert, Perspectives on Projective Geometry, 2011, ch. 11).
    fn of(degenerate: &Matrix3<f64>) -> Self {
        let adjugate = adjugate(degenerate);
        let k = adjugate.diagonal().iamax();
        let column = adjugate.column(k).into_owned();
        if adjugate[(k, k)] > 0.0 {
            return Self::Complex { common: column };
        }
        let length = (-adjugate[(k, k)]).sqrt();
        let common = if length > 0.0 { column / length } else { Vector3::zeros() };
        let product = degenerate + common.cross_matrix();
        let (row, col) = product.iamax_full();
        Self::Real([product.column(col).into_owned(), product.row(row).transpose()])
    }
}

/// The two directions in which the plane with this normal meets the cone.
fn cut(normal: &Vector3<f64>, cone: &Matrix3<f64>, found: &mut impl FnMut(Vector3<f64>)) {
    // The two axes that are least along the normal span the plane without cancellation.
    let k = normal.iamax();
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let mut u = Vector3::zeros();
    let mut v = Vector3::zeros();
    (u[i], u[k]) = (normal[k], -normal[i]);
    (v[j], v[k]) = (normal[k], -normal[j]);
    // a s^2 + 2 b s t + c t^2 = 0 along s u + t v.
    let (a, b, c) = (u.dot(&(cone * u)), u.dot(&(cone * v)), v.dot(&(cone * v)));
    let discriminant = b * b - a * c;
    if discriminant > 0.0 {
        let w = -(b + discriminant.sqrt().copysign(b));
        found(u * w + v * a);
        found(u * c + v * w);
    } else if a.abs() > c.abs() {
        found(v * a - u * b);
    } else {
        found(u * c - v * b);
    }
}
