//! Camera calibrations: every format that users have, told apart by content.
//!
//! A file enters; a checked [`Camera`] leaves, with what is odd about the file. Photinus's own TOML, OCamCalib
//! text and the YAML formats are written, too. Every format may carry a field limit, `field_limit_deg` (in OCamCalib text inside a comment): without
//! one the field ends at the farthest corner of the image.
//!
//! Photinus TOML, one table of plain keys:
//! ```toml
//! model = "ocam"              # or equidistant, equisolid, stereographic, orthographic, kannala_brandt, pinhole
//! width_px = 752
//! height_px = 480
//! field_limit_deg = 100.0     # optional
//! centre_px = [364.4, 229.6]  # column, row
//! direct_polynomial = [-259.5, 0.0, 1.63e-3, -2.33e-6, 6.6e-9]   # ocam: z(r) in px, ascending, as OCamCalib has it
//! stretch = [[1.0, 0.0], [0.0, 1.0]]                             # ocam: [[c, d], [e, 1]] on (row, column)
//! # all others: focal_px = [fx, fy]; kannala_brandt: k = [k1, k2, k3, k4], optional shear_px; pinhole: radial = [k1, .. k6],
//! # tangential = [p1, p2]
//! [calibration]               # optional: what `photinus calibrate camera` found out about it
//! covariance = [[...], ...]   # of the model's parameters, in the order of Model::parameter_count
//! [optics]                    # optional: lens and sensor as `photinus calibrate optics` measured them, docs/file-formats.md
//! ```

mod camera_info;
mod detect;
mod inverse;
mod kalibr;
mod numbers;
mod ocam_text;
mod ocam_write;
mod optics_toml;
mod own_toml;
mod pyocamcalib;
mod uvdar_yaml;
mod yaml;
mod yaml_write;

use std::path::Path;

use photinus::camera::{Camera, CameraError, Model};

use crate::{Error, Result, whole};

pub use camera_info::parse_camera_info;
pub use inverse::InverseReport;
pub use kalibr::parse_kalibr;
pub use ocam_text::parse_ocam_text;
pub use ocam_write::write_ocam_text;
pub use own_toml::{parse_camera_toml, write_calibrated_camera_toml, write_camera_toml};
pub use pyocamcalib::parse_pyocamcalib;
pub use uvdar_yaml::parse_uvdar_yaml;
pub use yaml_write::{CameraYaml, write_camera_yaml};

/// A camera as a file gave it.
#[derive(Clone, Debug)]
pub struct CameraFile {
    /// The camera.
    pub camera: Camera,
    /// The format of the file.
    pub format: CameraFormat,
    /// What a user should know about the file, one sentence each; empty for an ordinary one.
    pub oddities: Vec<String>,
    /// How far the file's own inverse polynomial is from the inverse of its direct one, where it has both.
    pub inverse: Option<InverseReport>,
    /// What the calibration reached, where the file says so.
    pub calibration: Option<CalibrationSummary>,
    /// What the calibration of the optics says about itself, where the file has optics.
    pub optics: Option<OpticsSummary>,
}

/// What a calibration of optics says about itself; the optics are those of the camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpticsSummary {
    /// Frames that it rests on.
    pub frames: u64,
    /// Spots that it rests on.
    pub spots: u64,
    /// Standard deviation of the mean level of full pixels, grey levels.
    pub saturation_sigma_dn: Option<f64>,
    /// Standard deviation of the error of the point spread, a share of the light.
    pub shape_error_sigma: Option<f64>,
    /// What the frames did not tell: what stands there is what was believed before.
    pub unseen: Vec<String>,
}

/// What a calibration reached: distances between where the photos show LEDs and where the camera expects them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationSummary {
    /// Photos that the camera rests on.
    pub photos_used: u32,
    /// Mean distance, px.
    pub mean_px: f64,
    /// Root mean square distance, px.
    pub rms_px: f64,
    /// Largest distance, px.
    pub max_px: f64,
}

/// The formats of camera files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraFormat {
    /// OCamCalib text (`calib_results.txt`).
    OcamText,
    /// Photinus's own TOML.
    Toml,
    /// The YAML of UVDAR for ROS 2.
    UvdarYaml,
    /// Kalibr's camchain YAML.
    Kalibr,
    /// ROS CameraInfo YAML.
    CameraInfo,
    /// The JSON of pyocamcalib.
    Pyocamcalib,
}

