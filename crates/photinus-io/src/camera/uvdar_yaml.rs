//! The YAML calibrations of UVDAR for ROS 2: six models under `calibration_model`.

use std::path::Path;

use nalgebra::Matrix2;
use photinus::camera::{CameraError, Ideal, IdealLaw, KannalaBrandt, Model, OCam, Pixel};
use serde::Deserialize;

use super::camera_info::plumb_bob;
use super::numbers::{Finite, exactly, values};
use super::yaml::{at_key, parse, required};
use super::{CameraFile, CameraFormat, camera_error};
use crate::Result;

#[derive(Deserialize)]
struct Document {
    calibration_model: String,
    direct_polynomial: Option<Vec<Finite>>,
    inverse_polynomial: Option<Vec<Finite>>,
    /// Row, column.
    center: Option<[Finite; 2]>,
    /// c, d, e.
    affine: Option<[Finite; 3]>,
    /// Height, width.
    image_size: Option<[usize; 2]>,
    /// fx, fy, cx, cy.
    intrinsics: Option<[Finite; 4]>,
    distortion: Option<Vec<Finite>>,
    image_width: Option<usize>,
    image_height: Option<usize>,
    field_limit_deg: Option<Finite>,
}

/// Reads a YAML calibration of UVDAR for ROS 2; `path` is for messages.
///
/// # Errors
/// An [`crate::Error`] with the line or key when the text is no YAML, a key is missing or has the wrong count, the model is
/// unknown, or the numbers do not make a camera.
pub fn parse_uvdar_yaml(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let document: Document = parse(text, path)?;
    let size = document.size(path)?;
    let limit = document.field_limit_deg.map(|limit| limit.0);
    let refuse = |error| camera_error(path, error);
    if document.calibration_model == "ocamcalib" {
        let lens = document.ocam(path)?.map_err(refuse)?;
        let mut file = CameraFile::new(CameraFormat::UvdarYaml, Model::OCam(lens.clone()), size, limit)
            .map_err(refuse)?;
        file.remark_lens(&lens);
        if let Some(inverse) = &document.inverse_polynomial {
            file.compare_inverse(&lens, &values(inverse));
        }
        return Ok(file);
    }
    let model = document.other(path)?.map_err(refuse)?;
    CameraFile::new(CameraFormat::UvdarYaml, model, size, limit).map_err(refuse)
}

impl Document {
    /// Width and height.
    fn size(&self, path: &Path) -> Result<[usize; 2]> {
        match (self.image_size, self.image_width, self.image_height) {
            (Some([height, width]), None, None) => Ok([width, height]),
            (None, width, height) => {
                Ok([required(width, "image_width", path)?, required(height, "image_height", path)?])
            }
            _ => Err(at_key(
                path,
                "image_size",
                "the size is given twice, also as image_width and image_height",
                "keep one of them",
            )),
        }
    }

    fn ocam(&self, path: &Path) -> Result<std::result::Result<OCam, CameraError>> {
        let direct = values(required(self.direct_polynomial.as_deref(), "direct_polynomial", path)?);
        let [row, column] = required(self.center, "center", path)?.map(|n| n.0);
        let [c, d, e] = required(self.affine, "affine", path)?.map(|n| n.0);
        Ok(OCam::new(&direct, Pixel::new(column, row), Matrix2::new(c, d, e, 1.0)))
    }

