//! visualization_msgs/MarkerArray: the ellipsoid of each neighbour, the line between its bounds, and what it is called.

use nalgebra::{Matrix3 as M3, Rotation3, UnitQuaternion, Vector3 as V};
use photinus_io::results::FrameRecord;

use super::Viewpoint;
use super::name;
use crate::ros::{ColorRGBA, Header, Marker, MarkerArray, Matrix3, Point, Pose, Quaternion, Shape, Vector3};

/// An ellipsoid of this many sigma holds truth in 95 of 100 cases: the root of the quantile of chi square with three degrees of freedom.
const SIGMAS: f64 = 2.795_483_482_915_108;
/// A line without an upper bound is drawn this many times as far as its lower one, at least.
const BEYOND: f64 = 2.0;
const MEASURED: ColorRGBA = ColorRGBA { r: 0.3, g: 0.6, b: 1.0, a: 0.6 };
const PREDICTED: ColorRGBA = ColorRGBA { r: 0.6, g: 0.6, b: 0.6, a: 0.4 };
const LETTER_M: f64 = 0.3;
const LINE_M: f64 = 0.02;

/// Everything of the frame before is taken away first: who is gone does not stay on the screen.
pub(super) fn of(record: &FrameRecord, view: &Viewpoint, header: &Header) -> MarkerArray {
    let namespace = |what: &str| format!("{}/{what}", view.camera);
    let clear = Marker { header: header.clone(), action: Marker::DELETE_ALL, ..Marker::default() };
    let mut markers = vec![clear];
    let mut put = |marker: Marker| {
        // There are never so many.
        let id = i32::try_from(markers.len()).unwrap_or(i32::MAX);
        markers.push(Marker { header: header.clone(), id, ..marker });
    };
    for neighbour in &record.neighbours {
        let distance = &neighbour.distance_m;
        let far_m =
            distance.max.unwrap_or_else(|| BEYOND * distance.min.max(distance.estimate.unwrap_or(0.0)));
        let at = |away_m: f64| Point::from(neighbour.bearing.map(|axis| axis * away_m));
        put(Marker {
            ns: namespace("bounds"),
            shape: Shape::LineList as i32,
            scale: Vector3 { x: LINE_M, ..Vector3::default() },
            color: MEASURED,
            points: vec![at(distance.min), at(far_m)],
            ..Marker::default()
        });
        if let Some((position_m, covariance_m2)) = neighbour.position_m.zip(neighbour.position_covariance_m2)
        {
            put(Marker { ns: namespace("ellipsoids"), ..ellipsoid(position_m, &covariance_m2, MEASURED) });
            let text = name(neighbour.id, neighbour.track);
            put(Marker { ns: namespace("names"), ..letters(position_m, text) });
        }
    }
    for track in record.tracks.iter().filter(|track| track.predicted) {
        let covariance_m2 = &track.position_covariance_m2;
        put(Marker { ns: namespace("ellipsoids"), ..ellipsoid(track.position_m, covariance_m2, PREDICTED) });
        let text = name(track.id, Some(track.track));
        put(Marker { ns: namespace("names"), ..letters(track.position_m, text) });
    }
    MarkerArray { markers }
}

fn ellipsoid(position_m: [f64; 3], covariance_m2: &Matrix3, color: ColorRGBA) -> Marker {
    let axes = M3::from_fn(|row, column| covariance_m2[row][column]).symmetric_eigen();
    let mut turn = axes.eigenvectors;
    if turn.determinant() < 0.0 {
        turn.column_mut(2).neg_mut();
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    let size: V<f64> = axes.eigenvalues.map(|variance| 2.0 * SIGMAS * variance.max(1e-12).sqrt());
    Marker {
        shape: Shape::Sphere as i32,
        pose: Pose { position: position_m.into(), orientation: Quaternion::from(turn) },
        scale: size.into(),
        color,
        ..Marker::default()
    }
}

fn letters(position_m: [f64; 3], text: String) -> Marker {
    let [x, y, z] = position_m;
    Marker {
        shape: Shape::Text as i32,
        // Up is against y in an optical frame.
        pose: Pose { position: [x, y - LETTER_M, z].into(), ..Pose::default() },
        scale: Vector3 { z: LETTER_M, ..Vector3::default() },
        color: ColorRGBA { r: 1.0, g: 1.0, b: 1.0, a: 1.0 },
        text,
        ..Marker::default()
    }
}
