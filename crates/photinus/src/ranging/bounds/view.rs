//! What two markers show over a box of camera places: interval arithmetic on the angle of a pair.
//!
//! The camera is at u / w: u a direction in the body frame, w the inverse of its distance, 0 for infinitely
//! far. With the middle m of a pair, its vector d and y = u - w m, the angle theta of the pair obeys
//!
//! ```text
//! w cot(theta) = (|y| / |d| - w^2 |d| / (4 |y|)) / sin(psi),    psi = angle between d and y
//! ```
//!
//! which is exact from the near limit to infinity, where it is the inverse of the pair's lateral extent. It
//! grows with |y|, falls with w, and is monotone in sin(psi): ranges of the three give its range.

use nalgebra::Vector3;

use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Widens every box, against the rounding of its own arithmetic.
const ROUNDING: f64 = 1e-9;

/// A box this small, rad and share of the distance, is not split again.
const FINEST: f64 = 2e-3;

/// From `lo` to `hi`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) lo: f64,
    pub(super) hi: f64,
}

impl Range {
    fn middle(&self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    fn half(&self) -> f64 {
        0.5 * (self.hi - self.lo)
    }

    fn split(&self) -> [Self; 2] {
        let middle = self.middle();
        [Self { lo: self.lo, hi: middle }, Self { lo: middle, hi: self.hi }]
    }
}

/// A box of camera places.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewBox {
    pub(super) yaw_rad: Range,
    pub(super) elevation_rad: Range,
    /// Inverse distance, 1/m.
    pub(super) inverse_m: Range,
}

impl ViewBox {
    /// The two halves in yaw.
    pub(super) fn split_yaw(&self) -> [Self; 2] {
        self.yaw_rad.split().map(|yaw_rad| Self { yaw_rad, ..*self })
    }

    /// Whether splitting can still show something new of an airframe of radius `reach_m`.
    pub(super) fn is_coarse(&self, reach_m: f64) -> bool {
        self.yaw_rad.half() * self.max_cos_elevation() > FINEST
            || self.elevation_rad.half() > FINEST
            || self.inverse_m.half() * reach_m > FINEST
    }

    /// The two halves, across the side along which an airframe of radius `reach_m` looks most different.
    pub(super) fn split(&self, reach_m: f64) -> [Self; 2] {
        let yaw = self.yaw_rad.half() * self.max_cos_elevation();
        let elevation = self.elevation_rad.half();
        let inverse = self.inverse_m.half() * reach_m;
        if yaw >= elevation && yaw >= inverse {
            self.split_yaw()
        } else if elevation >= inverse {
            self.elevation_rad.split().map(|elevation_rad| Self { elevation_rad, ..*self })
        } else {
            self.inverse_m.split().map(|inverse_m| Self { inverse_m, ..*self })
        }
    }

    fn max_cos_elevation(&self) -> f64 {
        let Range { lo, hi } = self.elevation_rad;
        if lo <= 0.0 && hi >= 0.0 { 1.0 } else { libm::cos(lo.abs().min(hi.abs())) }
    }

    /// The ball of directions, and the inverse distances, that cover the box.
    pub(super) fn cover(&self) -> Views {
        let (sin_yaw, cos_yaw) = libm::sincos(self.yaw_rad.middle());
        let (sin, cos) = libm::sincos(self.elevation_rad.middle());
        let turn = libm::hypot(self.elevation_rad.half(), self.yaw_rad.half() * self.max_cos_elevation());
        Views {
            direction: Vector3::new(cos * cos_yaw, cos * sin_yaw, sin),
            turn: turn + ROUNDING,
            inverse_m: self.inverse_m.middle(),
            half_inverse_m: self.inverse_m.half() * (1.0 + ROUNDING),
        }
    }

    /// The one place in the middle of the box.
    pub(super) fn middle(&self) -> Views {
        Views { turn: 0.0, half_inverse_m: 0.0, ..self.cover() }
    }
}

