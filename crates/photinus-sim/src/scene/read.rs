//! From the file as it stands to a scene.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use photinus_io::sky::{Site, is_utc, sun_direction};
use photinus_io::{Result, physics, read_camera, table as toml_table};

use super::camera_table::{OpticsTable, SensorTable};
use super::check::Check;
use super::table::{CameraTable, DaylightTable, PresetName, SceneTable, SkyName};
use super::{MountedCamera, Scene, Target};
use crate::background::{Daylight, Sky, Water};
use crate::clock::Clock;
use crate::instruments::Instruments;
use crate::motion::Motion;
use crate::preset::{BLUEFOX_FIT, Preset, SMALL_FISHEYE_FIT, bluefox, small_fisheye};
use crate::recording::Recording;
use crate::sensor::hash;

/// Longest scene, s, and most frames of one.
pub(super) const LONGEST_S: f64 = 86_400.0;

impl Scene {
    /// Reads a scene file and the files it names.
    ///
    /// # Errors
    /// [`photinus_io::Error`] with file, line or key and reason: see [`Scene::parse`]; and when a file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|error| photinus_io::Error::io(path, error))?;
        Self::parse(&text, path)
    }

    /// Reads the text of a scene; the files it names are relative to the folder of `path`.
    ///
    /// # Errors
    /// [`photinus_io::Error`] for unknown and missing keys, numbers that make no sense, an exposure longer than the time
    /// between frames, a target that flies through a camera, and for any error in a file that is named.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let table: SceneTable = toml_table::parse(text, path)?;
        let reader = Reader { check: Check { path }, seed: table.seed };
        let scene = reader.scene(table)?;
        reader.bits_in_an_exposure(&scene)?;
        reader.clear_of_cameras(&scene)?;
        Ok(scene)
    }
}

impl Scene {
    /// The same scene with other random numbers: noise, wind, units of LEDs.
    pub fn set_seed(&mut self, seed: u64) {
        self.seed = seed;
        let robots = self.targets.iter_mut().map(|target| (u64::from(target.id), &mut target.motion));
        for (salt, motion) in robots.chain([(OBSERVER, &mut self.observer)]) {
            if let Motion::Flown(flight) = motion {
                flight.wander = flight.wander.with_seed(wind_seed(seed, salt));
            }
        }
    }
}

/// What tells the observer's wind from that of target number n, which is n.
const OBSERVER: u64 = u64::MAX;

pub(super) fn wind_seed(seed: u64, robot: u64) -> u64 {
    hash(seed ^ hash(robot))
}

pub(super) struct Reader<'a> {
    pub(super) check: Check<'a>,
    pub(super) seed: u64,
}

