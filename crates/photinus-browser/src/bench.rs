//! A locator with a picture in front of it.

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};

use crate::told;

/// A locator, the picture, and what was told of it.
#[derive(Debug)]
pub struct Bench {
    locator: Locator,
    pixels: Vec<u8>,
    told: String,
}

impl Bench {
    /// For an equidistant lens with its axis in the middle of the image, and a ring of so many arms and LEDs on each. `None` where there
    /// is no such camera or ring.
    pub fn new(
        [width, height]: [usize; 2],
        focal_px: f64,
        [arms, leds_per_arm]: [usize; 2],
        radius_m: f64,
        splay_deg: f64,
    ) -> Option<Self> {
        let centre = Pixel::new(0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0));
        let lens = Ideal::new(IdealLaw::Equidistant, [focal_px; 2], centre).ok()?;
        let camera = Camera::new(Model::Ideal(lens), width, height, None).ok()?;
        let splay_rad = splay_deg.to_radians();
        let airframe = Airframe::from_ring("ring", Ring { arms, radius_m, leds_per_arm, splay_rad }).ok()?;
        let locator = Locator::new(camera, &airframe, None, Settings::default()).ok()?;
        Some(Self { locator, pixels: vec![0; width * height], told: String::new() })
    }

    /// Where the picture goes.
    pub fn pixels(&mut self) -> *mut u8 {
        self.pixels.as_mut_ptr()
    }

    /// The picture, to be written to.
    pub fn picture(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// Locates; the length of what is told.
    pub fn locate(&mut self, is_level: bool) -> usize {
        let (width, height) = (self.locator.camera().width(), self.locator.camera().height());
        self.told.clear();
        let Ok(view) = FrameView::packed(&self.pixels, width, height) else { return 0 };
        let down = Vector3::y_axis();
        let input = Input::frame(&view).gravity(is_level.then_some(&down));
        let Ok(located) = self.locator.locate(input) else { return 0 };
        told::write(located, &mut self.told);
        self.told.len()
    }

    /// What was told, as JSON.
    pub fn told(&self) -> &str {
        &self.told
    }
}
