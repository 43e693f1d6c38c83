//! From the set-up's file, with the parts that it names laid under it, to what simulator and core take: each number within what it can be.

use core::f64::consts::{FRAC_PI_4, TAU};
use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::airframe::{Airframe, Led, Lobe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::spots::Brightness;
use photinus_io::airframe::read_airframe;
use photinus_io::{Error, Place, Result, physics, read_camera, table as toml_table};
use photinus_sim::background::{Daylight, Sky};
use photinus_sim::optics::{Gaussian, Lens, PointSpread};
use photinus_sim::preset::{BLUEFOX_FIT, bluefox};
use photinus_sim::sensor::{Overflow, Sensor};
use photinus_sim::source::Emitter;
use toml::{Table, Value};

use super::table::{
    AirframeTable, DetectorTable, FilterTable, LedTable, LensTable, RingTable, SensorTable, SetupTable,
    SkyName, SkyTable,
};
use super::{Light, PARTS, Setup, Watch};

/// Reads a set-up from its text.
pub(super) fn read(text: &str, path: &Path) -> Result<Setup> {
    let mut table: Table = toml_table::parse(text, path)?;
    for kind in ["led", "filter", "lens", "sensor"] {
        lay_part(&mut table, kind, path)?;
    }
    let laid = toml::to_string(&table).map_err(|error| Error::format(path, error.to_string()))?;
    // Lines of what was laid together are nobody's: a message names the key.
    let table: SetupTable = toml_table::parse(&laid, path).map_err(|error| Error { place: None, ..error })?;
    Reading { path }.setup(table)
}

/// Lays the keys of the part that a table names under its own.
fn lay_part(setup: &mut Table, kind: &str, path: &Path) -> Result<()> {
    let Some(Value::Table(own)) = setup.get_mut(kind) else { return Ok(()) };
    let Some(named) = own.remove("part") else { return Ok(()) };
    let parts: Table = toml_table::parse(PARTS, Path::new("parts.toml"))?;
    let known = parts.get(kind).and_then(Value::as_table);
    let part = known.zip(named.as_str()).and_then(|(known, name)| known.get(name)?.as_table());
    let Some(part) = part else {
        let names = known.map_or(Vec::new(), |known| known.keys().cloned().collect());
        let place = Place::Key(format!("{kind}.part"));
        return Err(Error::format(path, format!("{named} is not known"))
            .at(place)
            .advise(format!("choose among {}, or give the numbers of your own", names.join(", "))));
    };
    for (key, value) in part.iter().filter(|(key, _)| *key != "source") {
        own.entry(key.clone()).or_insert_with(|| value.clone());
    }
    Ok(())
}

/// Turns tables into parts, each number within what it can be.
struct Reading<'a> {
    path: &'a Path,
}