impl Reader<'_> {
    fn scene(&self, table: SceneTable) -> Result<Scene> {
        let check = &self.check;
        let rate_hz = check.rate("rate_hz", table.rate_hz)?;
        let duration_s = check.positive("duration_s", table.duration_s, LONGEST_S)?;
        let exposure_us = self.exposure("exposure_us", table.exposure_us, rate_hz)?;
        let names: Vec<&str> = table.camera.iter().map(|camera| camera.name.as_str()).collect();
        if let Some(twice) = (1..names.len()).find(|i| names[..*i].contains(&names[*i])) {
            let reason = format!("another camera is called `{}`", names[twice]);
            return Err(check
                .refuse(&format!("camera[{twice}].name"), reason)
                .advise("name each its own way"));
        }
        for (key, count) in [("camera", table.camera.len()), ("target", table.target.len())] {
            if count == 0 {
                return Err(check.refuse(key, "there is none").advise(format!("add a [[{key}]]")));
            }
        }
        let observer = table.observer;
        let observer = self.motion(
            "observer",
            observer.motion,
            (observer.wind_m_s, observer.heading_deg, observer.spin),
            OBSERVER,
        )?;
        let cameras = table.camera.into_iter().enumerate().map(|(i, camera)| self.camera(i, camera, rate_hz));
        let targets = table.target.into_iter().enumerate().map(|(i, target)| self.target(i, target));
        let targets: Vec<Target> = targets.collect::<Result<_>>()?;
        let lamps = table.lamp.into_iter().enumerate();
        let lamps = lamps.map(|(i, lamp)| lamp.read(check, &format!("lamp[{i}]"), &targets));
        Ok(Scene {
            name: table.name,
            seed: table.seed,
            rate_hz,
            frames: (duration_s * rate_hz).round().max(1.0) as u64,
            exposure_us,
            preset: self.preset(table.preset, &table.optics, &table.sensor)?,
            sky: table.daylight.as_ref().map(DaylightTable::sky),
            daylight: table.daylight.map(|daylight| self.daylight(&daylight)).transpose()?,
            water: table
                .water
                .map(|water| -> Result<Water> {
                    let level_m =
                        physics::within(check.path, "water.level_m", water.level_m, &physics::PLACE_M)?;
                    let wind_m_s = check.within("water.wind_m_s", water.wind_m_s, (0.0, 40.0))?;
                    Ok(Water { level_m, wind_m_s })
                })
                .transpose()?,
            observer,
            cameras: cameras.collect::<Result<_>>()?,
            lamps: lamps.collect::<Result<_>>()?,
            own_airframe: table.own_airframe.read(check, |key, solid| self.solid(key, solid))?,
            targets,
            instruments: Instruments {
                gyro: table.gyro.map(|gyro| self.gyro(&gyro)).transpose()?,
                gravity: table.gravity.map(|gravity| self.gravity(&gravity)).transpose()?,
                odometry: table.odometry.map(|odometry| self.odometry(&odometry)).transpose()?,
            },
            recording: table.recording.map_or(Ok(Recording::default()), |r| self.recording(&r, rate_hz))?,
        })
    }

    /// A preset with what the scene changes of it.
    fn preset(&self, name: PresetName, optics: &OpticsTable, sensor: &SensorTable) -> Result<Preset> {
        let mut preset = match name {
            PresetName::Bluefox => bluefox(&BLUEFOX_FIT),
            PresetName::SmallFisheye => small_fisheye(&SMALL_FISHEYE_FIT),
        };
        optics.apply(&self.check, &mut preset.lens)?;
        sensor.apply(&self.check, &mut preset.sensor)?;
        Ok(preset)
    }

    /// An exposure that fits between two frames.
    fn exposure(&self, key: &str, exposure_us: f64, rate_hz: f64) -> Result<f64> {
        let exposure_us = physics::within(self.check.path, key, exposure_us, &physics::EXPOSURE_US)?;
        if exposure_us <= 1e6 / rate_hz {
            return Ok(exposure_us);
        }
        let reason = format!("an exposure of {exposure_us} us is longer than {:.1} us", 1e6 / rate_hz);
        Err(self.check.refuse(key, reason).advise("that is the time between frames at rate_hz"))
    }

    /// A file that the scene names.
    pub(super) fn named(&self, key: &str, file: &Path) -> Result<PathBuf> {
        if file.as_os_str().is_empty() {
            return Err(self.check.refuse(key, "the path is empty").advise("name a file"));
        }
        let path = self.check.path.parent().map_or_else(|| file.to_owned(), |folder| folder.join(file));
        if path.is_file() {
            return Ok(path);
        }
        let reason = format!("there is no file {}", path.display());
        Err(self.check.refuse(key, reason).advise("paths are taken from the scene's folder"))
    }

    fn daylight(&self, table: &DaylightTable) -> Result<Daylight> {
        let check = &self.check;
        let site = Site {
            latitude_deg: check.within("daylight.latitude_deg", table.latitude_deg, (-90.0, 90.0))?,
            longitude_deg: check.within("daylight.longitude_deg", table.longitude_deg, (-180.0, 180.0))?,
            height_m: check.within("daylight.height_m", table.height_m, (-500.0, 9000.0))?,
        };
        if !is_utc(&table.time) {
            return Err(check
                .refuse("daylight.time", format!("{} is no date and time in UTC", table.time))
                .advise("write it as 2018-05-10T10:00:00Z"));
        }
        let sun = sun_direction(&site, &table.time)
            .ok_or_else(|| check.refuse("daylight.time", "the sun's place is not known for it"))?;
        let sky = match table.sky {
            SkyName::Clear => Sky::Clear,
            SkyName::Overcast => Sky::Overcast,
        };
        Ok(Daylight::new(sky, sun))
    }

    fn camera(&self, index: usize, table: CameraTable, rate_hz: f64) -> Result<MountedCamera> {
        let key = |name: &str| format!("camera[{index}].{name}");
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if table.name.is_empty() || !table.name.chars().all(plain) {
            let reason = format!("`{}` cannot name a folder", table.name);
            return Err(self.check.refuse(&key("name"), reason).advise("use letters, digits, - and _"));
        }
        let camera = read_camera(&self.named(&key("file"), &table.file)?)?.camera;
        let position_m = self.check.place(&key("position_m"), table.position_m)?;
        let yaw_rad = self.check.angle(&key("yaw_deg"), table.yaw_deg)?;
        let pitch_rad = self.check.angle(&key("pitch_deg"), table.pitch_deg)?;
        let roll_rad = self.check.angle(&key("roll_deg"), table.roll_deg)?;
        Ok(MountedCamera {
            name: table.name,
            camera,
            body_from_camera: Isometry3::from_parts(
                Translation3::from(position_m),
                mounting(yaw_rad, pitch_rad, roll_rad),
            ),
            clock: Clock {
                offset_s: self.check.within(&key("clock.offset_s"), table.clock.offset_s, (-1e3, 1e3))?,
                ppm: physics::within(
                    self.check.path,
                    &key("clock.ppm"),
                    table.clock.ppm,
                    &physics::CLOCK_PPM,
                )?,
            },
            phase_s: self.check.within(&key("clock.phase_s"), table.clock.phase_s, (-1e3, 1e3))?,
            exposure_us: match table.exposure_us {
                Some(exposure_us) => Some(self.exposure(&key("exposure_us"), exposure_us, rate_hz)?),
                None => None,
            },
        })
    }

    /// Refuses a target that a camera would be inside of, looked at every frame, or 2000 times in a long scene.
    fn clear_of_cameras(&self, scene: &Scene) -> Result<()> {
        let looks = scene.frames.min(2000);
        for look in 0..looks {
            let time_s = scene.frames as f64 / scene.rate_hz * look as f64 / looks as f64;
            let observer = scene.observer.pose(time_s);
            for (index, target) in scene.targets.iter().enumerate() {
                let target_m = target.motion.pose(time_s).translation.vector;
                for mounted in &scene.cameras {
                    let camera_m = (observer * mounted.body_from_camera).translation.vector;
                    let gap_m = (target_m - camera_m).norm();
                    if gap_m <= target.airframe.max_radius_m() {
                        let reason = format!(
                            "at {time_s:.2} s camera {} is inside the target, {gap_m:.2} m from its centre",
                            mounted.name
                        );
                        let advice = format!("keep more than {:.2} m apart", target.airframe.max_radius_m());
                        return Err(self
                            .check
                            .refuse(&format!("target[{index}].motion"), reason)
                            .advise(advice));
                    }
                }
            }
        }
        Ok(())
    }
}

/// body_from_camera of a camera that looks along the body's x axis, then turned: yaw to the left, pitch down, roll
/// clockwise about the view.
pub fn mounting(yaw_rad: f64, pitch_rad: f64, roll_rad: f64) -> UnitQuaternion<f64> {
    let level = Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
    let about = |axis: Vector3<f64>, angle_rad: f64| {
        let (sin, cos) = libm::sincos(0.5 * angle_rad);
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(cos, axis * sin))
    };
    about(Vector3::z(), yaw_rad)
        * about(Vector3::y(), pitch_rad)
        * about(Vector3::x(), roll_rad)
        * UnitQuaternion::from_rotation_matrix(&level)
}
