//! A locator with a picture in front of it, and what follows from picture to picture.

use nalgebra::{Rotation3, Vector3};
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};
use photinus::lookout::{Glance, Lookout};
use photinus::tracking::{self, Turned};

use crate::told;

/// The camera of the page stands still to this, rad.
const STILL_RAD: f64 = 1e-6;

/// Camera and airframe by their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetUp {
    /// Width and height of the image.
    pub size_px: [usize; 2],
    /// Pixels per radian of the equidistant lens, its axis in the middle of the image.
    pub focal_px: f64,
    /// The ring of LEDs.
    pub ring: Ring,
}

/// A locator, the picture before it, and the tracks.
#[derive(Debug)]
pub struct Bench {
    airframe: Airframe,
    locator: Locator,
    lookout: Lookout,
    pixels: Vec<u8>,
}

impl Bench {
    /// `None` where there is no such camera or ring.
    pub fn new(set_up: &SetUp) -> Option<Self> {
        let SetUp { size_px: [width, height], focal_px, ring } = *set_up;
        let centre = Pixel::new(0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0));
        let lens = Ideal::new(IdealLaw::Equidistant, [focal_px; 2], centre).ok()?;
        let camera = Camera::new(Model::Ideal(lens), width, height, None).ok()?;
        let airframe = Airframe::from_ring("ring", ring).ok()?;
        let settings = Settings::default();
        let locator = Locator::new(camera.clone(), &airframe, None, settings).ok()?;
        let lookout = Lookout::new(camera, &airframe, &settings, tracking::Settings::default(), None).ok()?;
        Some(Self { airframe, locator, lookout, pixels: vec![0; width * height] })
    }

    /// Its camera.
    pub fn camera(&self) -> &Camera {
        self.locator.camera()
    }

    /// Its airframe.
    pub fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// The picture, to be written to, a byte for each pixel.
    pub fn picture(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// Locates the neighbours in the picture, and follows them where the time of the picture is known; gravity is down in the picture if it is level.
    /// What is told is JSON.
    pub fn locate(&mut self, is_level: bool, time_s: Option<f64>) -> Option<String> {
        let (width, height) = (self.camera().width(), self.camera().height());
        let view = FrameView::packed(&self.pixels, width, height).ok()?;
        let gravity = is_level.then_some(Vector3::y_axis());
        let located = self.locator.locate(Input::frame(&view).gravity(gravity.as_ref())).ok()?;
        let tracked = time_s.and_then(|time_s| {
            let turned = Some(Turned { now_from_before: Rotation3::identity(), sigma_rad: STILL_RAD });
            self.lookout
                .look(&Glance { exposure_s: 0.0, turned, gravity, ..Glance::new(time_s, located) })
                .ok()
        });
        told::json(&told::Frame::of(located, tracked))
    }
}
