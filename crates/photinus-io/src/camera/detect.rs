//! Which format a camera file is in, by its content; a wrong kind of file is named.

use std::path::Path;

use super::{CameraFormat, yaml};
use crate::kind::{Kind, Syntax};
use crate::{Error, Result};

const KNOWN: &str = "a camera is OCamCalib text, Photinus TOML, UVDAR YAML, Kalibr camchain YAML, ROS CameraInfo YAML or \
                     pyocamcalib JSON";

/// The text of a camera file, without a byte order mark, and its format.
pub(super) fn format<'a>(bytes: &'a [u8], path: &Path) -> Result<(CameraFormat, &'a str)> {
    let kind = Kind::of_content(bytes);
    let refuse = |kind: Kind| Err(kind.refuse(path, "a camera", KNOWN));
    // The kind shows in the beginning; what is no text may come later.
    let Some(text) = std::str::from_utf8(bytes).ok().filter(|text| !text.contains('\0')) else {
        let is_named = matches!(kind, Kind::Image | Kind::Video | Kind::Foreign(_));
        return refuse(if is_named { kind } else { Kind::Binary });
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match kind {
        Kind::Camera(format) => Ok((format, text)),
        Kind::DatasetTable => Err(kind.refuse(path, "a camera", "name the file that its `camera` names")),
        Kind::Keys(Syntax::Toml) => Err(Error::format(path, "missing key `model`").advise(
            "write model = \"ocam\", \"equidistant\", \"equisolid\", \"stereographic\", \"orthographic\", \
             \"kannala_brandt\" or \"pinhole\"",
        )),
        Kind::Keys(Syntax::Yaml) => {
            let keys = yaml::keys(text, path)?;
            let reason = format!(
                "a YAML file with the keys {}: none of a camera",
                keys[..keys.len().min(6)].join(", ")
            );
            Err(Error::format(path, reason).advise(KNOWN))
        }
        other => refuse(other),
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse_camera;
    use super::*;

    #[test]
    fn a_wrong_kind_of_file_is_named() {
        let cases: [(&[u8], &str); 12] = [
            (b"\x89PNG\r\n\x1a\n", "this is an image, not a camera"),
            (b"\xff\xd8\xff\xe0", "this is an image"),
            (b"a\0b", "this is binary data"),
            (b"\xfe\xff", "this is binary data"),
            (b"5 -259 0\n\xfe\xff", "this is binary data"),
            (b"# only\n\n", "nothing but comments"),
            (b"# X Y Z Type Pitch Yaw id\n0.17 0.17 0 0 0.0 0 0\n", "this is an airframe"),
            (b"0,0,1,0\n1,1,0,0\n", "a list of blink sequences"),
            (b"name = \"x\"\n[[led]]\nposition_m = [0, 0, 0]\n", "an airframe"),
            (b"camera = \"c.txt\"\nairframe = \"a.toml\"\n", "the dataset.toml of a dataset"),
            (b"detector: 3\ntracking: 4\n", "the keys detector, tracking"),
            (b"hello\n", "text in no format that Photinus knows, not a camera; a camera is OCamCalib text"),
        ];
        for (bytes, reason) in cases {
            let refusal = parse_camera(bytes, Path::new("x")).unwrap_err().to_string();
            assert!(refusal.contains(reason), "{refusal}");
        }
    }
}
