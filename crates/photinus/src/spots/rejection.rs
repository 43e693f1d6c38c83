//! Bright regions that are not markers, and why.
//!
//! In: the outline of a part: its size, shape, saturation and how much of it is masked. Out: a reason, or none.

use core::f64::consts::PI;
use core::fmt;

use super::Extent;
use super::settings::Shape;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A saturated core of this many pixels, 8 px wide, in something too large for a marker makes it the sun.
const SUN_CORE_PX: u32 = 50;
/// Of a disc that the frame cuts only a side tells how wide it is, and a low one: such a share of the widest marker is too
/// much with a saturated core. A 20 px LED with its soft edge is 24 px.
const CUT_SUN_SHARE: f64 = 0.8;
/// A streak is at least this long, px: shorter ones are markers cut by the pixel grid, or two of them.
const SHORTEST_STREAK_PX: f64 = 8.0;
/// A streak that is no longer than this may be a marker that moves during the exposure, px.
const LONGEST_SMEAR_PX: f64 = 16.0;
/// The sun's glare reaches this far past the edge of what is bright, as a share of its radius.
const GLARE_REACH: f64 = 0.5;

/// Why a bright region is not a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reason {
    /// At least half of it lies where the mask says not to look.
    Mask,
    /// Larger than any marker, with a saturated core: the sun.
    Sun,
    /// Long and thin, longer than a marker that moves during the exposure: light off an edge, a wire, a ripple.
    Streak,
    /// A lit surface: larger than any marker.
    Reflection,
    /// No summit of its own: the edge of a brighter background.
    Background,
    /// Outside the calibrated field of the camera: it has no bearing.
    Outside,
}

impl Reason {
    /// The name used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Mask => "mask",
            Self::Sun => "sun",
            Self::Streak => "streak",
            Self::Reflection => "reflection",
            Self::Background => "background",
            Self::Outside => "outside",
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What is known of a part before its light is measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    pub(super) extent: Extent,
    pub(super) area_px: u32,
    pub(super) peak: u8,
    pub(super) saturated_px: u32,
    pub(super) masked_px: u32,
    /// It touches the border of the frame: the rest of it may lie outside.
    pub(super) cut: bool,
    /// It goes on past the end of its tile: no summit of its own.
    pub(super) goes_on: bool,
    /// Sums over the pixels of du, dv, du^2, du dv, dv^2, from the first pixel.
    pub(super) moments: [f64; 5],
}

impl Outline {
    /// Why this cannot be a marker, from the outline alone.
    pub(super) fn reject(&self, shape: &Shape) -> Option<Reason> {
        if 2 * self.masked_px >= self.area_px {
            return Some(Reason::Mask);
        }
        if f64::from(self.area_px) > PI / 4.0 * shape.widest_px * shape.widest_px {
            let sun = self.saturated_px >= SUN_CORE_PX;
            return Some(if sun { Reason::Sun } else { Reason::Reflection });
        }
        if self.is_streak(shape) && self.axes_px().0 > LONGEST_SMEAR_PX {
            return Some(Reason::Streak);
        }
        let side = f64::from(self.extent.width().max(self.extent.height()));
        if self.cut && self.saturated_px >= SUN_CORE_PX && side > CUT_SUN_SHARE * shape.widest_px {
            return Some(Reason::Sun);
        }
        self.goes_on.then_some(Reason::Background)
    }

    /// Whether this is long and thin.
    pub(super) fn is_streak(&self, shape: &Shape) -> bool {
        let (long, short) = self.axes_px();
        long >= SHORTEST_STREAK_PX && long > shape.elongation * short
    }

    /// Radius of the disc of the same area, px.
    pub(super) fn radius_px(&self) -> f64 {
        (f64::from(self.area_px) / PI).sqrt()
    }

    /// Whether this lies in the glare around `sun`.
    pub(super) fn is_in_glare_of(&self, sun: &Outline) -> bool {
        let reach = sun.radius_px() * GLARE_REACH;
        let gap = |low: u32, high: u32, sun_low: u32, sun_high: u32| {
            f64::from(low.saturating_sub(sun_high).max(sun_low.saturating_sub(high)))
        };
        let (a, b) = (&self.extent, &sun.extent);
        let across = gap(a.left, a.right, b.left, b.right);
        let down = gap(a.top, a.bottom, b.top, b.bottom);
        across * across + down * down <= reach * reach
    }

    /// Unit vector along the longer of its axes, and by how much that is the longer one, px.
    pub(super) fn direction(&self) -> ((f64, f64), f64) {
        let [xx, xy, yy] = self.variances_px2();
        let (long, short) = self.axes_px();
        let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
        ((libm::cos(angle), libm::sin(angle)), long - short)
    }

    /// Second moments about the middle along columns, across, along rows, px^2.
    fn variances_px2(&self) -> [f64; 3] {
        let n = f64::from(self.area_px);
        let [u, v, uu, uv, vv] = self.moments.map(|sum| sum / n);
        let pixel = 1.0 / 12.0;
        [uu - u * u + pixel, uv - u * v, vv - v * v + pixel]
    }

    /// Sides of the rectangle with the same second moments, px: a row of n pixels is n by 1.
    fn axes_px(&self) -> (f64, f64) {
        let pixel = 1.0 / 12.0;
        let [xx, xy, yy] = self.variances_px2();
        let middle = (xx + yy) / 2.0;
        let spread = ((xx - yy) * (xx - yy) / 4.0 + xy * xy).sqrt();
        ((12.0 * (middle + spread)).sqrt(), (12.0 * (middle - spread).max(pixel)).sqrt())
    }
}
