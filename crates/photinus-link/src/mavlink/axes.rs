//! Axes of ROS and Photinus -> axes of autopilots.
//!
//! Body: forward, left, up (FLU) -> forward, right, down (FRD). World: east, north, up (ENU) -> north, east, down (NED). Each is a half
//! turn, and so its own inverse.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// A vector or point in FLU -> FRD, or back.
#[must_use]
pub fn frd(flu: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(flu.x, -flu.y, -flu.z)
}

/// A vector or point in ENU -> NED, or back.
#[must_use]
pub fn ned(enu: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(enu.y, enu.x, -enu.z)
}

/// A covariance in FLU -> FRD, or back.
#[must_use]
pub fn frd_covariance(flu: &Matrix3<f64>) -> Matrix3<f64> {
    let signs = Vector3::new(1.0, -1.0, -1.0);
    Matrix3::from_fn(|row, column| signs[row] * flu[(row, column)] * signs[column])
}

/// The attitude enu_from_flu -> ned_from_frd, or back.
#[must_use]
pub fn ned_from_frd(enu_from_flu: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    // Half a turn about the axis between east and north, and half a turn about forward.
    let root = core::f64::consts::FRAC_1_SQRT_2;
    let of_world = UnitQuaternion::new_unchecked(Quaternion::new(0.0, root, root, 0.0));
    let of_body = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0));
    of_world * enu_from_flu * of_body
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn north_is_first_and_down_is_last() {
        let (east, north, up) = (Vector3::x(), Vector3::y(), Vector3::z());
        assert_eq!([ned(&north), ned(&east), ned(&-up)], [Vector3::x(), Vector3::y(), Vector3::z()]);
        let (forward, left, up) = (Vector3::x(), Vector3::y(), Vector3::z());
        assert_eq!([frd(&forward), frd(&-left), frd(&-up)], [Vector3::x(), Vector3::y(), Vector3::z()]);
    }

    #[test]
    fn a_level_vehicle_that_looks_north_has_no_rotation_in_ned() {
        // In ENU it is turned a quarter to the left of east.
        let enu_from_flu = UnitQuaternion::from_euler_angles(0.0, 0.0, core::f64::consts::FRAC_PI_2);
        assert!(ned_from_frd(&enu_from_flu).angle() < 1e-12);
        // One that looks east has a heading of 90 deg, clockwise from above: about down.
        let heading = ned_from_frd(&UnitQuaternion::identity()).scaled_axis();
        assert!((heading - Vector3::z() * core::f64::consts::FRAC_PI_2).norm() < 1e-12);
    }

    proptest! {
        #[test]
        fn a_vector_goes_the_same_way_by_either_axes(
            axis in proptest::array::uniform3(-3.0..3.0_f64),
            vector in proptest::array::uniform3(-10.0..10.0_f64),
        ) {
            let enu_from_flu = UnitQuaternion::from_scaled_axis(Vector3::from(axis));
            let flu = Vector3::from(vector);
            let by_ros = ned(&(enu_from_flu * flu));
            let by_autopilot = ned_from_frd(&enu_from_flu) * frd(&flu);
            prop_assert!((by_ros - by_autopilot).norm() < 1e-12 * (1.0 + flu.norm()));
            prop_assert!(ned_from_frd(&ned_from_frd(&enu_from_flu)).angle_to(&enu_from_flu) < 1e-7);
        }

        #[test]
        fn a_covariance_is_that_of_the_turned_vector(root in proptest::array::uniform9(-1.0..1.0_f64), along in proptest::array::uniform3(-1.0..1.0_f64)) {
            let root = Matrix3::from_row_slice(&root);
            let (flu, along) = (root * root.transpose(), Vector3::from(along));
            let [by_flu, by_frd] = [along.dot(&(flu * along)), frd(&along).dot(&(frd_covariance(&flu) * frd(&along)))];
            prop_assert!((by_flu - by_frd).abs() < 1e-12);
        }
    }
}
