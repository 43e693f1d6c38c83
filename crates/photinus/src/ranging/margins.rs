//! What the paper predicts of its two estimates at a true distance: equations (7) to (12), as printed.
//!
//! They are here to reproduce the paper's figures 13 and 14, not to bound anything: the paper widens an angle
//! by one bearing error although two bearings enter, and (10) adds the error to the *half* angle, so that it
//! equals l_A(alpha_A + 2 eps) where its counterpart (9) is l_A(alpha_B - eps). Strict bounds are
//! [`DistanceBounds`](super::DistanceBounds).

use super::AdjacentPair;

/// The margins of a pair at a true distance. Each is `None` where an angle it needs leaves (0, pi): at too
/// small a distance, or where the error exceeds the angle, so that there is no farthest distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    pair: AdjacentPair,
    distance_m: f64,
    eps_rad: f64,
}

impl Margins {
    /// The margins of `pair` at the true distance `distance_m`, for a bearing error of `eps_rad` (paper (3)).
    pub fn at(pair: AdjacentPair, distance_m: f64, eps_rad: f64) -> Self {
        Self { pair, distance_m, eps_rad }
    }

    /// (7): l_A computed while case B holds, l_A(alpha_B), m.
    pub fn wrong_perpendicular_m(&self) -> Option<f64> {
        self.pair.perpendicular_m(self.pair.inline_angle_rad(self.distance_m)?)
    }

    /// (8): l_B computed while case A holds, l_B(alpha_A), m.
    pub fn wrong_inline_m(&self) -> Option<f64> {
        self.pair.inline_m(self.pair.perpendicular_angle_rad(self.distance_m)?)
    }

    /// (9): the largest l_A, l_A(alpha_B - eps), m.
    pub fn max_perpendicular_m(&self) -> Option<f64> {
        self.pair.perpendicular_m(self.pair.inline_angle_rad(self.distance_m)? - self.eps_rad)
    }

    /// (10): the smallest l_A, (d/2) cot(atan((d/2) / (l - v)) + eps) + v, m: the error is added to the half
    /// angle.
    pub fn min_perpendicular_m(&self) -> Option<f64> {
        let half_rad = self.pair.perpendicular_angle_rad(self.distance_m)? / 2.0;
        self.pair.perpendicular_from_half_m(half_rad + self.eps_rad)
    }

    /// (11): the largest l_B, l_B(alpha_B - eps), m.
    pub fn max_inline_m(&self) -> Option<f64> {
        self.pair.inline_m(self.pair.inline_angle_rad(self.distance_m)? - self.eps_rad)
    }

    /// (12): the smallest l_B, l_B(alpha_A + eps), m.
    pub fn min_inline_m(&self) -> Option<f64> {
        self.pair.inline_m(self.pair.perpendicular_angle_rad(self.distance_m)? + self.eps_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::RingGeometry;

    fn hexagon() -> AdjacentPair {
        AdjacentPair::of(&RingGeometry { markers: 6, radius_m: 0.4 })
    }

    #[test]
    fn equation_10_widens_by_twice_the_error() {
        for distance_m in [1.0, 4.0, 12.0] {
            let margins = Margins::at(hexagon(), distance_m, 4e-3);
            let alpha_rad = hexagon().perpendicular_angle_rad(distance_m).unwrap();
            let twice_m = hexagon().perpendicular_m(alpha_rad + 8e-3).unwrap();
            let once_m = hexagon().perpendicular_m(alpha_rad + 4e-3).unwrap();
            let printed_m = margins.min_perpendicular_m().unwrap();
            assert!((printed_m - twice_m).abs() < 1e-9);
            assert!(printed_m < once_m - 1e-3);
        }
    }

    #[test]
    fn equation_10_is_the_printed_formula() {
        let (half_m, v_m) = (0.2, 0.4 * 3.0_f64.sqrt() / 2.0);
        let printed_m = half_m / libm::tan(libm::atan(half_m / (5.0 - v_m)) + 4e-3) + v_m;
        let margin_m = Margins::at(hexagon(), 5.0, 4e-3).min_perpendicular_m().unwrap();
        assert!((margin_m - printed_m).abs() < 1e-9);
    }

    #[test]
    fn without_error_margins_are_the_truth_or_the_wrong_case() {
        let margins = Margins::at(hexagon(), 6.0, 0.0);
        let close = |a: Option<f64>, b: Option<f64>| (a.unwrap() - b.unwrap()).abs() < 1e-9;
        assert!(close(margins.max_perpendicular_m(), margins.wrong_perpendicular_m()));
        assert!(close(margins.min_inline_m(), margins.wrong_inline_m()));
        assert!(close(margins.min_perpendicular_m(), Some(6.0)));
        assert!(close(margins.max_inline_m(), Some(6.0)));
    }

    #[test]
    fn margins_keep_their_order_out_to_the_papers_15_m() {
        for tenths in 20..=150 {
            let distance_m = f64::from(tenths) / 10.0;
            let margins = Margins::at(hexagon(), distance_m, 1.9e-3);
            let min_inline_m = margins.min_inline_m().unwrap();
            assert!(min_inline_m < margins.wrong_inline_m().unwrap());
            assert!(margins.wrong_inline_m().unwrap() < distance_m);
            assert!(distance_m < margins.max_inline_m().unwrap());
            assert!(margins.min_perpendicular_m().unwrap() < distance_m);
            assert!(distance_m < margins.wrong_perpendicular_m().unwrap());
            assert!(margins.wrong_perpendicular_m().unwrap() < margins.max_perpendicular_m().unwrap());
        }
    }

    #[test]
    fn past_the_angle_there_is_no_farthest_distance() {
        let margins = Margins::at(hexagon(), 60.0, 0.02);
        assert_eq!(margins.max_perpendicular_m(), None);
        assert_eq!(margins.max_inline_m(), None);
        assert_eq!(Margins::at(hexagon(), 0.1, 0.0).min_perpendicular_m(), None);
    }
}