/// Camera places around one: directions up to `turn` away (rad, an arc is longer than its chord).
#[derive(Clone, Copy, Debug)]
pub(super) struct Views {
    direction: Vector3<f64>,
    turn: f64,
    inverse_m: f64,
    half_inverse_m: f64,
}

impl Views {
    /// Whether `marker` shines towards any of the places.
    pub(super) fn can_see(&self, airframe: &Airframe, marker: usize) -> bool {
        airframe.markers()[marker].leds.iter().map(|&led| &airframe.leds()[led]).any(|led| {
            let Some(dark_cos) = led.lobe.dark_from_cos() else { return true };
            let (ahead_m, reach_m) = (led.position_m.dot(&led.axis), led.position_m.norm());
            let ray = self.direction - self.inverse_m * led.position_m;
            let beyond = self.direction.dot(&led.axis) - self.inverse_m * ahead_m - dark_cos * ray.norm();
            // How far the ray's part along the axis changes, and its length.
            let [along, length] = [ahead_m.abs(), reach_m].map(|m| self.turn + self.half_inverse_m * m);
            beyond > -(along + dark_cos.abs() * length)
        })
    }

    fn nearest_inverse_m(&self) -> f64 {
        self.inverse_m + self.half_inverse_m
    }

    fn farthest_inverse_m(&self) -> f64 {
        (self.inverse_m - self.half_inverse_m).max(0.0)
    }

    /// Largest distance times angle, m, of a pair whose least w cot(theta) over the places is `cot_per_m`.
    pub(super) fn max_extent_m(&self, cot_per_m: f64) -> f64 {
        extent_m(cot_per_m, self.farthest_inverse_m())
    }

    /// Smallest distance times angle, m, of a pair whose largest w cot(theta) over the places is `cot_per_m`.
    pub(super) fn min_extent_m(&self, cot_per_m: f64) -> f64 {
        extent_m(cot_per_m, self.nearest_inverse_m())
    }
}

/// theta / w for w cot(theta), m; at w = 0 its limit. Falls with either argument.
fn extent_m(cot_per_m: f64, inverse_m: f64) -> f64 {
    if inverse_m > 0.0 {
        libm::atan2(inverse_m, cot_per_m) / inverse_m
    } else if cot_per_m > 0.0 {
        1.0 / cot_per_m
    } else {
        f64::INFINITY
    }
}

/// Two markers, as their middle and the vector between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    middle_m: Vector3<f64>,
    middle_norm_m: f64,
    along: Vector3<f64>,
    length_m: f64,
}

impl Pair {
    pub(super) fn new(a_m: &Vector3<f64>, b_m: &Vector3<f64>) -> Self {
        let middle_m = (a_m + b_m) / 2.0;
        let gap_m = b_m - a_m;
        let length_m = gap_m.norm();
        Self { middle_m, middle_norm_m: middle_m.norm(), along: gap_m / length_m, length_m }
    }

