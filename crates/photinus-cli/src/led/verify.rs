//! What a camera sees of LEDs that blink -> what is in order and what is not. Vehicle and camera are at rest.

use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::identity::CodeBook;
use photinus::locator::LocatorError;
use photinus::spots::{self, Detector, Spot};
use photinus_io::airframe::read_airframe;
use photinus_io::dataset::Dataset;
use photinus_io::{Error, read_camera};

use super::lights::{Light, lights};
use super::placing::{Fault, Placing};
use super::reading::{Film, Reading, Seen};
use crate::failure::Failure;
use crate::input::{DatasetArgs, Input, InputArgs};
use crate::terminal::Terminal;

/// Of a long recording these frames are looked at: clocks of boards drift.
const MOST_FRAMES: usize = 240;
/// LEDs of one board are in step within this, bits.
const IN_STEP: f64 = 0.5;
/// A light agrees with the clock of the others above this share of frames.
const AGREES: f64 = 0.95;

/// What the user says about what was seen.
#[derive(Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// A recording of the vehicle while it blinks, a second or two, both at rest: anything that `photinus locate` takes
    #[arg(long, value_name = "INPUT")]
    verify: Option<PathBuf>,
    /// Its camera, where the recording does not bring one: with the airframe, dark and swapped LEDs are told
    #[arg(long, value_name = "FILE", requires = "verify")]
    camera: Option<PathBuf>,
    /// How the vehicle is built, where the recording does not say
    #[arg(long, value_name = "FILE", requires = "verify")]
    airframe: Option<PathBuf>,
    #[command(flatten)]
    dataset: DatasetArgs,
}

impl VerifyArgs {
    pub(super) fn is_wanted(&self) -> bool {
        self.verify.is_some()
    }
}

impl VerifyArgs {
    /// The camera and the vehicle's airframe, of those that are named or of the dataset.
    fn vehicle(&self, input: &Input) -> Result<(Option<Camera>, Option<Airframe>), Failure> {
        let own = input.one_camera()?.cloned();
        let of_dataset = input.dataset.as_ref().zip(own).map(|(dataset, own)| dataset.path(&own.camera));
        let camera = self.camera.clone().or(of_dataset);
        let camera = camera.map(|path| read_camera(path).map(|file| file.camera)).transpose();
        // Of several kinds nobody knows which one it is.
        let kinds = input.dataset.as_ref().map(Dataset::airframes).unwrap_or_default();
        let only = <[PathBuf; 1]>::try_from(kinds).ok().map(|[path]| path);
        let airframe = self.airframe.clone().or(only);
        let airframe = airframe.map(|path| read_airframe(path).map(|file| file.airframe)).transpose();
        Ok((camera.map_err(Failure::input)?, airframe.map_err(Failure::input)?))
    }
}

/// Looks whether the LEDs blink these words.
pub(super) fn run(
    args: &VerifyArgs,
    book: &CodeBook,
    words: &[usize],
    rate_hz: f64,
    terminal: &mut Terminal,
) -> Result<(), Failure> {
    let Some(path) = &args.verify else { return Ok(()) };
    let mut input = InputArgs::of(std::slice::from_ref(path), &args.dataset).open()?;
    let (camera, airframe) = args.vehicle(&input)?;
    let film = Frames::of(&mut input.entries, path, terminal)?;
    let lights = lights(&film.spots);
    let placing = camera.as_ref().zip(airframe.as_ref());
    let placing = placing.map(|(camera, airframe)| Placing { airframe, camera, down: film.down });
    let seen = Sight { book, words, rate_hz, times_s: &film.times_s, lights: &lights };
    let findings = seen.findings(placing.as_ref()).map_err(|error| Failure::Input(error.to_string()))?;
    for finding in &findings {
        match finding.is_wrong {
            true => terminal.error(&finding.text),
            false => terminal.result(&finding.text)?,
        }
    }
    match findings.iter().filter(|finding| finding.is_wrong).count() {
        0 => Ok(()),
        wrong => Err(Failure::Running(format!("{}: {wrong} things are not in order", path.display()))),
    }
}

/// What of a recording is looked at.
struct Frames {
    spots: Vec<Vec<Spot>>,
    times_s: Vec<f64>,
    /// Down in the camera frame, of the first frame that says so: vehicle and camera are at rest.
    down: Option<Unit<Vector3<f64>>>,
}

