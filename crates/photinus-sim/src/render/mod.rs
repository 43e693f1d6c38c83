//! Scene -> frames with truth.
//!
//! A frame in the order of the light: every LED that shines towards the camera is drawn where it falls (`lights.rs`), hot
//! pixels and shot noise are added, charge overflows, the sun's disc and the background are laid under it (`backdrop.rs`), and one
//! pass over the rows reads it out. A frame depends on scene and number alone, so threads may share them out as they like.

mod backdrop;
mod lights;
mod parallel;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Unit, Vector3};
use photinus_io::dataset::TruthFrame;
use photinus_io::image::GreyImage;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::scene::{MountedCamera, Scene};
use crate::sensor::{Background, Charge, Readout, Shutter, hash};
use backdrop::Backdrop;

/// A frame and what was there.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The frame.
    pub image: GreyImage,
    /// Where everything was, at the middle of the exposure.
    pub truth: TruthFrame,
    /// Direction of gravity (down) in the camera frame.
    pub gravity: Unit<Vector3<f64>>,
}

/// Renders the frames of one camera of a scene.
#[derive(Clone, Debug)]
pub struct Simulator<'a> {
    scene: &'a Scene,
    mounted: &'a MountedCamera,
    camera_index: usize,
    /// Where the optical axis meets the image.
    axis_px: [f64; 2],
    unit_factors: Vec<Vec<f64>>,
    hot_pixels: Vec<(usize, usize, f32)>,
    charge: Charge,
    background: Background,
    backdrop: Backdrop,
    readout: Readout,
}

/// The three instants between which motion during an exposure is taken as quadratic, s.
#[derive(Clone, Copy, Debug)]
struct Exposure {
    start_s: f64,
    length_s: f64,
}

impl Exposure {
    fn instants_s(&self) -> [f64; 3] {
        [self.start_s, self.start_s + 0.5 * self.length_s, self.start_s + self.length_s]
    }

    fn delayed(&self, delay_s: f64) -> Self {
        Self { start_s: self.start_s + delay_s, ..*self }
    }
}

impl<'a> Simulator<'a> {
    /// A simulator of camera number `camera` of a scene; `None` when there is no such camera.
    pub fn new(scene: &'a Scene, camera: usize) -> Option<Self> {
        let mounted = scene.cameras.get(camera)?;
        let (width, height) = (mounted.camera.width(), mounted.camera.height());
        let sensor = &scene.preset.sensor;
        let mut random = Pcg64::new(u128::from(scene.seed), 0x1ed);
        let emitter = &scene.preset.emitter;
        let mut factor = || emitter.unit_factor(StandardNormal.sample(&mut random));
        let unit_factors = scene
            .targets
            .iter()
            .map(|target| target.airframe.leds().iter().map(|_| factor()).collect())
            .collect();
        let count = (sensor.hot_pixel_share * (width * height) as f64).round() as u64;
        let hot = |index: u64| {
            let draw = hash(scene.seed ^ hash(index ^ ((camera as u64) << 32)));
            let (u, v) = (draw as usize % width, (draw >> 20) as usize % height);
            let uniform = ((hash(draw) >> 11) as f64 + 1.0) / (1_u64 << 53) as f64;
            let electrons = -libm::log(uniform) * sensor.hot_pixel_e_per_s * scene.exposure_us * 1e-6;
            (u, v, electrons as f32)
        };
        Some(Self {
            scene,
            mounted,
            camera_index: camera,
            axis_px: [mounted.camera.model().centre().u, mounted.camera.model().centre().v],
            unit_factors,
            hot_pixels: (0..count).map(hot).collect(),
            charge: Charge::new(width, height),
            background: Background::new(width, height),
            backdrop: Backdrop::new(&mounted.camera, &scene.preset.lens),
            readout: Readout::of_unit(sensor, (width, height), hash(scene.seed ^ ((camera as u64) << 32))),
        })
    }

    /// Frame number `number`, counted from 0; any, in any order.
    pub fn frame(&mut self, number: u64) -> Rendered {
        let exposure =
            Exposure { start_s: number as f64 / self.scene.rate_hz, length_s: self.scene.exposure_us * 1e-6 };
        let middle_s = exposure.instants_s()[1];
        let key = hash(self.scene.seed ^ hash(number) ^ ((self.camera_index as u64) << 56));
        self.charge.clear();
        let (neighbours, mut electrons) = self.draw_markers(exposure);
        electrons += self.draw_glints(middle_s, key);
        for &(u, v, dark) in &self.hot_pixels {
            self.charge.add(u, v, dark);
        }
        self.readout.expose(&mut self.charge, key);
        let world_from_camera = self.world_from_camera(middle_s);
        self.lay_background(&world_from_camera, electrons);
        let down = world_from_camera.rotation.inverse() * -Vector3::z();
        Rendered {
            image: self.read(key),
            truth: TruthFrame { frame: number, time_s: middle_s, neighbours },
            gravity: Unit::new_normalize(down),
        }
    }

    /// All frames of the scene, one after the other.
    pub fn frames(&mut self) -> impl Iterator<Item = Rendered> + '_ {
        (0..self.scene.frames).map(|number| self.frame(number))
    }

    fn world_from_camera(&self, time_s: f64) -> Isometry3<f64> {
        self.scene.observer.pose(time_s) * self.mounted.body_from_camera
    }

    /// How much later than the first row a row is exposed, s.
    fn delay_s(&self, row: f64) -> f64 {
        match self.scene.preset.sensor.shutter {
            Shutter::Global => 0.0,
            Shutter::Rolling { line_s } => line_s * row,
        }
    }

    fn read(&mut self, key: u64) -> GreyImage {
        let (width, height) = (self.charge.width(), self.charge.height());
        let mut pixels = vec![0; width * height];
        for (v, row) in pixels.chunks_exact_mut(width).enumerate() {
            self.readout.read_row(v, &self.background, &self.charge, key, row);
        }
        GreyImage::new(pixels, width, height).expect("the size of a camera")
    }
}