    fn other(&self, path: &Path) -> Result<std::result::Result<Model, CameraError>> {
        let law = match self.calibration_model.as_str() {
            "pinhole" | "equidistant" => None,
            "equisolid" => Some(IdealLaw::Equisolid),
            "stereographic" => Some(IdealLaw::Stereographic),
            "orthographic" => Some(IdealLaw::Orthographic),
            unknown => {
                let reason = format!(
                    "`{unknown}` is none of ocamcalib, pinhole, equidistant, equisolid, stereographic, orthographic"
                );
                return Err(at_key(path, "calibration_model", reason, "calibrate with one of them"));
            }
        };
        let [fx, fy, cx, cy] = required(self.intrinsics, "intrinsics", path)?.map(|n| n.0);
        let (focal_px, centre) = ([fx, fy], Pixel::new(cx, cy));
        let distortion = self.distortion.as_deref().unwrap_or_default();
        let count = |expected: &str| {
            let reason = format!("{} numbers where {expected}", distortion.len());
            at_key(path, "distortion", reason, "give all of them, zeros where the lens has none")
        };
        if let Some(law) = law {
            if distortion.iter().any(|d| d.0.abs() > 0.0) {
                let reason = "this model has none: zeros or nothing are expected";
                return Err(at_key(path, "distortion", reason, "use another model, or remove it"));
            }
            return Ok(Ideal::new(law, focal_px, centre).map(Model::Ideal));
        }
        if self.calibration_model == "pinhole" {
            let lens = plumb_bob(focal_px, centre, distortion)
                .ok_or_else(|| count("k1 k2 p1 p2 [k3] are expected"))?;
            return Ok(lens.map(Model::Pinhole));
        }
        let k = if distortion.is_empty() { Some([0.0; 4]) } else { exactly(distortion) };
        let k = k.ok_or_else(|| count("k1 k2 k3 k4 are expected"))?;
        Ok(KannalaBrandt::new(focal_px, centre, k).map(Model::KannalaBrandt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OCAM: &str = "calibration_model: ocamcalib\ndirect_polynomial: [-259.5395, 0, 1.626945e-3, -2.328091e-6, 6.601777e-9]\n\
        inverse_polynomial: [388.557547, 220.910537, -10.127377, 31.174444, 16.299989, 0.874110, 31.882430, 44.770601, 21.586002, 3.593416]\n\
        center: [229.581672, 364.430465]\naffine: [1.000314, -0.000012, -0.000158]\nimage_size: [480, 752]\n";
    const EQUIDISTANT: &str = "calibration_model: equidistant\nintrinsics: [250.0, 251.0, 370.0, 240.0]\n\
        distortion: [0.01, 0.002, 0, 0]\nimage_width: 752\nimage_height: 480\nserial: 17\n";

    fn read(text: &str) -> Result<CameraFile> {
        parse_uvdar_yaml(text, Path::new("cam.yaml"))
    }

    #[test]
    fn ocam_is_what_the_text_format_gives() {
        let file = read(OCAM).unwrap();
        assert!(file.oddities.is_empty() && file.inverse.is_some());
        assert_eq!((file.camera.width(), file.camera.height()), (752, 480));
        assert_eq!(file.camera.model().centre(), Pixel::new(364.430465, 229.581672));
    }

    #[test]
    fn the_other_models_are_read() {
        assert!(matches!(read(EQUIDISTANT).unwrap().camera.model(), Model::KannalaBrandt(_)));
        let narrow = EQUIDISTANT.replace("250.0, 251.0", "600, 600").replace("[0.01, 0.002, 0, 0]", "[]");
        for (name, law) in [
            ("equisolid", IdealLaw::Equisolid),
            ("stereographic", IdealLaw::Stereographic),
            ("orthographic", IdealLaw::Orthographic),
        ] {
            let file = read(&narrow.replace("equidistant", name)).unwrap();
            assert!(matches!(file.camera.model(), Model::Ideal(lens) if lens.law() == law));
        }
        let pinhole = read(&narrow.replace("equidistant", "pinhole")).unwrap();
        assert!(matches!(pinhole.camera.model(), Model::Pinhole(_)));
    }

    #[test]
    fn mistakes_are_named_with_line_or_key() {
        let cases = [
            (OCAM.replace("center:", "middle:"), "cam.yaml: missing key `center`; add it"),
            (OCAM.replace("-259.5395", ".nan"), "cam.yaml, line 2: "),
            (OCAM.replace("-259.5395", "1e400"), "cam.yaml, line 2: "),
            (OCAM.replace("[480, 752]", "[480, 752"), "cam.yaml, line "),
            (
                OCAM.replace("[480, 752]", "[480, 752]\nimage_width: 752"),
                "cam.yaml, `image_size`: the size is given twice",
            ),
            (
                EQUIDISTANT.replace("equidistant", "plenoptic"),
                "cam.yaml, `calibration_model`: `plenoptic` is none of",
            ),
            (EQUIDISTANT.replace("equidistant", "equisolid"), "cam.yaml, `distortion`: this model has none"),
            (EQUIDISTANT.replace(", 0, 0]", "]"), "cam.yaml, `distortion`: 2 numbers where k1 k2 k3 k4"),
            (
                EQUIDISTANT.replace("image_height", "image_size_y"),
                "cam.yaml: missing key `image_height`; add it",
            ),
        ];
        for (text, message) in cases {
            let refusal = read(&text).unwrap_err().to_string();
            assert!(refusal.starts_with(message), "{refusal}\nnot {message}");
        }
    }
}
