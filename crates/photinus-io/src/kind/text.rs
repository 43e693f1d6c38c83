//! Kinds of texts.

use super::keys;
use super::{Kind, Syntax, Table};
use crate::CameraFormat;

/// The first element of a page or a drawing stands within this many bytes.
const MARKUP_BYTES: usize = 1000;

/// What a text is, from its beginning.
pub(super) fn kind(text: &str) -> Kind {
    let text = text.trim_start_matches('\u{feff}');
    let says_something = |line: &&str| !line.is_empty() && !line.starts_with('#') && !line.starts_with("---");
    let Some(first) = text.lines().map(str::trim).find(says_something) else { return Kind::Empty };
    if first.starts_with('<') {
        return of_markup(text);
    }
    if text.trim_start().starts_with(['{', '[']) && !first.starts_with("[[") && !is_toml_table(first) {
        return of_json(text);
    }
    if first.split([' ', '\t', ',']).next().is_some_and(|word| word.parse::<f64>().is_ok()) {
        return of_numbers(first);
    }
    if first.contains(',') && !first.contains(['=', ':', ' ']) {
        return Kind::Table(of_columns(first));
    }
    match (is_toml_table(first), is_toml_pair(first), keys::yaml_key(first)) {
        (true, ..) | (_, true, _) => of_toml(&keys::of_toml(text)),
        (.., Some(_)) => of_yaml(&keys::of_yaml(text)),
        _ => Kind::Text,
    }
}

fn is_toml_table(line: &str) -> bool {
    let name = line.trim_start_matches('[');
    name.len() < line.len() && name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

/// Whether a line begins with `key =`.
fn is_toml_pair(line: &str) -> bool {
    line.split_once('=').is_some_and(|(key, _)| {
        let key = key.trim();
        !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-.\"".contains(c))
    })
}

/// A first line that begins with a number: code words, an LED layout of seven columns, or OCamCalib text, whose first number
/// says how many follow.
fn of_numbers(first: &str) -> Kind {
    if first.contains(',') {
        let is_bits = first.split('#').next().unwrap_or_default().chars().all(|c| "01, \t".contains(c));
        return if is_bits { Kind::Blink } else { Kind::Table(Table::Unknown) };
    }
    let words: Vec<&str> = first.split('#').next().unwrap_or_default().split_whitespace().collect();
    let counts_itself = words[0].parse() == Ok(words.len() - 1);
    match words.len() {
        7 if !counts_itself => Kind::Airframe,
        _ => Kind::Camera(CameraFormat::OcamText),
    }
}

fn of_markup(text: &str) -> Kind {
    let begins = text.get(..text.len().min(MARKUP_BYTES)).unwrap_or(text).to_ascii_lowercase();
    match (begins.contains("<html"), begins.contains("<svg")) {
        (true, _) => Kind::Page,
        (false, true) => Kind::Drawing,
        (false, false) => Kind::Text,
    }
}

fn of_json(text: &str) -> Kind {
    let keys = keys::of_json(text);
    let has = |key: &str| keys.contains(&key);
    // A list begins a level deeper.
    let listed = || text.trim_start().strip_prefix('[').map(keys::of_json).unwrap_or_default();
    match () {
        () if has("taylor_coefficient") => Kind::Camera(CameraFormat::Pyocamcalib),
        () if has("settings") && has("frames") => Kind::Scores,
        () if has("photos_given") => Kind::CalibrationReport,
        () if has("spots") => Kind::Results,
        () if has("neighbours") => Kind::Truth,
        () if listed().contains(&"exposure_us") => Kind::SpotSizeReport,
        () => Kind::Keys(Syntax::Json),
    }
}

fn of_toml(keys: &[&str]) -> Kind {
    let has = |key: &str| keys.contains(&key);
    match () {
        () if has("preset") || has("[observer]") || has("[[target]]") => Kind::Scene,
        () if has("model") => Kind::Camera(CameraFormat::Toml),
        () if has("[[led]]") || has("[ring]") || has("ring") => Kind::Airframe,
        () if has("upper") || has("[upper]") => Kind::SpotCurve,
        () if has("body_from_camera_xyzw") => Kind::Mounting,
        () if has("[[vehicle]]") => Kind::Vehicles,
        () if has("[[camera]]") || (has("camera") && has("airframe")) => Kind::DatasetTable,
        () if has("rate_hz") && has("exposure_us") => Kind::DatasetTable,
        () if has("samples_per_px") || has("spread") => Kind::PointSpread,
        () if has("electrons_per_dn") || has("full_reads_dn") => Kind::Sensor,
        () => Kind::Keys(Syntax::Toml),
    }
}

fn of_yaml(keys: &[&str]) -> Kind {
    let has = |key: &str| keys.contains(&key);
    match () {
        () if has("calibration_model") => Kind::Camera(CameraFormat::UvdarYaml),
        () if keys.iter().any(|key| is_kalibr_camera(key)) || has("camera_model") => {
            Kind::Camera(CameraFormat::Kalibr)
        }
        () if ["camera_matrix", "K", "k", "distortion_model"].into_iter().any(has) => {
            Kind::Camera(CameraFormat::CameraInfo)
        }
        () => Kind::Keys(Syntax::Yaml),
    }
}

/// Whether a key is Kalibr's name of a camera: `cam0`, `cam1`, ...
pub(crate) fn is_kalibr_camera(key: &str) -> bool {
    key.strip_prefix("cam")
        .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

/// The table whose columns have these names.
fn of_columns(first: &str) -> Table {
    let columns: Vec<&str> = first.split(',').map(str::trim).collect();
    let has = |names: &[&str]| names.iter().all(|name| columns.contains(name));
    match () {
        () if has(&["frame", "time_s", "image"]) => Table::Frames,
        () if has(&["time_s", "wx_rad_s"]) => Table::Gyro,
        () if has(&["time_s", "gx", "gy", "gz"]) => Table::Gravity,
        () if has(&["time_s", "x_m", "qw", "vx_m_s"]) => Table::Odometry,
        () if has(&["frame", "bearing_x", "distance_m"]) => Table::Results,
        () if has(&["time_s", "x_m", "qw"]) => Table::Poses,
        () if has(&["image", "u", "v"]) || has(&["image", "row", "col"]) => Table::Corners,
        () if has(&["distance_m", "area_px"]) => Table::SpotSizes,
        () if has(&["photo", "led", "u_px", "v_px"]) => Table::LedSightings,
        () if has(&["u_px", "v_px"]) => Table::KnownSightings,
        () if has(&["panel", "series"]) => Table::Figure,
        () if has(&["quantity", "paper", "reproduced"]) => Table::Summary,
        () => Table::Unknown,
    }
}