/// Reads a camera file of any format; the content decides, not the name.
///
/// # Errors
/// An [`Error`] with the line or key when the file cannot be read, is of no known format, does not follow it, or does
/// not make a camera.
pub fn read_camera(path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    parse_camera(&whole::read_bytes(path)?, path)
}

/// Reads a camera from the bytes of a file of any format; `path` is for messages.
///
/// # Errors
/// Those of [`read_camera`].
pub fn parse_camera(bytes: &[u8], path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let (format, text) = detect::format(bytes, path)?;
    match format {
        CameraFormat::OcamText => parse_ocam_text(text, path),
        CameraFormat::Toml => parse_camera_toml(text, path),
        CameraFormat::UvdarYaml => parse_uvdar_yaml(text, path),
        CameraFormat::Kalibr => parse_kalibr(text, path),
        CameraFormat::CameraInfo => parse_camera_info(text, path),
        CameraFormat::Pyocamcalib => parse_pyocamcalib(text, path),
    }
}

impl CameraFile {
    /// A camera from a file's numbers, with the oddities that any format can have.
    fn new(
        format: CameraFormat,
        model: Model,
        [width_px, height_px]: [usize; 2],
        field_limit_deg: Option<f64>,
    ) -> std::result::Result<Self, CameraError> {
        let camera = Camera::new(model, width_px, height_px, field_limit_deg.map(f64::to_radians))?;
        let mut file =
            Self { camera, format, oddities: Vec::new(), inverse: None, calibration: None, optics: None };
        file.remark_centre();
        Ok(file)
    }

    fn remark_centre(&mut self) {
        let centre = self.camera.model().centre();
        let (width, height) = (self.camera.width() as f64, self.camera.height() as f64);
        let (du, dv) = (centre.u - 0.5 * (width - 1.0), centre.v - 0.5 * (height - 1.0));
        if (du * du + dv * dv).sqrt() > 0.2 * width.min(height) {
            self.oddities.push(format!(
                "the optical centre, column {:.1} row {:.1}, is far from the middle of the {width}x{height} image",
                centre.u, centre.v
            ));
        }
    }
}

/// What to do about a value that no calibration has.
const RENEW: &str = "correct it there, or export the calibration again";

/// A camera error in a file, with what to do about it.
fn camera_error(path: &Path, error: CameraError) -> Error {
    use CameraError as E;
    let advice = match &error {
        // A whole number of degrees below the turn, where there is one.
        E::NotMonotonic { angle_rad, .. } if angle_rad.to_degrees() > 1.0 => {
            let limit_deg = angle_rad.to_degrees().next_down().floor();
            return Error::new(path, error).advise(format!(
                "if the lens was calibrated no farther, restrict the field with field_limit_deg = {limit_deg} or less (in \
                 OCamCalib text behind a #); else correct the coefficients, or export the calibration again"
            ));
        }
        E::NotMonotonic { .. } => "check the order and the signs of the coefficients",
        E::Size { .. } => "give the size of the images that the camera was calibrated with",
        E::FocalLength { .. } => "give focal lengths in pixels, as the calibration has them",
        E::Coefficients { .. } => "give the direct polynomial in ascending powers, mostly 5 coefficients",
        E::LooksBack { .. } => {
            "check that the coefficients stand in ascending powers; where z points forward, change all their signs"
        }
        E::Singular { .. } => "for square pixels it is the identity: c d e = 1 0 0",
        E::CovarianceSize { .. } | E::NoCovariance => "calibrate again, or remove the table [calibration]",
        E::FieldLimit { .. } => {
            "give the angle off the axis out to which the lens was calibrated, or leave it out"
        }
        _ => RENEW,
    };
    Error::new(path, error).advise(advice)
}

#[cfg(test)]
mod tests_of_optics {
    use photinus::camera::{Ideal, IdealLaw, Pixel};

    use super::*;

