//! A dataset: its cameras with their frames, the files it names, and whether they are there.

use std::path::Path;

use photinus_io::airframe::read_airframe;
use photinus_io::dataset::{Dataset, DatasetCamera};
use photinus_io::image::read_image;
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::read_spot_curve;
use photinus_io::{Result, read_camera};

use super::frames::counted_px;
use super::{Report, airframe, counted};

/// Columns and rows of an image, px.
type Size = (usize, usize);

pub(super) fn dataset(folder: &Path) -> Result<Report> {
    let dataset = Dataset::read(folder)?;
    let info = dataset.info();
    let mut report = Report::new(match dataset.cameras() {
        [_] => "a dataset".to_owned(),
        several => format!("a dataset of {} cameras", several.len()),
    });
    for named in info.airframe.iter() {
        let file = read_airframe(dataset.path(named));
        let told = file.map(|file| format!("{}: {}", named.display(), airframe::in_a_line(&file.airframe)));
        part(&mut report, "airframe", told);
    }
    if let Some(codes) = dataset.codes() {
        let words = format!("{} of {} bits", counted(codes.words().len(), "word"), codes.length());
        report.fact("codes", words);
    }
    if !dataset.vehicles().is_empty() {
        report.fact("vehicles", dataset.vehicles().len().to_string());
    }
    let rows = |count: Option<usize>| count.map_or("none".to_owned(), |count| counted(count, "row"));
    for (name, count) in [
        ("imu", dataset.imu().map(|rows| rows.map(|rows| rows.len()))),
        ("odometry", dataset.odometry().map(|rows| rows.map(|rows| rows.len()))),
    ] {
        if !matches!(count, Ok(None)) {
            part(&mut report, name, count.map(rows));
        }
    }
    let truth = dataset.truth().map(|truth| match truth {
        Some(frames) => format!("for {}", counted(frames.len(), "frame")),
        None => "none".to_owned(),
    });
    part(&mut report, "truth", truth);
    for camera in dataset.cameras() {
        of_camera(&mut report, &dataset, camera);
    }
    if let Err(error) = dataset.check_inside() {
        report.notes.push(error.advise("--allow-outside lets the other commands read it").to_string());
    }
    Ok(report)
}

/// A camera and its frames.
fn of_camera(report: &mut Report, dataset: &Dataset, camera: &DatasetCamera) {
    if let Some(name) = &camera.name {
        report.fact("", "");
        report.fact("camera called", name);
    }
    let rows = &camera.frames;
    let span_s = rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last.time_s - first.time_s);
    report.fact("frames", format!("{} over {span_s:.2} s", rows.len()));
    let rate_hz = dataset.info().rate_hz;
    report.fact("camera ran at", format!("{rate_hz} frames per second, {} us exposure", camera.exposure_us));
    let with_gravity = rows.iter().filter(|row| row.gravity.is_some()).count();
    report.fact("gravity", format!("known for {with_gravity} of {} frames", rows.len()));
    let file = read_camera(dataset.path(&camera.camera));
    let size = file.as_ref().ok().map(|file| (file.camera.width(), file.camera.height()));
    let told = file.map(|file| {
        let (width, height) = (file.camera.width(), file.camera.height());
        let format = super::camera::format_name(file.format);
        format!("{}, {format}, {width} x {height} px", camera.camera.display())
    });
    part(report, "camera", told);
    if let (Some(mounting), Some(file)) = (&camera.mounting, &camera.mounting_file) {
        let place = mounting.position_m.map_or("place not known".to_owned(), |m| {
            format!("at {:.3}, {:.3}, {:.3} m in the body frame", m.x, m.y, m.z)
        });
        report.fact("mounting", format!("{}: {place}", file.display()));
    }
    if let Some(mask) = &camera.mask {
        let told = read_mask(dataset.path(mask)).and_then(|file| {
            if let Some((width, height)) = size {
                file.check_size(width, height)?;
            }
            Ok(format!("{}: {} ignored", mask.display(), counted_px(file.mask.ignored_px())))
        });
        part(report, "mask", told);
    }
    if let Some(curve) = &camera.spot_curve {
        let told = read_spot_curve(dataset.path(curve)).map(|_| curve.display().to_string());
        part(report, "spot curve", told);
    }
    let images = images(dataset, camera, size, report);
    report.fact("images", images);
}

/// What a file says, or why it cannot be used.
fn part(report: &mut Report, name: &str, told: Result<String>) {
    match told {
        Ok(text) => report.fact(name, text),
        Err(error) => {
            report.fact(name, "not usable");
            report.broken(error.to_string());
        }
    }
}

/// How many images are there, and whether the first one fits the camera.
fn images(dataset: &Dataset, camera: &DatasetCamera, size: Option<Size>, report: &mut Report) -> String {
    let is_there = |named: &Path| dataset.path(named).is_file();
    let missing: Vec<_> = camera.frames.iter().filter(|row| !is_there(&row.image)).collect();
    if let Some(first) = missing.first() {
        report.broken(format!(
            "{} missing, the first is {}: restore it, or remove line {} of {}",
            counted(missing.len(), "image"),
            first.image.display(),
            first.line,
            camera.frames_file.display()
        ));
    }
    let first = camera.frames.iter().find(|row| is_there(&row.image));
    match first.map(|row| read_image(dataset.path(&row.image))) {
        Some(Ok(file)) => {
            let (width, height) = (file.image.width(), file.image.height());
            if size.is_some_and(|size| size != (width, height)) {
                report.broken(format!(
                    "the first image is {width}x{height}, which is not the size of the camera"
                ));
            }
            format!("{}, {width} x {height} px", camera.frames.len() - missing.len())
        }
        Some(Err(error)) => {
            report.broken(error.to_string());
            "the first one cannot be read".to_owned()
        }
        None => "none".to_owned(),
    }
}
