//! Rendered frames of known content, and the detections in them.

use photinus::camera::Pixel;
use photinus::frame::{FrameView, Mask};
use photinus::spots::{Brightness, Detections, Detector, Reason, Settings, Spot};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// The rules for what is bright, with their defaults.
pub(crate) const RULES: [Brightness; 2] = [Brightness::Threshold(200), Brightness::Contrast(20)];

/// Light on a sensor before noise, rounding and clipping, grey levels.
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) width: usize,
    pub(crate) height: usize,
    light: Vec<f64>,
}

impl Scene {
    /// An even background.
    pub(crate) fn flat(width: usize, height: usize, level: f64) -> Self {
        Self::new(width, height, |_, _| level)
    }

    /// A background of the level at each (u, v).
    pub(crate) fn new(width: usize, height: usize, level: impl Fn(f64, f64) -> f64) -> Self {
        let light = (0..width * height).map(|i| level((i % width) as f64, (i / width) as f64)).collect();
        Self { width, height, light }
    }

    fn add(&mut self, centre: Pixel, light_at: impl Fn(f64, f64) -> f64) {
        for (i, light) in self.light.iter_mut().enumerate() {
            *light += light_at((i % self.width) as f64 - centre.u, (i / self.width) as f64 - centre.v);
        }
    }

    /// A Gaussian marker of this width (sigma) and height above the background.
    pub(crate) fn marker(&mut self, centre: Pixel, width_px: f64, height: f64) {
        self.add(centre, |du, dv| height * libm::exp(-(du * du + dv * dv) / (2.0 * width_px * width_px)));
    }

    /// A disc of 300 grey levels whose edge falls off over about `edge_px`.
    pub(crate) fn disc(&mut self, centre: Pixel, radius_px: f64, edge_px: f64) {
        self.add(centre, |du, dv| {
            300.0 / (1.0 + libm::exp((libm::hypot(du, dv) - radius_px) / (0.35 * edge_px)))
        });
    }

    /// A saturated disc of 20 px, a halo and six streaks.
    pub(crate) fn sun(&mut self, centre: Pixel) {
        self.disc(centre, 20.0, 2.0);
        self.add(centre, |du, dv| {
            let distance = libm::hypot(du, dv);
            let angle = libm::atan2(dv, du) * 6.0 / std::f64::consts::TAU;
            let off = (angle - angle.round()).abs() * distance;
            120.0 * libm::exp(-distance / 25.0) + 200.0 * libm::exp(-off * off - distance / 40.0)
        });
    }

    /// A box of this many more grey levels, both corners included.
    pub(crate) fn lit_box(
        &mut self,
        (left, top): (usize, usize),
        (right, bottom): (usize, usize),
        height: f64,
    ) {
        for v in top..=bottom {
            for light in &mut self.light[v * self.width + left..=v * self.width + right] {
                *light += height;
            }
        }
    }

    /// The same where wells are full at this level.
    pub(crate) fn clipped(&self, full_dn: f64) -> Self {
        Self { light: self.light.iter().map(|light| light.min(full_dn)).collect(), ..*self }
    }

    /// The same where each pixel answers to light in its own way.
    pub(crate) fn answered(&self, answer: impl Fn(usize, usize) -> f64) -> Self {
        let pixels = self.light.iter().enumerate();
        let light = pixels.map(|(i, light)| light * answer(i % self.width, i / self.width)).collect();
        Self { light, ..*self }
    }

    /// What the sensor gives with Gaussian noise of this sigma.
    pub(crate) fn noisy(&self, sigma: f64, rng: &mut Pcg64) -> Vec<u8> {
        let mut value = |light: f64| {
            let noise: f64 = StandardNormal.sample(rng);
            (light + sigma * noise).round().clamp(0.0, 255.0) as u8
        };
        self.light.iter().map(|&light| value(light)).collect()
    }

    /// What the sensor gives without noise.
    pub(crate) fn clean(&self) -> Vec<u8> {
        self.light.iter().map(|light| light.round().clamp(0.0, 255.0) as u8).collect()
    }

    /// The detections in `pixels` of this scene.
    pub(crate) fn detect(&self, pixels: &[u8], brightness: Brightness) -> Detections {
        detect(pixels, self.width, self.height, brightness)
    }
}

pub(crate) fn detect(pixels: &[u8], width: usize, height: usize, brightness: Brightness) -> Detections {
    detect_masked(pixels, (width, height), brightness, None)
}

pub(crate) fn detect_masked(
    pixels: &[u8],
    (width, height): (usize, usize),
    brightness: Brightness,
    mask: Option<&Mask>,
) -> Detections {
    let frame = FrameView::packed(pixels, width, height).unwrap();
    let mut settings = Settings::default();
    settings.brightness = brightness;
    Detector::new(settings).unwrap().detect(&frame, mask).unwrap().clone()
}

pub(crate) fn distance_px(a: Pixel, b: Pixel) -> f64 {
    libm::hypot(a.u - b.u, a.v - b.v)
}

/// The spot within `reach_px` of `place`; panics when there is none or more than one.
pub(crate) fn spot_at(found: &Detections, place: Pixel, reach_px: f64) -> &Spot {
    let mut near = found.spots.iter().filter(|spot| distance_px(spot.centre, place) < reach_px);
    let first = near.next().unwrap_or_else(|| panic!("no spot at {place:?}: {found:?}"));
    assert!(near.next().is_none(), "two spots at {place:?}");
    first
}

/// How many were rejected for this reason.
pub(crate) fn rejected_as(found: &Detections, reason: Reason) -> usize {
    found.rejected.iter().filter(|rejected| rejected.reason == reason).count()
}
