//! The light of a part -> a spot: background, window, centre with covariance.
//!
//! In: a part and how much room it has. Out: a spot, or the reason that it is none after all. A spot that stands alone is
//! centred by a window as wide as the spot is, a saturated one by its skirt, one beside another or cut by the border by
//! the parabola through its summit.

use nalgebra::Matrix2;

use super::Spot;
use super::centroid::{self, PixelVariance};
use super::part::Part;
use super::patch::{self, Patch, Surroundings};
use super::rejection::Reason;
use super::sampling;
use super::settings::{Brightness, Settings};
use super::skirt::{self, Fit};
use crate::camera::Pixel;
use crate::frame::FrameView;

/// Standard deviation of a place known to lie somewhere in one pixel, px.
const WITHIN_A_PIXEL: f64 = 0.288_675_134_594_812_9;
/// Radius around the summit of a spot in which its own light is far above that of a spot beside it, px.
const SUMMIT_PX: f64 = 1.8;
/// A skirt that fits no better than this (squared misfit over degrees of freedom) is not that of a Gaussian: charge has
/// overflowed, or the spot is a core in a halo. Its summit says less than its formal covariance.
const LARGEST_MISFIT: f64 = 5.0;
/// Error of the centre of a saturated core of no pixels at all, px; it falls with the root of their number. On rendered
/// frames with overflow 0.08 to 0.12.
const SATURATION_BLUR_PX: f64 = 0.13;
/// Error of the centre of an undersampled spot whose window is cut short by another spot, px.
const CROWDED_BLUR_PX: f64 = 0.07;
/// The same once the light that the other scatters is taken off, px.
const RELIEVED_BLUR_PX: f64 = 0.045;

/// Measures the light of parts, one after the other in the same room.
#[derive(Debug, Default)]
pub(super) struct Meter {
    patch: Patch,
}

/// The pixels that tell of a part.
#[derive(Clone, Copy, Debug)]
struct Window {
    radius_px: f64,
    around: Surroundings,
    /// Other light comes so near that the window is narrower than the spot.
    crowded: bool,
    /// The light that the spot beside it scatters was taken off.
    relieved: bool,
}

impl Meter {
    /// Measures `part`, whose light is its own as far as `room_px` but for what a part `beside` it scatters.
    pub(super) fn measure(
        &mut self,
        frame: &FrameView<'_>,
        part: &Part,
        room_px: f64,
        beside: Option<Pixel>,
        settings: &Settings,
    ) -> Result<Spot, Reason> {
        let outline = &part.outline;
        let mut window = open_window(frame, part, room_px);
        let level = window.around.level;
        let height = f64::from(outline.peak) - f64::from(level);
        if let Brightness::Contrast(step) = settings.brightness
            && 2.0 * height < f64::from(step)
        {
            return Err(Reason::Background);
        }
        let (middle, reach) = (nearest_pixel(part.guess), reach_px(window.radius_px));
        let alone = outline.saturated_px == 0 && !outline.cut;
        let beside = beside.filter(|_| alone).is_some_and(|beside| {
            let radius_px = window.radius_px + 1.5;
            self.patch.read_beside(frame, middle, reach, radius_px, beside, part.bright)
        });
        if beside {
            (window.relieved, window.crowded) = (window.crowded, false);
        } else {
            self.patch.read(frame, middle, reach, &window.around);
        }
        let flux = self.patch.flux(part.guess, window.radius_px as f32);
        let noise = settings.noise;
        let dark = (noise.read_dn * noise.read_dn + 1.0 / 12.0) as f32;
        let variance = PixelVariance { dark: dark.max(window.around.variance), shot: noise.shot as f32 };
        let (centre, covariance_px2) = self.centre(part, &window, variance);
        Ok(Spot {
            centre,
            covariance_px2,
            area_px: outline.area_px,
            peak: outline.peak,
            saturated_px: outline.saturated_px,
            flux,
            background: f64::from(level),
            middle: part.middle,
            extent: outline.extent,
        })
    }

