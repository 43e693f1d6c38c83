//! The JSON of pyocamcalib: an OCam model with a full stretch matrix. The format is loosely known, so what is assumed is said.

use std::path::Path;

use nalgebra::Matrix2;
use photinus::camera::{Model, OCam, Pixel};
use serde::Deserialize;

use super::numbers::{Finite, values};
use super::{CameraFile, CameraFormat, RENEW, camera_error};
use crate::{ContentError, Error, Place, Result};

#[derive(Deserialize)]
struct Document {
    taylor_coefficient: Vec<Finite>,
    /// Column, row.
    distortion_center: [Finite; 2],
    /// On (column, row).
    stretch_matrix: [[Finite; 2]; 2],
    /// Height, width.
    #[serde(alias = "img_size")]
    image_size: Option<[usize; 2]>,
    field_limit_deg: Option<Finite>,
}

/// Reads a calibration of pyocamcalib; `path` is for messages.
///
/// Assumed, and said among the oddities: the centre is (column, row) and the stretch matrix acts on them; a Taylor
/// polynomial that begins above 0 has z forward. The inverse polynomial is not used.
///
/// # Errors
/// An [`Error`] with the line or key when the text is no JSON, a key is missing or of another shape, or the numbers do
/// not make a camera.
pub fn parse_pyocamcalib(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let document: Document = serde_json::from_str(text).map_err(|error| {
        let cause = ContentError::of_json::<Document>(text.as_bytes(), &error);
        let advice = cause.advice().unwrap_or(RENEW);
        Error::new(path, cause).at(Place::Line(error.line())).advise(advice)
    })?;
    let [height_px, width_px] = document.image_size.ok_or_else(|| {
        Error::format(path, "the file does not say how large the image is")
            .at(Place::Key("image_size".to_owned()))
            .advise("add \"image_size\": [height, width]")
    })?;
    let refuse = |error| camera_error(path, error);
    let forward = document.taylor_coefficient.first().is_some_and(|term| term.0 > 0.0);
    let direct: Vec<f64> =
        values(&document.taylor_coefficient).into_iter().map(|a| if forward { -a } else { a }).collect();
    let [column, row] = document.distortion_center.map(|n| n.0);
    let [[a, b], [c, d]] = document.stretch_matrix.map(|row| row.map(|n| n.0));
    // from (column, row) to the (row, column) of the model
    let lens = OCam::new(&direct, Pixel::new(column, row), Matrix2::new(d, c, b, a)).map_err(refuse)?;
    let limit = document.field_limit_deg.map(|limit| limit.0);
    let model = Model::OCam(lens.clone());
    let mut file =
        CameraFile::new(CameraFormat::Pyocamcalib, model, [width_px, height_px], limit).map_err(refuse)?;
    let axis = if forward { "forward" } else { "backward" };
    file.oddities.push(format!(
        "assumed of this JSON: distortion_center is column then row, stretch_matrix acts on (column, row), z points \
         {axis}; its inverse polynomial is not used"
    ));
    file.remark_lens(&lens);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "{\n\"date\": \"today\",\n\"taylor_coefficient\": [259.5395, 0, -1.626945e-3, 2.328091e-6, -6.601777e-9],\n\
        \"distortion_center\": [364.43, 229.58],\n\"stretch_matrix\": [[1.0, 0.002], [0.001, 1.003]],\n\
        \"image_size\": [480, 752],\n\"inverse_poly\": [1, 2]\n}\n";

    fn read(text: &str) -> Result<CameraFile> {
        parse_pyocamcalib(text, Path::new("cam.json"))
    }

    #[test]
    fn either_sign_of_z_is_the_same_camera() {
        let file = read(FILE).unwrap();
        assert!(file.oddities[0].contains("z points forward"), "{:?}", file.oddities);
        let Model::OCam(lens) = file.camera.model() else { panic!("{:?}", file.camera.model()) };
        assert_eq!(lens.stretch(), Matrix2::new(1.003, 0.001, 0.002, 1.0));
        let toolbox = FILE
            .replace("[259", "[-259")
            .replace("-1.6", "1.6")
            .replace("2.3", "-2.3")
            .replace("-6.6", "6.6");
        assert_eq!(read(&toolbox).unwrap().camera, file.camera);
    }

    #[test]
    fn mistakes_are_named_with_line_or_key() {
        let cases = [
            (
                FILE.replace("\"image_size\": [480, 752],", ""),
                "cam.json, `image_size`: the file does not say",
            ),
            (FILE.replace("364.43", "NaN"), "cam.json, line 4: "),
            (FILE.replace("364.43", "1e400"), "cam.json, line 4: "),
            (FILE.replace("[[1.0, 0.002], ", "["), "cam.json, line 5: "),
            (FILE.replace("[0.001, 1.003]", "[0.5, 0.001]"), "cam.json: the affine matrix cannot"),
            (
                FILE.replace("[259.5395, 0, -1.626945e-3, 2.328091e-6, -6.601777e-9]", "[]"),
                "cam.json: a polynomial of 0",
            ),
        ];
        for (text, message) in cases {
            let refusal = read(&text).unwrap_err().to_string();
            assert!(refusal.starts_with(message), "{refusal}\nnot {message}");
        }
    }
}
