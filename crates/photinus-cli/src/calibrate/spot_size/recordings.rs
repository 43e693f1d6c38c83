//! What was recorded: a dataset through the detector, or a table -> areas over distance.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Pixel;
use photinus::spots::{Brightness, Detections, Detector};
use photinus_calibrate::spot_size::Sample;
use photinus_io::calibration::{SpotSizeRow, read_spot_sizes};
use photinus_io::dataset::{Dataset, TruthFrame, TruthNeighbour};
use photinus_io::{Error, Place};

use crate::beforehand;
use crate::failure::Failure;
use crate::input::{DatasetArgs, InputArgs};
use crate::spot_options::{SpotArgs, mask_of};
use crate::terminal::Terminal;

/// A spot is that of the LED when it is no farther from it than this, or than its own radius, px.
const GATE_PX: f64 = 3.0;
/// Places within a pixel are told apart on a raster of 4 x 4.
const RASTER: usize = 4;
/// Of 16 places, this many must have been seen.
const ENOUGH_PLACES: usize = 12;

/// Areas of one exposure.
pub(super) struct Recording {
    /// Exposure, us, where it is known.
    pub(super) exposure_us: Option<f64>,
    /// The rule of the detector, where it is known.
    pub(super) brightness: Option<Brightness>,
    /// In the order in which they were taken.
    pub(super) samples: Vec<Sample>,
    /// At which places within a pixel the LED was seen, where that is known.
    places: Option<[[bool; RASTER]; RASTER]>,
}

/// Reads a dataset folder or a table.
pub(super) fn read(
    input: &Path,
    choice: &DatasetArgs,
    spots: &SpotArgs,
    terminal: &mut Terminal,
) -> Result<Vec<Recording>, Failure> {
    match input.is_dir() {
        true => Ok(vec![of_dataset(input, choice, spots, terminal)?]),
        false => Ok(of_table(read_spot_sizes(input).map_err(Failure::input)?)),
    }
}

impl Recording {
    /// Says what makes the curve less than it could be.
    pub(super) fn warn(&self, input: &Path, terminal: &Terminal) {
        let Some(places) = self.places else { return };
        let seen = places.iter().flatten().filter(|seen| **seen).count();
        if seen < ENOUGH_PLACES {
            terminal.warning(format_args!(
                "{}: the LED was seen at {seen} of {} places within a pixel: at others its spot may be larger; \
                 let it sway a little while recording",
                input.display(),
                RASTER * RASTER
            ));
        }
    }
}

fn of_table(rows: Vec<SpotSizeRow>) -> Vec<Recording> {
    let mut recordings: Vec<Recording> = Vec::new();
    for SpotSizeRow { distance_m, area_px, exposure_us } in rows {
        let sample = Sample { distance_m, area_px };
        match recordings.iter_mut().find(|recording| recording.exposure_us == exposure_us) {
            Some(recording) => recording.samples.push(sample),
            None => recordings.push(Recording {
                exposure_us,
                brightness: None,
                samples: vec![sample],
                places: None,
            }),
        }
    }
    recordings
}

fn of_dataset(
    input: &Path,
    choice: &DatasetArgs,
    spots: &SpotArgs,
    terminal: &mut Terminal,
) -> Result<Recording, Failure> {
    let frames = InputArgs::of(&[input.to_owned()], choice).open()?;
    let camera = frames.one_camera()?.cloned();
    let dataset = Dataset::read(input).map_err(Failure::input)?;
    let airframe_file = dataset.path(&dataset.info().airframe.first);
    let airframe = beforehand::airframe(&airframe_file, terminal).map_err(Failure::input)?.airframe;
    let truth = dataset.truth().map_err(Failure::input)?.ok_or_else(|| {
        let advice = "the distances must be known: add the truth, or give a table of distances and areas";
        Failure::input(Error::format(input, "the folder holds no truth.jsonl").advise(advice))
    })?;
    let mask = spots.masks(&frames, terminal)?.pop().flatten();
    let mut detector = Detector::new(spots.settings()).map_err(|error| Failure::Input(error.to_string()))?;
    let mut recording = Recording {
        exposure_us: camera.as_ref().map(|camera| camera.exposure_us),
        brightness: Some(spots.settings().brightness),
        samples: Vec::new(),
        places: Some(Default::default()),
    };
    let mut without_one_led = 0;
    terminal.start(frames.count);
    for entry in frames.entries {
        terminal.frame_done();
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                terminal.error(error);
                continue;
            }
        };
        let (Some(number), Some(image)) = (entry.record.frame, &entry.image) else { continue };
        let of_frame =
            truth.iter().find(|truth| truth.frame == number && truth.camera == entry.record.camera);
        let Some((distance_m, led)) = of_frame.and_then(|truth| only_led(truth, &airframe)) else {
            without_one_led += 1;
            continue;
        };
        let found = detector.detect(&image.view(), mask_of(mask.as_ref())).map_err(|error| {
            Failure::input(Error::new(&entry.record.source, error).at(Place::Frame(number)))
        })?;
        if let Some(area_px) = area_px(found, led) {
            recording.samples.push(Sample { distance_m, area_px });
            recording.note_place(led);
        }
    }
    terminal.finish();
    if without_one_led > 0 {
        terminal.note(format_args!(
            "{}: {without_one_led} frames have no LED in sight, or several: left out",
            input.display()
        ));
    }
    Ok(recording)
}

impl Recording {
    fn note_place(&mut self, led: Pixel) {
        let step = |coordinate: f64| ((coordinate - coordinate.floor()) * RASTER as f64) as usize % RASTER;
        if let Some(places) = &mut self.places {
            places[step(led.v)][step(led.u)] = true;
        }
    }
}

/// Distance and place of the LED that shines into the image, where it is the only one.
fn only_led(truth: &TruthFrame, airframe: &Airframe) -> Option<(f64, Pixel)> {
    let mut leds =
        truth.neighbours.iter().flat_map(|neighbour| neighbour.leds.iter().map(move |led| (neighbour, led)));
    let (neighbour, led) = leds.next()?;
    let is_only = leds.next().is_none();
    is_only.then(|| (distance_m(neighbour, led.led, airframe), Pixel::new(led.u_px, led.v_px)))
}

/// From the camera to an LED; to the airframe's origin where the truth does not say which LED it is.
fn distance_m(neighbour: &TruthNeighbour, led: Option<u32>, airframe: &Airframe) -> f64 {
    let led = led.and_then(|led| airframe.leds().get(led as usize));
    let [x, y, z, w] = neighbour.orientation_xyzw;
    let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    led.map_or(neighbour.distance_m, |led| {
        (Vector3::from(neighbour.position_m) + attitude * led.position_m).norm()
    })
}

/// Pixels of the spot at a place, 0 without one; `None` where what is there was rejected.
fn area_px(found: &Detections, at: Pixel) -> Option<u32> {
    let apart_px = |centre: Pixel| libm::hypot(centre.u - at.u, centre.v - at.v);
    let reach_px = |area_px: u32| GATE_PX.max((f64::from(area_px) / std::f64::consts::PI).sqrt());
    let near = found.spots.iter().filter(|spot| apart_px(spot.centre) <= reach_px(spot.area_px));
    let nearest = near.min_by(|a, b| apart_px(a.centre).total_cmp(&apart_px(b.centre)));
    let is_rejected = || found.rejected.iter().any(|other| apart_px(other.centre) <= reach_px(other.area_px));
    match nearest {
        Some(spot) => Some(spot.area_px),
        None if is_rejected() => None,
        None => Some(0),
    }
}
