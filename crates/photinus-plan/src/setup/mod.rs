//! A set-up: enters a TOML file and the parts of data sheets that it names, leaves what simulator and core take.

mod read;
mod table;

use std::path::Path;

use nalgebra::{Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::spots::Brightness;
use photinus_io::Result;
use photinus_sim::background::Daylight;
use photinus_sim::optics::Lens;
use photinus_sim::sensor::Sensor;
use photinus_sim::source::Emitter;

/// A set-up with every key explained: the founding paper's.
pub const EXAMPLE: &str = include_str!("../../example.toml");
/// The parts that are known, with where their numbers come from.
pub const PARTS: &str = include_str!("../../parts.toml");

/// LEDs, camera, airframe and surroundings.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The LED, at its current.
    pub emitter: Emitter,
    /// What the LEDs take.
    pub light: Light,
    /// Lens and filter.
    pub lens: Lens,
    /// The sensor.
    pub sensor: Sensor,
    /// The projection.
    pub camera: Camera,
    /// Exposure, us.
    pub exposure_us: f64,
    /// The neighbours' LEDs, their lobes those of the LED.
    pub airframe: Airframe,
    /// Light behind the neighbours; `None` at night.
    pub daylight: Option<Daylight>,
    /// What is a spot.
    pub brightness: Brightness,
    /// Where neighbours are.
    pub watch: Watch,
    /// The range at which layouts are compared, m.
    pub wanted_m: f64,
    /// Capacity, Wh, and what hovering takes, W.
    pub battery: Option<[f64; 2]>,
}

/// What one LED takes, and what it is to eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Electrical power from the battery, W: current, voltage, driver.
    pub electrical_w: f64,
    /// The power of the cosine that its light falls off with.
    pub lobe_power: f64,
}

/// Where neighbours are seen: evenly within these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    /// Off the axis to either side, rad.
    pub azimuth_rad: f64,
    /// Above or below the camera, rad.
    pub elevation_rad: f64,
}

impl Setup {
    /// Reads a set-up.
    ///
    /// # Errors
    /// [`photinus_io::Error`] with key and reason where it, a part or a file that it names is not as it must be.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&photinus_io::whole::read_text(path)?, path)
    }

    /// The same from its text; `path` is for messages, and files that it names are looked for in its folder.
    ///
    /// # Errors
    /// As [`Setup::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        read::read(text, path)
    }

    /// Photo-electrons of the background in a pixel in the middle of the image, with dark current.
    pub fn background_e(&self) -> f64 {
        let middle = self.camera.model().centre();
        let exposure_s = self.exposure_us * 1e-6;
        let seen = self.camera.bearing_with_jacobian(middle);
        // the camera looks level along x of the world; somewhat above the horizon the sky is brightest
        let ahead = Unit::new_normalize(Vector3::new(1.0, 0.0, 0.06)).into_inner();
        let light_e = seen.zip(self.daylight).map_or(0.0, |((_, jacobian), daylight)| {
            let solid_angle_sr = jacobian.column(0).cross(&jacobian.column(1)).norm();
            let power_w =
                daylight.radiance(&ahead) * self.lens.pupil_m2 * self.lens.transmission * solid_angle_sr;
            self.sensor.photo_electrons(power_w, exposure_s, self.emitter.photon_j())
        });
        light_e + self.sensor.dark_current_e_per_s * exposure_s
    }

    /// Photo-electrons that an LED of such an intensity, 1 being straight ahead, sends into the camera from such a distance, off the axis.
    pub fn electrons(&self, intensity: f64, distance_m: f64, off_axis_rad: f64) -> f64 {
        let irradiance = self.emitter.irradiance_w_m2(intensity, distance_m);
        let power_w = self.lens.gathered_w(irradiance, off_axis_rad);
        self.sensor.photo_electrons(power_w, self.exposure_us * 1e-6, self.emitter.photon_j())
    }
}
