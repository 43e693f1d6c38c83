//! The configuration of `photinus run`: enters a TOML file, leaves cameras and sinks that are ready to run.
//!
//! ```text
//! mod      what the file may hold; what it does not know is refused with its line
//! cameras  tables -> what looks through each camera, and what opens it
//! ```
//! Paths are relative to the file's folder. Tables of protocols that are linked elsewhere are handed on as they stand: [`Config::text`].

mod cameras;
#[cfg(test)]
mod tests;

use std::io::ErrorKind;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use photinus_io::dataset::AirframeFiles;
use photinus_io::video::RawFormat;
use photinus_io::{Cause, Error, Place, Result, table, whole};
use serde::Deserialize;

pub use cameras::{Linked, Topic};

use crate::exposure::Wanted;
use crate::live::Pace;
use crate::sink::{Address, HealthLines, JsonLines, Sink};
use crate::source::PixelFormat;

/// An example with every key, to be written to a file and changed.
pub const EXAMPLE: &str = include_str!("example.toml");

/// What a configuration holds.
#[derive(Clone, Debug)]
pub struct Config {
    path: PathBuf,
    text: String,
    keys: Keys,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(default)]
    pace: PaceKey,
    #[serde(default)]
    camera: Vec<CameraKeys>,
    airframe: Option<AirframeKeys>,
    vehicles: Option<VehiclesKeys>,
    #[serde(default)]
    locate: LocateKeys,
    exposure: Option<ExposureKeys>,
    json: Option<JsonKeys>,
    health: Option<HealthKeys>,
    page: Option<PageKeys>,
    record: Option<toml::Table>,
    ros2: Option<toml::Table>,
    mavlink: Option<toml::Table>,
    zenoh: Option<toml::Table>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum PaceKey {
    #[default]
    Live,
    Fast,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeys {
    name: String,
    source: SourceKeys,
    camera: Option<PathBuf>,
    mounting: Option<PathBuf>,
    mask: Option<PathBuf>,
    spot_curve: Option<PathBuf>,
    exposure_us: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceKeys {
    dataset: Option<PathBuf>,
    /// Which camera of a dataset with several.
    camera: Option<String>,
    #[serde(default)]
    repeat: bool,
    command: Option<Vec<String>>,
    stdin: Option<bool>,
    tcp: Option<String>,
    unix: Option<PathBuf>,
    raw: Option<RawKeys>,
    times: Option<TimesKey>,
    /// Lines of spots come in place of frames.
    #[serde(default)]
    spots: bool,
    /// A topic of ROS 2.
    ros2: Option<String>,
    /// A key of Zenoh.
    zenoh: Option<String>,
    v4l2: Option<PathBuf>,
    /// How a V4L2 camera lays out its pixels.
    format: Option<String>,
    rate_hz: Option<f64>,
    gain: Option<i64>,
}

impl SourceKeys {
    /// Where messages of others are taken from, if they are.
    fn topic(&self) -> Option<Topic<'_>> {
        let of_zenoh = || self.zenoh.as_deref().map(Topic::Zenoh);
        self.ros2.as_deref().map(Topic::Ros2).or_else(of_zenoh)
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawKeys {
    width: usize,
    height: usize,
    rate_hz: Option<f64>,
}

impl From<RawKeys> for RawFormat {
    fn from(keys: RawKeys) -> Self {
        Self { width: keys.width, height: keys.height, rate_hz: keys.rate_hz }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum TimesKey {
    Arrival,
    Stream,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AirframeKeys {
    file: AirframeFiles,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct VehiclesKeys {
    file: PathBuf,
    codes: Option<PathBuf>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct LocateKeys {
    contrast: Option<u8>,
    threshold: Option<u8>,
    reflection_ratio: Option<f64>,
    max_tilt_deg: Option<f64>,
    min_probability: Option<f64>,
    budget: Option<u32>,
    tilt_sigma_deg: Option<f64>,
    marker_sigma_m: Option<f64>,
    power_spread: Option<f64>,
    scale_sigma: Option<f64>,
    miss_rate: Option<f64>,
    brightness: Option<bool>,
    time: Option<bool>,
    gravity: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ExposureKeys {
    reach_m: f64,
    shortest_us: f64,
    longest_us: f64,
    #[serde(default)]
    alternate: bool,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonKeys {
    file: Option<PathBuf>,
    #[serde(default)]
    stdout: bool,
    tcp: Option<SocketAddr>,
    unix: Option<PathBuf>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HealthKeys {
    file: PathBuf,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PageKeys {
    listen: SocketAddr,
    token: Option<String>,
}

/// Where the page is served.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageAddress {
    /// Where it listens.
    pub listen: SocketAddr,
    /// What a browser must know; always there when others than this machine can reach the address.
    pub token: Option<String>,
}

impl Config {
    /// Reads a configuration.
    ///
    /// # Errors
    /// As [`Self::parse`], and when the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&whole::read_text(path.as_ref())?, path)
    }

    /// Reads the text of a configuration; `path` is for the messages, and paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`Error`] with the line for what is no TOML, unknown and missing keys; with the key for what has no meaning.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref().to_owned();
        let config = Self { keys: table::parse(text, &path)?, text: text.to_owned(), path };
        config.check()?;
        Ok(config)
    }

    /// The file itself, for those who link `[record]`, `[ros2]`, `[mavlink]` or `[zenoh]` and read their own table, with its lines.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What it is called in messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A path that stands in the file, as it can be opened.
    pub fn located(&self, named: &Path) -> PathBuf {
        self.path.parent().map_or_else(|| named.to_owned(), |folder| folder.join(named))
    }

    /// How fast frames are taken.
    pub fn pace(&self) -> Pace {
        match self.keys.pace {
            PaceKey::Live => Pace::Live,
            PaceKey::Fast => Pace::Fast,
        }
    }

    /// Tables of protocols that are linked elsewhere, by name.
    pub fn protocols(&self) -> impl Iterator<Item = &'static str> {
        let Keys { record, ros2, mavlink, zenoh, .. } = &self.keys;
        let tables = [("record", record), ("ros2", ros2), ("mavlink", mavlink), ("zenoh", zenoh)];
        tables.into_iter().filter(|(_, table)| table.is_some()).map(|(name, _)| name)
    }

    /// Where the page is served, if it is.
    pub fn page(&self) -> Option<PageAddress> {
        let page = self.keys.page.as_ref()?;
        Some(PageAddress { listen: page.listen, token: page.token.clone() })
    }

    /// The files that sinks of [`Self::sinks`] add to.
    pub fn files(&self) -> Vec<PathBuf> {
        let json = self.keys.json.as_ref().and_then(|json| json.file.as_ref());
        let health = self.keys.health.as_ref().map(|health| &health.file);
        json.into_iter().chain(health).map(|path| self.located(path)).collect()
    }

    /// The sinks that need no middleware: JSON lines and health.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be opened or an address is taken.
    pub fn sinks(&self) -> Result<Vec<Box<dyn Sink>>> {
        let mut sinks: Vec<Box<dyn Sink>> = Vec::new();
        if let Some(json) = &self.keys.json {
            if let Some(file) = &json.file {
                sinks.push(Box::new(JsonLines::file(&self.located(file))?));
            }
            if json.stdout {
                sinks.push(Box::new(JsonLines::standard()));
            }
            if let Some(tcp) = json.tcp {
                sinks.push(Box::new(JsonLines::socket(&Address::Tcp(tcp))?));
            }
            if let Some(unix) = &json.unix {
                sinks.push(Box::new(JsonLines::socket(&Address::Unix(self.located(unix)))?));
            }
        }
        if let Some(health) = &self.keys.health {
            sinks.push(Box::new(HealthLines::file(&self.located(&health.file))?));
        }
        Ok(sinks)
    }

    fn wanted_exposure(&self) -> Option<Wanted> {
        let keys = self.keys.exposure?;
        let limits_us = [keys.shortest_us, keys.longest_us];
        let contrast = f64::from(self.keys.locate.contrast.or(self.keys.locate.threshold).unwrap_or(20));
        Some(Wanted { reach_m: keys.reach_m, limits_us, contrast, alternate: keys.alternate })
    }

    fn check(&self) -> Result<()> {
        let keys = &self.keys;
        if keys.camera.is_empty() {
            return Err(self.refuse("camera", "there is no camera", "add a table [[camera]]"));
        }
        for (number, camera) in keys.camera.iter().enumerate() {
            let key = format!("camera[{number}]");
            if camera.name.is_empty() || keys.camera[..number].iter().any(|other| other.name == camera.name) {
                return Err(self.refuse(
                    &format!("{key}.name"),
                    "cameras need names of their own",
                    "give each another name",
                ));
            }
            if camera.exposure_us.is_some_and(|us| !(0.1..=6e7).contains(&us)) {
                return Err(self.refuse(
                    &format!("{key}.exposure_us"),
                    "no camera exposes so long",
                    "give 0.1 us to 60 s",
                ));
            }
            self.check_source(&camera.source, &format!("{key}.source"))?;
        }
        if let Some(page) = &keys.page
            && !page.listen.ip().is_loopback()
            && page.token.as_ref().is_none_or(|token| token.len() < 8)
        {
            let reason = "others than this machine can reach that address";
            return Err(self.refuse(
                "page.token",
                reason,
                "add a token of 8 letters or more, or listen at 127.0.0.1",
            ));
        }
        if let Some(ExposureKeys { reach_m, shortest_us, longest_us, .. }) = keys.exposure
            && !(reach_m > 0.0
                && reach_m < 1e4
                && shortest_us > 0.0
                && shortest_us <= longest_us
                && longest_us <= 6e7)
        {
            return Err(self.refuse(
                "exposure",
                "these numbers have no meaning",
                "give reach_m above 0, and shortest_us <= longest_us",
            ));
        }
        Ok(())
    }

    fn check_source(&self, source: &SourceKeys, key: &str) -> Result<()> {
        let SourceKeys { dataset, camera, repeat, command, stdin, tcp, unix, raw, times, spots, .. } = source;
        let SourceKeys { ros2, zenoh, v4l2, format, rate_hz, gain, .. } = source;
        let is_stream = command.is_some() || *stdin == Some(true) || tcp.is_some() || unix.is_some();
        let kinds = [
            dataset.is_some(),
            command.is_some(),
            *stdin == Some(true),
            tcp.is_some(),
            unix.is_some(),
            v4l2.is_some(),
            ros2.is_some(),
            zenoh.is_some(),
        ];
        if kinds.into_iter().filter(|there| *there).count() != 1 {
            return Err(self.refuse(
                key,
                "it needs exactly one source",
                "give one of dataset, command, stdin = true, tcp, unix, v4l2, ros2, zenoh",
            ));
        }
        let of_dataset = camera.is_some() || *repeat;
        let of_stream = raw.is_some() || times.is_some();
        let is_lost = *spots && !is_stream && source.topic().is_none();
        let of_v4l2 = format.is_some() || rate_hz.is_some() || gain.is_some();
        if of_dataset && dataset.is_none() || of_stream && !is_stream || of_v4l2 && v4l2.is_none() || is_lost
        {
            return Err(self.refuse(
                key,
                "these keys do not go together",
                "`camera` and `repeat` are of a dataset, `raw` and `times` of a stream, `spots` of a stream, ros2 or zenoh, `format`, `rate_hz` and `gain` of v4l2",
            ));
        }
        if *spots && raw.is_some() {
            return Err(self.refuse(key, "spots are no raw frames", "keep `spots` or `raw`"));
        }
        if let Some(code) = format
            && PixelFormat::of_code(code).is_none()
        {
            return Err(self.refuse(
                &format!("{key}.format"),
                &format!("no grey frame is known to be in {code}"),
                "give GREY, Y10, Y12, Y16, Y10P, Y12P, YUYV, UYVY or MJPG, or leave it out",
            ));
        }
        if rate_hz.is_some_and(|hz| !(0.001..=1e5).contains(&hz)) {
            return Err(self.refuse(
                &format!("{key}.rate_hz"),
                "no camera has this rate",
                "give frames a second",
            ));
        }
        Ok(())
    }

    /// What is wrong with a file that this key names.
    fn of_key(&self, key: &str, error: Error) -> Error {
        let advice = match &error.cause {
            Cause::Io(cause) if cause.kind() == ErrorKind::NotFound => {
                "check the path, which is taken from the folder of the configuration".to_owned()
            }
            _ => error.advice.clone(),
        };
        self.refuse(key, &error.advise("").to_string(), &advice)
    }

    fn refuse(&self, key: &str, reason: &str, advice: &str) -> Error {
        Error::format(&self.path, reason).at(Place::Key(key.to_owned())).advise(advice)
    }
}
