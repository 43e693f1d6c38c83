//! dataset.toml: enters its text, leaves which files belong to the dataset, of one camera or of several.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::airframe_key::AirframeFiles;
use super::camera_key::CameraKey;
use crate::sky::{Sky, SkyInfo};
use crate::{Error, Place, Result, physics, table};

/// What dataset.toml says of a dataset with one camera. Paths are relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DatasetInfo {
    /// Any camera file that Photinus reads.
    pub camera: PathBuf,
    /// Any airframe file that Photinus reads; several where neighbours are of several kinds.
    pub airframe: AirframeFiles,
    /// Exposure of a frame, us.
    pub exposure_us: f64,
    /// Frames per second.
    pub rate_hz: f64,
    /// The spot-size curve of this camera, if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot_curve: Option<PathBuf>,
    /// Where not to look, if something is in the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// The book of code words that LEDs blink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub codes: Option<PathBuf>,
    /// Which vehicles there may be, and what they blink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicles: Option<PathBuf>,
    /// Where and when it was recorded: tells where the sun was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkyInfo>,
}

/// What dataset.toml says of a dataset with cameras that are mounted on one vehicle. Paths are relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RigInfo {
    /// Any airframe file that Photinus reads; several where neighbours are of several kinds.
    pub airframe: AirframeFiles,
    /// Exposure of a frame, us, of the cameras that do not say their own.
    pub exposure_us: f64,
    /// Frames per second.
    pub rate_hz: f64,
    /// The book of code words that LEDs blink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub codes: Option<PathBuf>,
    /// Which vehicles there may be, and what they blink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicles: Option<PathBuf>,
    /// Where and when it was recorded: tells where the sun was. Cameras of a rig look in different directions and have no heading here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkyInfo>,
    /// The cameras, at least one; their names differ.
    #[serde(rename = "camera")]
    pub cameras: Vec<RigCamera>,
}

/// A `[[camera]]` of dataset.toml. Paths are relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigCamera {
    /// What it is called: letters, digits, - and _.
    pub name: String,
    /// Any camera file that Photinus reads.
    pub camera: PathBuf,
    /// How it sits on the vehicle, as `photinus calibrate mounting` writes it.
    pub mounting: PathBuf,
    /// A frames.csv of its own.
    pub frames: PathBuf,
    /// Where not to look.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// The spot-size curve of this camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot_curve: Option<PathBuf>,
    /// Exposure of its frames, us.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_us: Option<f64>,
}

/// A dataset.toml.
#[derive(Clone, Debug, PartialEq)]
pub enum DatasetToml {
    /// `camera = "camera.txt"`.
    One(DatasetInfo),
    /// `[[camera]]`.
    Rig(RigInfo),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    camera: CameraKey,
    airframe: AirframeFiles,
    exposure_us: f64,
    rate_hz: f64,
    spot_curve: Option<PathBuf>,
    mask: Option<PathBuf>,
    codes: Option<PathBuf>,
    vehicles: Option<PathBuf>,
    sky: Option<SkyInfo>,
}

impl DatasetToml {
    /// Reads the text of a dataset.toml; `path` is for the messages.
    ///
    /// # Errors
    /// [`Error`] for unknown or missing keys, for values that no camera has, and for cameras of one name.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let Table { camera, airframe, exposure_us, rate_hz, spot_curve, mask, codes, vehicles, sky } =
            table::parse(text, path)?;
        let cameras = match camera {
            CameraKey::One(camera) => {
                let info = DatasetInfo {
                    camera,
                    airframe,
                    exposure_us,
                    rate_hz,
                    spot_curve,
                    mask,
                    codes,
                    vehicles,
                    sky,
                };
                info.check(path)?;
                return Ok(Self::One(info));
            }
            CameraKey::Several(cameras) => cameras,
        };
        for (key, named) in [("spot_curve", spot_curve), ("mask", mask)] {
            if named.is_some() {
                return Err(refuse(
                    path,
                    key,
                    "it is not said of which camera",
                    "write it into a [[camera]]",
                ));
            }
        }
        let info = RigInfo { airframe, exposure_us, rate_hz, codes, vehicles, sky, cameras };
        info.check(path)?;
        Ok(Self::Rig(info))
    }
}

