//! Spots so near each other that parting them has moved their centres.
//!
//! In: measured spots. Out: the same, with wider covariances along the line between two that are hardly apart. Each pixel of
//! two summits goes to one of them, and the fainter keeps the side that the brighter one does not outshine: on rendered
//! frames two LEDs 1.9 to 2.3 px apart are told to be 1.2 to 1.6 px apart, the fainter off by 0.5 to 0.9 px.

use nalgebra::{Matrix2, Vector2};

use super::Spot;

/// Spots farther apart than this do not move each other, px.
const APART_PX: f64 = 2.5;
/// How far the fainter of two is off at no distance, px; it falls in proportion to the distance.
const MOST_PX: f64 = 1.4;
/// How far the brighter one is off, as a share of that per light of the fainter one over its own.
const BRIGHTER: f64 = 0.5;

/// Widens the covariances of spots that are hardly apart. Spots come ordered by their first row.
pub(super) fn widen(spots: &mut [Spot]) {
    for index in 0..spots.len() {
        let Some((own, below)) = spots[index..].split_first_mut() else { return };
        for other in below {
            if f64::from(other.extent.top) > f64::from(own.extent.bottom) + APART_PX {
                break;
            }
            widen_pair(own, other);
        }
    }
}

fn widen_pair(a: &mut Spot, b: &mut Spot) {
    let between = Vector2::new(b.centre.u - a.centre.u, b.centre.v - a.centre.v);
    let gap_px = between.norm();
    if gap_px >= APART_PX || gap_px <= 0.0 {
        return;
    }
    let along: Matrix2<f64> = between * between.transpose() / (gap_px * gap_px);
    let off_px = MOST_PX * (1.0 - gap_px / APART_PX);
    let (fainter, brighter) = if a.flux < b.flux { (a, b) } else { (b, a) };
    let share = BRIGHTER * fainter.flux.max(0.0) / brighter.flux.max(1.0);
    fainter.covariance_px2 += along * (off_px * off_px);
    brighter.covariance_px2 += along * (off_px * share * off_px * share);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Pixel;
    use crate::spots::Extent;

    fn spot(u: f64, flux: f64) -> Spot {
        let column = u as u32;
        Spot {
            centre: Pixel::new(u, 20.0),
            covariance_px2: Matrix2::from_diagonal_element(1e-4),
            area_px: 1,
            peak: 100,
            saturated_px: 0,
            flux,
            background: 0.0,
            middle: (column, 20),
            extent: Extent { left: column, top: 20, right: column, bottom: 20 },
        }
    }

    #[test]
    fn the_fainter_of_two_that_are_hardly_apart_is_unsure_along_the_line_between() {
        let mut spots = [spot(20.0, 240.0), spot(21.3, 80.0), spot(30.0, 80.0)];
        widen(&mut spots);
        let sigmas = |spot: &Spot| [spot.covariance_px2.m11.sqrt(), spot.covariance_px2.m22.sqrt()];
        let [bright, faint, far] = [&spots[0], &spots[1], &spots[2]].map(sigmas);
        assert!((0.5..0.9).contains(&faint[0]) && (0.08..0.15).contains(&bright[0]), "{faint:?} {bright:?}");
        for across in [bright[1], faint[1], far[0], far[1]] {
            assert!((across - 0.01).abs() < 1e-12);
        }
    }
}
