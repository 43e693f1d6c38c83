//! Snapshot -> frame with truth.
//!
//! A frame in the order of the light: every LED that shines towards the camera is drawn where it falls (`lights.rs`), by way of
//! mirrors too (`mirrors.rs`), what the observer's own airframe leaves of it (`own.rs`), hot pixels and shot noise are added, charge overflows, the sun's disc and the background are laid under it (`backdrop.rs`), and one
//! pass over the rows reads it out. A frame depends on camera, seed, snapshot and number alone.

mod backdrop;
mod lights;
mod mirrors;
mod own;
#[cfg(test)]
mod tests;
mod view;

use std::sync::Arc;

use nalgebra::{Unit, Vector3};
use photinus_io::dataset::TruthFrame;
use photinus_io::image::GreyImage;

use crate::sensor::{Background, Charge, Readout, Sensor, hash};
use crate::snapshot::Snapshot;
use backdrop::Backdrop;
use own::Own;
pub use view::CameraView;

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

/// Renders what one camera sees. It keeps the camera's hot pixels and its own memory; the world is handed to it.
#[derive(Clone, Debug)]
pub struct Renderer {
    view: Arc<CameraView>,
    /// Where the optical axis meets the image.
    axis_px: [f64; 2],
    seed: u64,
    hot_pixels: Vec<HotPixel>,
    charge: Charge,
    background: Background,
    backdrop: Backdrop,
    readout: Readout,
    own: Own,
}

#[derive(Clone, Copy, Debug)]
struct HotPixel {
    u: usize,
    v: usize,
    dark: Dark,
}

/// What a hot pixel gathers without light.
#[derive(Clone, Copy, Debug)]
enum Dark {
    ElectronsPerSecond(f64),
    /// As measured, whatever the exposure.
    Electrons(f64),
}

impl Dark {
    fn electrons(self, exposure_s: f64) -> f64 {
        match self {
            Self::ElectronsPerSecond(rate) => rate * exposure_s,
            Self::Electrons(charge) => charge,
        }
    }
}

/// Charge of a hot pixel that reads so much above darkness; a full one holds twice its well.
fn measured_electrons(sensor: &Sensor, level_dn: f64) -> f64 {
    sensor.electrons_at(level_dn + sensor.dark_offset_dn).min(2.0 * sensor.full_well_e)
}

impl Renderer {
    /// A renderer for a camera; `seed` is that of its hot pixels and its noise.
    pub fn new(view: CameraView, seed: u64) -> Self {
        let (width, height) = (view.camera.width(), view.camera.height());
        let count = (view.sensor.hot_pixel_share * (width * height) as f64).round() as u64;
        let hot = |index: u64| {
            let draw = hash(seed ^ hash(index));
            let uniform = ((hash(draw) >> 11) as f64 + 1.0) / (1_u64 << 53) as f64;
            let rate = -libm::log(uniform) * view.sensor.hot_pixel_e_per_s;
            let (u, v) = (draw as usize % width, (draw >> 20) as usize % height);
            HotPixel { u, v, dark: Dark::ElectronsPerSecond(rate) }
        };
        let measured = view.camera.optics().map(|optics| optics.hot_pixels.iter().copied());
        let measured = measured.into_iter().flatten().map(|hot| HotPixel {
            u: (hot.column as usize).min(width - 1),
            v: (hot.row as usize).min(height - 1),
            dark: Dark::Electrons(measured_electrons(&view.sensor, hot.level_dn.value)),
        });
        let axis = view.camera.model().centre();
        Self {
            seed,
            axis_px: [axis.u, axis.v],
            hot_pixels: (0..count).map(hot).chain(measured).collect(),
            charge: Charge::new(width, height),
            background: Background::new(width, height),
            backdrop: Backdrop::new(&view.camera, &view.lens),
            readout: Readout::of_unit(&view.sensor, (width, height), seed),
            own: Own::default(),
            view: Arc::new(view),
        }
    }

    /// The camera.
    pub fn view(&self) -> &CameraView {
        &self.view
    }

    /// Renders a snapshot; `frame` is its number in the truth, and tells its noise from that of other frames.
    pub fn render(&mut self, snapshot: &Snapshot, frame: u64) -> Rendered {
        let key = hash(self.seed ^ hash(frame));
        let exposure = snapshot.exposure;
        let world_from_camera = snapshot.camera.pose(exposure.share(0.5 * exposure.length_s));
        self.charge.clear();
        let (neighbours, mut electrons) = self.draw_markers(snapshot);
        electrons += self.draw_glints(snapshot, &world_from_camera, key);
        electrons += self.draw_lamps(snapshot);
        electrons += self.draw_own_edges(&snapshot.emitter, exposure.length_s);
        for hot in &self.hot_pixels {
            self.charge.add(hot.u, hot.v, hot.dark.electrons(exposure.length_s) as f32);
        }
        self.readout.expose(&mut self.charge, key);
        self.lay_background(snapshot, &world_from_camera, electrons);
        let down = world_from_camera.rotation.inverse() * -Vector3::z();
        Rendered {
            image: self.read(key),
            truth: TruthFrame { frame, time_s: exposure.middle_s(), neighbours, ..TruthFrame::default() },
            gravity: Unit::new_normalize(down),
        }
    }

    /// All light that falls into the frame from points, without noise, before anything overflows.
    #[cfg(test)]
    pub(crate) fn points(&mut self, snapshot: &Snapshot) -> Charge {
        self.charge.clear();
        self.draw_markers(snapshot);
        self.draw_lamps(snapshot);
        self.draw_own_edges(&snapshot.emitter, snapshot.exposure.length_s);
        self.charge.clone()
    }

    /// The markers' light alone, without noise, before anything overflows.
    #[cfg(test)]
    pub(crate) fn markers(&mut self, snapshot: &Snapshot) -> Charge {
        self.charge.clear();
        self.draw_markers(snapshot);
        self.charge.clone()
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
