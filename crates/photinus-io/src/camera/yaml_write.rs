//! A camera -> the YAML of Kalibr, of ROS or of UVDAR, where its model is one that the format has.

use std::io::Write;
use std::path::Path;

use photinus::camera::{Camera, IdealLaw, Model, Pinhole};

use super::inverse::InverseReport;
use super::numbers::degrees;
use super::ocam_write::Numbers;
use crate::{Error, Result};

/// A YAML format of cameras.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraYaml {
    /// Kalibr's camchain: `pinhole` with `equidistant` or `radtan`.
    Kalibr,
    /// ROS CameraInfo, as `camera_calibration` saves it: `equidistant`, `plumb_bob` or `rational_polynomial`.
    CameraInfo,
    /// UVDAR for ROS 2: `calibration_model` is one of six.
    Uvdar,
}

impl CameraYaml {
    /// Whether a model can stand in a file of this format as it is.
    pub fn holds(self, model: &Model) -> bool {
        match model {
            Model::KannalaBrandt(lens) => lens.shear_px().abs() <= 0.0,
            Model::Ideal(lens) => self == Self::Uvdar || lens.law() == IdealLaw::Equidistant,
            Model::OCam(_) => self == Self::Uvdar,
            Model::Pinhole(lens) => match self {
                Self::Kalibr => lens.radial()[2..].iter().all(|k| k.abs() <= 0.0),
                Self::CameraInfo => true,
                Self::Uvdar => !is_rational(lens),
            },
        }
    }
}

/// Writes a camera in one of the YAML formats, every digit kept; `path` is for messages. The report is that of the inverse
/// polynomial, which UVDAR's `ocamcalib` has.
///
/// # Errors
/// An [`Error`] for a model that the format does not have ([`CameraYaml::holds`]), for a stretch matrix that c, d, e cannot hold, and when writing fails.
pub fn write_camera_yaml(
    camera: &Camera,
    format: CameraYaml,
    to: &mut impl Write,
    path: &Path,
) -> Result<Option<InverseReport>> {
    let lens = Lens::of(camera.model()).filter(|_| format.holds(camera.model()));
    let (text, report) = match (format, camera.model(), lens) {
        (CameraYaml::Uvdar, Model::OCam(lens), _) => {
            let numbers = Numbers::of(camera, lens, path)?;
            (ocam(camera, &numbers), Some(numbers.report))
        }
        (CameraYaml::Uvdar, _, Some(lens)) => (uvdar(camera, lens), None),
        (CameraYaml::Kalibr, _, Some(lens)) => (kalibr(camera, lens), None),
        (CameraYaml::CameraInfo, _, Some(lens)) => (camera_info(camera, lens), None),
        (_, _, None) => {
            let reason = "the format does not have the model of this camera";
            let advice = "write it as Photinus TOML: end the output in .toml";
            return Err(Error::format(path, reason).advise(advice));
        }
    };
    to.write_all(text.as_bytes()).map_err(|error| Error::new(path, error))?;
    Ok(report)
}

/// The lens as all three formats have it: fx, fy, cx, cy, the name of its distortion at Kalibr and at ROS, and its numbers.
struct Lens {
    intrinsics: [f64; 4],
    kalibr: &'static str,
    ros: &'static str,
    distortion: Vec<f64>,
}

impl Lens {
    /// Nothing of an OCam lens, which has no focal length.
    fn of(model: &Model) -> Option<Self> {
        let centre = model.centre();
        let (focal_px, kalibr, ros, distortion) = match model {
            Model::OCam(_) => return None,
            Model::KannalaBrandt(lens) => (lens.focal_px(), "equidistant", "equidistant", lens.k().to_vec()),
            Model::Ideal(lens) => (lens.focal_px(), "equidistant", "equidistant", vec![0.0; 4]),
            Model::Pinhole(lens) => {
                let ros = if is_rational(lens) { "rational_polynomial" } else { "plumb_bob" };
                (lens.focal_px(), "radtan", ros, brown_conrady(lens))
            }
        };
        let [fx, fy] = focal_px;
        Some(Self { intrinsics: [fx, fy, centre.u, centre.v], kalibr, ros, distortion })
    }
}

fn is_rational(lens: &Pinhole) -> bool {
    lens.radial()[3..].iter().any(|k| k.abs() > 0.0)
}

