//! What C reads is what Rust is told, bit for bit: compared with the records of the results' files, which share no conversion with the structures of C.

use std::fmt::Write;

use photinus::camera::Camera;
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};
use photinus::lookout::{Glance, Lookout};
use photinus::tracking;
use photinus_io::airframe::{AirframeFile, read_airframe};
use photinus_io::camera::read_camera;
use photinus_io::results::FrameRecord;

use crate::compiled::{Program, Under};
use crate::shown::{Shown, airframe, camera};

const FRAMES: u32 = 4;

fn bits(told: &mut String, name: &str, numbers: &[f64]) {
    told.push_str(name);
    numbers.iter().for_each(|number| write!(told, " {:016x}", number.to_bits()).unwrap());
    told.push('\n');
}

/// What Rust makes of the same frames.
fn record(shown: &Shown, camera: &Camera, file: &AirframeFile) -> FrameRecord {
    let mut settings = Settings::default();
    let pose = &mut settings.pose;
    pose.marker_sigma_m = file.tolerances.position_sigma_m.unwrap_or(pose.marker_sigma_m);
    pose.unit_sigma = file.tolerances.power_sigma.unwrap_or(pose.unit_sigma);
    let mut locator = Locator::new(camera.clone(), &file.airframe, None, settings).unwrap();
    let mut lookout =
        Lookout::new(camera.clone(), &file.airframe, &settings, tracking::Settings::default(), None).unwrap();
    let view = FrameView::packed(&shown.pixels, shown.width, shown.height).unwrap();
    let down = nalgebra::Vector3::y_axis();
    for number in 0..FRAMES {
        let located = locator.locate(Input::frame(&view).gravity(&down)).unwrap();
        let time_s = f64::from(number) / 30.0;
        lookout
            .look(&Glance {
                camera: 0,
                turned_since_any: None,
                time_s,
                exposure_s: 0.0,
                turned: None,
                moving: None,
                gravity: Some(down),
                located,
            })
            .unwrap();
    }
    let mut record: FrameRecord = FrameRecord {
        frame: None,
        camera: None,
        time_s: None,
        latency_s: None,
        source: String::new(),
        incomplete: false,
        spots: Vec::new(),
        rejected: Vec::new(),
        neighbours: Vec::new(),
        tracks: Vec::new(),
    };
    record.put_located(locator.located(), &[file.airframe.name()]);
    record.add_tracked(lookout.tracked(), None, 0, &[file.airframe.name()]);
    record.name_neighbours();
    record
}

/// The record as the program in C prints it.
fn printed(record: &FrameRecord) -> String {
    let mut told = String::new();
    for spot in &record.spots {
        let bound_rad = spot.bound_rad.unwrap();
        let (area, peak) = (f64::from(spot.area_px), f64::from(spot.peak));
        let numbers =
            [spot.u_px, spot.v_px, spot.flux, spot.background, spot.probability, bound_rad, area, peak];
        bits(&mut told, "spot", &numbers);
        bits(&mut told, "spot.covariance", spot.covariance_px2.as_flattened());
        bits(&mut told, "spot.bearing", &spot.bearing.unwrap());
    }
    for seen in &record.neighbours {
        let (distance, misfit) = (seen.distance_m, seen.misfit.unwrap());
        let numbers = [
            distance.estimate.unwrap(),
            distance.sigma.unwrap(),
            distance.min,
            distance.max.unwrap_or(f64::INFINITY),
            seen.probability.unwrap(),
            misfit.chi2,
            misfit.p,
            f64::from(misfit.dof),
            seen.runner_up.unwrap().probability,
        ];
        bits(&mut told, "neighbour", &numbers);
        bits(&mut told, "neighbour.bearing", &seen.bearing);
        bits(&mut told, "neighbour.position", &seen.position_m.unwrap());
        let covariance = seen.position_covariance_m2.unwrap();
        bits(&mut told, "neighbour.position_covariance", covariance.as_flattened());
        bits(&mut told, "neighbour.orientation", &seen.orientation_xyzw.unwrap());
        let covariance = seen.orientation_covariance_rad2.unwrap();
        bits(&mut told, "neighbour.orientation_covariance", covariance.as_flattened());
        let spots: String = seen.spots.iter().map(|spot| format!(" {spot}")).collect();
        writeln!(told, "neighbour.spots{spots}").unwrap();
        for mode in &seen.modes {
            bits(&mut told, "mode", &[mode.weight]);
            bits(&mut told, "mode.position", &mode.position_m);
            bits(&mut told, "mode.position_covariance", mode.position_covariance_m2.as_flattened());
            bits(&mut told, "mode.orientation", &mode.orientation_xyzw.unwrap());
        }
    }
    for track in &record.tracks {
        bits(&mut told, "track", &[track.probability]);
        bits(&mut told, "track.position", &track.position_m);
        bits(&mut told, "track.velocity", &track.velocity_m_s);
        bits(&mut told, "track.velocity_covariance", track.velocity_covariance_m2_s2.as_flattened());
        bits(&mut told, "track.orientation", &track.orientation_xyzw);
    }
    told
}

#[test]
fn c_reads_the_bits_that_rust_is_told() {
    let Some(program) = Program::compile("tests/interface/bits.c", Under::Nothing) else { return };
    let shown = Shown::new();
    let camera_file = read_camera(camera()).unwrap();
    let record = record(&shown, &camera_file.camera, &read_airframe(airframe()).unwrap());
    assert_eq!((record.neighbours.len(), record.tracks.len()), (1, 1), "the frame shows one quadrotor");
    let told = program.run(&[&camera(), &airframe(), &shown.path(), &FRAMES.to_string()]);
    assert_eq!(told, printed(&record));
}
