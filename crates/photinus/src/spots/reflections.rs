//! Faint images of markers in shiny surfaces.
//!
//! In: the spots of a frame. Out: those that are markers; the rest is rejected. A reflection is much fainter than the
//! brightest marker of the frame and lies beside markers that outshine it. A far neighbour is faint too, but beside its own
//! kind: a faint spot whose nearest certain spot is not much brighter stays, and so does one that stands out well by itself.

use super::settings::Shape;
use super::{Detections, Rejected, Spot};
use crate::spots::Reason;

/// Light of a spot that is hardly wider than a pixel over its height, px.
const NARROW_PX: f64 = 8.0;

/// Rejects the spots that are taken for reflections.
pub(super) fn reject(detections: &mut Detections, shape: &Shape) {
    let Detections { spots, rejected } = detections;
    let brightest = spots.iter().map(height).fold(0.0, f64::max);
    let doubtful_below = (shape.faintest * brightest).min(shape.faint_dn);
    let is_certain = |spot: &Spot| height(spot) >= doubtful_below;
    if spots.iter().all(is_certain) {
        return;
    }
    let first_rejected = rejected.len();
    for (index, spot) in spots.iter().enumerate() {
        if is_certain(spot) {
            continue;
        }
        let nearest = nearest_certain(spots, index, 4.0 * shape.widest_px, is_certain);
        // The height of a narrow spot depends on where in a pixel it falls: it is faint if its light is, too.
        let is_faint = |nearest: &Spot| {
            spot.flux > NARROW_PX * height(spot) || spot.flux < shape.faintest * nearest.flux
        };
        let outshone = |nearest: &Spot| height(spot) < shape.faintest * height(nearest) && is_faint(nearest);
        if nearest.is_some_and(outshone) {
            rejected.push(Rejected {
                centre: spot.centre,
                area_px: spot.area_px,
                peak: spot.peak,
                reason: Reason::Reflection,
                extent: spot.extent,
            });
        }
    }
    let mut gone = rejected[first_rejected..].iter().peekable();
    spots.retain(|spot| {
        let goes = gone.peek().is_some_and(|gone| gone.centre == spot.centre && gone.extent == spot.extent);
        if goes {
            gone.next();
        }
        !goes
    });
}

/// Grey levels above the background.
fn height(spot: &Spot) -> f64 {
    f64::from(spot.peak) - spot.background
}

/// The certain spot nearest to spot `index`. Spots come ordered by their first row, and none is taller than `tallest_px`, so
/// that the search may stop where rows alone are farther than what was found.
fn nearest_certain(
    spots: &[Spot],
    index: usize,
    tallest_px: f64,
    is_certain: impl Fn(&Spot) -> bool,
) -> Option<&Spot> {
    let own = &spots[index];
    let mut nearest: Option<(f64, &Spot)> = None;
    let (mut after, mut before) = (spots[index + 1..].iter(), spots[..index].iter().rev());
    for side in [&mut after as &mut dyn Iterator<Item = &Spot>, &mut before] {
        for spot in side {
            let rows = f64::from(spot.extent.top) - f64::from(own.extent.top);
            if nearest.is_some_and(|(distance, _)| rows.abs() > distance + tallest_px) {
                break;
            }
            let distance = libm::hypot(spot.centre.u - own.centre.u, spot.centre.v - own.centre.v);
            if is_certain(spot) && nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, spot));
            }
        }
    }
    nearest.map(|(_, spot)| spot)
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;

    use super::*;
    use crate::camera::Pixel;
    use crate::spots::Extent;

    fn spot(u: f64, v: f64, peak: u8) -> Spot {
        let (column, row) = (u as u32, v as u32);
        Spot {
            centre: Pixel::new(u, v),
            covariance_px2: Matrix2::identity(),
            area_px: 1,
            peak,
            saturated_px: 0,
            flux: f64::from(peak),
            light: None,
            background: 0.0,
            middle: (column, row),
            extent: Extent { left: column, top: row, right: column, bottom: row },
        }
    }

    fn peaks_left(spots: Vec<Spot>) -> Vec<u8> {
        let mut detections = Detections { spots, rejected: Vec::new() };
        reject(&mut detections, &Shape::default());
        assert!(detections.rejected.iter().all(|rejected| rejected.reason == Reason::Reflection));
        detections.spots.iter().map(|spot| spot.peak).collect()
    }

    #[test]
    fn a_faint_spot_beside_one_that_outshines_it_is_a_reflection() {
        assert_eq!(peaks_left(vec![spot(100.0, 50.0, 240), spot(110.0, 60.0, 40)]), [240]);
        assert_eq!(peaks_left(vec![spot(110.0, 40.0, 40), spot(100.0, 50.0, 240)]), [240]);
    }

    #[test]
    fn a_far_neighbour_stays_though_a_near_one_is_bright() {
        let far = [spot(300.0, 80.0, 40), spot(310.0, 81.0, 60), spot(320.0, 82.0, 35)];
        let mut spots = vec![spot(100.0, 50.0, 250), spot(120.0, 51.0, 240)];
        spots.extend(far);
        assert_eq!(peaks_left(spots), [250, 240, 40, 60, 35]);
    }

    #[test]
    fn alone_in_the_frame_a_faint_spot_stays() {
        assert_eq!(peaks_left(vec![spot(100.0, 50.0, 25)]), [25]);
        assert_eq!(peaks_left(vec![spot(100.0, 50.0, 25), spot(400.0, 50.0, 60)]), [25, 60]);
    }
}
