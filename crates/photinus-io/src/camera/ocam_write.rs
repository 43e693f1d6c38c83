//! A camera -> OCamCalib text whose two polynomials agree.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

use photinus::camera::{Camera, Model, OCam};

use super::inverse::{Curve, InverseReport};
use super::numbers::degrees;
use crate::{Error, Result};

/// An inverse polynomial this good is not worth another degree.
const GOOD_ENOUGH_PX: f64 = 0.01;

const INSTEAD: &str = "write it as Photinus TOML: end the output in .toml";

/// Writes an OCam camera as OCamCalib text; `path` is for messages.
///
/// The direct polynomial keeps every digit. The inverse one is fitted over the field with the least degree
/// that stays within 0.01 px; the report says what it reached. A full stretch matrix becomes c, d, e by
/// scaling the radius, which changes no direction.
///
/// # Errors
/// An [`Error`] for a camera of another model, for a stretch matrix whose last term is not positive, and when writing
/// fails.
pub fn write_ocam_text(camera: &Camera, to: &mut impl Write, path: &Path) -> Result<InverseReport> {
    let Model::OCam(lens) = camera.model() else {
        return Err(Error::format(path, "only a camera of model ocam can be written as OCamCalib text")
            .advise(INSTEAD));
    };
    let Numbers { direct, inverse, affine, report } = Numbers::of(camera, lens, path)?;
    let centre = lens.centre();
    let limit = camera
        .stated_limit_rad()
        .map_or(String::new(), |rad| format!("; field_limit_deg = {}", degrees(rad)));

    let text = format!(
        "# direct polynomial z(r), px, ascending powers of r{limit}\n\n{}\n\n\
         # inverse polynomial rho(theta), px, ascending powers of theta, -pi/2 on the axis; within {:.2e} px of the direct one\n\n\
         {}\n\n\
         # centre: row column, from 0\n\n{} {}\n\n\
         # affine parameters c d e\n\n{} {} {}\n\n\
         # image size: height width\n\n{} {}\n",
        counted(&direct),
        report.max_px,
        counted(&inverse),
        centre.v,
        centre.u,
        affine[0],
        affine[1],
        affine[2],
        camera.height(),
        camera.width(),
    );
    to.write_all(text.as_bytes()).map_err(|error| Error::new(path, error))?;
    Ok(report)
}

/// The numbers of an OCam lens as OCamCalib has them.
pub(super) struct Numbers {
    /// z(r), px, ascending powers of r.
    pub(super) direct: Vec<f64>,
    /// rho(theta), px, ascending powers of theta.
    pub(super) inverse: Vec<f64>,
    /// c, d, e.
    pub(super) affine: [f64; 3],
    /// How far the two polynomials are apart.
    pub(super) report: InverseReport,
}

impl Numbers {
    pub(super) fn of(camera: &Camera, lens: &OCam, path: &Path) -> Result<Self> {
        let stretch = lens.stretch();
        let scale = stretch.m22;
        if scale <= 0.0 {
            return Err(Error::format(
                path,
                "the stretch matrix turns the image over: c, d, e cannot hold it",
            )
            .advise(INSTEAD));
        }
        let (inverse, report) = Curve::of(camera, lens).fit(GOOD_ENOUGH_PX / scale);
        Ok(Self {
            // radii grow by `scale`: z(r) keeps its shape when term k shrinks by scale^(k-1)
            direct: lens.direct().iter().zip(-1..).map(|(a, power)| a / scale.powi(power)).collect(),
            inverse: inverse.iter().map(|a| a * scale).collect(),
            affine: [stretch.m11, stretch.m12, stretch.m21].map(|term| term / scale),
            report: InverseReport { max_px: report.max_px * scale, rms_px: report.rms_px * scale, ..report },
        })
    }
}

/// A block with its count, every digit kept.
fn counted(values: &[f64]) -> String {
    let mut block = values.len().to_string();
    for value in values {
        let _ = write!(block, " {value:e}"); // a String takes everything
    }
    block
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;
    use photinus::camera::Pixel;

    use super::super::parse_ocam_text;
    use super::*;

    fn written(stretch: Matrix2<f64>, limit_rad: Option<f64>) -> (Camera, Camera, InverseReport) {
        let direct = [-259.5395, 0.0, 1.626945e-3, -2.328091e-6, 6.601777e-9];
        let lens = OCam::new(&direct, Pixel::new(364.430465, 229.581672), stretch).unwrap();
        let camera = Camera::new(Model::OCam(lens), 752, 480, limit_rad).unwrap();
        let mut bytes = Vec::new();
        let report = write_ocam_text(&camera, &mut bytes, Path::new("out.txt")).unwrap();
        let file = parse_ocam_text(std::str::from_utf8(&bytes).unwrap(), Path::new("out.txt")).unwrap();
        assert!(file.oddities.is_empty(), "{:?}", file.oddities);
        assert!((file.inverse.unwrap().max_px - report.max_px).abs() < 1e-6);
        (camera, file.camera, report)
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        let (camera, back, report) = written(Matrix2::new(1.000314, -1.2e-5, -1.58e-4, 1.0), Some(1.2));
        assert_eq!(camera, back);
        assert!(report.max_px <= 0.01);
    }

    #[test]
    fn a_full_stretch_matrix_keeps_every_direction() {
        let (camera, back, report) = written(Matrix2::new(0.99, 0.01, -0.02, 1.03), None);
        for (u, v) in [(364.4, 229.5), (3.0, 5.0), (740.0, 12.0), (500.0, 470.0)] {
            let (a, b) = (camera.bearing(Pixel::new(u, v)).unwrap(), back.bearing(Pixel::new(u, v)).unwrap());
            assert!(a.angle_to(&b) < 1e-13, "{}", a.angle_to(&b));
        }
        assert!(report.max_px <= 0.01);
    }

    #[test]
    fn another_model_is_refused() {
        use photinus::camera::{Ideal, IdealLaw};
        let lens = Ideal::new(IdealLaw::Equidistant, [250.0; 2], Pixel::new(375.5, 239.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens), 752, 480, None).unwrap();
        assert!(write_ocam_text(&camera, &mut Vec::new(), Path::new("out.txt")).is_err());
    }
}
