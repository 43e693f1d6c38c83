//! A motion during an exposure, to second order.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// Poses at the start, the middle and the end of an exposure (all rows of it); between them places lie on a parabola, and so do
/// the components of the quaternion: the error grows with the third power of the span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    poses: [Isometry3<f64>; 3],
}

/// How something moves at an instant: what an integrator knows of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// The pose world_from_body.
    pub pose: Isometry3<f64>,
    /// Velocity in the world, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Acceleration in the world, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Rate of turn about the body's axes, rad/s.
    pub turn_rad_s: Vector3<f64>,
}

impl Kinematics {
    /// Where it is `after_s` seconds later, while acceleration and rate of turn stay as they are.
    pub fn after(&self, after_s: f64) -> Isometry3<f64> {
        let way_m = self.velocity_m_s * after_s + self.acceleration_m_s2 * (0.5 * after_s * after_s);
        let place_m = self.pose.translation.vector + way_m;
        Isometry3::from_parts(
            Translation3::from(place_m),
            self.pose.rotation * UnitQuaternion::from_scaled_axis(self.turn_rad_s * after_s),
        )
    }

    /// The motion during a span of `span_s` seconds that begins `after_s` seconds later.
    pub fn during(&self, after_s: f64, span_s: f64) -> Moving {
        Moving::through([0.0, 0.5, 1.0].map(|share| self.after(after_s + share * span_s)))
    }
}

impl Moving {
    /// What stands still.
    pub fn still(pose: Isometry3<f64>) -> Self {
        Self { poses: [pose; 3] }
    }

    /// What has these poses at the start, the middle and the end.
    pub fn through(poses: [Isometry3<f64>; 3]) -> Self {
        Self { poses }
    }

    /// The pose when a share of the span has passed, 0 to 1.
    pub fn pose(&self, share: f64) -> Isometry3<f64> {
        let [start, middle, end] = &self.poses;
        // the three poses themselves, bit for bit: a global shutter asks for nothing else
        if share <= 0.0 {
            return *start;
        }
        if share >= 1.0 {
            return *end;
        }
        if (share - 0.5).abs() < 1e-12 {
            return *middle;
        }
        let weights =
            [(1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)];
        let mut place_m = Vector3::zeros();
        let mut turn = Quaternion::from_parts(0.0, Vector3::zeros());
        for (pose, weight) in self.poses.iter().zip(weights) {
            place_m += pose.translation.vector * weight;
            // q and -q are the same attitude: take the one on the side of the middle
            let side = if pose.rotation.coords.dot(&middle.rotation.coords) < 0.0 { -1.0 } else { 1.0 };
            turn += *pose.rotation.quaternion() * (side * weight);
        }
        Isometry3::from_parts(Translation3::from(place_m), UnitQuaternion::new_normalize(turn))
    }

    /// The way from the start of the span to its end, m: over the span the velocity in its middle.
    pub(crate) fn way_m(&self) -> Vector3<f64> {
        self.poses[2].translation.vector - self.poses[0].translation.vector
    }

    /// The same as seen from a frame that is fixed to it: world_from_part of world_from_body.
    #[must_use]
    pub fn carrying(&self, body_from_part: &Isometry3<f64>) -> Self {
        Self { poses: self.poses.map(|pose| pose * body_from_part) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> Kinematics {
        Kinematics {
            pose: Isometry3::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, -0.2, 2.9)),
            velocity_m_s: Vector3::new(8.0, -3.0, 1.0),
            acceleration_m_s2: Vector3::new(-4.0, 9.0, 5.0),
            turn_rad_s: Vector3::new(2.0, -1.0, 9.0),
        }
    }

    #[test]
    fn between_its_poses_it_is_where_the_state_leads() {
        let (state, span_s) = (state(), 0.02);
        let moving = state.during(0.1, span_s);
        for step in 0..=40 {
            let share = f64::from(step) / 40.0;
            let (is, should) = (moving.pose(share), state.after(0.1 + share * span_s));
            let gap_m = (is.translation.vector - should.translation.vector).norm();
            // 9 rad/s for 20 ms: the cube of half of 0.18 rad, over 9 sqrt 3, halved twice
            assert!(gap_m < 1e-12 && is.rotation.angle_to(&should.rotation) < 3e-5, "{share}: {gap_m}");
        }
        assert_eq!(moving.pose(0.5), state.after(0.1 + 0.5 * span_s), "the middle is as it was given");
    }

    #[test]
    fn an_attitude_written_with_the_other_sign_is_the_same() {
        let moving = state().during(0.0, 0.02);
        let mut other = moving;
        other.poses[2].rotation = UnitQuaternion::new_unchecked(-other.poses[2].rotation.into_inner());
        assert!(other.pose(0.7).rotation.angle_to(&moving.pose(0.7).rotation) < 1e-9);
    }

    #[test]
    fn a_part_is_carried_along() {
        let part = Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.0, 0.0));
        let moving = state().during(0.0, 0.01);
        assert_eq!(moving.carrying(&part).pose(1.0), moving.pose(1.0) * part);
        assert!((Moving::still(part).pose(0.3).to_homogeneous() - part.to_homogeneous()).norm() < 1e-15);
    }
}
