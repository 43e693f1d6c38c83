use nalgebra::{Unit, Vector3};

use super::*;
use crate::image::GreyImage;
use crate::scratch::Folder;

const INFO: &str =
    "camera = \"camera.txt\"\nairframe = \"airframe.toml\"\nexposure_us = 1000.0\nrate_hz = 60\n";
const HEADER: &str = "frame,time_s,image,gx,gy,gz\n";

fn info() -> DatasetInfo {
    DatasetInfo::parse(INFO, "dataset.toml").unwrap()
}

fn info_message(text: &str) -> String {
    DatasetInfo::parse(text, "d/dataset.toml").unwrap_err().to_string()
}

fn csv_message(rows: &str) -> String {
    parse_frames_csv(&format!("{HEADER}{rows}"), "d/frames.csv").unwrap_err().to_string()
}

#[test]
fn a_folder_written_is_read_back() {
    let scratch = Folder::new("dataset");
    let folder = scratch.path().join("recording");
    let info = DatasetInfo { mask: Some("mask.png".into()), ..info() };
    let image = GreyImage::new((0..12).collect(), 4, 3).unwrap();
    let down = Unit::new_normalize(Vector3::new(0.1, 0.9, -0.2));
    let truth = TruthFrame {
        frame: 1,
        time_s: 1.0 / 60.0,
        camera: None,
        true_time_s: None,
        neighbours: vec![TruthNeighbour {
            id: 3,
            position_m: [0.1, -0.2, 7.3],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            velocity_m_s: Some([1.0, -2.5, 0.125]),
            distance_m: 7.303_423_9,
            leds: vec![TruthLed { u_px: 100.25, v_px: 3.5, led: Some(2) }],
        }],
    };
    let mut writer = DatasetWriter::create(&folder, &info).unwrap();
    assert_eq!(writer.frame(&image.view(), 0.0, None).unwrap(), 0);
    assert_eq!(writer.frame(&image.view(), 1.0 / 60.0, Some(down)).unwrap(), 1);
    writer.truth(&truth).unwrap();

    let dataset = Dataset::read(&folder).unwrap();
    assert_eq!(dataset.info(), &info);
    let rows: Vec<_> = dataset.frames().iter().map(|row| (row.frame, row.time_s, row.gravity)).collect();
    assert_eq!(rows, [(0, 0.0, None), (1, 1.0 / 60.0, Some(down))]);
    assert_eq!(crate::image::read_image(dataset.path(&dataset.frames()[1].image)).unwrap().image, image);
    assert_eq!(dataset.truth().unwrap().unwrap(), std::slice::from_ref(&truth));

    for time_s in [1.0 / 60.0, 0.0, f64::NAN] {
        let message = writer.frame(&image.view(), time_s, None).unwrap_err().to_string();
        assert!(message.contains("frames.csv, frame 2: "), "{message}");
    }
    assert!(
        writer
            .numbered_frame(1, &image.view(), 9.0, None)
            .unwrap_err()
            .to_string()
            .contains("number 1 does not")
    );
    let mut broken = truth;
    broken.neighbours[0].leds[0].u_px = f64::NAN;
    assert!(
        writer
            .truth(&broken)
            .unwrap_err()
            .to_string()
            .contains("truth.jsonl, frame 1: a number of the truth")
    );
    assert_eq!(Dataset::read(&folder).unwrap(), dataset, "what was refused is not written");

    writer.numbered_frame(7, &image.view(), 9.0, None).unwrap();
    assert_eq!(writer.frame(&image.view(), 10.0, None).unwrap(), 8);
    let last = Dataset::read(&folder).unwrap().frames().last().unwrap().clone();
    assert_eq!((last.frame, last.image.as_path()), (8, Path::new("images/000008.png")));

    let again = DatasetWriter::create(&folder, &info).unwrap_err().to_string();
    assert!(again.ends_with("; remove it, or write elsewhere"), "{again}");
}

#[test]
fn a_folder_that_is_no_dataset_says_what_it_lacks() {
    let scratch = Folder::new("no-dataset");
    let message = Dataset::read(scratch.path()).unwrap_err().to_string();
    assert!(message.contains("the folder holds no dataset.toml; name the folder of a dataset"), "{message}");
    scratch.file("dataset.toml", INFO.as_bytes());
    assert!(Dataset::read(scratch.path()).unwrap_err().to_string().contains("no frames.csv"));
    let gone = Dataset::read(scratch.path().join("gone")).unwrap_err().to_string();
    assert!(gone.ends_with("; check the path, which is taken from the current folder"), "{gone}");
}

