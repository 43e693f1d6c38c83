//! Photinus's own camera file: every model, plain keys, unknown ones refused.

use std::io::Write;
use std::path::Path;

use nalgebra::{DMatrix, Matrix2};
use photinus::camera::{Camera, CameraError, Ideal, IdealLaw, KannalaBrandt, Model, OCam, Pinhole, Pixel};
use serde::{Deserialize, Serialize};

use super::numbers::{Finite, degrees, values};
use super::optics_toml::{self, OpticsTable};
use super::{CalibrationSummary, CameraFile, CameraFormat, OpticsSummary, camera_error};
use crate::{Error, Place, Result, table};

/// The file as it stands: the keys of all models, of which each model has its own.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Table {
    model: Name,
    width_px: usize,
    height_px: usize,
    field_limit_deg: Option<Finite>,
    centre_px: [Finite; 2],
    direct_polynomial: Option<Vec<Finite>>,
    stretch: Option<[[Finite; 2]; 2]>,
    focal_px: Option<[Finite; 2]>,
    k: Option<[Finite; 4]>,
    shear_px: Option<Finite>,
    radial: Option<[Finite; 6]>,
    tangential: Option<[Finite; 2]>,
    calibration: Option<Calibration>,
    optics: Option<OpticsTable>,
}

/// What a calibration knows about itself.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Calibration {
    photos_used: Option<u32>,
    mean_px: Option<Finite>,
    rms_px: Option<Finite>,
    max_px: Option<Finite>,
    covariance: Vec<Vec<Finite>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
enum Name {
    Ocam,
    Equidistant,
    Equisolid,
    Stereographic,
    Orthographic,
    KannalaBrandt,
    Pinhole,
}

/// Reads a camera in Photinus's own format; `path` is for messages.
///
/// # Errors
/// An [`Error`] with the line or key when the text is no TOML, a key is missing, unknown or of another model, or the
/// numbers do not make a camera.
pub fn parse_camera_toml(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let mut table: Table = table::parse(text, path)?;
    let model = table.take_model(path)?.map_err(|error| camera_error(path, error))?;
    if let Some(key) = table.left_over() {
        let reason = format!("a camera of model {} has no `{key}`", name_in_toml(table.model));
        return Err(Error::format(path, reason)
            .at(Place::Key(key.to_owned()))
            .advise("remove it, or correct the model"));
    }
    let limit = table.field_limit_deg.map(|limit| limit.0);
    let size = [table.width_px, table.height_px];
    let mut file =
        CameraFile::new(CameraFormat::Toml, model, size, limit).map_err(|error| camera_error(path, error))?;
    if let Some(calibration) = table.calibration {
        file.calibration = calibration.summary();
        file.camera = calibrated(file.camera, &calibration.covariance, path)?;
    }
    if let Some(optics) = table.optics {
        let (camera, summary) = optics.install(file.camera, path)?;
        (file.camera, file.optics) = (camera, Some(summary));
    }
    if let Model::OCam(lens) = file.camera.model().clone() {
        file.remark_lens(&lens);
    }
    Ok(file)
}

/// The camera with the covariance that stands in its file.
fn calibrated(camera: Camera, rows: &[Vec<Finite>], path: &Path) -> Result<Camera> {
    let wrong =
        |error: CameraError| camera_error(path, error).at(Place::Key("calibration.covariance".to_owned()));
    let needed = camera.model().parameter_count();
    if rows.len() != needed || rows.iter().any(|row| row.len() != needed) {
        return Err(wrong(CameraError::CovarianceSize { needed, rows: rows.len() }));
    }
    let covariance = DMatrix::from_fn(needed, needed, |i, j| rows[i][j].0);
    camera.with_calibration(covariance).map_err(wrong)
}

/// Writes a camera in Photinus's own format, with the covariance of its calibration if it has one; `path` is for messages.
/// Every digit is kept.
///
/// # Errors
/// An [`Error`] when writing fails.
pub fn write_camera_toml(camera: &Camera, to: &mut impl Write, path: &Path) -> Result<()> {
    write_calibrated_camera_toml(camera, None, None, to, path)
}

