//! ROS CameraInfo YAML, as `camera_calibration` saves it and as the message prints.

use std::path::Path;

use photinus::camera::{CameraError, KannalaBrandt, Model, Pinhole, Pixel};
use serde::Deserialize;

use super::numbers::{Finite, exactly, values};
use super::yaml::{at_key, parse, required};
use super::{CameraFile, CameraFormat, camera_error};
use crate::Result;

#[derive(Deserialize)]
struct Document {
    #[serde(alias = "width")]
    image_width: usize,
    #[serde(alias = "height")]
    image_height: usize,
    camera_matrix: Option<Matrix>,
    /// The message's spelling.
    #[serde(alias = "K")]
    k: Option<Vec<Finite>>,
    #[serde(default)]
    distortion_model: String,
    distortion_coefficients: Option<Matrix>,
    /// The message's spelling.
    #[serde(alias = "D")]
    d: Option<Vec<Finite>>,
    field_limit_deg: Option<Finite>,
}

#[derive(Deserialize)]
struct Matrix {
    data: Vec<Finite>,
}

/// Reads a ROS CameraInfo; `path` is for messages. `plumb_bob`, `rational_polynomial`, `equidistant` and
/// `kannala_brandt` (also called `fisheye`) are known; no distortion at all is a plain pinhole.
///
/// # Errors
/// An [`crate::Error`] with the line or key when the text is no YAML, a key is missing or has the wrong count, the
/// distortion is unknown, the matrix is skewed, or the numbers do not make a camera.
pub fn parse_camera_info(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let document: Document = parse(text, path)?;
    let model = document.model(path)?.map_err(|error| camera_error(path, error))?;
    let limit = document.field_limit_deg.map(|limit| limit.0);
    let size = [document.image_width, document.image_height];
    CameraFile::new(CameraFormat::CameraInfo, model, size, limit).map_err(|error| camera_error(path, error))
}

impl Document {
    fn model(&self, path: &Path) -> Result<std::result::Result<Model, CameraError>> {
        let data = |matrix: &Option<Matrix>| matrix.as_ref().map(|matrix| matrix.data.clone());
        let matrix = required(data(&self.camera_matrix).or(self.k.clone()), "camera_matrix", path)?;
        let Some([fx, skew, cx, zero_a, fy, cy, zero_b, zero_c, one]) = exactly(&matrix) else {
            return Err(at_key(
                path,
                "camera_matrix",
                format!("{} numbers where 9 are expected", matrix.len()),
                "give the 3 x 3 matrix row by row",
            ));
        };
        if [skew, zero_a, zero_b, zero_c, one - 1.0].iter().any(|x| x.abs() > 1e-9) {
            let reason = "fx 0 cx, 0 fy cy, 0 0 1 is expected, without skew";
            return Err(at_key(path, "camera_matrix", reason, "calibrate without skew"));
        }
        let (focal_px, centre) = ([fx, fy], Pixel::new(cx, cy));
        let d = data(&self.distortion_coefficients).or(self.d.clone()).unwrap_or_default();
        let count = |expected: &str| {
            at_key(
                path,
                "distortion_coefficients",
                format!("{} numbers where {expected} are expected", d.len()),
                "give as many as the distortion_model has, or correct the distortion_model",
            )
        };
        match self.distortion_model.as_str() {
            "plumb_bob" | "radtan" | "none" | "" => Ok(plumb_bob(focal_px, centre, &d)
                .ok_or_else(|| count("k1 k2 p1 p2 [k3]"))?
                .map(Model::Pinhole)),
            "rational_polynomial" => {
                let [k1, k2, p1, p2, k3, k4, k5, k6] =
                    exactly(&d).ok_or_else(|| count("k1 k2 p1 p2 k3 k4 k5 k6"))?;
                Ok(Pinhole::new(focal_px, centre, [k1, k2, k3, k4, k5, k6], [p1, p2]).map(Model::Pinhole))
            }
            "equidistant" | "kannala_brandt" | "fisheye" => {
                let k = exactly(&d).ok_or_else(|| count("k1 k2 k3 k4"))?;
                Ok(KannalaBrandt::new(focal_px, centre, k).map(Model::KannalaBrandt))
            }
            other => {
                let known = "plumb_bob, rational_polynomial, equidistant, kannala_brandt";
                let reason = format!("`{other}` is none of {known}");
                Err(at_key(path, "distortion_model", reason, "calibrate with one of them"))
            }
        }
    }
}

