//! Which estimator the light of a part calls for.
//!
//! In: a part in its window. Out: its centre with covariance. A spot whose core is certainly about as narrow as a pixel is
//! centred by a model of its core and halo, any other by a balanced window, a saturated one by its skirt, one beside another
//! or cut by the border by the parabola through its summit. Where charge may have overflowed only pixels that touch no
//! saturated one are believed, and only where they fit a halo: a wide spot with a flat top does not.

use nalgebra::Matrix2;

use super::centroid::{self, PixelVariance};
use super::halo;
use super::measuring::reach_px;
use super::part::Part;
use super::patch::{Patch, Surroundings};
use super::skirt::{self, Fit};
use crate::camera::Pixel;

/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = 0.288_675_134_594_812_9;
/// Radius around the summit of a spot in which its own light is far above that of a spot beside it, px.
const SUMMIT_PX: f64 = 1.8;
/// A spot with less of its light in four pixels has so wide a core that the grid does not pull.
const NARROW_SHARE: f32 = 0.85;
/// The grid pulls a core of this sigma by two thousandths of a pixel at most, px.
const WIDEST_CORE_PX: f64 = 0.5;
/// A skirt that fits as well as this (squared misfit over degrees of freedom) is that of a Gaussian ...
const GAUSSIAN_MISFIT: f64 = 1.5;
/// ... and one that fits no better than this is not: its summit says less than its formal covariance.
const LARGEST_MISFIT: f64 = 5.0;
/// Where a core in a halo, or a halo, fits no better than this there is more: charge that has overflowed, or no halo at all.
const OVERFLOW_MISFIT: f64 = 2.0;
/// Light of a core, in units of what saturates a pixel, from which charge may overflow unseen: a full pixel holds several
/// times what its converter tells.
const OVERFLOW: f64 = 6.0;
/// As many pixels as a core about as narrow as a pixel saturates without that.
const MOST_SATURATED_PX: u32 = 4;
/// Sigma of a centre by core and halo, or by the halo alone, from which other ways to find it are as good, px.
const WORST_CORE_PX: f64 = 0.22;
const WORST_HALO_PX: f64 = 0.1;
/// Error of the centre of a saturated core of no pixels at all, px; it falls with the root of their number.
const SATURATION_BLUR_PX: f64 = 0.13;
/// Error of the centre of a spot whose window is cut short by another spot, or that should be a core in a halo and is
/// not: two LEDs in one, px.
const CROWDED_BLUR_PX: f64 = 0.07;

/// Less scattered light than this share of a spot's own does not pull its window.
const PULLING_SHARE: f64 = 0.1;

/// The pixels that tell of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) radius_px: f64,
    /// How far light is the part's own, px.
    pub(super) room_px: f64,
    pub(super) around: Surroundings,
    /// Other light comes so near that the window is narrower than the spot.
    pub(super) crowded: bool,
}

/// Another part, whose halo reaches into the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside {
    pub(super) place: Pixel,
    /// Its light at the edge of its spot, over the part's own, as far as it reaches.
    pub(super) share: f64,
}

/// A part in its window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    pub(super) part: &'a Part,
    pub(super) window: Window,
    /// Noise of a pixel as the settings tell it.
    pub(super) told: PixelVariance,
    /// Light in the window, grey levels.
    pub(super) flux: f64,
    /// The part that scatters most light into the window.
    pub(super) beside: Option<Beside>,
    /// Whether core and halo may be looked for: it takes time.
    pub(super) models: bool,
}

type Placed = (Pixel, Matrix2<f64>);

