//! The examples of docs/file-formats.md are read as they stand there.

use photinus_io::airframe::parse_airframe;
use photinus_io::camera::parse_camera_toml;
use photinus_io::codes::parse_codes;
use photinus_io::dataset::{
    DatasetInfo, DatasetToml, parse_frames_csv, parse_imu, parse_odometry, parse_truth, parse_vehicles,
};
use photinus_io::results::{CsvWriter, ResultsReader};
use photinus_io::spot_curve::parse_spot_curve;

/// The indented block that begins with `first`, without its indent.
fn example(first: &str) -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/file-formats.md");
    let document = std::fs::read_to_string(path).expect("the document is there");
    let block = document.lines().skip_while(|line| !line.starts_with(&format!("    {first}")));
    let block: Vec<&str> = block.take_while(|line| line.is_empty() || line.starts_with("    ")).collect();
    assert!(!block.is_empty(), "no example begins with {first}");
    let text: String =
        block.iter().map(|line| line.strip_prefix("    ").unwrap_or(line).to_owned() + "\n").collect();
    text.trim_end().to_owned() + "\n"
}

#[test]
fn datasets() {
    assert!(DatasetInfo::parse(&example("camera ="), "example").unwrap().mask.is_some());
    assert_eq!(parse_frames_csv(&example("frame,time_s,image"), "example").unwrap().len(), 2);
    assert_eq!(parse_truth(&example("{\"frame\":0"), "example").unwrap().len(), 1);
}

#[test]
fn rigs() {
    let rig = DatasetToml::parse(&example("# a dataset.toml with"), "example").unwrap();
    assert!(matches!(rig, DatasetToml::Rig(rig) if rig.cameras[0].exposure_us.is_some()));
    assert_eq!(parse_vehicles(&example("[[vehicle]]"), "example").unwrap()[0].words, [1, 4]);
    assert_eq!(parse_imu(&example("time_s,wx_rad_s"), "example").unwrap().len(), 2);
    assert_eq!(parse_odometry(&example("time_s,x_m"), "example").unwrap().len(), 2);
}

#[test]
fn cameras() {
    let camera = parse_camera_toml(&example("model ="), "example").unwrap().camera;
    assert!((camera.field_limit_rad().to_degrees() - 100.0).abs() < 1e-9);
}

#[test]
fn airframes() {
    // The list shows one LED, so it gets a second one.
    let second = "[[led]]\nposition_m = [-0.4, 0.0, 0.0]\naxis = [-1.0, 0.0, 0.0]\nlobe = \"omni\"\n";
    let list = example("name = \"hexarotor-0.4\"") + second;
    assert_eq!(parse_airframe(&list, "example").unwrap().airframe.leds()[0].signal, Some(0));
    let ring = format!("name = \"hexarotor-0.4\"\n{}", example("ring ="));
    assert_eq!(parse_airframe(&ring, "example").unwrap().airframe.markers().len(), 6);
    let layout = example("# X Y Z") + "-0.173241 0.173241 0 0 0.0 3.14159265359 0\n";
    assert_eq!(parse_airframe(&layout, "example").unwrap().airframe.markers().len(), 2);
}

#[test]
fn spot_curves() {
    let file = parse_spot_curve(&example("exposure_us = 1000.0  "), "example").unwrap();
    assert_eq!(
        (file.exposure_us, file.threshold, file.curve.limit_m()),
        (Some(1000.0), Some(200), Some(20.0))
    );
    assert!(file.curve.lower().is_some());
}

#[test]
fn blink_sequences() {
    assert_eq!(parse_codes(&example("0,0,1,0"), "example").unwrap().words().len(), 2);
}

#[test]
fn results() {
    let line = example("{\"frame\":17").replace('\n', "");
    let record = ResultsReader::new(line.as_bytes(), "example").next().unwrap().unwrap();
    assert_eq!((record.spots.len(), record.neighbours[0].modes.len()), (1, 1));
    let spots = example("{\"spots\"");
    assert_eq!(ResultsReader::new(spots.as_bytes(), "example").next().unwrap().unwrap().spots.len(), 2);
}

#[test]
fn the_columns_of_the_table() {
    let mut table = Vec::new();
    let empty = ResultsReader::new(b"{\"spots\":[]}".as_slice(), "example").next().unwrap().unwrap();
    CsvWriter::new(&mut table, "example").unwrap().write(&empty).unwrap();
    assert_eq!(String::from_utf8(table).unwrap(), example("frame,time_s,source"));
}