impl Frames {
    fn of(entries: &mut crate::input::Entries, path: &Path, terminal: &Terminal) -> Result<Self, Failure> {
        let mut detector =
            Detector::new(spots::Settings::default()).map_err(|error| Failure::Input(error.to_string()))?;
        let mut frames = Self { spots: Vec::new(), times_s: Vec::new(), down: None };
        for entry in entries.take(MOST_FRAMES) {
            let entry = match entry {
                Ok(entry) => entry,
                Err(error) => {
                    terminal.warning(error);
                    continue;
                }
            };
            let (Some(image), Some(time_s)) = (&entry.image, entry.record.time_s) else { continue };
            let found = detector
                .detect(&image.view(), None)
                .map_err(|error| Failure::input(Error::new(path, error)))?;
            frames.spots.push(found.spots.clone());
            frames.times_s.push(time_s);
            frames.down = frames.down.or(entry.gravity);
        }
        let first_s = frames.times_s.first().copied().unwrap_or(0.0);
        frames.times_s.iter_mut().for_each(|time_s| *time_s -= first_s);
        match frames.spots.len() {
            0..30 => {
                let reason = format!("{} frames with times are too few to read words in", frames.spots.len());
                Err(Failure::input(Error::format(path, reason).advise("record a second or two")))
            }
            _ => Ok(frames),
        }
    }
}

/// What was found.
struct Finding {
    text: String,
    is_wrong: bool,
}

/// What was seen, and what was to be seen.
struct Sight<'a> {
    book: &'a CodeBook,
    words: &'a [usize],
    rate_hz: f64,
    times_s: &'a [f64],
    lights: &'a [Light],
}

impl Sight<'_> {
    /// What is in order and what is not; `placing` knows how the vehicle is built.
    fn findings(&self, placing: Option<&Placing<'_>>) -> Result<Vec<Finding>, LocatorError> {
        let film = Film { times_s: self.times_s, book: self.book, rate_hz: self.rate_hz };
        let readings: Vec<Reading> = self.lights.iter().map(|light| film.read(&light.lit)).collect();
        let signals: Vec<Option<u32>> = readings.iter().map(|reading| self.signal(*reading)).collect();
        let mut findings: Vec<Finding> =
            (0..self.lights.len()).map(|light| self.light(light, readings[light], signals[light])).collect();
        findings.extend(self.out_of_step(&film, &readings, &signals));
        let placed = match placing {
            Some(placing) => self.placed(placing, &signals)?,
            None => Vec::new(),
        };
        findings.extend(placed);
        findings.extend(self.unseen(&signals));
        Ok(findings)
    }

    /// LEDs that are dark though they face the camera, and those that blink the signal of another.
    fn placed(&self, placing: &Placing<'_>, signals: &[Option<u32>]) -> Result<Vec<Finding>, LocatorError> {
        let spots: Vec<Spot> = self.lights.iter().map(|light| light.spot.clone()).collect();
        let Some(placed) = placing.placed(&spots, signals)? else { return Ok(Vec::new()) };
        let told = |fault: &Fault| match *fault {
            Fault::Dark(marker) => format!("{} is dark, though it faces the camera", placing.named(marker)),
            Fault::Swapped(marker, signal) => {
                format!("{} blinks signal {signal}: swapped", placing.named(marker))
            }
        };
        let mut texts: Vec<String> = placed.sure.iter().map(told).collect();
        if placed.is_unsure {
            texts.push(
                "LEDs are dark or swapped, but from this side it cannot be told which: turn the vehicle"
                    .to_owned(),
            );
        }
        Ok(texts.into_iter().map(|text| Finding { text, is_wrong: true }).collect())
    }

    /// Which signal of the vehicle a reading is.
    fn signal(&self, reading: Reading) -> Option<u32> {
        let Reading::Word(word, _) = reading else { return None };
        self.words.iter().position(|own| *own == word).map(|signal| signal as u32)
    }

    /// What is to be said of a light by itself.
    fn light(&self, light: usize, reading: Reading, signal: Option<u32>) -> Finding {
        let centre = self.lights[light].spot.centre;
        let at = format!("at {:.0}, {:.0} px", centre.u, centre.v);
        let wrong = |text: String| Finding { text, is_wrong: true };
        match (reading, signal) {
            (Reading::Steady, _) => wrong(format!("{at}: a light does not blink")),
            (Reading::Unknown, _) => wrong(format!("{at}: a light blinks no word of the book")),
            (Reading::Word(word, _), None) => {
                wrong(format!("{at}: word {word}, which is not of this vehicle"))
            }
            (Reading::Word(word, agreed), Some(signal)) => {
                let text =
                    format!("{at}: word {word} of signal {signal}, in {:.0} % of the frames", 100.0 * agreed);
                Finding { text, is_wrong: false }
            }
        }
    }

    /// Lights that blink the right words, but not with the clock of the others.
    fn out_of_step(&self, film: &Film<'_>, readings: &[Reading], signals: &[Option<u32>]) -> Vec<Finding> {
        let own = (0..self.lights.len()).filter_map(|light| match (readings[light], signals[light]) {
            (Reading::Word(word, _), Some(_)) => Some((light, Seen { lit: &self.lights[light].lit, word })),
            _ => None,
        });
        let own: Vec<(usize, Seen<'_>)> = own.collect();
        if own.len() < 2 {
            return Vec::new();
        }
        let all: Vec<Seen<'_>> = own.iter().map(|(_, seen)| *seen).collect();
        let clock = film.clock(&all);
        let late = own.iter().filter(|(_, seen)| film.agreed(seen, &clock) < AGREES);
        late.filter_map(|(light, seen)| {
            let length = self.book.length() as f64;
            let by = (film.shift(&[*seen], clock.rate_hz).shift - clock.shift + length / 2.0)
                .rem_euclid(length)
                - length / 2.0;
            let centre = self.lights[*light].spot.centre;
            let text = format!(
                "at {:.0}, {:.0} px: out of step with the other LEDs by {by:+.1} bits",
                centre.u, centre.v
            );
            (by.abs() > IN_STEP).then_some(Finding { text, is_wrong: true })
        })
        .collect()
    }

    /// Signals of the vehicle that no light blinks: whether they face the camera nobody says.
    fn unseen(&self, signals: &[Option<u32>]) -> Vec<Finding> {
        let unseen = (0..self.words.len() as u32).filter(|signal| !signals.contains(&Some(*signal)));
        let told = |signal: u32| {
            let word = self.words[signal as usize];
            let text =
                format!("signal {signal}, word {word}: not seen: its LEDs are dark, or on the far side");
            Finding { text, is_wrong: self.lights.is_empty() }
        };
        unseen.map(told).collect()
    }
}

