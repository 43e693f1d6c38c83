//! What the method found, as records, and spots of a file as the method takes them.

use nalgebra::Matrix2;

use photinus::camera::Pixel;
use photinus::spots::{Extent, Rejected, Spot};

use super::{RejectedRecord, SpotRecord};

impl From<&Spot> for SpotRecord {
    fn from(spot: &Spot) -> Self {
        let c = &spot.covariance_px2;
        Self {
            u_px: spot.centre.u,
            v_px: spot.centre.v,
            area_px: spot.area_px,
            peak: spot.peak,
            saturated_px: spot.saturated_px,
            flux: spot.flux,
            sigma_px: spot.sigma_px(),
            covariance_px2: [[c.m11, c.m12], [c.m21, c.m22]],
            middle_px: [spot.middle.0, spot.middle.1],
            background: spot.background,
            bearing: None,
            bound_rad: None,
            range_m: None,
        }
    }
}

impl From<&SpotRecord> for Spot {
    /// The extent, which no file has, becomes the square of the spot's area around its middle pixel.
    fn from(record: &SpotRecord) -> Self {
        let [[uu, uv], [vu, vv]] = record.covariance_px2;
        let [u, v] = record.middle_px;
        let reach = (f64::from(record.area_px).sqrt() / 2.0).floor() as u32;
        Self {
            centre: Pixel::new(record.u_px, record.v_px),
            covariance_px2: Matrix2::new(uu, uv, vu, vv),
            area_px: record.area_px,
            peak: record.peak,
            saturated_px: record.saturated_px,
            flux: record.flux,
            background: record.background,
            middle: (u, v),
            extent: Extent {
                left: u.saturating_sub(reach),
                top: v.saturating_sub(reach),
                right: u.saturating_add(reach),
                bottom: v.saturating_add(reach),
            },
        }
    }
}

impl From<&Rejected> for RejectedRecord {
    fn from(rejected: &Rejected) -> Self {
        Self {
            u_px: rejected.centre.u,
            v_px: rejected.centre.v,
            area_px: rejected.area_px,
            reason: rejected.reason.as_str().to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_survives_the_way_through_a_record() {
        let spot = Spot {
            centre: Pixel::new(100.25, 50.5),
            covariance_px2: Matrix2::new(0.05, 0.01, 0.01, 0.03),
            area_px: 9,
            peak: 255,
            saturated_px: 2,
            flux: 812.5,
            background: 3.5,
            middle: (100, 51),
            extent: Extent { left: 99, top: 50, right: 101, bottom: 52 },
        };
        let record = SpotRecord::from(&spot);
        assert_eq!(Spot::from(&record), spot);
        assert!((record.sigma_px - 0.2).abs() < 1e-12);
        let huge = SpotRecord { area_px: u32::MAX, middle_px: [u32::MAX; 2], ..record };
        assert_eq!(Spot::from(&huge).extent.right, u32::MAX);
    }
}
