//! Paths in closed form.

use nalgebra::Vector3;

/// Where a robot means to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// In one place.
    Hover {
        /// Where, m.
        position_m: Vector3<f64>,
    },
    /// Between two places, at rest at both, there and back again.
    Line {
        /// Where it begins, m.
        from_m: Vector3<f64>,
        /// Where it turns, m.
        to_m: Vector3<f64>,
        /// Time from one to the other, s.
        duration_s: f64,
    },
    /// A level circle.
    Circle {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Its radius, m.
        radius_m: f64,
        /// Speed along it, counter-clockwise from above, m/s.
        speed_m_s: f64,
        /// Where it begins, counter-clockwise from east, rad.
        phase_rad: f64,
    },
    /// A level figure eight (lemniscate of Gerono), its long axis east.
    FigureEight {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Half its length and half its width, m.
        half_size_m: [f64; 2],
        /// Time for all of it, s.
        period_s: f64,
    },
}

impl Path {
    /// Where it is at a time, m.
    pub fn position_m(&self, time_s: f64) -> Vector3<f64> {
        match self {
            Self::Hover { position_m } => *position_m,
            Self::Line { from_m, to_m, duration_s } => {
                let share = 0.5 - 0.5 * libm::cos(core::f64::consts::PI * time_s / duration_s);
                from_m + (to_m - from_m) * share
            }
            Self::Circle { centre_m, radius_m, speed_m_s, phase_rad } => {
                let (sin, cos) = libm::sincos(phase_rad + speed_m_s / radius_m * time_s);
                centre_m + Vector3::new(cos, sin, 0.0) * *radius_m
            }
            Self::FigureEight { centre_m, half_size_m, period_s } => {
                let (sin, cos) = libm::sincos(core::f64::consts::TAU * time_s / period_s);
                centre_m + Vector3::new(half_size_m[0] * sin, 2.0 * half_size_m[1] * sin * cos, 0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_pass_where_they_should() {
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(5.0, 2.0, 3.0));
        let line = Path::Line { from_m: a, to_m: b, duration_s: 4.0 };
        for (time_s, x_m) in [(0.0, 1.0), (2.0, 3.0), (4.0, 5.0), (8.0, 1.0)] {
            assert!((line.position_m(time_s) - Vector3::new(x_m, 2.0, 3.0)).norm() < 1e-12);
        }
        let eight = Path::FigureEight { centre_m: a, half_size_m: [4.0, 1.0], period_s: 8.0 };
        for (time_s, x_m, y_m) in
            [(0.0, 0.0, 0.0), (1.0, 8.0_f64.sqrt(), 1.0), (2.0, 4.0, 0.0), (4.0, 0.0, 0.0)]
        {
            assert!((eight.position_m(time_s) - a - Vector3::new(x_m, y_m, 0.0)).norm() < 1e-12);
        }
        let circle = Path::Circle { centre_m: a, radius_m: 2.0, speed_m_s: 1.0, phase_rad: 0.0 };
        let quarter = circle.position_m(core::f64::consts::PI);
        assert!((quarter - a - Vector3::new(0.0, 2.0, 0.0)).norm() < 1e-12);
    }
}