/// k1 k2 p1 p2 k3, and k4 k5 k6 where the lens has them.
fn brown_conrady(lens: &Pinhole) -> Vec<f64> {
    let ([k1, k2, k3, k4, k5, k6], [p1, p2]) = (lens.radial(), lens.tangential());
    let mut numbers = vec![k1, k2, p1, p2, k3];
    if is_rational(lens) {
        numbers.extend([k4, k5, k6]);
    }
    numbers
}

fn kalibr(camera: &Camera, lens: Lens) -> String {
    let Lens { intrinsics, kalibr, mut distortion, .. } = lens;
    distortion.truncate(4);
    format!(
        "cam0:\n  camera_model: pinhole\n  distortion_model: {kalibr}\n  distortion_coeffs: {}\n  intrinsics: {}\n  \
         resolution: [{}, {}]\n{}",
        list(&distortion),
        list(&intrinsics),
        camera.width(),
        camera.height(),
        limit(camera, "  ")
    )
}

fn camera_info(camera: &Camera, lens: Lens) -> String {
    let Lens { intrinsics: [fx, fy, cx, cy], ros, distortion, .. } = lens;
    let matrix = |name: &str, columns: usize, data: &[f64]| {
        let rows = data.len() / columns;
        format!("{name}:\n  rows: {rows}\n  cols: {columns}\n  data: {}\n", list(data))
    };
    [
        format!("image_width: {}\nimage_height: {}\ncamera_name: uv\n", camera.width(), camera.height()),
        matrix("camera_matrix", 3, &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
        format!("distortion_model: {ros}\n"),
        matrix("distortion_coefficients", distortion.len(), &distortion),
        matrix("rectification_matrix", 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
        matrix("projection_matrix", 4, &[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]),
        limit(camera, ""),
    ]
    .concat()
}

fn uvdar(camera: &Camera, lens: Lens) -> String {
    let Lens { intrinsics, distortion, .. } = lens;
    let (name, distortion) = match camera.model() {
        Model::Ideal(lens) => match lens.law() {
            IdealLaw::Equidistant => ("equidistant", distortion),
            IdealLaw::Equisolid => ("equisolid", Vec::new()),
            IdealLaw::Stereographic => ("stereographic", Vec::new()),
            IdealLaw::Orthographic => ("orthographic", Vec::new()),
        },
        Model::Pinhole(_) => ("pinhole", distortion),
        _ => ("equidistant", distortion),
    };
    format!(
        "calibration_model: {name}\nintrinsics: {}\ndistortion: {}\nimage_width: {}\nimage_height: {}\n{}",
        list(&intrinsics),
        list(&distortion),
        camera.width(),
        camera.height(),
        limit(camera, "")
    )
}

fn ocam(camera: &Camera, numbers: &Numbers) -> String {
    let centre = camera.model().centre();
    format!(
        "calibration_model: ocamcalib\ndirect_polynomial: {}\ninverse_polynomial: {}\ncenter: {}\naffine: {}\n\
         image_size: [{}, {}]\n{}",
        list(&numbers.direct),
        list(&numbers.inverse),
        list(&[centre.v, centre.u]),
        list(&numbers.affine),
        camera.height(),
        camera.width(),
        limit(camera, "")
    )
}

/// Photinus's own key for where the field ends; other programs pass it over.
fn limit(camera: &Camera, indent: &str) -> String {
    let stated = camera.stated_limit_rad();
    stated.map_or_else(String::new, |rad| format!("{indent}field_limit_deg: {}\n", number(degrees(rad))))
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|value| number(*value)).collect();
    format!("[{}]", numbers.join(", "))
}

/// A number as every YAML reads it: those of version 1.1 want a point before the exponent and a sign in it.
fn number(value: f64) -> String {
    let plain = format!("{value:?}");
    let Some((digits, power)) = plain.split_once('e') else { return plain };
    let point = if digits.contains('.') { "" } else { ".0" };
    let sign = if power.starts_with('-') { "" } else { "+" };
    format!("{digits}{point}e{sign}{power}")
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;
    use photinus::camera::{Ideal, KannalaBrandt, OCam, Pixel};
    use proptest::prelude::*;

    use super::super::{CameraFormat, parse_camera};
    use super::*;

    fn read(camera: &Camera, format: CameraYaml) -> (Camera, CameraFormat) {
        let (mut bytes, path) = (Vec::new(), Path::new("cam.yaml"));
        write_camera_yaml(camera, format, &mut bytes, path).unwrap_or_else(|error| panic!("{error}"));
        let file = parse_camera(&bytes, path)
            .unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(&bytes)));
        (file.camera, file.format)
    }

    #[test]
    fn numbers_are_those_of_every_yaml() {
        for (value, text) in
            [(1e-7, "1.0e-7"), (1.5e-7, "1.5e-7"), (2e20, "2.0e+20"), (-0.5, "-0.5"), (3.0, "3.0")]
        {
            assert_eq!(number(value), text);
        }
    }

    proptest! {
        #[test]
        fn every_model_that_a_format_holds_reads_back_the_same(
            n in prop::array::uniform12(-0.02..0.02_f64),
            f in 300.0..600.0_f64,
            limit_deg in prop::option::of(1.0..30.0_f64),
        ) {
            use CameraYaml as Y;
            let centre = Pixel::new(370.0 + n[0], 240.0 + n[1]);
            let direct = [-f, 0.0, n[2] / f, n[3] / (f * f), 1e-5 * n[4]];
            let stretch = Matrix2::new(1.0 + n[8], n[9], n[10], 1.0);
            let pinhole = |radial| Model::Pinhole(Pinhole::new([f, f + n[8]], centre, radial, [0.02 * n[9], 0.02 * n[10]]).unwrap());
            let ideal = |law| Model::Ideal(Ideal::new(law, [f, f + n[2]], centre).unwrap());
            let all = [Y::Kalibr, Y::CameraInfo, Y::Uvdar];
            let models: [(Model, &[CameraYaml]); 9] = [
                (Model::KannalaBrandt(KannalaBrandt::new([f, f + n[2]], centre, [n[3], 0.1 * n[4], 0.1 * n[5], 0.01 * n[6]]).unwrap()), &all),
                (Model::KannalaBrandt(KannalaBrandt::with_shear([f, f], centre, [0.0; 4], 0.1).unwrap()), &[]),
                (ideal(IdealLaw::Equidistant), &all),
                (ideal(IdealLaw::Equisolid), &[Y::Uvdar]),
                (ideal(IdealLaw::Stereographic), &[Y::Uvdar]),
                (Model::OCam(OCam::new(&direct[..4], centre, stretch).unwrap()), &[Y::Uvdar]),
                (pinhole([n[2], 0.1 * n[3], 0.0, 0.0, 0.0, 0.0]), &all),
                (pinhole([n[2], 0.1 * n[3], 0.01 * n[4] + 1e-6, 0.0, 0.0, 0.0]), &[Y::CameraInfo, Y::Uvdar]),
                (pinhole([n[2], 0.1 * n[3], 0.01 * n[4], n[5] + 0.03, 0.1 * n[6], 0.01 * n[7]]), &[Y::CameraInfo]),
            ];
            let formats = [CameraFormat::Kalibr, CameraFormat::CameraInfo, CameraFormat::UvdarYaml];
            for (model, held_by) in models {
                let camera = Camera::new(model, 752, 480, limit_deg.map(f64::to_radians)).unwrap();
                for (yaml, format) in all.into_iter().zip(formats) {
                    prop_assert_eq!(yaml.holds(camera.model()), held_by.contains(&yaml), "{:?} {:?}", yaml, camera.model());
                    if !yaml.holds(camera.model()) {
                        let refused = write_camera_yaml(&camera, yaml, &mut Vec::new(), Path::new("x"));
                        prop_assert!(refused.is_err());
                        continue;
                    }
                    let (back, read_as) = read(&camera, yaml);
                    prop_assert_eq!(read_as, format);
                    prop_assert_eq!((back.width(), back.height(), back.stated_limit_rad()), (752, 480, camera.stated_limit_rad()));
                    for (u, v) in [(370.0, 239.0), (200.5, 100.5), (500.0, 300.0), (3.0, 5.0)] {
                        prop_assert_eq!(back.bearing(Pixel::new(u, v)), camera.bearing(Pixel::new(u, v)));
                    }
                }
            }
        }
    }
}