    pub(super) fn bare_camera() -> Camera {
        let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(375.5, 239.5)).unwrap();
        Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
    }

    pub(super) fn round_trip(camera: &Camera, summary: &OpticsSummary) -> CameraFile {
        let (mut bytes, path) = (Vec::new(), Path::new("out.toml"));
        write_calibrated_camera_toml(camera, None, Some(summary), &mut bytes, path).unwrap();
        parse_camera(&bytes, path).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// One small file of each format.
    const FILES: [&str; 6] = [
        "5 -259.5 0 1.6e-3 -2.3e-6 6.6e-9\n3 388.5 220.9 -10.1\n229.5 364.4\n1 0 0\n480 752\n",
        "model = \"pinhole\"\nwidth_px = 640\nheight_px = 480\ncentre_px = [320, 240]\nfocal_px = [500, 500]\n\
         radial = [-0.1, 0, 0, 0, 0, 0]\ntangential = [0, 0]\n",
        "calibration_model: equisolid\nintrinsics: [250, 250, 320, 240]\nimage_width: 640\nimage_height: 480\n",
        "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n  distortion_coeffs: [0.01, 0, 0, 0]\n  \
         intrinsics: [300, 300, 320, 240]\n  resolution: [640, 480]\n",
        "image_width: 640\nimage_height: 480\ncamera_matrix: {data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n\
         distortion_model: plumb_bob\ndistortion_coefficients: {data: [-0.1, 0, 0, 0, 0]}\n",
        "{\"taylor_coefficient\": [259.5, 0, -1.6e-3], \"distortion_center\": [364.4, 229.5],\n\
         \"stretch_matrix\": [[1, 0], [0, 1]], \"image_size\": [480, 752]}\n",
    ];

    #[test]
    fn each_format_is_read_whatever_its_line_ends_and_mark() {
        let formats = [
            CameraFormat::OcamText,
            CameraFormat::Toml,
            CameraFormat::UvdarYaml,
            CameraFormat::Kalibr,
            CameraFormat::CameraInfo,
            CameraFormat::Pyocamcalib,
        ];
        for (text, format) in FILES.iter().zip(formats) {
            let file =
                parse_camera(text.as_bytes(), Path::new("x")).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(file.format, format);
            let windows = format!("\u{feff}{}", text.replace('\n', "\r\n"));
            assert_eq!(parse_camera(windows.as_bytes(), Path::new("x")).unwrap().camera, file.camera);
        }
    }

    #[test]
    fn a_field_limit_is_taken_from_every_format() {
        for (text, limit) in FILES.iter().zip([
            "# field_limit_deg = 20\n",
            "field_limit_deg = 20\n",
            "field_limit_deg: 20\n",
            "  field_limit_deg: 20\n",
            "field_limit_deg: 20\n",
            "",
        ]) {
            let text =
                format!("{text}{limit}").replace("\"image_size\"", "\"field_limit_deg\": 20, \"image_size\"");
            let camera = parse_camera(text.as_bytes(), Path::new("x")).unwrap().camera;
            assert!((camera.field_limit_rad().to_degrees() - 20.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn a_file_that_is_not_there_says_so() {
        let error = read_camera(Path::new("no/such/camera.txt")).unwrap_err().to_string();
        assert!(error.starts_with("no/such/camera.txt: "), "{error}");
        assert!(error.ends_with("; check the path, which is taken from the current folder"), "{error}");
    }

    proptest! {
        #[test]
        fn no_text_panics(
            which in 0..FILES.len(),
            at in any::<prop::sample::Index>(),
            cut in 0..12_usize,
            put in prop_oneof!["nan", "1e400", "-1e300", "99999999999999999999", "\\PC{0,6}", "[\\[{]{0,40}", "0", "&a *a"],
        ) {
            let text: Vec<char> = FILES[which].chars().collect();
            let from = at.index(text.len());
            let to = (from + cut).min(text.len());
            let changed: String = text[..from].iter().copied().chain(put.chars()).chain(text[to..].iter().copied()).collect();
            if let Err(error) = parse_camera(changed.as_bytes(), Path::new("x")) {
                prop_assert!(error.to_string().starts_with('x') && !error.advice.is_empty(), "{}", error);
            }
        }

        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            if let Err(error) = parse_camera(&bytes, Path::new("x")) {
                prop_assert!(!error.advice.is_empty(), "{}", error);
            }
        }
    }
}
