//! The light of a part -> a spot: background, window, centre with covariance.
//!
//! In: a part, how much room it has, and the part beside it whose light scatters into the window, if any. Out: a spot, or
//! the reason that it is none after all.

use super::Spot;
use super::centring::{Beside, Seen, Window};
use super::centroid::PixelVariance;
use super::part::Part;
use super::patch::{self, Patch, Surroundings};
use super::rejection::Reason;
use super::settings::{Brightness, Settings};
use crate::camera::Pixel;
use crate::frame::FrameView;

/// Measures the light of parts, one after the other in the same room.
#[derive(Debug, Default)]
pub(super) struct Meter {
    patch: Patch,
}

impl Meter {
    /// Measures `part`, whose light is its own as far as `room_px` but for what a part `beside` it scatters.
    pub(super) fn measure(
        &mut self,
        frame: &FrameView<'_>,
        part: &Part,
        room_px: f64,
        beside: Option<Beside>,
        settings: &Settings,
    ) -> Result<Spot, Reason> {
        let outline = &part.outline;
        let window = open_window(frame, part, room_px);
        let level = window.around.level;
        let height = f64::from(outline.peak) - f64::from(level);
        if let Brightness::Contrast(step) = settings.brightness
            && 2.0 * height < f64::from(step)
        {
            return Err(Reason::Background);
        }
        self.patch.read(frame, nearest_pixel(part.guess), reach_px(window.radius_px), &window.around);
        let flux = self.patch.flux(part.guess, window.radius_px as f32);
        let noise = settings.noise;
        let dark = (noise.read_dn * noise.read_dn + 1.0 / 12.0) as f32;
        let told = PixelVariance { dark, shot: noise.shot as f32 };
        let models = matches!(settings.brightness, Brightness::Contrast(_));
        let (centre, covariance_px2) =
            Seen { part, window, told, flux, beside, models }.centre(&mut self.patch);
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
    let window = Window { radius_px: narrow, room_px: room, around: around(narrow), crowded: false };
    if part.outline.saturated_px > 0 {
        return window;
    }
    let spot_px = 3.5 * part.width_px(window.around.level);
    let whole = (spot_px + 1.0).min(room);
    Window {
        radius_px: whole,
        room_px: room,
        around: if whole > narrow { around(whole) } else { window.around },
        crowded: room_px < part.most_room_px().min(spot_px),
    }
}

fn nearest_pixel(place: Pixel) -> (i32, i32) {
    (place.u.round() as i32, place.v.round() as i32)
}

/// Pixels from the middle of a patch to its edge that hold a window of this radius, wherever in a pixel it settles.
pub(super) fn reach_px(window_px: f64) -> i32 {
    window_px as i32 + 2
}
