//! Kalibr's camchain YAML: `cam0:` with a camera model, a distortion model and their numbers.

use std::collections::BTreeMap;
use std::path::Path;

use photinus::camera::{CameraError, KannalaBrandt, Model, Pixel};
use serde::Deserialize;

use super::camera_info::plumb_bob;
use super::numbers::{Finite, exactly};
use super::yaml::{at_key, keys, parse, required};
use super::{CameraFile, CameraFormat, RENEW, camera_error};
use crate::Result;
use crate::kind::is_kalibr_camera;

#[derive(Deserialize)]
struct Chain {
    camera_model: String,
    distortion_model: String,
    distortion_coeffs: Vec<Finite>,
    /// fx, fy, cx, cy.
    intrinsics: Vec<Finite>,
    /// Width, height.
    resolution: [usize; 2],
    field_limit_deg: Option<Finite>,
}

/// Reads a Kalibr camchain of one camera; `path` is for messages.
///
/// Kalibr's `pinhole` with `equidistant` is the Kannala-Brandt model, with `radtan` or `none` the pinhole.
///
/// # Errors
/// An [`crate::Error`] with the line or key when the text is no YAML, holds several cameras, a model that Photinus does not
/// have, the wrong count of numbers, or numbers that do not make a camera.
pub fn parse_kalibr(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let cameras: Vec<String> = keys(text, path)?.into_iter().filter(|key| is_kalibr_camera(key)).collect();
    let chain: Chain = match cameras.as_slice() {
        [] => parse(text, path)?,
        [only] => required(parse::<BTreeMap<String, Chain>>(text, path)?.remove(only), only, path)?,
        several => {
            let reason = format!("the file holds {} cameras", several.len());
            return Err(at_key(path, &several.join(", "), reason, "leave one of them in a file of its own"));
        }
    };
    let model = chain.model(path)?.map_err(|error| camera_error(path, error))?;
    let limit = chain.field_limit_deg.map(|limit| limit.0);
    CameraFile::new(CameraFormat::Kalibr, model, chain.resolution, limit)
        .map_err(|error| camera_error(path, error))
}

impl Chain {
    fn model(&self, path: &Path) -> Result<std::result::Result<Model, CameraError>> {
        if self.camera_model != "pinhole" {
            let reason = format!("`{}`: of Kalibr's camera models only pinhole is read", self.camera_model);
            return Err(at_key(
                path,
                "camera_model",
                reason,
                "calibrate with pinhole-equi or pinhole-radtan",
            ));
        }
        let Some([fx, fy, cx, cy]) = exactly(&self.intrinsics) else {
            let reason = format!("{} numbers where fx fy cx cy are expected", self.intrinsics.len());
            return Err(at_key(path, "intrinsics", reason, RENEW));
        };
        let (focal_px, centre) = ([fx, fy], Pixel::new(cx, cy));
        let count = || {
            at_key(
                path,
                "distortion_coeffs",
                format!("{} numbers where 4 are expected", self.distortion_coeffs.len()),
                "give all of them, zeros where the lens has none",
            )
        };
        match self.distortion_model.as_str() {
            "equidistant" => {
                let k = exactly(&self.distortion_coeffs).ok_or_else(count)?;
                Ok(KannalaBrandt::new(focal_px, centre, k).map(Model::KannalaBrandt))
            }
            "radtan" | "none" => {
                let lens = plumb_bob(focal_px, centre, &self.distortion_coeffs).ok_or_else(count)?;
                Ok(lens.map(Model::Pinhole))
            }
            other => {
                let reason =
                    format!("`{other}`: of Kalibr's distortions equidistant, radtan and none are read");
                Err(at_key(path, "distortion_model", reason, "calibrate with pinhole-equi or pinhole-radtan"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHAIN: &str = "cam0:\n  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: [-0.03, 0.004, -0.002, 0.0003]\n  \
        distortion_model: equidistant\n  intrinsics: [464.0, 461.0, 478.0, 301.0]\n  resolution: [960, 600]\n  rostopic: /uv\n";

    fn read(text: &str) -> Result<CameraFile> {
        parse_kalibr(text, Path::new("camchain.yaml"))
    }

    #[test]
    fn equidistant_and_radtan_are_read() {
        let file = read(CHAIN).unwrap();
        let Model::KannalaBrandt(lens) = file.camera.model() else { panic!("{:?}", file.camera.model()) };
        let expected = ([464.0, 461.0], Pixel::new(478.0, 301.0), [-0.03, 0.004, -0.002, 0.0003]);
        assert_eq!((lens.focal_px(), lens.centre(), lens.k()), expected);
        assert_eq!((file.camera.width(), file.camera.height()), (960, 600));
        let radtan = read(&CHAIN.replace("equidistant", "radtan")).unwrap();
        let Model::Pinhole(lens) = radtan.camera.model() else { panic!("{:?}", radtan.camera.model()) };
        assert_eq!(
            (lens.radial()[..3].to_vec(), lens.tangential()),
            (vec![-0.03, 0.004, 0.0], [-0.002, 0.0003])
        );
    }

    #[test]
    fn mistakes_are_named_with_line_or_key() {
        let second = CHAIN.replace("cam0", "cam1");
        let cases = [
            (format!("{CHAIN}{second}"), "camchain.yaml, `cam0, cam1`: the file holds 2 cameras; leave one"),
            (
                CHAIN.replace("camera_model: pinhole", "camera_model: omni"),
                "camchain.yaml, `camera_model`: `omni`",
            ),
            (CHAIN.replace("equidistant", "fov"), "camchain.yaml, `distortion_model`: `fov`"),
            (CHAIN.replace(", 0.0003", ""), "camchain.yaml, `distortion_coeffs`: 3 numbers where 4"),
            (CHAIN.replace(", 301.0", ""), "camchain.yaml, `intrinsics`: 3 numbers where fx fy cx cy"),
            (CHAIN.replace("[960, 600]", "[960, -1]"), "camchain.yaml, line 7: "),
        ];
        for (text, message) in cases {
            let refusal = read(&text).unwrap_err().to_string();
            assert!(refusal.starts_with(message), "{refusal}\nnot {message}");
        }
    }
}
