//! The configuration of `photinus run`: enters a TOML file, leaves cameras and sinks that are ready to run.
//!
//! ```text
//! keys     what the file may hold; what it does not know is refused with its line
//! mod      what has a meaning, and the sinks
//! cameras  tables -> what looks through each camera, and what opens it
//! ```
//! Paths are relative to the file's folder. Tables of protocols that are linked elsewhere are handed on as they stand: [`Config::text`].

mod cameras;
mod keys;
#[cfg(test)]
mod tests;

use std::io::ErrorKind;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use photinus_io::sky::{Sky, SkyInfo};
use photinus_io::{Cause, Error, Place, Result, table, whole};
use toml::value::{Date, Datetime, Offset, Time};

pub use cameras::{Linked, Origin};
use keys::{ExposureKeys, Keys, PaceKey, SkyKeys, SourceKeys};

use crate::exposure::Wanted;
use crate::live::Pace;
use crate::sink::{Address, HealthLines, JsonLines, Sink};
use crate::source::PixelFormat;

/// An example with every key, to be written to a file and changed.
pub const EXAMPLE: &str = include_str!("example.toml");

/// When times of frames that are taken now are 0.
const EPOCH: Datetime = Datetime {
    date: Some(Date { year: 1970, month: 1, day: 1 }),
    time: Some(Time { hour: 0, minute: 0, second: Some(0), nanosecond: None }),
    offset: Some(Offset::Z),
};

/// What a configuration holds.
#[derive(Clone, Debug)]
pub struct Config {
    path: PathBuf,
    text: String,
    keys: Keys,
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

    /// The sky over the vehicle, where it is described here.
    fn sky(&self) -> Result<Option<Sky>> {
        let Some(keys) = self.keys.sky.clone() else { return Ok(None) };
        let SkyKeys { latitude_deg, longitude_deg, height_m, time, heading_deg, heading_sigma_deg } = keys;
        if heading_deg.is_some() && self.keys.camera.len() > 1 {
            let advice = "leave it out: the sun is then looked for at its height all around";
            return Err(self.refuse("sky.heading_deg", "it is not said of which camera", advice));
        }
        let time = time.unwrap_or(EPOCH);
        let info = SkyInfo { latitude_deg, longitude_deg, height_m, time, heading_deg, heading_sigma_deg };
        Sky::new(&info, &self.path).map(Some)
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
        self.sky()?;
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
        let SourceKeys {
            dataset,
            recording,
            scene,
            camera,
            repeat,
            command,
            stdin,
            tcp,
            unix,
            raw,
            times,
            spots,
            ..
        } = source;
        let SourceKeys { ros2, zenoh, v4l2, format, rate_hz, gain, .. } = source;
        let is_stream = command.is_some() || *stdin == Some(true) || tcp.is_some() || unix.is_some();
        let kinds = [
            dataset.is_some(),
            recording.is_some(),
            scene.is_some(),
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
                "give one of dataset, recording, scene, command, stdin = true, tcp, unix, v4l2, ros2, zenoh",
            ));
        }
        let is_named = camera.is_some() && dataset.is_none() && recording.is_none() && scene.is_none();
        let is_repeated = *repeat && dataset.is_none() && scene.is_none();
        let of_stream = raw.is_some() || times.is_some();
        let is_lost = *spots && !is_stream && !source.is_topic();
        let of_v4l2 = format.is_some() || rate_hz.is_some() || gain.is_some();
        if is_named || is_repeated || of_stream && !is_stream || of_v4l2 && v4l2.is_none() || is_lost {
            return Err(self.refuse(
                key,
                "these keys do not go together",
                "`camera` is of a dataset, a recording or a scene, `repeat` of a dataset or a scene, `raw` and `times` of a stream, `spots` of a stream, ros2 or zenoh, `format`, `rate_hz` and `gain` of v4l2",
            ));
        }
        if recording.is_some() && self.pace() == Pace::Live {
            return Err(self.refuse(
                &format!("{key}.recording"),
                "a recording is replayed as fast as it is read",
                "add pace = \"fast\"",
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