impl DatasetInfo {
    /// Reads the text of a dataset.toml with one camera; `path` is for the messages.
    ///
    /// # Errors
    /// As [`DatasetToml::parse`], and for `[[camera]]`.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        match DatasetToml::parse(text, &path)? {
            DatasetToml::One(info) => Ok(info),
            DatasetToml::Rig(_) => {
                Err(refuse(path.as_ref(), "camera", "it lists cameras of a rig", "name one camera file"))
            }
        }
    }

    pub(super) fn check(&self, path: &Path) -> Result<()> {
        check_numbers(path, self.exposure_us, self.rate_hz)?;
        check_named(path, "camera", Some(&self.camera))?;
        check_airframes(path, &self.airframe)?;
        check_named(path, "spot_curve", self.spot_curve.as_ref())?;
        check_named(path, "mask", self.mask.as_ref())?;
        check_named(path, "codes", self.codes.as_ref())?;
        self.sky.as_ref().map(|sky| Sky::new(sky, path)).transpose()?;
        check_named(path, "vehicles", self.vehicles.as_ref())
    }
}

impl RigInfo {
    pub(super) fn check(&self, path: &Path) -> Result<()> {
        check_numbers(path, self.exposure_us, self.rate_hz)?;
        check_airframes(path, &self.airframe)?;
        check_named(path, "codes", self.codes.as_ref())?;
        check_named(path, "vehicles", self.vehicles.as_ref())?;
        if let Some(sky) = &self.sky {
            Sky::new(sky, path)?;
            if sky.heading_deg.is_some() {
                let advice = "leave it out: the sun is then looked for at its elevation";
                return Err(refuse(path, "sky.heading_deg", "it is not said of which camera", advice));
            }
        }
        if self.cameras.is_empty() {
            return Err(refuse(path, "camera", "there is none", "add a [[camera]]"));
        }
        for (index, camera) in self.cameras.iter().enumerate() {
            let key = |name: &str| format!("camera[{index}].{name}");
            let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            if camera.name.is_empty() || !camera.name.chars().all(plain) {
                let reason = format!("`{}` is no name", camera.name);
                return Err(refuse(path, &key("name"), reason, "use letters, digits, - and _"));
            }
            let before = &self.cameras[..index];
            if before.iter().any(|other| other.name == camera.name) {
                let reason = format!("another camera is called `{}`", camera.name);
                return Err(refuse(path, &key("name"), reason, "give every camera a name of its own"));
            }
            if before.iter().any(|other| other.frames == camera.frames) {
                let reason = format!("another camera has the frames of {}", camera.frames.display());
                return Err(refuse(path, &key("frames"), reason, "give every camera a file of its own"));
            }
            check_named(path, &key("camera"), Some(&camera.camera))?;
            check_named(path, &key("mounting"), Some(&camera.mounting))?;
            check_named(path, &key("frames"), Some(&camera.frames))?;
            check_named(path, &key("mask"), camera.mask.as_ref())?;
            check_named(path, &key("spot_curve"), camera.spot_curve.as_ref())?;
            if let Some(exposure_us) = camera.exposure_us {
                physics::within(path, &key("exposure_us"), exposure_us, &physics::EXPOSURE_US)?;
            }
        }
        Ok(())
    }
}

fn check_numbers(path: &Path, exposure_us: f64, rate_hz: f64) -> Result<()> {
    physics::within(path, "exposure_us", exposure_us, &physics::EXPOSURE_US)?;
    physics::within(path, "rate_hz", rate_hz, &physics::RATE_HZ)?;
    Ok(())
}

fn check_airframes(path: &Path, files: &AirframeFiles) -> Result<()> {
    files.iter().try_for_each(|file| check_named(path, "airframe", Some(file)))
}

fn check_named(path: &Path, key: &str, named: Option<&PathBuf>) -> Result<()> {
    match named.is_some_and(|named| named.as_os_str().is_empty()) {
        true => Err(refuse(path, key, "the path is empty", "name a file in the dataset's folder")),
        false => Ok(()),
    }
}

fn refuse(path: &Path, key: &str, reason: impl Into<String>, advice: &str) -> Error {
    Error::format(path, reason).at(Place::Key(key.to_owned())).advise(advice)
}
