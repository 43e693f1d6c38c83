//! What a spot looks like, and how far off the centres of its like are.

use photinus_io::results::SpotRecord;
use serde::Serialize;

use super::spots::Centroid;
use super::spread::mean;

/// What a spot looks like: the first of these that holds, from the last to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpotClass {
    /// It covers a single pixel.
    SinglePixel,
    /// It covers 2 to [`SpotClass::LARGE_PX`] - 1 pixels.
    Small,
    /// It covers more.
    Large,
    /// A pixel of it is saturated.
    Saturated,
    /// Another spot is within [`SpotClass::BESIDE_PX`].
    Beside,
}

impl SpotClass {
    /// All of them, in their order.
    pub const ALL: [Self; 5] = [Self::SinglePixel, Self::Small, Self::Large, Self::Saturated, Self::Beside];
    /// A spot of this many pixels is large.
    pub const LARGE_PX: u32 = 10;
    /// Spots no further apart stand beside each other, px.
    pub const BESIDE_PX: f64 = 15.0;

    /// The class of spot `index` of a frame's.
    pub fn of(index: usize, spots: &[SpotRecord]) -> Self {
        let spot = &spots[index];
        let is_near = |other: &SpotRecord| {
            libm::hypot(other.u_px - spot.u_px, other.v_px - spot.v_px) <= Self::BESIDE_PX
        };
        let others = spots.iter().enumerate().filter(|(other, _)| *other != index);
        match spot.area_px {
            _ if others.into_iter().any(|(_, other)| is_near(other)) => Self::Beside,
            _ if spot.saturated_px > 0 => Self::Saturated,
            0..=1 => Self::SinglePixel,
            area_px if area_px < Self::LARGE_PX => Self::Small,
            _ => Self::Large,
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::SinglePixel => "single pixel",
            Self::Small => "small",
            Self::Large => "large",
            Self::Saturated => "saturated",
            Self::Beside => "beside another",
        }
    }
}

/// Centres of the spots of one class.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClassScore {
    /// Spots that are of one LED alone.
    pub count: usize,
    /// Root of the mean squared distance of a centre from its LED, px.
    pub rms_px: Option<f64>,
    /// Mean squared error over covariance; 2 where covariances are right.
    pub nees: Option<f64>,
}

impl ClassScore {
    pub(crate) fn new(centroids: &[Centroid<'_>]) -> Self {
        Self {
            count: centroids.len(),
            rms_px: mean(centroids.iter().map(|centroid| centroid.error_px.norm_squared())).map(f64::sqrt),
            nees: mean(centroids.iter().filter_map(Centroid::nees)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand_made::spot;

    #[test]
    fn a_spot_is_of_the_last_class_that_holds() {
        let class = |area_px, saturated_px, gap_px: f64| {
            let first = SpotRecord { saturated_px, ..spot(100.0, 100.0, area_px) };
            SpotClass::of(0, &[first, spot(100.0 + gap_px, 100.0, 4)])
        };
        assert_eq!(class(1, 0, 15.1), SpotClass::SinglePixel);
        assert_eq!(class(2, 0, 15.1), SpotClass::Small);
        assert_eq!(class(9, 0, 15.1), SpotClass::Small);
        assert_eq!(class(10, 0, 15.1), SpotClass::Large);
        assert_eq!(class(1, 1, 15.1), SpotClass::Saturated);
        assert_eq!(class(1, 1, 15.0), SpotClass::Beside);
    }
}