/// [`write_camera_toml`] with what the calibrations reached, where the camera has a covariance, and where it has optics.
///
/// # Errors
/// An [`Error`] when writing fails.
pub fn write_calibrated_camera_toml(
    camera: &Camera,
    summary: Option<&CalibrationSummary>,
    optics: Option<&OpticsSummary>,
    to: &mut impl Write,
    path: &Path,
) -> Result<()> {
    let mut text = toml::to_string(&Table::of(camera, summary, optics))
        .map_err(|error| Error::format(path, error.to_string()))?;
    // the table of the point spread is the last one
    text += &camera.optics().map_or(String::new(), |optics| optics_toml::zones_text(optics));
    to.write_all(text.as_bytes()).map_err(|error| Error::io(path, error))
}

impl Table {
    /// The model, taking its keys out of the table.
    fn take_model(&mut self, path: &Path) -> Result<std::result::Result<Model, CameraError>> {
        let centre = Pixel::new(self.centre_px[0].0, self.centre_px[1].0);
        let law = match self.model {
            Name::Ocam => {
                let direct = values(&required(self.direct_polynomial.take(), "direct_polynomial", path)?);
                let [[a, b], [c, d]] =
                    required(self.stretch.take(), "stretch", path)?.map(|row| row.map(|n| n.0));
                return Ok(OCam::new(&direct, centre, Matrix2::new(a, b, c, d)).map(Model::OCam));
            }
            Name::KannalaBrandt => {
                let focal_px = required(self.focal_px.take(), "focal_px", path)?.map(|n| n.0);
                let k = required(self.k.take(), "k", path)?.map(|n| n.0);
                let shear_px = self.shear_px.take().map_or(0.0, |n| n.0);
                return Ok(KannalaBrandt::with_shear(focal_px, centre, k, shear_px).map(Model::KannalaBrandt));
            }
            Name::Pinhole => {
                let focal_px = required(self.focal_px.take(), "focal_px", path)?.map(|n| n.0);
                let radial = required(self.radial.take(), "radial", path)?.map(|n| n.0);
                let tangential = required(self.tangential.take(), "tangential", path)?.map(|n| n.0);
                return Ok(Pinhole::new(focal_px, centre, radial, tangential).map(Model::Pinhole));
            }
            Name::Equidistant => IdealLaw::Equidistant,
            Name::Equisolid => IdealLaw::Equisolid,
            Name::Stereographic => IdealLaw::Stereographic,
            Name::Orthographic => IdealLaw::Orthographic,
        };
        let focal_px = required(self.focal_px.take(), "focal_px", path)?.map(|n| n.0);
        Ok(Ideal::new(law, focal_px, centre).map(Model::Ideal))
    }