impl Seen<'_> {
    /// The centre and its covariance, px^2. `patch` holds the signal around the part; it may be changed.
    pub(super) fn centre(&self, patch: &mut Patch) -> Placed {
        let outline = &self.part.outline;
        let found = if outline.cut {
            self.summit(patch, SUMMIT_PX.max(self.part.radius_px)).or_else(|| self.balanced(patch, false))
        } else if outline.saturated_px > 0 {
            self.saturated(patch)
        } else {
            self.clear(patch)
        };
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        let (centre, covariance) = found.unwrap_or((self.part.guess, anywhere));
        (centre, if outline.cut { covariance + anywhere } else { covariance })
    }

    /// A spot without a saturated pixel.
    fn clear(&self, patch: &Patch) -> Option<Placed> {
        let is_narrow = patch.share_in_four(self.part.guess) >= NARROW_SHARE;
        let may_be_narrow = is_narrow || self.beside.is_some();
        let core = if self.models && may_be_narrow { self.core(patch) } else { None };
        let core = core.filter(|core| is_narrow || core.fit.misfit < LARGEST_MISFIT);
        // A wider core that stands alone is the window's.
        let is_wide = self.beside.is_none() && core.is_some_and(|core| core.width_px > WIDEST_CORE_PX);
        let worst_px2 = 2.0 * WORST_CORE_PX * WORST_CORE_PX;
        let core = core.filter(|core| !is_wide && core.fit.covariance_px2.trace() < worst_px2);
        let is_pulled = self.beside.is_some_and(|beside| beside.share > PULLING_SHARE);
        let is_unclear = (is_narrow || is_pulled) && !is_wide;
        let crowded = || if self.window.crowded { self.crowded(patch) } else { None };
        core.map(|core| placed(core.fit)).or_else(crowded).or_else(|| self.balanced(patch, is_unclear))
    }

    /// A saturated spot: the whole skirt where it is that of a Gaussian, else core and halo, or the halo alone.
    fn saturated(&self, patch: &mut Patch) -> Option<Placed> {
        let radius_px = (self.part.radius_px + 2.5).min(self.window.radius_px + 1.0);
        let worst_px2 = 2.0 * self.blur_of_saturation_px2();
        // Neither skirt nor halo knows of the light of a spot beside.
        let pull_px2 = if self.beside.is_some() { self.blur_of_saturation_px2() / 2.0 } else { 0.0 };
        let pulled = |fit: Fit| (fit.centre, fit.covariance_px2 + Matrix2::from_diagonal_element(pull_px2));
        let skirt =
            skirt::fit(patch, self.part.guess, radius_px as f32, self.lowest_saturated(), self.noise());
        let skirt = skirt.filter(|fit| fit.misfit < LARGEST_MISFIT && fit.covariance_px2.trace() < worst_px2);
        if let Some(fit) = skirt.filter(|fit| fit.misfit < GAUSSIAN_MISFIT || !self.models) {
            return Some(pulled(fit));
        }
        let model = if self.models { self.saturated_core(patch).or_else(|| self.halo(patch)) } else { None };
        let surer = |a: Fit, b: Fit| if a.covariance_px2.trace() < b.covariance_px2.trace() { a } else { b };
        let found = [model, skirt].into_iter().flatten().reduce(surer).map(pulled);
        found.or_else(|| {
            patch.show_overflow();
            self.balanced(patch, false)
        })
    }

    /// By core and halo, where so few pixels are saturated that no charge may have overflowed.
    fn saturated_core(&self, patch: &Patch) -> Option<Fit> {
        if self.part.outline.saturated_px > MOST_SATURATED_PX {
            return None;
        }
        let most = OVERFLOW * f64::from(self.lowest_saturated());
        let core = self.core(patch).filter(|core| core.light < most);
        core.map(|core| core.fit).filter(|fit| fit.misfit < OVERFLOW_MISFIT)
    }

    /// By core and halo, next to the halo of a spot beside.
    fn core(&self, patch: &Patch) -> Option<halo::Core> {
        let guess = halo::Guess {
            centre: self.part.guess,
            flux: self.flux,
            beside: self.beside.map(|beside| beside.place),
        };
        halo::fit(patch, &guess, self.reach_px(), self.lowest_saturated(), self.noise())
    }

    /// By the halo alone: no charge overflows further than into the pixels that touch a full one, and no narrow core shines
    /// further.
    fn halo(&self, patch: &mut Patch) -> Option<Fit> {
        if self.beside.is_some() {
            return None;
        }
        patch.hide_overflow(self.lowest_saturated());
        let fit = skirt::fit(patch, self.part.guess, self.reach_px(), self.lowest_saturated(), self.noise());
        let worst_px2 = 2.0 * WORST_HALO_PX * WORST_HALO_PX;
        fit.filter(|fit| fit.misfit < OVERFLOW_MISFIT && fit.covariance_px2.trace() < worst_px2)
    }

    /// By the parabola through the logarithm of the light within `radius_px`.
    fn summit(&self, patch: &Patch, radius_px: f64) -> Option<Placed> {
        let saturation = self.lowest_saturated();
        skirt::fit(patch, self.part.guess, radius_px as f32, saturation, self.noise()).map(placed)
    }

    /// By the summit of a spot in the light of another, which may be two spots.
    fn crowded(&self, patch: &Patch) -> Option<Placed> {
        let (centre, covariance_px2) = self.summit(patch, SUMMIT_PX)?;
        Some((centre, covariance_px2 + Matrix2::from_diagonal_element(CROWDED_BLUR_PX * CROWDED_BLUR_PX)))
    }

    /// By a balanced window.
    fn balanced(&self, patch: &Patch, is_unclear: bool) -> Option<Placed> {
        let window_px = self.window.radius_px as f32;
        let (centre, covariance) = centroid::balance(patch, self.part.guess, window_px, self.noise())?;
        let missing_px2 = match (self.part.outline.cut, self.part.outline.saturated_px > 0) {
            (true, _) => self.part.radius_px * self.part.radius_px / 4.0,
            (false, true) => self.blur_of_saturation_px2(),
            (false, false) if self.window.crowded || is_unclear => CROWDED_BLUR_PX * CROWDED_BLUR_PX,
            (false, false) => 0.0,
        };
        Some((centre, covariance + Matrix2::from_diagonal_element(missing_px2)))
    }

    /// Noise of a pixel, the frame's own where that is more.
    fn noise(&self) -> PixelVariance {
        PixelVariance { dark: self.told.dark.max(self.window.around.variance), ..self.told }
    }

    /// The radius of a model, px: beyond the window, where there is room, it weighs what it sees.
    fn reach_px(&self) -> f32 {
        (self.window.radius_px + 1.0).min(self.window.room_px) as f32
    }

    /// The lowest signal that a pixel at 255 can have anywhere in the window.
    fn lowest_saturated(&self) -> f32 {
        let Surroundings { level, slope: [rise_u, rise_v], .. } = self.window.around;
        let reach_px = reach_px(self.window.radius_px) as f32;
        f32::from(u8::MAX) - level - (rise_u.abs() + rise_v.abs()) * reach_px
    }

    /// Variance of the centre of a saturated core that shows no skirt, px^2: its outline is known to a pixel all around.
    fn blur_of_saturation_px2(&self) -> f64 {
        let saturated_px = f64::from(self.part.outline.saturated_px.max(5));
        SATURATION_BLUR_PX * SATURATION_BLUR_PX / (saturated_px + 4.0)
    }
}

fn placed(fit: Fit) -> Placed {
    (fit.centre, fit.covariance_px2)
}