/// A pinhole with none, k1 k2 p1 p2, or k1 k2 p1 p2 k3; `None` for another count.
pub(super) fn plumb_bob(
    focal_px: [f64; 2],
    centre: Pixel,
    distortion: &[Finite],
) -> Option<std::result::Result<Pinhole, CameraError>> {
    let [k1, k2, p1, p2, k3] = match *values(distortion).as_slice() {
        [] => [0.0; 5],
        [k1, k2, p1, p2] => [k1, k2, p1, p2, 0.0],
        [k1, k2, p1, p2, k3] => [k1, k2, p1, p2, k3],
        _ => return None,
    };
    Some(Pinhole::new(focal_px, centre, [k1, k2, k3, 0.0, 0.0, 0.0], [p1, p2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAVED: &str = "image_width: 640\nimage_height: 480\ncamera_name: uv\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
        data: [574.05, 0, 319.5, 0, 575.0, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n\
        distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.1, 0.02, 0.001, -0.0005, 0.003]\n";
    const PRINTED: &str = "height: 480\nwidth: 640\ndistortion_model: rational_polynomial\nD: [6.0, 4.0, 0.001, -0.0005, 0.2, 6.3, 5.5, 1.2]\n\
        K: [574.05, 0.0, 319.5, 0.0, 575.0, 239.5, 0.0, 0.0, 1.0]\nR: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n";

    fn read(text: &str) -> Result<CameraFile> {
        parse_camera_info(text, Path::new("info.yaml"))
    }

    #[test]
    fn the_saved_file_and_the_printed_message_are_read() {
        let saved = read(SAVED).unwrap().camera;
        let Model::Pinhole(lens) = saved.model() else { panic!("{:?}", saved.model()) };
        assert_eq!(
            (lens.radial(), lens.tangential()),
            ([-0.1, 0.02, 0.003, 0.0, 0.0, 0.0], [0.001, -0.0005])
        );
        assert_eq!((lens.focal_px(), lens.centre()), ([574.05, 575.0], Pixel::new(319.5, 239.5)));
        let printed = read(PRINTED).unwrap().camera;
        let Model::Pinhole(lens) = printed.model() else { panic!("{:?}", printed.model()) };
        assert_eq!((lens.radial(), lens.tangential()), ([6.0, 4.0, 0.2, 6.3, 5.5, 1.2], [0.001, -0.0005]));
        let plain = read(&SAVED.replace("[-0.1, 0.02, 0.001, -0.0005, 0.003]", "[]")).unwrap().camera;
        let Model::Pinhole(lens) = plain.model() else { panic!("{:?}", plain.model()) };
        assert_eq!((lens.radial(), lens.tangential()), ([0.0; 6], [0.0; 2]));
        let fisheye = SAVED.replace("plumb_bob", "equidistant").replace(", 0.003]", "]");
        assert!(matches!(read(&fisheye).unwrap().camera.model(), Model::KannalaBrandt(_)));
    }

    #[test]
    fn mistakes_are_named_with_line_or_key() {
        let cases = [
            (SAVED.replace("[574.05, 0,", "[574.05, 3,"), "info.yaml, `camera_matrix`: fx 0 cx, 0 fy cy"),
            (SAVED.replace("0, 0, 1]", "0, 1]"), "info.yaml, `camera_matrix`: 8 numbers where 9"),
            (
                SAVED.replace("plumb_bob", "thin_prism"),
                "info.yaml, `distortion_model`: `thin_prism` is none of",
            ),
            (
                SAVED.replace("plumb_bob", "equidistant"),
                "info.yaml, `distortion_coefficients`: 5 numbers where k1 k2 k3 k4",
            ),
            (SAVED.replace("574.05", ".inf"), "info.yaml, line 7: "),
            (SAVED.replace("camera_matrix", "matrix"), "info.yaml: missing key `camera_matrix`; add it"),
            (SAVED.replace("-0.1, 0.02", "-3.1, 0.02"), "info.yaml: the angle off the axis stops growing"),
        ];
        for (text, message) in cases {
            let refusal = read(&text).unwrap_err().to_string();
            assert!(refusal.starts_with(message), "{refusal}\nnot {message}");
        }
    }
}
