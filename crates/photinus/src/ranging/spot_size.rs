//! Area of a spot -> the distances at which a spot of that area is possible.

use super::Interval;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// The area of a spot over distance, S(l) = round(offset + scale / (l + shift)^2): the form of the paper's
/// (13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// What remains far away, px.
    pub offset_px: f64,
    /// How steeply it grows when near, px m^2; above 0.
    pub scale_px_m2: f64,
    /// What is added to the distance, m; at or below -l the area is unlimited.
    pub shift_m: f64,
}

impl Envelope {
    /// The area before rounding, px; infinite at or below the pole.
    pub fn area_px(&self, distance_m: f64) -> f64 {
        let shifted_m = distance_m + self.shift_m;
        if shifted_m <= 0.0 {
            return f64::INFINITY;
        }
        self.offset_px + self.scale_px_m2 / (shifted_m * shifted_m)
    }

    /// The distance at which the area before rounding is `area_px`, m; `None` for an area never gone below.
    fn distance_m(&self, area_px: f64) -> Option<f64> {
        let above_px = area_px - self.offset_px;
        (above_px > 0.0).then(|| (self.scale_px_m2 / above_px).sqrt() - self.shift_m)
    }

    fn is_legal(&self) -> bool {
        let finite = [self.offset_px, self.scale_px_m2, self.shift_m].iter().all(|number| number.is_finite());
        finite && self.offset_px >= 0.0 && self.scale_px_m2 > 0.0
    }
}

/// Why parameters are not a spot curve.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpotCurveError {
    /// A number that is not finite, a negative offset, or a scale that is not above 0.
    #[error("{0:?} is no envelope of spot areas: numbers finite, offset 0 or more, scale above 0")]
    Envelope(Envelope),
    /// A lower envelope above the upper one.
    #[error("at {distance_m} m the lower envelope lies above the upper one")]
    Order {
        /// Where it does, m.
        distance_m: f64,
    },
    /// A detection limit that is not a positive distance.
    #[error("a detection limit of {0} m: it must be a distance above 0")]
    Limit(f64),
}

/// How large the spot of an LED can be at a distance, for one exposure time and threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCurve {
    upper: Envelope,
    lower: Option<Envelope>,
    limit_m: Option<f64>,
}

impl SpotCurve {
    /// A curve from its envelopes: `upper` for the largest spot, `lower` for the smallest of an LED that
    /// faces the camera, `limit_m` for the distance past which no LED makes a spot at all.
    ///
    /// # Errors
    /// [`SpotCurveError`] for an illegal envelope or limit, or envelopes that cross between 0.1 m and 100 m.
    pub fn new(
        upper: Envelope,
        lower: Option<Envelope>,
        limit_m: Option<f64>,
    ) -> Result<Self, SpotCurveError> {
        let illegal = [Some(upper), lower].into_iter().flatten().find(|envelope| !envelope.is_legal());
        if let Some(envelope) = illegal {
            return Err(SpotCurveError::Envelope(envelope));
        }
        if let Some(limit_m) = limit_m.filter(|limit_m| !(limit_m.is_finite() && *limit_m > 0.0)) {
            return Err(SpotCurveError::Limit(limit_m));
        }
        let grid_m = (0..=60).map(|step| libm::exp10(f64::from(step) / 20.0 - 1.0));
        let crosses = |distance_m: &f64| {
            lower.is_some_and(|lower| lower.area_px(*distance_m) > upper.area_px(*distance_m))
        };
        match grid_m.into_iter().find(crosses) {
            Some(distance_m) => Err(SpotCurveError::Order { distance_m }),
            None => Ok(Self { upper, lower, limit_m }),
        }
    }

    /// Paper (13): camera and LED of the paper, 1000 us, threshold 200 of 255. The paper prints the shift
    /// with either sign; taken is the one of its equation, -0.0154 m, which gives the larger spot and so the
    /// safe bound.
    pub fn paper_1000_us() -> Self {
        let upper = Envelope { offset_px: 1.3398, scale_px_m2: 31.4704, shift_m: -0.0154 };
        Self { upper, lower: None, limit_m: None }
    }

    /// The envelope of the largest spots.
    pub fn upper(&self) -> Envelope {
        self.upper
    }

    /// The envelope of the smallest spots of LEDs that face the camera, where it is known.
    pub fn lower(&self) -> Option<Envelope> {
        self.lower
    }

    /// The distance past which no LED makes a spot, m, where it is known.
    pub fn limit_m(&self) -> Option<f64> {
        self.limit_m
    }

    /// Largest area of a spot at a distance, px; `u32::MAX` where the curve has no limit.
    pub fn max_area_px(&self, distance_m: f64) -> u32 {
        self.upper.area_px(distance_m).round() as u32 // saturates
    }

