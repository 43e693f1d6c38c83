//! Which format a file is in, by its content; a wrong kind of file is named.

use std::path::Path;

use super::CameraFormat;
use super::yaml;
use crate::{Error, Result};

const KNOWN: &str = "a camera is OCamCalib text, Photinus TOML, UVDAR YAML, Kalibr camchain YAML, ROS CameraInfo YAML or \
                     pyocamcalib JSON";

/// The text of a file, without a byte order mark.
pub(super) fn text<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str> {
    let picture: [(&[u8], &str); 5] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"BM", "a BMP picture"),
        (b"P5", "a PGM picture"),
        (b"\x1f\x8b", "a gzip archive"),
    ];
    let wrong = |what: &str| Error::format(path, format!("this is {what}, not a camera")).advise(KNOWN);
    if let Some((_, what)) = picture.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(wrong(what));
    }
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("binary data, or text other than UTF-8"))?;
    if text.contains('\0') {
        return Err(wrong("binary data"));
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The format of a text.
pub(super) fn format(text: &str, path: &Path) -> Result<CameraFormat> {
    let significant = |line: &&str| !line.is_empty() && !line.starts_with('#') && !line.starts_with("---");
    let Some(first) = text.lines().map(str::trim).find(significant) else {
        return Err(Error::format(path, "the file holds nothing but comments").advise(KNOWN));
    };
    if first.starts_with('{') {
        return Ok(CameraFormat::Pyocamcalib);
    }
    if first.split([' ', '\t', ',']).next().is_some_and(|word| word.parse::<f64>().is_ok()) {
        return numbers(first, path);
    }
    let equals = first.find('=').unwrap_or(usize::MAX);
    let colon = first.find(':').unwrap_or(usize::MAX);
    match (first.starts_with('['), equals.cmp(&colon)) {
        (true, _) | (_, std::cmp::Ordering::Less) => toml(text, path),
        (_, std::cmp::Ordering::Greater) => yaml_keys(text, path),
        _ => Err(Error::format(path, format!("`{}` begins no camera file", shortened(first))).advise(KNOWN)),
    }
}

/// OCamCalib text, unless the first line is one of the other tables of numbers that lie beside it.
fn numbers(first: &str, path: &Path) -> Result<CameraFormat> {
    let other =
        |what: &str| Error::format(path, format!("this looks like {what}, not a camera")).advise(KNOWN);
    if first.contains(',') {
        return Err(other("a list of blink sequences"));
    }
    let words = first.split_whitespace().count();
    let count = first.split_whitespace().next().and_then(|word| word.parse::<usize>().ok());
    if words == 7 && count != Some(6) {
        return Err(other("an LED layout (X Y Z type pitch yaw signal)"));
    }
    Ok(CameraFormat::OcamText)
}

fn toml(text: &str, path: &Path) -> Result<CameraFormat> {
    let key = |line: &str| line.split('=').next().unwrap_or_default().trim().to_owned();
    let has = |name: &str| text.lines().any(|line| key(line) == name);
    let other = |what: &str, advice: &str| {
        Err(Error::format(path, format!("this looks like {what}, not a camera")).advise(advice))
    };
    match () {
        () if has("model") => Ok(CameraFormat::Toml),
        () if has("[[led]]") || has("ring") => other("an airframe", KNOWN),
        () if text.contains("scale_px_m2") => other("a curve of spot sizes", KNOWN),
        () if has("camera") && has("airframe") => {
            other("the dataset.toml of a recording", "name the file that its `camera` names")
        }
        () => Err(Error::format(path, "missing key `model`").advise(
            "write model = \"ocam\", \"equidistant\", \"equisolid\", \"stereographic\", \"orthographic\", \
             \"kannala_brandt\" or \"pinhole\"",
        )),
    }
}

fn yaml_keys(text: &str, path: &Path) -> Result<CameraFormat> {
    let keys = yaml::keys(text, path)?;
    let has = |name: &str| keys.iter().any(|key| key == name);
    if has("calibration_model") {
        Ok(CameraFormat::UvdarYaml)
    } else if keys.iter().any(|key| is_kalibr_camera(key)) || has("camera_model") {
        Ok(CameraFormat::Kalibr)
    } else if has("camera_matrix") || has("K") || has("k") || has("distortion_model") {
        Ok(CameraFormat::CameraInfo)
    } else {
        let found: Vec<&str> = keys.iter().take(6).map(String::as_str).collect();
        let reason = format!("a YAML file with the keys {}: none of a camera", found.join(", "));
        Err(Error::format(path, reason).advise(KNOWN))
    }
}

/// Whether a key is Kalibr's name of a camera: `cam0`, `cam1`, ...
pub(super) fn is_kalibr_camera(key: &str) -> bool {
    key.strip_prefix("cam")
        .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

fn shortened(line: &str) -> String {
    line.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::super::parse_camera;
    use super::*;

    #[test]
    fn the_content_decides() {
        let cases = [
            ("# c\n\n5 -259 0 1e-3 -2e-6 6e-9\n", CameraFormat::OcamText),
            ("model = \"ocam\"\n", CameraFormat::Toml),
            ("# mine\nwidth_px = 3\nmodel = \"ocam\"\n", CameraFormat::Toml),
            ("---\ncalibration_model: ocamcalib\n", CameraFormat::UvdarYaml),
            ("cam0:\n  camera_model: pinhole\n", CameraFormat::Kalibr),
            ("image_width: 3\ncamera_matrix: {}\n", CameraFormat::CameraInfo),
            ("width: 3\nK: []\n", CameraFormat::CameraInfo),
            ("\n{\"taylor_coefficient\": []}", CameraFormat::Pyocamcalib),
        ];
        for (text, expected) in cases {
            assert_eq!(format(text, Path::new("x")).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn a_wrong_kind_of_file_is_named() {
        let cases: [(&[u8], &str); 11] = [
            (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
            (b"\xff\xd8\xff\xe0", "a JPEG picture"),
            (b"a\0b", "this is binary data"),
            (b"\xfe\xff", "this is binary data, or text other than UTF-8"),
            (b"# only\n\n", "nothing but comments"),
            (b"# X Y Z Type Pitch Yaw id\n0.17 0.17 0 0 0.0 0 0\n", "an LED layout"),
            (b"0,0,1,0\n1,1,0,0\n", "a list of blink sequences"),
            (b"name = \"x\"\n[[led]]\nposition_m = [0, 0, 0]\n", "an airframe"),
            (b"camera = \"c.txt\"\nairframe = \"a.toml\"\n", "the dataset.toml of a recording"),
            (b"detector: 3\ntracking: 4\n", "the keys detector, tracking"),
            (b"hello\n", "`hello` begins no camera file"),
        ];
        for (bytes, reason) in cases {
            let refusal = parse_camera(bytes, Path::new("x")).unwrap_err().to_string();
            assert!(refusal.contains(reason), "{refusal}");
        }
    }
}
