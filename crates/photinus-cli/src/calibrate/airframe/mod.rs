//! `photinus calibrate airframe`: photos taken around an airframe -> where its LEDs sit.
//!
//! LEDs that the nominal airframe has closer together than a marker's gap make one spot: they are placed together, and keep their
//! places within the marker.

mod report;

use std::path::PathBuf;

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Led};
use photinus::camera::{Camera, Pixel};
use photinus_calibrate::airframe_layout::{KnownDistance, Layout, LayoutError, LedSighting, calibrate};
use photinus_calibrate::sighted::Sighted;
use photinus_io::airframe::{AirframeFile, Tolerances, toml_text};
use photinus_io::calibration::{self, read_led_sightings};
use photinus_io::{Error, Place};

use crate::beforehand;
use crate::ending::Content;
use crate::failure::Failure;
use crate::number;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate airframe seen.csv --camera camera.toml \\
      --nominal quad.toml --distance 0-3=0.8 --out measured.toml

The table has the columns photo,led,u_px,v_px and, if known, sigma_px: where
each LED is in each photo. LEDs are counted as in the nominal airframe, which
may be off by centimetres: from it come the axes and lobes of the LEDs, the body
frame, and without --distance the scale. Take a dozen photos or more from all
around and from above, with four LEDs or more in each.";

/// Standard deviation of a place whose row gives none, px: only its ratio to others matters.
const SIGMA_PX: f64 = 1.0;

/// Calibrate where the LEDs of an airframe sit
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The table (CSV) of LEDs in photos
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// The camera's calibration, in any format that `photinus info` knows
    #[arg(long, value_name = "FILE")]
    camera: PathBuf,
    /// The airframe as it should be
    #[arg(long, value_name = "FILE")]
    nominal: PathBuf,
    /// A distance between two LEDs, measured by hand; may be given several times
    #[arg(long, value_name = "LED-LED=M", value_parser = distance)]
    distance: Vec<([usize; 2], f64)>,
    /// How well those distances are measured: a standard deviation
    #[arg(long, value_name = "M", default_value_t = 0.001, value_parser = number::metres)]
    distance_sigma: f64,
    /// Write the airframe as measured
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    write: WriteArgs,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let mut targets =
        Targets::new(args.write, [args.table.clone(), args.camera.clone(), args.nominal.clone()]);
    let out = args.out.as_deref().map(|path| targets.file(path, Content::Toml)).transpose()?;
    let camera = beforehand::camera(&args.camera, terminal).map_err(Failure::input)?.camera;
    let AirframeFile { airframe: nominal, tolerances, .. } =
        beforehand::airframe(&args.nominal, terminal).map_err(Failure::input)?;
    let rows = read_led_sightings(&args.table).map_err(Failure::input)?;
    let table = Table { args, camera: &camera, nominal: &nominal, rows: &rows };
    let sightings = table.sightings()?;
    let distances = table.distances()?;
    let nominal_m: Vec<Vector3<f64>> = nominal.markers().iter().map(|marker| marker.position_m).collect();
    let found =
        calibrate(&nominal_m, &sightings, &distances).map_err(|error| refuse(args, &nominal, error))?;
    if let Some(out) = out {
        let airframe = measured(&nominal, &found)
            .map_err(|error| Failure::Running(format!("the LEDs as measured: {error}")))?;
        let told = report::comment(&found, !args.distance.is_empty());
        let tolerances = Tolerances { position_sigma_m: Some(report::mean_sigma_m(&found)), ..tolerances };
        let text = toml_text(&airframe, &tolerances);
        out.write(format!("{told}{text}").as_bytes()).map_err(Failure::running)?;
    }
    match args.quiet {
        true => Ok(()),
        false => terminal.result(report::Told {
            found: &found,
            nominal: &nominal,
            rows: &rows,
            photos: &table.photos(),
        }),
    }
}

/// What was given.
struct Table<'a> {
    args: &'a Args,
    camera: &'a Camera,
    nominal: &'a Airframe,
    rows: &'a [calibration::LedSighting],
}