impl Reading<'_> {
    fn within(&self, key: &str, value: f64, least: f64, most: f64) -> Result<f64> {
        physics::within(self.path, key, value, &(least..=most))
    }

    fn refuse(&self, key: &str, reason: impl Into<String>) -> Error {
        Error::format(self.path, reason).at(Place::Key(key.to_owned()))
    }

    fn setup(&self, table: SetupTable) -> Result<Setup> {
        let (emitter, light) = self.led(&table.led)?;
        let exposure_us =
            physics::within(self.path, "exposure_us", table.exposure_us, &physics::EXPOSURE_US)?;
        let camera = match &table.camera {
            Some(file) => read_camera(self.beside(file))?.camera,
            None => self.camera(&table.lens, &table.sensor)?,
        };
        let battery = table.battery.map(|battery| -> Result<[f64; 2]> {
            let capacity_wh = self.within("battery.capacity_wh", battery.capacity_wh, 0.1, 1e5)?;
            Ok([capacity_wh, self.within("battery.hover_w", battery.hover_w, 0.1, 1e5)?])
        });
        Ok(Setup {
            lens: self.lens(&table.lens, &table.filter, &table.sensor)?,
            sensor: self.sensor(&table.sensor)?,
            airframe: self.airframe(&table.airframe, light.lobe_power)?,
            daylight: self.daylight(&table.sky)?,
            brightness: self.brightness(&table.detector)?,
            watch: Watch {
                azimuth_rad: self.within("view.azimuth_deg", table.view.azimuth_deg, 0.0, 85.0)?.to_radians(),
                elevation_rad: self
                    .within("view.elevation_deg", table.view.elevation_deg, 0.0, 60.0)?
                    .to_radians(),
            },
            wanted_m: self.within("wanted.range_m", table.wanted.range_m, 0.5, 500.0)?,
            battery: battery.transpose()?,
            emitter,
            light,
            camera,
            exposure_us,
        })
    }

    fn led(&self, led: &LedTable) -> Result<(Emitter, Light)> {
        let within = |key: &str, value, least, most| self.within(&format!("led.{key}"), value, least, most);
        let rated_ma = within("rated_current_ma", led.rated_current_ma, 0.1, 1e5)?;
        let current_ma = within("current_ma", led.current_ma.unwrap_or(rated_ma), 0.01, 1e5)?;
        let rated_w = within("radiant_power_mw", led.radiant_power_mw, 1e-3, 1e6)? * 1e-3;
        let lobe_power = within("lobe_power", led.lobe_power, 0.0, 200.0)?;
        let power_w = rated_w * current_ma / rated_ma;
        let emitter = Emitter {
            // A cosine to the power of n sends 2 pi / (n + 1) of its peak into the half sphere.
            peak_w_per_sr: power_w * (lobe_power + 1.0) / TAU,
            radius_m: 0.5e-3 * within("face_mm", led.face_mm, 0.01, 100.0)?,
            unit_spread: within("unit_spread", led.unit_spread, 0.0, 1.0)?,
            wavelength_m: within("wavelength_nm", led.wavelength_nm, 315.0, 400.0)? * 1e-9,
        };
        let electrical_w = current_ma * 1e-3 * within("forward_v", led.forward_v, 0.5, 100.0)?
            / within("driver_efficiency", led.driver_efficiency, 0.01, 1.0)?;
        Ok((emitter, Light { electrical_w, lobe_power }))
    }

    fn lens(&self, lens: &LensTable, filter: &FilterTable, sensor: &SensorTable) -> Result<Lens> {
        let within = |key: &str, value, least, most| self.within(&format!("lens.{key}"), value, least, most);
        let pixel_um = self.within("sensor.pixel_um", sensor.pixel_um, 0.3, 100.0)?;
        let pupil_m = within("focal_mm", lens.focal_mm, 0.1, 1000.0)? * 1e-3
            / within("f_number", lens.f_number, 0.5, 64.0)?;
        let halo_share = within("halo_share", lens.halo_share, 0.0, 0.99)?;
        let px = |key: &str, um: f64| Ok::<f64, Error>(within(key, um, 0.1, 500.0)? / pixel_um);
        let mut parts =
            vec![Gaussian { share: 1.0 - halo_share, sigma_px: px("core_um", lens.core_um)?.max(0.05) }];
        if halo_share > 0.0 {
            parts.push(Gaussian { share: halo_share, sigma_px: px("halo_um", lens.halo_um)?.max(0.05) });
        }
        let spread = PointSpread::new(parts, 0.0)
            .ok_or_else(|| self.refuse("lens", "no lens spreads light like that"))?;
        Ok(Lens {
            pupil_m2: FRAC_PI_4 * pupil_m * pupil_m,
            transmission: within("transmission", lens.transmission, 1e-6, 1.0)?
                * self.within("filter.transmission", filter.transmission, 1e-6, 1.0)?,
            side_illumination: within("side_illumination", lens.side_illumination, 0.0, 1.0)?,
            falloff: None,
            vignette: None,
            spread,
            veiling_glare: 0.0,
        })
    }

    fn sensor(&self, table: &SensorTable) -> Result<Sensor> {
        let within =
            |key: &str, value, least, most| self.within(&format!("sensor.{key}"), value, least, most);
        let electrons_per_dn = within("electrons_per_dn", table.electrons_per_dn, 0.1, 1e4)?;
        // what no table here speaks of is as plain as in the simulator's preset
        Ok(Sensor {
            quantum_efficiency: within("quantum_efficiency", table.quantum_efficiency, 1e-3, 1.0)?,
            electrons_per_dn,
            full_well_e: within("full_reads_dn", table.full_reads_dn, 101.0, 1e5)? * electrons_per_dn,
            overflow: Overflow { spill: within("spill", table.spill, 0.0, 1.0)? },
            read_noise_e: within("read_noise_e", table.read_noise_e, 0.0, 1e4)?,
            dark_current_e_per_s: within("dark_current_e_per_s", table.dark_current_e_per_s, 0.0, 1e7)?,
            hot_pixel_share: 0.0,
            ..bluefox(&BLUEFOX_FIT).sensor
        })
    }

    /// A lens of the equidistant law in front of the sensor.
    fn camera(&self, lens: &LensTable, sensor: &SensorTable) -> Result<Camera> {
        let focal_px = lens.focal_mm * 1e3 / sensor.pixel_um;
        let [u, v] = [sensor.width_px, sensor.height_px].map(|side| 0.5 * (side as f64 - 1.0));
        let camera = Ideal::new(IdealLaw::Equidistant, [focal_px; 2], Pixel::new(u, v))
            .and_then(|law| Camera::new(Model::Ideal(law), sensor.width_px, sensor.height_px, None));
        camera.map_err(|error| Error::new(self.path, error).advise("correct lens and sensor"))
    }

    /// An airframe whose LEDs shine as the LED does.
    fn airframe(&self, table: &AirframeTable, lobe_power: f64) -> Result<Airframe> {
        let airframe = match (&table.ring, &table.file) {
            (Some(ring), None) => {
                let splay_rad = ring.splay_deg.to_radians();
                let RingTable { arms, radius_m, leds_per_arm, .. } = *ring;
                Airframe::from_ring("ring", Ring { arms, radius_m, leds_per_arm, splay_rad }).map_err(
                    |error| Error::new(self.path, error).at(Place::Key("airframe.ring".to_owned())),
                )?
            }
            (None, Some(file)) => return Ok(read_airframe(self.beside(file))?.airframe),
            _ => return Err(self.refuse("airframe", "it takes a ring or a file").advise("give one of them")),
        };
        let lobe = if (lobe_power - 1.0).abs() < 1e-9 {
            Lobe::Lambertian
        } else {
            Lobe::Cosine { power: lobe_power }
        };
        let leds: Vec<Led> =
            airframe.leds().iter().map(|led| Led { lobe: lobe.clone(), ..led.clone() }).collect();
        Airframe::new(airframe.name(), leds).map_err(|error| Error::new(self.path, error))
    }

    fn daylight(&self, table: &SkyTable) -> Result<Option<Daylight>> {
        let sun_rad = self.within("sky.sun_deg", table.sun_deg, 0.0, 90.0)?.to_radians();
        // to the side of the camera, out of the image
        let sun = Unit::new_normalize(Vector3::new(0.0, libm::cos(sun_rad), libm::sin(sun_rad)));
        Ok(match table.kind {
            SkyName::Night => None,
            SkyName::Overcast => Some(Daylight::new(Sky::Overcast, sun)),
            SkyName::Clear => Some(Daylight::new(Sky::Clear, sun)),
        })
    }

    fn brightness(&self, table: &DetectorTable) -> Result<Brightness> {
        match (table.contrast, table.threshold) {
            (Some(_), Some(_)) => {
                Err(self.refuse("detector", "it takes a contrast or a threshold").advise("give one of them"))
            }
            (_, Some(0)) | (Some(0), _) => Err(self.refuse("detector", "everything is bright above 0")),
            (None, Some(level)) => Ok(Brightness::Threshold(level)),
            (Some(step), None) => Ok(Brightness::Contrast(step)),
            (None, None) => Ok(Brightness::default()),
        }
    }

    fn beside(&self, file: &Path) -> PathBuf {
        self.path.parent().map_or_else(|| file.to_owned(), |folder| folder.join(file))
    }
}