    /// Smallest area of the spot of an LED that faces the camera at a distance, px; 1 without a lower
    /// envelope.
    pub fn min_area_px(&self, distance_m: f64) -> u32 {
        self.lower.map_or(1, |lower| lower.area_px(distance_m).round() as u32)
    }

    /// The distances at which an LED that faces the camera can make a spot of `area_px` pixels; `None` when
    /// there are none. An LED turned away looks smaller and so farther: for it, only the maximum holds.
    pub fn distances(&self, area_px: u32) -> Option<Interval> {
        if area_px == 0 {
            return None;
        }
        // A rounded area is at least S from S - 1/2 on, and at most S below S + 1/2.
        let area_px = f64::from(area_px);
        let far_m = self.upper.distance_m(area_px - 0.5).unwrap_or(f64::INFINITY);
        let near_m = match self.lower {
            Some(lower) => lower.distance_m(area_px + 0.5)?,
            None => 0.0,
        };
        Interval::new(near_m.max(0.0), far_m.min(self.limit_m.unwrap_or(f64::INFINITY)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_sided() -> SpotCurve {
        let upper = Envelope { offset_px: 1.4, scale_px_m2: 30.0, shift_m: 0.02 };
        let lower = Envelope { offset_px: 0.9, scale_px_m2: 12.0, shift_m: 0.02 };
        SpotCurve::new(upper, Some(lower), Some(20.0)).unwrap()
    }

    #[test]
    fn papers_curve_gives_the_papers_numbers() {
        let curve = SpotCurve::paper_1000_us();
        assert_eq!(curve.max_area_px(2.0), 9);
        assert_eq!(curve.max_area_px(6.62), 2);
        assert_eq!(curve.max_area_px(15.0), 1);
        assert_eq!(curve.max_area_px(0.01), u32::MAX, "nearer than the pole");
        assert_eq!(curve.distances(1), Interval::new(0.0, f64::INFINITY));
        assert_eq!(curve.distances(0), None);
        let two = curve.distances(2).unwrap();
        assert!((two.max_m() - 14.04).abs() < 0.01, "{two:?}");
    }

    #[test]
    fn inverse_is_the_largest_and_smallest_distance_of_a_brute_force_search() {
        let curve = two_sided();
        let step_m = 1e-3;
        let grid_m: Vec<f64> = (50..25_000).map(|i| f64::from(i) * step_m).collect();
        for area_px in [1, 2, 3, 5, 8, 13, 40, 100] {
            let possible = |&&l_m: &&f64| {
                l_m <= 20.0 && curve.min_area_px(l_m) <= area_px && area_px <= curve.max_area_px(l_m)
            };
            let first_m = grid_m.iter().find(possible).unwrap();
            let last_m = grid_m.iter().rfind(possible).unwrap();
            let interval = curve.distances(area_px).unwrap();
            assert!(interval.contains(*first_m) && interval.contains(*last_m), "{area_px}: {interval:?}");
            assert!(first_m - interval.min_m() <= step_m, "{area_px}: {first_m} {interval:?}");
            assert!(interval.max_m() - last_m <= step_m, "{area_px}: {last_m} {interval:?}");
        }
    }

    #[test]
    fn areas_that_no_distance_gives_have_no_interval() {
        assert_eq!(two_sided().distances(1_000_000), None, "larger than at distance 0");
        let upper = Envelope { offset_px: 4.0, scale_px_m2: 30.0, shift_m: 0.0 };
        let lower = Envelope { offset_px: 3.0, scale_px_m2: 12.0, shift_m: 0.0 };
        let curve = SpotCurve::new(upper, Some(lower), None).unwrap();
        assert_eq!(curve.distances(2), None, "smaller than ever");
        assert!(curve.distances(3).unwrap().max_m().is_infinite());
    }

    #[test]
    fn illegal_curves_are_refused() {
        let good = Envelope { offset_px: 1.0, scale_px_m2: 30.0, shift_m: 0.0 };
        for bad in [
            Envelope { scale_px_m2: -30.0, ..good },
            Envelope { scale_px_m2: 0.0, ..good },
            Envelope { offset_px: f64::NAN, ..good },
            Envelope { offset_px: -1.0, ..good },
            Envelope { shift_m: f64::INFINITY, ..good },
        ] {
            assert!(matches!(SpotCurve::new(bad, None, None), Err(SpotCurveError::Envelope(_))));
            assert!(matches!(SpotCurve::new(good, Some(bad), None), Err(SpotCurveError::Envelope(_))));
        }
        let above = Envelope { scale_px_m2: 40.0, ..good };
        assert!(matches!(SpotCurve::new(good, Some(above), None), Err(SpotCurveError::Order { .. })));
        assert!(matches!(SpotCurve::new(good, None, Some(f64::NAN)), Err(SpotCurveError::Limit(_))));
        assert!(matches!(SpotCurve::new(good, None, Some(-2.0)), Err(SpotCurveError::Limit(_))));
    }
}