impl Table<'_> {
    /// Names of the photos, in the order in which they come.
    fn photos(&self) -> Vec<&str> {
        let mut photos: Vec<&str> = Vec::new();
        for row in self.rows {
            if !photos.contains(&row.photo.as_str()) {
                photos.push(&row.photo);
            }
        }
        photos
    }

    fn sightings(&self) -> Result<Vec<LedSighting>, Failure> {
        let photos = self.photos();
        let refuse = |row: &calibration::LedSighting, reason: String, advice: &str| {
            Failure::input(Error::format(&self.args.table, reason).at(Place::Line(row.line)).advise(advice))
        };
        let sighting = |row: &calibration::LedSighting| {
            let marker = marker_of(self.nominal, row.led).ok_or_else(|| {
                let reason = format!(
                    "there is no LED {}: {} has {}",
                    row.led,
                    self.nominal.name(),
                    self.nominal.leds().len()
                );
                refuse(row, reason, "LEDs are counted from 0, in the order of the airframe file")
            })?;
            let (pixel, sigma_px) = (Pixel::new(row.u_px, row.v_px), row.sigma_px.unwrap_or(SIGMA_PX));
            let sighted = Sighted::new(self.camera, pixel, sigma_px).ok_or_else(|| {
                let reason = format!("the camera sees nothing at ({}, {}) px", row.u_px, row.v_px);
                refuse(
                    row,
                    reason,
                    "give places inside the image and the camera's field, in pixels of this calibration",
                )
            })?;
            let photo = photos.iter().position(|photo| *photo == row.photo).unwrap_or(0);
            Ok(LedSighting { photo, led: marker, sighted })
        };
        self.rows.iter().map(sighting).collect()
    }

    fn distances(&self) -> Result<Vec<KnownDistance>, Failure> {
        let known = |&([a, b], distance_m): &([usize; 2], f64)| {
            let (Some(first), Some(second)) = (marker_of(self.nominal, a), marker_of(self.nominal, b)) else {
                return Err(Failure::Input(format!(
                    "--distance {a}-{b}={distance_m}: {} has LEDs 0 to {}",
                    self.nominal.name(),
                    self.nominal.leds().len() - 1
                )));
            };
            Ok(KnownDistance { leds: [first, second], distance_m, sigma_m: self.args.distance_sigma })
        };
        self.args.distance.iter().map(known).collect()
    }
}

/// The marker that an LED belongs to.
fn marker_of(airframe: &Airframe, led: usize) -> Option<usize> {
    airframe.markers().iter().position(|marker| marker.leds.contains(&led))
}

/// The nominal airframe with its markers where they were found.
fn measured(nominal: &Airframe, found: &Layout) -> Result<Airframe, photinus::airframe::AirframeError> {
    let moved = |(index, led): (usize, &Led)| {
        let marker = marker_of(nominal, index).unwrap_or(0);
        let shift_m = found.positions_m[marker].map(|place_m| place_m - nominal.markers()[marker].position_m);
        Led { position_m: led.position_m + shift_m.unwrap_or_else(Vector3::zeros), ..led.clone() }
    };
    Airframe::new(nominal.name(), nominal.leds().iter().enumerate().map(moved).collect())
}

fn refuse(args: &Args, nominal: &Airframe, error: LayoutError) -> Failure {
    let advice = match error {
        LayoutError::TooFew { .. } => "add photos with four LEDs or more, each LED in several photos",
        LayoutError::DoNotFit { .. } => {
            "check the numbers of the LEDs in the photos, and that the camera file is this camera's"
        }
        LayoutError::Undetermined { .. } => "add photos of it from other sides, near by",
        _ => "check the distances and the LEDs that they are between",
    };
    // The library counts markers; the user, LEDs.
    let led = |marker: usize| nominal.markers()[marker].leds[0];
    let error = match error {
        LayoutError::Undetermined { led: marker, sigma_m } => {
            LayoutError::Undetermined { led: led(marker), sigma_m }
        }
        LayoutError::Distance { leds, distance_m, sigma_m } => {
            LayoutError::Distance { leds: leds.map(led), distance_m, sigma_m }
        }
        other => other,
    };
    Failure::input(Error::format(&args.table, error.to_string()).advise(advice))
}

fn distance(text: &str) -> Result<([usize; 2], f64), String> {
    let wrong = || "give two LEDs and the metres between them, such as 0-3=0.8".to_owned();
    let (leds, distance) = text.split_once('=').ok_or_else(wrong)?;
    let (a, b) = leds.split_once('-').ok_or_else(wrong)?;
    let led = |word: &str| word.trim().parse().map_err(|_| wrong());
    Ok(([led(a)?, led(b)?], number::metres(distance.trim()).map_err(|_| wrong())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_name_two_leds_and_metres() {
        assert_eq!(distance("0-3=0.8"), Ok(([0, 3], 0.8)));
        for wrong in ["", "0-3", "0=0.8", "0-3=nan", "0-3=-1", "0-3=0", "a-b=1", "-1-3=0.8"] {
            assert!(distance(wrong).is_err(), "{wrong}");
        }
    }
}
