//! `photinus calibrate`, from a table of corners to files.

use std::fmt::Write;

use nalgebra::{Isometry3, Point3, Vector3};
use photinus_io::image::{GreyImage, write_png};

use crate::stage::Stage;

/// Corners of an exact grid seen by an equidistant camera of 260 px per rad, 752x480.
pub(crate) fn corners(photos: u32, (columns, rows): (u32, u32)) -> String {
    let mut table = "image,u,v\n".to_owned();
    for photo in 0..photos {
        let (sin, cos) = libm::sincos(f64::from(photo));
        let shift = Vector3::new(0.45 * sin, 0.25 * cos, 0.5 + 0.05 * f64::from(photo % 3));
        let pose = Isometry3::new(shift, Vector3::new(0.4 * cos, 0.4 * sin, 0.7 * f64::from(photo)));
        for led in 0..columns * rows {
            let from_middle = |place: u32, count: u32| 0.05 * f64::from(place) - 0.025 * f64::from(count - 1);
            let place =
                Point3::new(from_middle(led % columns, columns), from_middle(led / columns, rows), 0.0);
            let point = pose * place;
            let flat = libm::hypot(point.x, point.y);
            let radius = 260.0 * libm::atan2(flat, point.z);
            let (u, v) = (375.5 + radius * point.x / flat, 239.5 + radius * point.y / flat);
            writeln!(table, "photo{photo}.png,{u},{v}").unwrap();
        }
    }
    table
}

/// Photos of such a grid of 7x5 LEDs, in a folder.
pub(crate) fn photos(stage: &Stage, folder: &str, count: u32) {
    let table = corners(count, (7, 5));
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|row| row.split(',').collect()).collect();
    for photo in rows.chunks(35) {
        let mut pixels = vec![0_u8; 752 * 480];
        for [at_u, at_v] in photo.iter().map(|row| [row[1], row[2]].map(|at| at.parse::<f64>().unwrap())) {
            let near = |at: f64, end: u32| (0..end).filter(move |&px| (f64::from(px) - at).abs() < 7.0);
            for (v, u) in near(at_v, 480).flat_map(|v| near(at_u, 752).map(move |u| (v, u))) {
                let (du, dv) = (f64::from(u) - at_u, f64::from(v) - at_v);
                let light = 200.0 * libm::exp(-0.5 * (du * du + dv * dv) / (1.5 * 1.5));
                let pixel = &mut pixels[(v * 752 + u) as usize];
                *pixel = pixel.saturating_add(light as u8);
            }
        }
        let image = GreyImage::new(pixels, 752, 480).unwrap();
        write_png(stage.path(folder).join(photo[0][0]), &image.view()).unwrap();
    }
}

#[test]
fn a_table_of_corners_becomes_a_camera_with_its_report() {
    let stage = Stage::new("calibrate");
    stage.file("corners.csv", corners(10, (7, 5)));
    let words = "calibrate camera corners.csv --size 752x480 --grid 7x5 --model kannala-brandt:1 --board flat \
                 --splits 2 --bootstraps 4 --out cal.toml --ocam cal.txt --report report";
    let done = stage.run(words);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.out.contains("10 of 10 photos used, board flat"), "{done:?}");
    let camera = stage.read("cal.toml");
    assert!(camera.contains("[calibration]") && camera.contains("field_limit_deg"), "{camera}");
    let report: serde_json::Value = serde_json::from_str(&stage.read("report/report.json")).unwrap();
    assert_eq!(report["photos_used"], 10);
    assert!(report["mean_px"].as_f64().unwrap() < 1e-3, "{}", report["mean_px"]);
    let focal = &report["parameters"][0];
    assert!((focal["value"].as_f64().unwrap() - 260.0).abs() < 0.1, "{focal}");
    for file in ["cal.toml", "cal.txt"] {
        let info = stage.run(&format!("info {file}"));
        assert!(info.code == 0 && info.out.contains("752 x 480"), "{info:?}");
    }
}

#[test]
fn what_cannot_be_calibrated_is_told_with_what_to_do() {
    let stage = Stage::new("calibrate-refusals");
    stage.file("corners.csv", corners(10, (7, 5)));
    stage.file("two.csv", corners(2, (7, 5)));
    for (words, told) in [
        ("corners.csv --grid 7x5", "give --size, such as --size 752x480"),
        (
            "corners.csv --size 752x480 --grid 8x6",
            "10 of 10 photos show a grid of 7x5, not 8x6: give --grid 7x5",
        ),
        ("two.csv --size 752x480 --grid 7x5", "2 of 2 photos show the grid: at least 3 are needed"),
        ("corners.csv --size 752x480 --grid 7", "two whole numbers with an x between them"),
        ("corners.csv --size 752x480 --grid 7x5 --model fish", "`fish` is no model"),
        ("frame.png --grid 7x5", "0 of 1 photos show the grid"),
    ] {
        let done = stage.run(&format!("calibrate camera {words} --out cal.toml"));
        assert!(done.code == 2 && done.err.contains(told), "{words}: {done:?}");
    }
    let done = stage.run("calibrate coverage corners.csv --size 752x480 --grid 7x5");
    assert!(done.code == 0 && done.out.contains("10 of 10 photos show the grid"), "{done:?}");
}
