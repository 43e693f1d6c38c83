//! Measured angles -> the distances at which the table's angles meet them.

use core::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Unit, Vector3};

use super::table::{Column, Extents, ROWS};
use super::view::Range;
use super::{BoundedBearing, DistanceBounds};
use crate::ranging::Interval;

impl DistanceBounds {
    /// The distances at which these spots can be markers of one such airframe; `None` when there are none,
    /// that is, when they cannot be.
    ///
    /// `gravity` is down in the camera frame; without it (or when it is not finite) every attitude is
    /// allowed. Fewer than two spots bound nothing but the near limit.
    pub fn interval(
        &self,
        spots: &[BoundedBearing],
        gravity: Option<&Unit<Vector3<f64>>>,
    ) -> Option<Interval> {
        if spots.len() < 2 {
            return Interval::new(self.near_m(), f64::INFINITY);
        }
        if spots.len() > self.markers {
            return None;
        }
        let measured = Measured::between(spots);
        let band_rad = gravity.and_then(|down| self.elevation_rad(spots, down));
        self.hull(spots.len(), &measured, |column| match band_rad {
            None => Some((0, ROWS - 1)),
            Some(band_rad) => {
                rows_within(band_rad.lo - column.off_origin_rad, band_rad.hi + column.off_origin_rad)
            }
        })
    }

    /// The distances at which two spots `angle_rad` apart, known to `slack_rad` (the sum of their bounds),
    /// can be markers of one such airframe in any attitude, alone or among others; `None` when there are
    /// none. An angle outside 0 to pi says nothing.
    pub fn pair_interval(&self, angle_rad: f64, slack_rad: f64) -> Option<Interval> {
        if self.markers < 2 {
            return None;
        }
        let is_angle = (0.0..=PI).contains(&angle_rad);
        let slack_rad = known_angle_rad(slack_rad);
        let angle = if is_angle {
            Range { lo: angle_rad - slack_rad, hi: angle_rad + slack_rad }
        } else {
            Range { lo: 0.0, hi: PI }
        };
        self.hull(2, &Measured::new(angle, angle), |_| Some((0, ROWS - 1)))
    }

    /// Elevations of the camera above the target's horizon that every spot allows, widened by the tilt, were
    /// the spots at the airframe's origin.
    fn elevation_rad(&self, spots: &[BoundedBearing], down: &Vector3<f64>) -> Option<Range> {
        let mut band = Range { lo: -FRAC_PI_2, hi: FRAC_PI_2 };
        for spot in spots {
            let elevation_rad = libm::asin(spot.bearing.vector().dot(down).clamp(-1.0, 1.0));
            let bound_rad = known_angle_rad(spot.bound_rad);
            band.lo = band.lo.max(elevation_rad - bound_rad);
            band.hi = band.hi.min(elevation_rad + bound_rad);
        }
        let all_finite = down.iter().all(|number| number.is_finite());
        all_finite.then_some(Range { lo: band.lo - self.max_tilt_rad, hi: band.hi + self.max_tilt_rad })
    }

    /// The hull of what the columns, each in the rows that `rows` gives it, allow.
    fn hull(
        &self,
        spots: usize,
        measured: &Measured,
        rows: impl Fn(&Column) -> Option<(usize, usize)>,
    ) -> Option<Interval> {
        let allowed = |(column, any_row, by_row): (&Column, &Extents, &[Extents])| {
            let possible = measured.distances(column, any_row);
            let (first, last) = rows(column).filter(|_| possible.lo <= possible.hi)?;
            let each = by_row[first..=last].iter().map(|extents| measured.distances(column, extents));
            each.filter(|possible| possible.lo <= possible.hi)
                .reduce(|all, one| Range { lo: all.lo.min(one.lo), hi: all.hi.max(one.hi) })
        };
        let possible = measured.distances(&Column::ANY, self.table.anywhere(spots));
        // From the farthest column to the nearest: those between the first and the last that allow any add nothing.
        let farthest = self.table.of_spots(spots, &possible).find_map(allowed)?;
        let nearest = self.table.of_spots(spots, &possible).rev().find_map(allowed)?;
        Interval::new(nearest.lo, farthest.hi)
    }
}

/// The ranges of the widest and the narrowest angle among the spots, as the inverses that a query multiplies
/// by.
struct Measured {
    widest: Range,
    narrowest: Range,
}

impl Measured {
    fn new(widest_rad: Range, narrowest_rad: Range) -> Self {
        // Distance is extent over angle; the slightest share outwards covers the rounding of the angles.
        let inverse = |angle_rad: Range| Range {
            lo: (1.0 - 1e-9) / angle_rad.hi.clamp(0.0, PI),
            hi: (1.0 + 1e-9) / angle_rad.lo.clamp(0.0, PI),
        };
        Self { widest: inverse(widest_rad), narrowest: inverse(narrowest_rad) }
    }

    /// Each of two bearings is off by up to its own bound, the angle between them by up to both.
    fn between(spots: &[BoundedBearing]) -> Self {
        let mut widest = Range { lo: 0.0, hi: 0.0 };
        let mut narrowest = Range { lo: PI, hi: PI };
        for (index, spot) in spots.iter().enumerate() {
            for other in &spots[..index] {
                let angle_rad = spot.bearing.angle_to(&other.bearing);
                let slack_rad = known_angle_rad(spot.bound_rad) + known_angle_rad(other.bound_rad);
                let angle = Range { lo: angle_rad - slack_rad, hi: angle_rad + slack_rad };
                widest = Range { lo: widest.lo.max(angle.lo), hi: widest.hi.max(angle.hi) };
                narrowest = Range { lo: narrowest.lo.min(angle.lo), hi: narrowest.hi.min(angle.hi) };
            }
        }
        Self::new(widest, narrowest)
    }

    /// The distances of a column at which these extents meet the angles; `lo` above `hi` where they do not.
    fn distances(&self, column: &Column, extents: &Extents) -> Range {
        // What is no number, markers that may seem to be in one place at any distance, gives way to the other.
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let lo = larger(extents.narrowest.lo * self.narrowest.lo, extents.widest.lo * self.widest.lo);
        let hi = smaller(extents.narrowest.hi * self.narrowest.hi, extents.widest.hi * self.widest.hi);
        Range { lo: larger(lo, column.min_m), hi: smaller(hi, column.max_m) }
    }
}

/// The rows that elevations from `lo` to `hi` touch; `None` when there is none.
fn rows_within(lo_rad: f64, hi_rad: f64) -> Option<(usize, usize)> {
    let row = |elevation_rad: f64| {
        let share = (elevation_rad + FRAC_PI_2) / PI;
        ((share * ROWS as f64).max(0.0) as usize).min(ROWS - 1)
    };
    // Elevations a hair outside count as on the edge: both ends are sums of rounded angles.
    let (lo_rad, hi_rad) = (lo_rad - 1e-9, hi_rad + 1e-9);
    (lo_rad <= hi_rad && hi_rad >= -FRAC_PI_2 && lo_rad <= FRAC_PI_2).then(|| (row(lo_rad), row(hi_rad)))
}

/// A bound or limit on an angle, rad; pi, nothing known, for a value that is not an angle.
pub(super) fn known_angle_rad(angle_rad: f64) -> f64 {
    if angle_rad >= 0.0 { angle_rad.min(PI) } else { PI }
}
