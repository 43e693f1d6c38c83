//! What else Photinus writes: mountings, scenes and their parts, vehicles, scores and reports.

use std::path::Path;

use photinus_io::calibration::read_mounting;
use photinus_io::dataset::parse_vehicles;
use photinus_io::kind::Kind;
use photinus_io::{Error, Place, Result};
use photinus_sim::Scene;
use serde_json::Value;

use super::{Report, counted};

pub(super) fn mounting(path: &Path) -> Result<Report> {
    let file = read_mounting(path)?;
    let mut report = Report::new(Kind::Mounting.to_string());
    let axis = |axis: nalgebra::Vector3<f64>| {
        let [x, y, z]: [f64; 3] = (file.body_from_camera * axis).into();
        format!("{x:.4}, {y:.4}, {z:.4} in the body frame")
    };
    report.fact("camera looks along", axis(nalgebra::Vector3::z()));
    report.fact("right in the image", axis(nalgebra::Vector3::x()));
    let sigma_rad = (file.rotation_covariance_rad2.trace() / 3.0).sqrt();
    report.fact("rotation known to", format!("{:.2} mrad per axis", 1e3 * sigma_rad));
    report.fact(
        "position",
        file.position_m.map_or("not known".to_owned(), |m| format!("{:.4}, {:.4}, {:.4} m", m.x, m.y, m.z)),
    );
    if let Some(covariance) = file.position_covariance_m2 {
        report
            .fact("position known to", format!("{:.2} mm per axis", 1e3 * (covariance.trace() / 3.0).sqrt()));
    }
    Ok(report)
}

pub(super) fn scene(path: &Path) -> Result<Report> {
    let scene = Scene::read(path)?;
    let mut report = Report::new(Kind::Scene.to_string());
    report.fact("name", &scene.name);
    let duration_s = scene.frames as f64 / scene.rate_hz;
    report.fact("length", format!("{duration_s:.1} s, {} frames at {} Hz", scene.frames, scene.rate_hz));
    report.fact("exposure", format!("{} us", scene.exposure_us));
    let cameras = scene.cameras.iter().map(|mounted| {
        format!("{}, {} x {} px", mounted.name, mounted.camera.width(), mounted.camera.height())
    });
    report.fact("cameras", cameras.collect::<Vec<_>>().join("; "));
    let targets = scene.targets.iter().map(|target| format!("{} {}", target.id, target.airframe.name()));
    report.fact("neighbours", targets.collect::<Vec<_>>().join(", "));
    let light = [("daylight", scene.daylight.is_some()), ("water", scene.water.is_some())];
    let light: Vec<&str> =
        light.into_iter().filter(|(_, is_there)| *is_there).map(|(name, _)| name).collect();
    report.fact("light", if light.is_empty() { "night".to_owned() } else { light.join(", ") });
    report.fact("seed", scene.seed.to_string());
    Ok(report)
}

pub(super) fn vehicles(path: &Path) -> Result<Report> {
    let vehicles = parse_vehicles(&text(path)?, path)?;
    let mut report = Report::new(Kind::Vehicles.to_string());
    for vehicle in &vehicles {
        let blinks = match vehicle.words.as_slice() {
            [] => "does not blink".to_owned(),
            words => format!("blinks {}", counted(words.len(), "word")),
        };
        report.fact(&format!("id {}", vehicle.id), format!("{}, {blinks}", vehicle.airframe.display()));
    }
    Ok(report)
}

/// A file that is read with the scene that names it.
pub(super) fn part_of_a_scene(path: &Path, kind: Kind, table: &str) -> Result<Report> {
    let entries = text(path)?;
    toml::from_str::<toml::Table>(&entries)
        .map_err(|error| Error::format(path, error.message().trim().to_owned()).advise("correct it there"))?;
    let mut report = Report::new(kind.to_string());
    report.fact("used by", format!("a scene, in {table} file = \"...\": docs/scenes.md"));
    Ok(report)
}

/// What is looked at elsewhere.
pub(super) fn shown(path: &Path, kind: Kind) -> Report {
    let mut report = Report::new(kind.to_string());
    if let Some(remedy) = kind.remedy(path) {
        report.fact("next", remedy);
    }
    report
}

pub(super) fn scores(path: &Path) -> Result<Report> {
    let scores = json(path)?;
    let mut report = Report::new(Kind::Scores.to_string());
    let number = |place: &str| scores.pointer(place).and_then(Value::as_f64);
    let share = |place: &str| number(place).map_or("-".to_owned(), |share| format!("{:.2} %", 100.0 * share));
    report.fact("dataset", word(&scores, "/dataset"));
    report.fact("results", word(&scores, "/results"));
    report.fact(
        "frames",
        format!("{} of {} with truth", word(&scores, "/frames/evaluated"), word(&scores, "/frames/truth")),
    );
    report.fact("neighbours found", share("/neighbours/overall/recall"));
    report.fact("found where nobody is", word(&scores, "/neighbours/overall/false"));
    if let Some(rms_m) = number("/distance/overall/error_m/rms") {
        report.fact("distance error", format!("{rms_m:.3} m rms"));
    }
    report.fact("bounds held", share("/bounds/overall/coverage"));
    Ok(report)
}

pub(super) fn calibration_report(path: &Path) -> Result<Report> {
    let told = json(path)?;
    let mut report = Report::new(Kind::CalibrationReport.to_string());
    report
        .fact("photos", format!("{} used of {}", word(&told, "/photos_used"), word(&told, "/photos_given")));
    report.fact("image", format!("{} x {} px", word(&told, "/width_px"), word(&told, "/height_px")));
    report.fact("model", word(&told, "/model"));
    for (name, place) in [("mean", "/mean_px"), ("rms", "/rms_px"), ("largest", "/max_px")] {
        if let Some(px) = told.pointer(place).and_then(Value::as_f64) {
            report.fact(&format!("{name} residual"), format!("{px:.3} px"));
        }
    }
    let warnings = told.pointer("/warnings").and_then(Value::as_array).into_iter().flatten();
    report.notes.extend(warnings.filter_map(Value::as_str).map(str::to_owned));
    Ok(report)
}

pub(super) fn spot_size_report(path: &Path) -> Result<Report> {
    let told = json(path)?;
    let mut report = Report::new(Kind::SpotSizeReport.to_string());
    for exposure in told.as_array().into_iter().flatten() {
        let name = format!("{} us", word(exposure, "/exposure_us"));
        let curve =
            ["offset_px", "scale_px_m2", "shift_m"].map(|key| word(exposure, &format!("/curve/{key}")));
        let [offset, scale, shift] = curve;
        let frames = word(exposure, "/frames");
        report.fact(
            &name,
            format!("{frames} frames; offset {offset} px, scale {scale} px m^2, shift {shift} m"),
        );
    }
    Ok(report)
}

/// A value at a place of a JSON file as it is read aloud; `-` where there is none.
fn word(value: &Value, place: &str) -> String {
    match value.pointer(place) {
        None | Some(Value::Null) => "-".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    }
}

fn json(path: &Path) -> Result<Value> {
    serde_json::from_str(&text(path)?).map_err(|error| {
        let refused = Error::format(path, "the JSON is cut or damaged here").at(Place::Line(error.line()));
        refused.advise("write it again with the command that made it")
    })
}

fn text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| Error::io(path, error))
}
