//! vehicles.toml: which vehicles there may be, how they are built and what they blink.

use std::path::{Path, PathBuf};

use photinus::airframe::Airframe;
use photinus::identity::CodeBook;
use serde::{Deserialize, Serialize};

use crate::{Error, Place, Result, physics, table};

/// A `[[vehicle]]` of vehicles.toml.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleInfo {
    /// Its id in truth and results.
    pub id: u32,
    /// Any airframe file that Photinus reads, relative to the dataset's folder.
    pub airframe: PathBuf,
    /// The word of the book, from 0, that each signal of the airframe blinks; empty when it does not blink.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<usize>,
    /// Bits per second on its own clock, when it blinks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bit_rate_hz: Option<f64>,
}

/// A vehicle with its airframe read.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Its id in truth and results.
    pub id: u32,
    /// The file of its airframe, relative to the dataset's folder.
    pub airframe_file: PathBuf,
    /// Its airframe.
    pub airframe: Airframe,
    /// What it blinks; without, it shines steadily.
    pub blink: Option<VehicleBlink>,
}

/// What a vehicle blinks.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleBlink {
    /// The word of the book, from 0, of each signal of the airframe: one for every signal.
    pub words: Vec<usize>,
    /// Bits per second on the vehicle's clock.
    pub bit_rate_hz: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    vehicle: Vec<VehicleInfo>,
}

/// Reads the text of a vehicles.toml; `path` is for the messages.
///
/// # Errors
/// [`Error`] with line or key for unknown and missing keys, no vehicle, an id that stands twice, words without a bit rate, a
/// bit rate without words, and a bit rate that no LED has.
pub fn parse_vehicles(text: &str, path: impl AsRef<Path>) -> Result<Vec<VehicleInfo>> {
    let path = path.as_ref();
    let Table { vehicle: vehicles } = table::parse(text, path)?;
    if vehicles.is_empty() {
        return Err(Error::format(path, "it lists no vehicle").advise("add a [[vehicle]]"));
    }
    for (index, vehicle) in vehicles.iter().enumerate() {
        let refuse = |name: &str, reason: String, advice: &str| {
            let key = format!("vehicle[{index}].{name}");
            Err(Error::format(path, reason).at(Place::Key(key)).advise(advice))
        };
        if vehicles[..index].iter().any(|other| other.id == vehicle.id) {
            return refuse(
                "id",
                format!("vehicle {} stands twice", vehicle.id),
                "give each an id of its own",
            );
        }
        if vehicle.airframe.as_os_str().is_empty() {
            return refuse("airframe", "the path is empty".to_owned(), "name a file in the dataset's folder");
        }
        match (vehicle.bit_rate_hz, vehicle.words.is_empty()) {
            (Some(bit_rate_hz), false) => {
                let key = format!("vehicle[{index}].bit_rate_hz");
                physics::within(path, &key, bit_rate_hz, &physics::RATE_HZ)?;
            }
            (Some(_), true) => {
                return refuse("words", "there is none".to_owned(), "say the word of each signal");
            }
            (None, false) => {
                return refuse("bit_rate_hz", "it is missing".to_owned(), "say how many bits a second has");
            }
            (None, true) => {}
        }
    }
    Ok(vehicles)
}

/// Vehicles as the text of a file; it is read back as it was.
pub fn vehicles_text(vehicles: &[VehicleInfo]) -> String {
    toml::to_string(&Table { vehicle: vehicles.to_vec() }).expect("names and numbers are TOML")
}

impl VehicleInfo {
    /// The vehicle, with its airframe; `index` and `path` are for the messages.
    ///
    /// # Errors
    /// [`Error`] for a word that the book does not hold, words without a book, and a signal of the airframe without a word.
    pub(super) fn with(
        self,
        airframe: Airframe,
        codes: Option<&CodeBook>,
        (index, path): (usize, &Path),
    ) -> Result<Vehicle> {
        let refuse = |reason: String, advice: &str| {
            let key = format!("vehicle[{index}].words");
            Err(Error::format(path, reason).at(Place::Key(key)).advise(advice))
        };
        let Some(bit_rate_hz) = self.bit_rate_hz else {
            return Ok(Vehicle { id: self.id, airframe_file: self.airframe, airframe, blink: None });
        };
        let Some(codes) = codes else {
            return refuse("there is no book of words".to_owned(), "name it as codes in dataset.toml");
        };
        if let Some(word) = self.words.iter().find(|word| **word >= codes.words().len()) {
            let reason = format!("word {word} of {} words", codes.words().len());
            return refuse(reason, "words are counted from 0");
        }
        let signals = 1 + airframe.leds().iter().filter_map(|led| led.signal).max().unwrap_or(0) as usize;
        if self.words.len() != signals {
            let reason = format!("{} words for {signals} signals", self.words.len());
            return refuse(reason, "say a word for each signal of the airframe, from 0");
        }
        let blink = Some(VehicleBlink { words: self.words, bit_rate_hz });
        Ok(Vehicle { id: self.id, airframe_file: self.airframe, airframe, blink })
    }
}