    /// A key that the model did not take.
    fn left_over(&self) -> Option<&'static str> {
        [
            (self.direct_polynomial.is_some(), "direct_polynomial"),
            (self.stretch.is_some(), "stretch"),
            (self.focal_px.is_some(), "focal_px"),
            (self.k.is_some(), "k"),
            (self.shear_px.is_some(), "shear_px"),
            (self.radial.is_some(), "radial"),
            (self.tangential.is_some(), "tangential"),
        ]
        .into_iter()
        .find_map(|(there, key)| there.then_some(key))
    }

    fn of(camera: &Camera, summary: Option<&CalibrationSummary>, optics: Option<&OpticsSummary>) -> Self {
        let centre = camera.model().centre();
        let bare = Self {
            model: Name::Ocam,
            width_px: camera.width(),
            height_px: camera.height(),
            field_limit_deg: camera.stated_limit_rad().map(|rad| Finite(degrees(rad))),
            centre_px: [centre.u, centre.v].map(Finite),
            direct_polynomial: None,
            stretch: None,
            focal_px: None,
            k: None,
            shear_px: None,
            radial: None,
            tangential: None,
            calibration: camera.parameter_covariance().map(|matrix| Calibration::of(matrix, summary)),
            optics: camera.optics().map(|measured| OpticsTable::of(measured, optics)),
        };
        match camera.model() {
            Model::OCam(lens) => {
                let s = lens.stretch();
                Self {
                    direct_polynomial: Some(lens.direct().iter().copied().map(Finite).collect()),
                    stretch: Some([[s.m11, s.m12], [s.m21, s.m22]].map(|row| row.map(Finite))),
                    ..bare
                }
            }
            Model::Ideal(lens) => {
                let model = match lens.law() {
                    IdealLaw::Equidistant => Name::Equidistant,
                    IdealLaw::Equisolid => Name::Equisolid,
                    IdealLaw::Stereographic => Name::Stereographic,
                    IdealLaw::Orthographic => Name::Orthographic,
                };
                Self { model, focal_px: Some(lens.focal_px().map(Finite)), ..bare }
            }
            Model::KannalaBrandt(lens) => Self {
                model: Name::KannalaBrandt,
                focal_px: Some(lens.focal_px().map(Finite)),
                k: Some(lens.k().map(Finite)),
                shear_px: Some(lens.shear_px()).filter(|shear| shear.abs() > 0.0).map(Finite),
                ..bare
            },
            Model::Pinhole(lens) => Self {
                model: Name::Pinhole,
                focal_px: Some(lens.focal_px().map(Finite)),
                radial: Some(lens.radial().map(Finite)),
                tangential: Some(lens.tangential().map(Finite)),
                ..bare
            },
        }
    }
}

impl Calibration {
    fn of(covariance: &DMatrix<f64>, summary: Option<&CalibrationSummary>) -> Self {
        let number = |of: fn(&CalibrationSummary) -> f64| summary.map(|summary| Finite(of(summary)));
        Self {
            photos_used: summary.map(|summary| summary.photos_used),
            mean_px: number(|summary| summary.mean_px),
            rms_px: number(|summary| summary.rms_px),
            max_px: number(|summary| summary.max_px),
            covariance: covariance.row_iter().map(|row| row.iter().copied().map(Finite).collect()).collect(),
        }
    }

    fn summary(&self) -> Option<CalibrationSummary> {
        Some(CalibrationSummary {
            photos_used: self.photos_used?,
            mean_px: self.mean_px.as_ref()?.0,
            rms_px: self.rms_px.as_ref()?.0,
            max_px: self.max_px.as_ref()?.0,
        })
    }
}

/// A key that the model needs.
fn required<T>(value: Option<T>, key: &str, path: &Path) -> Result<T> {
    value.ok_or_else(|| {
        Error::format(path, format!("missing key `{key}`, which this model needs")).advise("add it")
    })
}

