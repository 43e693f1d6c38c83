//! Two directions -> the angle between them, or how it compares with a limit, which mostly needs no arc tangent.

use core::cmp::Ordering;

use nalgebra::{UnitVector3, Vector3};

/// Up to a right angle an arc is longer than its chord by this factor, squared, at the most: (pi / 2)^2 / 2.
const ARC_OVER_CHORD_SQUARED: f64 = 1.2338;
/// What squares are off by.
const ROUNDING: f64 = 1e-12;

/// Accurate from 0 to pi.
pub(super) fn angle_rad(a: &UnitVector3<f64>, b: &UnitVector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// How the angle between two directions compares with a limit; `None` where something is no number.
pub(super) fn compare(a: &UnitVector3<f64>, b: &UnitVector3<f64>, limit_rad: f64) -> Option<Ordering> {
    if limit_rad > 0.0 {
        let (chord_squared, limit_squared) = (2.0 - 2.0 * a.dot(b), limit_rad * limit_rad);
        if chord_squared > limit_squared + ROUNDING {
            return Some(Ordering::Greater);
        }
        let is_acute = chord_squared < 2.0 - ROUNDING;
        if is_acute && chord_squared * ARC_OVER_CHORD_SQUARED + ROUNDING < limit_squared {
            return Some(Ordering::Less);
        }
    }
    angle_rad(a, b).partial_cmp(&limit_rad)
}

/// The angle between a direction and the farthest of some others, rad.
pub(super) fn widest_rad(axis: &UnitVector3<f64>, others: &[UnitVector3<f64>]) -> f64 {
    let farthest = others.iter().min_by(|a, b| Vector3::dot(a, axis).total_cmp(&b.dot(axis)));
    farthest.map_or(0.0, |other| angle_rad(other, axis))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = UnitVector3<f64>> {
        let part = -1.0..1.0_f64;
        [part.clone(), part.clone(), part]
            .prop_map(Vector3::from)
            .prop_filter("has a direction", |vector| vector.norm() > 1e-3)
            .prop_map(UnitVector3::new_normalize)
    }

    proptest! {
        #[test]
        fn an_angle_compares_as_it_is(a in direction(), b in direction(), limit in -0.5..4.0_f64, off in -1e-7..1e-7_f64) {
            let angle = angle_rad(&a, &b);
            prop_assert_eq!(compare(&a, &b, limit), angle.partial_cmp(&limit));
            // and where it is near
            prop_assert_eq!(compare(&a, &b, angle + off), angle.partial_cmp(&(angle + off)));
            prop_assert_eq!(compare(&a, &a, 1e-9 * limit), angle_rad(&a, &a).partial_cmp(&(1e-9 * limit)));
        }

        #[test]
        fn the_widest_is_the_widest(a in direction(), others in proptest::collection::vec(direction(), 1..5)) {
            let widest = others.iter().map(|other| angle_rad(other, &a)).fold(0.0, f64::max);
            prop_assert!((widest_rad(&a, &others) - widest).abs() < 1e-7);
        }
    }

    #[test]
    fn what_is_no_number_compares_with_nothing() {
        let nowhere = UnitVector3::new_unchecked(Vector3::repeat(f64::NAN));
        let x = Vector3::x_axis();
        assert_eq!(compare(&x, &nowhere, 1.0), None);
        assert_eq!(compare(&x, &x, f64::NAN), None);
    }
}
