//! A camera as the renderer needs it: where light falls, how it spreads, what the sensor makes of it.

use photinus::camera::Camera;

use crate::optics::Lens;
use crate::sensor::{Sensor, Shutter};
use crate::snapshot::Exposure;

/// A camera: projection, lens and sensor.
#[derive(Clone, Debug)]
pub struct CameraView {
    /// Its projection.
    pub camera: Camera,
    /// Its lens and filter.
    pub lens: Lens,
    /// Its sensor.
    pub sensor: Sensor,
}

impl CameraView {
    /// When a frame is exposed whose first row begins at `start_s` and is exposed for `length_s`.
    pub fn exposure(&self, start_s: f64, length_s: f64) -> Exposure {
        let rows_s = self.delay_s((self.camera.height() - 1) as f64);
        Exposure { start_s, length_s, rows_s }
    }

    /// How much later than the first row a row is exposed, s.
    pub(super) fn delay_s(&self, row: f64) -> f64 {
        match self.sensor.shutter {
            Shutter::Global => 0.0,
            Shutter::Rolling { line_s } => line_s * row,
        }
    }
}