fn name_in_toml(name: Name) -> &'static str {
    match name {
        Name::Ocam => "ocam",
        Name::Equidistant => "equidistant",
        Name::Equisolid => "equisolid",
        Name::Stereographic => "stereographic",
        Name::Orthographic => "orthographic",
        Name::KannalaBrandt => "kannala_brandt",
        Name::Pinhole => "pinhole",
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FILE: &str = "# mine\nmodel = \"kannala_brandt\"\nwidth_px = 960\nheight_px = 600\ncentre_px = [478.0, 301]\n\
        focal_px = [464.0, 461.0]\nk = [-0.03, 0.004, -0.002, 0.0003]\n";

    fn refusal(text: &str) -> String {
        parse_camera_toml(text, Path::new("cam.toml")).unwrap_err().to_string()
    }

    #[test]
    fn mistakes_are_named_with_line_or_key() {
        let cases = [
            (FILE.replace("301", "nan"), "cam.toml, line 5: NaN where a finite number is expected"),
            (FILE.replace("301", "1e400"), "cam.toml, line 5: "),
            (FILE.replace("301", "\"a\""), "cam.toml, line 5: the text `a` where a number is expected"),
            (FILE.replace(", 301]", "]"), "cam.toml, line 5: a list of 1 where a list of 2 is expected"),
            (FILE.replace("k = [", "kay = ["), "cam.toml, line 7: unknown key `kay`"),
            (FILE.replace("k = [", "#k = ["), "cam.toml: missing key `k`, which this model needs; add it"),
            (
                FILE.replace("k = [", "radial = [1, 2, 3, 4, 5, 6]\nk = ["),
                "cam.toml, `radial`: a camera of model kannala",
            ),
            (FILE.replace("kannala_brandt", "fish"), "cam.toml, line 2: unknown name `fish`"),
            (
                FILE.replace("960", "-960"),
                "cam.toml, line 3: `-960` where a whole number, 0 or more, is expected",
            ),
            (FILE.replace("[464.0, 461.0]", "[0, 461.0]"), "cam.toml: a focal length of 0 px"),
            (FILE.replace("-0.03", "-3"), "cam.toml: the angle off the axis stops growing"),
            (format!("{FILE}field_limit_deg = 0"), "cam.toml: a field limit of 0 deg"),
            (
                format!("{FILE}[calibration]\ncovariance = [[1.0]]"),
                "cam.toml, `calibration.covariance`: a covariance of 1 rows: this model has 9 parameters",
            ),
            (format!("{FILE}[calibration]\nvariance = 1"), "cam.toml, line 9: unknown key `variance`"),
        ];
        for (text, message) in cases {
            assert!(refusal(&text).starts_with(message), "{}\nnot {message}", refusal(&text));
        }
    }

    fn round_trip(camera: &Camera) -> Camera {
        let mut bytes = Vec::new();
        write_camera_toml(camera, &mut bytes, Path::new("out.toml")).unwrap();
        parse_camera_toml(std::str::from_utf8(&bytes).unwrap(), Path::new("out.toml")).unwrap().camera
    }

    proptest! {
        #[test]
        fn every_camera_reads_back_the_same(
            n in prop::array::uniform12(-0.02..0.02_f64),
            f in 300.0..600.0_f64,
            limit_deg in prop::option::of(1.0..30.0_f64),
        ) {
            let centre = Pixel::new(370.0 + n[0], 240.0 + n[1]);
            let direct = [-f, 0.0, n[2] / f, n[3] / (f * f), 1e-5 * n[4]];
            let radial = [n[2], 0.1 * n[3], 0.01 * n[4], n[5], 0.1 * n[6], 0.01 * n[7]];
            let models = [
                Model::OCam(OCam::new(&direct[..4], centre, Matrix2::new(1.0 + n[8], n[9], n[10], 1.0 + n[11])).unwrap()),
                Model::Ideal(Ideal::new(IdealLaw::Equisolid, [f, f + n[2]], centre).unwrap()),
                Model::KannalaBrandt(KannalaBrandt::new([f, f + n[2]], centre, [n[3], 0.1 * n[4], 0.1 * n[5], 0.01 * n[6]]).unwrap()),
                Model::KannalaBrandt(KannalaBrandt::with_shear([f, f + n[2]], centre, [n[3], 0.0, 0.0, 0.0], n[4]).unwrap()),
                Model::Pinhole(Pinhole::new([f, f + n[8]], centre, radial, [0.02 * n[9], 0.02 * n[10]]).unwrap()),
            ];
            for model in models {
                let camera = Camera::new(model, 752, 480, limit_deg.map(f64::to_radians)).unwrap();
                prop_assert_eq!(round_trip(&camera), camera.clone());
                let size = camera.model().parameter_count();
                let covariance = DMatrix::from_fn(size, size, |i, j| if i == j { n[0] * n[0] + 1e-9 } else { 0.0 });
                if let Ok(camera) = camera.with_calibration(covariance) {
                    prop_assert_eq!(round_trip(&camera), camera);
                }
            }
        }
    }
}