#[cfg(test)]
mod tests {
    use photinus::camera::Pixel;
    use photinus_io::codes::{PRESETS, parse_codes};
    use photinus_io::results::SpotRecord;

    use super::*;

    /// A light at a column that blinks a word, so many bits late.
    fn light(u_px: f64, word: usize, late: f64, book: &CodeBook, times_s: &[f64]) -> Light {
        let bit =
            |time_s: &f64| (time_s * 60.0 + 3.4 - late).floor().rem_euclid(book.length() as f64) as usize;
        let record: SpotRecord = serde_json::from_str(r#"{"u_px":0,"v_px":0}"#).unwrap();
        let mut spot = Spot::from(&record);
        spot.centre = Pixel::new(u_px, 240.0);
        Light { spot, lit: times_s.iter().map(|time_s| book.words()[word].bit(bit(time_s))).collect() }
    }

    fn told(lights: &[Light], book: &CodeBook, times_s: &[f64]) -> Vec<String> {
        let words = [0, 1, 2, 3];
        let sight = Sight { book, words: &words, rate_hz: 60.0, times_s, lights };
        let wrong = sight.findings(None).unwrap().into_iter().filter(|finding| finding.is_wrong);
        wrong.map(|finding| finding.text).collect()
    }

    #[test]
    fn lights_in_step_are_in_order_and_one_that_is_late_is_told_with_how_much() {
        let book = parse_codes(PRESETS[1].text, PRESETS[1].name).unwrap();
        let times_s: Vec<f64> = (0..150).map(|frame| f64::from(frame) / 59.9).collect();
        let light = |u_px: f64, word: usize, late: f64| light(u_px, word, late, &book, &times_s);
        let good = [light(300.0, 0, 0.0), light(320.0, 1, 0.0), light(340.0, 2, 0.0)];
        assert_eq!(told(&good, &book, &times_s), [""; 0]);
        let late = [light(300.0, 0, 0.0), light(320.0, 1, 2.0), light(340.0, 2, 0.0)];
        let told_late = told(&late, &book, &times_s);
        assert!(
            matches!(told_late.as_slice(), [text] if text.starts_with("at 320, 240 px: out of step")),
            "{told_late:?}"
        );
        let by: f64 = told_late[0].split_whitespace().rev().nth(1).unwrap().parse().unwrap();
        assert!((by.abs() - 2.0).abs() < 0.4, "{by}");
    }

    #[test]
    fn a_light_of_somebody_else_and_one_that_does_not_blink_are_told() {
        let book = parse_codes(PRESETS[1].text, PRESETS[1].name).unwrap();
        let times_s: Vec<f64> = (0..150).map(|frame| f64::from(frame) / 59.9).collect();
        let mut steady = light(500.0, 0, 0.0, &book, &times_s);
        steady.lit.fill(true);
        let lights = [light(300.0, 0, 0.0, &book, &times_s), light(400.0, 5, 0.0, &book, &times_s), steady];
        let told = told(&lights, &book, &times_s);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(
            told[0].contains("word 5, which is not of this vehicle") && told[1].contains("does not blink"),
            "{told:?}"
        );
    }
}
