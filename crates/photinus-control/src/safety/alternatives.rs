//! What is wanted -> what may be done instead, to be tried in this order.

use nalgebra::Vector3;

/// Directions of a cube's faces, edges and corners.
const DIRECTIONS: i32 = 27;
const SIZES: [f64; 3] = [1.0, 0.5, 0.2];

/// Accelerations other than `wanted`, up to `most_m_s2`: on the way from it to braking, and in every direction.
pub(super) fn alternatives(
    wanted: Vector3<f64>,
    brake: Vector3<f64>,
    most_m_s2: f64,
) -> impl Iterator<Item = Vector3<f64>> {
    let towards_braking = (1..8).map(move |k| wanted + (brake - wanted) * (f64::from(k) / 8.0));
    let around = (0..DIRECTIONS).filter(|k| *k != DIRECTIONS / 2).flat_map(move |k| {
        let [x, y, z] = [k % 3, k / 3 % 3, k / 9].map(|step| f64::from(step - 1));
        let direction = Vector3::new(x, y, z).normalize();
        SIZES.into_iter().map(move |size| direction * (size * most_m_s2))
    });
    towards_braking.chain(around).chain([Vector3::zeros()])
}
