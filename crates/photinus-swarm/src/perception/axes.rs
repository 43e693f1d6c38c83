//! From the body frame to the level frame, as the vehicle believes it to be, with what that belief is unsure of.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use photinus_control::{Normal, Seen};

/// The same neighbour in axes that `level_from_body` leads to, which may be tilted by `tilt_sigma_rad` about x and y.
#[must_use]
pub fn levelled(seen: &Seen, level_from_body: &Rotation3<f64>, tilt_sigma_rad: f64) -> Seen {
    let turned = |normal: Normal| {
        let mean = level_from_body * normal.mean;
        let about = level_from_body.matrix() * normal.covariance * level_from_body.matrix().transpose();
        let lever = mean.cross_matrix();
        let tilt = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * (tilt_sigma_rad * tilt_sigma_rad);
        Normal { mean, covariance: about + lever * tilt * lever.transpose() }
    };
    // what a bound is widened by is exceeded twice in a hundred million readings
    let tilt_bound_rad = 6.0 * tilt_sigma_rad;
    Seen {
        bearing_bound_rad: (seen.bearing_bound_rad + tilt_bound_rad).min(core::f64::consts::PI),
        bearing: Unit::new_normalize(level_from_body * seen.bearing.into_inner()),
        position_m: seen.position_m.map(turned),
        velocity_m_s: seen.velocity_m_s.map(turned),
        ..*seen
    }
}

/// Squared Mahalanobis distance of the truth: chi-square of three degrees of freedom where the covariance is honest; `None` where the covariance has no
/// inverse.
pub fn nees(normal: &Normal, truth: &Vector3<f64>) -> Option<f64> {
    let off = truth - normal.mean;
    let inverse = normal.covariance.cholesky()?.inverse();
    Some(off.dot(&(inverse * off)))
}

#[cfg(test)]
mod tests {
    use photinus::locator::Distance;
    use photinus::ranging::Interval;

    use super::*;
    use crate::chance::{Chance, Use};
    use crate::perception::hand_made;

    fn seen() -> Seen {
        let covariance = Matrix3::from_diagonal(&Vector3::new(0.4, 0.02, 0.01));
        let seen = hand_made::seen(Vector3::new(6.0, -2.0, 1.0), covariance);
        let bounds = Interval::new(5.0, 8.0).unwrap();
        Seen { bearing_bound_rad: 0.01, distance: Distance { bounds, ..seen.distance }, ..seen }
    }

    #[test]
    fn what_tilted_axes_do_is_what_sampling_them_gives() {
        let mut chance = Chance::new(5, Use::Instruments, 0);
        let (seen, sigma_rad) = (seen(), 0.03);
        let believed = seen.position_m.unwrap();
        let samples = 40_000;
        let mut scatter = Matrix3::zeros();
        for _ in 0..samples {
            let tilt = chance.normals() * sigma_rad;
            let off = Rotation3::new(Vector3::new(tilt.x, tilt.y, 0.0)) * believed.mean - believed.mean;
            scatter += off * off.transpose() / f64::from(samples);
        }
        let unsure = levelled(&seen, &Rotation3::identity(), sigma_rad).position_m.unwrap();
        let told = unsure.covariance - believed.covariance;
        assert!((told - scatter).norm() / scatter.norm() < 0.03, "{told} {scatter}");
    }

    #[test]
    fn a_turn_keeps_the_nees() {
        let turn = Rotation3::new(Vector3::new(0.3, -0.2, 1.1));
        let truth = Vector3::new(6.5, -2.1, 1.2);
        let before = nees(&seen().position_m.unwrap(), &truth).unwrap();
        // 0.25 / 0.4 + 0.01 / 0.02 + 0.04 / 0.01
        assert!((before - 5.125).abs() < 1e-12);
        let turned = levelled(&seen(), &turn, 0.0);
        assert!((nees(&turned.position_m.unwrap(), &(turn * truth)).unwrap() - before).abs() < 1e-9);
        assert!((turned.bearing.into_inner() - turn * seen().bearing.into_inner()).norm() < 1e-12);
    }
}