#[test]
fn unknown_and_missing_keys_are_named() {
    let message = info_message(&format!("{INFO}exposure = 3\n"));
    assert_eq!(
        message,
        "d/dataset.toml, line 5: unknown key `exposure`, expected one of `camera`, `airframe`, `exposure_us`, \
         `rate_hz`, `spot_curve`, `mask`, `codes`, `vehicles`, `sky`; correct its name or remove it"
    );
    assert!(info_message(&INFO.replace("rate_hz = 60\n", "")).contains("missing key `rate_hz`; add it"));
    assert!(info_message("").contains("missing key `camera`"));
}

#[test]
fn values_that_no_camera_has_are_refused_with_their_key() {
    for value in ["nan", "inf", "-60", "0"] {
        let message = info_message(&INFO.replace("60", value));
        assert!(message.starts_with("d/dataset.toml, `rate_hz`: "), "{message}");
    }
    assert!(
        info_message(&INFO.replace("camera.txt", ""))
            .starts_with("d/dataset.toml, `camera`: the path is empty")
    );
    assert!(
        info_message(&INFO.replace("1000.0", "\"1 ms\""))
            .starts_with("d/dataset.toml, line 3: the text `1 ms` where a number is expected")
    );
}

#[test]
fn rows_are_read_with_and_without_gravity() {
    let text = format!("{HEADER}0,0,images/a.png,,,\r\n7, 0.1 ,images/b.png,0,0.6,0.801\n");
    let rows = parse_frames_csv(&text, "t").unwrap();
    assert_eq!((rows[0].frame, rows[0].gravity, rows[0].line), (0, None, 2));
    assert_eq!((rows[1].frame, rows[1].time_s, rows[1].line), (7, 0.1, 3));
    assert!((rows[1].gravity.unwrap().norm() - 1.0).abs() < 1e-15);
}

#[test]
fn a_bad_row_is_named_by_its_line() {
    for (row, reason) in [
        ("1,0.1,b.png,,", "5 values for 6 columns; write one value per column"),
        ("one,0.1,b.png,,,", "frame `one` is not a number; give a whole number, 0 or more"),
        ("-1,0.1,b.png,,,", "frame `-1` is not a number"),
        ("1,,b.png,,,", "time_s `` is not a number; give seconds"),
        ("1,nan,b.png,,,", "time_s `nan` is not a number"),
        ("1,0.1,,,,", "the image is empty; name the image file"),
        ("1,0.1,b.png,0,1,", "gz `` is not a number; give a number, or leave gx, gy and gz empty"),
        ("1,0.1,b.png,0,9.81,0", "the gravity vector has length 9.81, not 1; divide an accelerometer's"),
        ("1,0.1,b.png,0,inf,0", "gy `inf` is not a number"),
        ("0,0.1,b.png,,,", "frame 0 at 0.1 s does not come after the line before; list the frames"),
        ("1,0,b.png,,,", "frame 1 at 0 s does not come after"),
    ] {
        let message = csv_message(&format!("0,0,a.png,,,\n{row}\n"));
        assert!(message.starts_with(&format!("d/frames.csv, line 3: {reason}")), "{message}");
    }
    assert_eq!(csv_message(""), "d/frames.csv: it lists no frame; add a line per frame");
    let message = parse_frames_csv("frame,time,image\n0,0,a.png\n", "d/frames.csv").unwrap_err().to_string();
    assert!(message.contains("the columns are `frame,time,image`; they must be `frame,time_s,"), "{message}");
}

#[test]
fn a_bad_truth_line_is_named() {
    let message = parse_truth("{\"frame\":0,\"time_s\":0}\n", "d/truth.jsonl").unwrap_err().to_string();
    assert!(message.starts_with("d/truth.jsonl, line 1: column 22: missing key `neighbours`"), "{message}");
}

#[test]
fn a_sky_is_read_back_and_says_what_is_wrong_with_it() {
    const SKY: &str = "[sky]\nlatitude_deg = 50.08\nlongitude_deg = 14.42\ntime = 2018-05-10T10:00:00Z\nheading_deg = 90.0\n";
    let info = DatasetInfo::parse(&format!("{INFO}{SKY}"), "dataset.toml").unwrap();
    assert_eq!(info.sky.as_ref().and_then(|sky| sky.heading_deg), Some(90.0));
    let written = toml::to_string(&info).unwrap();
    assert_eq!(DatasetInfo::parse(&written, "dataset.toml").unwrap(), info, "{written}");
    for (from, to, message) in [
        ("50.08", "95.0", "`sky.latitude_deg`: 95.0 is out of range"),
        ("10:00:00Z", "10:00:00", "`sky.time`: 2018-05-10T10:00:00 is no date and time in UTC; write it as"),
        ("heading_deg = 90.0", "heading_sigma_deg = -1.0", "`sky.heading_sigma_deg`: -1.0 is out of range"),
        ("latitude_deg = 50.08\n", "", "latitude_deg"),
        ("heading_deg", "heading", "heading"),
    ] {
        let error = info_message(&format!("{INFO}{}", SKY.replace(from, to)));
        assert!(error.contains(message), "{error}");
    }
}
