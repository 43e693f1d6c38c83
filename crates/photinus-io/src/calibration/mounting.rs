//! How a camera sits on its vehicle, with its uncertainty: a TOML file.

use std::path::Path;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use photinus::camera::Mounting;
use serde::{Deserialize, Serialize};

use crate::kind::Kind;
use crate::{Error, Place, Result, table, whole};

/// How a camera sits on its vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountingFile {
    /// The rotation body_from_camera.
    pub body_from_camera: UnitQuaternion<f64>,
    /// Covariance of that rotation as a small turn about the body's axes, rad^2.
    pub rotation_covariance_rad2: Matrix3<f64>,
    /// The camera's centre in the body frame, m, where it is known.
    pub position_m: Option<Vector3<f64>>,
    /// Covariance of that position, m^2, where it is known.
    pub position_covariance_m2: Option<Matrix3<f64>>,
}

impl From<MountingFile> for Mounting {
    /// A place that nobody measured is the body's origin.
    fn from(file: MountingFile) -> Self {
        Self {
            body_from_camera: file.body_from_camera.to_rotation_matrix(),
            rotation_covariance_rad2: file.rotation_covariance_rad2,
            position_m: file.position_m.unwrap_or_default(),
            position_covariance_m2: file.position_covariance_m2.unwrap_or_default(),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    body_from_camera_xyzw: [f64; 4],
    rotation_covariance_rad2: [[f64; 3]; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    position_m: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_covariance_m2: Option<[[f64; 3]; 3]>,
}

/// Reads a mounting.
///
/// # Errors
/// As [`parse_mounting`], and when the file cannot be read.
pub fn read_mounting(path: impl AsRef<Path>) -> Result<MountingFile> {
    parse_mounting(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of a mounting; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line or the key for unknown and missing keys, for numbers that are not finite, for a quaternion whose
/// length is more than 1 % from 1, and for a matrix that is not a covariance.
pub fn parse_mounting(text: &str, path: impl AsRef<Path>) -> Result<MountingFile> {
    let path = path.as_ref();
    let known = "`photinus calibrate mounting` writes one; docs/file-formats.md has an example";
    Kind::of_content(text.as_bytes()).expect(Kind::Mounting, path, known)?;
    let table: Table = table::parse(text, path)?;
    let refuse = |key: &str, reason: &str, advice: &str| {
        Err(Error::format(path, reason).at(Place::Key(key.to_owned())).advise(advice))
    };
    let [x, y, z, w] = table.body_from_camera_xyzw;
    let quaternion = Quaternion::new(w, x, y, z);
    // false for NaN, too
    let is_turn = (quaternion.norm() - 1.0).abs() < 0.01;
    if !is_turn {
        return refuse("body_from_camera_xyzw", "this is no unit quaternion", "give x, y, z, w of length 1");
    }
    let covariances = [
        ("rotation_covariance_rad2", Some(table.rotation_covariance_rad2)),
        ("position_covariance_m2", table.position_covariance_m2),
    ];
    for (key, rows) in covariances {
        let is_covariance = rows.is_none_or(|rows| is_covariance(&matrix(rows)));
        if !is_covariance {
            return refuse(
                key,
                "this is no covariance",
                "give a symmetric matrix without negative variances",
            );
        }
    }
    if table.position_m.is_some_and(|position_m| !position_m.iter().all(|number| number.is_finite())) {
        return refuse("position_m", "a coordinate is not finite", "give metres, or leave it out");
    }
    // What is a unit quaternion to the last digits stays as it is written.
    let is_unit = (quaternion.norm() - 1.0).abs() < 1e-12;
    Ok(MountingFile {
        body_from_camera: match is_unit {
            true => UnitQuaternion::new_unchecked(quaternion),
            false => UnitQuaternion::new_normalize(quaternion),
        },
        rotation_covariance_rad2: matrix(table.rotation_covariance_rad2),
        position_m: table.position_m.map(Vector3::from),
        position_covariance_m2: table.position_covariance_m2.map(matrix),
    })
}

/// A mounting as the text of a file; it is read back bit for bit.
pub fn mounting_text(mounting: &MountingFile) -> String {
    let rotation = &mounting.body_from_camera;
    let table = Table {
        body_from_camera_xyzw: [rotation.i, rotation.j, rotation.k, rotation.w],
        rotation_covariance_rad2: rows(&mounting.rotation_covariance_rad2),
        position_m: mounting.position_m.map(Into::into),
        position_covariance_m2: mounting.position_covariance_m2.as_ref().map(rows),
    };
    toml::to_string(&table).expect("numbers are TOML")
}

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

fn is_covariance(matrix: &Matrix3<f64>) -> bool {
    let scale = matrix.amax();
    let is_symmetric = (matrix - matrix.transpose()).amax() <= 1e-9 * scale;
    // the largest entry and a comparison pass over NaN: every entry is looked at
    let is_finite = matrix.iter().all(|entry| entry.is_finite());
    is_finite && is_symmetric && (0..3).all(|axis| matrix[(axis, axis)] >= 0.0)
}