    /// The range of w cot(theta), 1/m, over all the places of `views`.
    pub(super) fn cot_per_m(&self, views: &Views) -> Range {
        let y = views.direction - views.inverse_m * self.middle_m;
        let square = y.norm_squared();
        let norm = square.sqrt();
        // How far y moves, and how much its square changes: first the direction turns, then the distance
        // changes.
        let shift = views.turn + self.middle_norm_m * views.half_inverse_m;
        let square_change = 2.0 * views.inverse_m * self.middle_norm_m * views.turn
            + 2.0 * views.half_inverse_m * (self.middle_m.dot(&y).abs() + self.middle_norm_m * shift);
        let min_norm = (square - square_change).max(0.0).sqrt().max(norm - shift);
        if shift >= norm || min_norm <= 0.0 {
            return Range { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
        }
        let max_norm = (square + square_change).sqrt();
        let sin =
            sin_range(self.along.cross(&y).norm() / norm, self.along.dot(&y).abs() / norm, shift / norm);
        let over = |norm: f64, inverse_m: f64| {
            norm / self.length_m - inverse_m * inverse_m * self.length_m / (4.0 * norm)
        };
        let least = over(min_norm, views.nearest_inverse_m());
        let most = over(max_norm, views.farthest_inverse_m());
        Range {
            lo: least / if least >= 0.0 { sin.hi } else { sin.lo },
            hi: if most <= 0.0 {
                most / sin.hi
            } else if sin.lo > 0.0 {
                most / sin.lo
            } else {
                f64::INFINITY
            },
        }
    }
}

/// The range of the sine of an angle in [0, pi/2], given its sine and cosine, when the angle moves by up to
/// the arcsine of `sin_turn`.
fn sin_range(sin: f64, cos: f64, sin_turn: f64) -> Range {
    let cos_turn = (1.0 - sin_turn * sin_turn).sqrt();
    let lo = if sin <= sin_turn { 0.0 } else { sin * cos_turn - cos * sin_turn };
    let hi = if cos <= sin_turn { 1.0 } else { sin * cos_turn + cos * sin_turn };
    Range { lo: lo.max(0.0), hi: hi.min(1.0) }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    fn exact_cot_per_m(a_m: &Vector3<f64>, b_m: &Vector3<f64>, u: &Vector3<f64>, inverse_m: f64) -> f64 {
        let (ya, yb) = (u - inverse_m * a_m, u - inverse_m * b_m);
        inverse_m * ya.dot(&yb) / ya.cross(&yb).norm()
    }

    #[test]
    fn range_of_a_pair_holds_at_every_place_of_the_box_and_is_narrow() {
        let a_m = Vector3::new(0.4, 0.0, 0.1);
        let pair_with = |b_m: Vector3<f64>| (b_m, Pair::new(&a_m, &b_m));
        let mut widths = Vec::new();
        for (b_m, pair) in [
            pair_with(Vector3::new(-0.4, 0.05, 0.0)),
            pair_with(Vector3::new(0.2, 0.35, 0.0)),
            pair_with(Vector3::new(0.38, 0.0, -0.1)),
        ] {
            for step in 0..400 {
                let lo = |period: u32, span: f64| f64::from(step % period) / f64::from(period) * span;
                let place = ViewBox {
                    yaw_rad: Range { lo: lo(40, TAU), hi: lo(40, TAU) + 0.05 },
                    elevation_rad: Range { lo: lo(23, 3.0) - 1.5, hi: lo(23, 3.0) - 1.46 },
                    inverse_m: Range { lo: 0.01 + lo(17, 2.0), hi: 0.03 + lo(17, 2.0) },
                };
                let range = pair.cot_per_m(&place.cover());
                for corner in 0..27 {
                    let at = |range: Range, place: i32| range.lo + f64::from(place % 3) * range.half();
                    let (sin_yaw, cos_yaw) = libm::sincos(at(place.yaw_rad, corner));
                    let (sin, cos) = libm::sincos(at(place.elevation_rad, corner / 3));
                    let u = Vector3::new(cos * cos_yaw, cos * sin_yaw, sin);
                    let exact = exact_cot_per_m(&a_m, &b_m, &u, at(place.inverse_m, corner / 9));
                    assert!(range.lo <= exact && exact <= range.hi, "{exact} outside {range:?} of {place:?}");
                }
                if range.lo > 0.0 && range.hi.is_finite() {
                    widths.push(range.hi / range.lo);
                }
            }
        }
        widths.sort_unstable_by(f64::total_cmp);
        assert!(widths.len() > 600 && widths[widths.len() / 2] < 1.25, "{}", widths[widths.len() / 2]);
    }

    #[test]
    fn extent_is_the_lateral_one_far_away_and_continuous_there() {
        assert!((extent_m(2.0, 0.0) - 0.5).abs() < 1e-12);
        assert!((extent_m(2.0, 1e-6) - 0.5).abs() < 1e-9);
        assert!(extent_m(2.0, 0.5) < 0.5);
    }
}