    /// The centre and its covariance.
    fn centre(&self, part: &Part, window: &Window, variance: PixelVariance) -> (Pixel, Matrix2<f64>) {
        let (radius, saturated_px) = (part.radius_px, part.outline.saturated_px);
        let skirt = |reach_px: f64| {
            skirt::fit(&self.patch, part.guess, reach_px as f32, lowest_saturated(window), variance)
        };
        let placed = |fit: Fit| (fit.centre, fit.covariance_px2);
        let balanced = || {
            let (centre, covariance) =
                centroid::balance(&self.patch, part.guess, window.radius_px as f32, variance)?;
            let (centre, covariance) = match saturated_px {
                0 => sampling::unfold(&self.patch, centre, covariance),
                _ => {
                    let blur = Matrix2::from_diagonal_element(blur_of_saturation(saturated_px));
                    (centre, covariance + blur)
                }
            };
            let missing = match (part.outline.cut, window.crowded) {
                (true, _) => radius / 2.0,
                (false, true) => CROWDED_BLUR_PX,
                (false, false) if window.relieved => RELIEVED_BLUR_PX,
                (false, false) => 0.0,
            };
            Some((centre, covariance + Matrix2::from_diagonal_element(missing * missing)))
        };
        let found = if saturated_px > 0 {
            let fit = skirt((radius + 2.5).min(window.radius_px + 1.0));
            let worst = 2.0 * blur_of_saturation(saturated_px);
            let good = fit.filter(|fit| fit.misfit < LARGEST_MISFIT && fit.covariance_px2.trace() < worst);
            good.map(placed).or_else(balanced)
        } else if part.outline.cut {
            skirt(SUMMIT_PX.max(radius)).map(placed).or_else(balanced)
        } else if window.crowded {
            skirt(SUMMIT_PX).map(placed).or_else(balanced)
        } else {
            balanced()
        };
        let anywhere = Matrix2::from_diagonal_element(WITHIN_A_PIXEL * WITHIN_A_PIXEL);
        let (centre, covariance) = found.unwrap_or((part.guess, anywhere));
        (centre, if part.outline.cut { covariance + anywhere } else { covariance })
    }
}

/// A window as wide as the spot is, or as its skirt where it is saturated, with the background around it.
fn open_window(frame: &FrameView<'_>, part: &Part, room_px: f64) -> Window {
    let radius = part.radius_px;
    let room = room_px.max(radius + 0.8).max(1.9);
    let around = |radius_px: f64| {
        let level = Surroundings { level: f32::from(part.level), slope: [0.0; 2], variance: 0.0 };
        patch::surroundings(frame, nearest_pixel(part.guess), reach_px(radius_px), part.bright)
            .unwrap_or(level)
    };
    let narrow = (radius + 2.5).min(room);
    let window = Window { radius_px: narrow, around: around(narrow), crowded: false, relieved: false };
    if part.outline.saturated_px > 0 {
        return window;
    }
    let spot_px = 3.5 * part.width_px(window.around.level);
    let whole = (spot_px + 1.0).min(room);
    Window {
        radius_px: whole,
        around: if whole > narrow { around(whole) } else { window.around },
        crowded: room_px < part.most_room_px().min(spot_px),
        relieved: false,
    }
}

/// The lowest signal that a pixel at 255 can have anywhere in the window.
fn lowest_saturated(window: &Window) -> f32 {
    let Surroundings { level, slope: [rise_u, rise_v], .. } = window.around;
    f32::from(u8::MAX) - level - (rise_u.abs() + rise_v.abs()) * reach_px(window.radius_px) as f32
}

fn nearest_pixel(place: Pixel) -> (i32, i32) {
    (place.u.round() as i32, place.v.round() as i32)
}

/// Pixels from the middle of a patch to its edge that hold a window of this radius, wherever in a pixel it settles.
fn reach_px(window_px: f64) -> i32 {
    window_px as i32 + 2
}

/// Variance of the centre of a saturated core that shows no skirt, px^2: its outline is known to a pixel all around.
fn blur_of_saturation(saturated_px: u32) -> f64 {
    SATURATION_BLUR_PX * SATURATION_BLUR_PX / (f64::from(saturated_px.max(5)) + 4.0)
}
