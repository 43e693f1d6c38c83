//! photinus_msgs/NeighbourArray: everything that the results tell of neighbours and tracks.

use nalgebra::Vector3 as V;
use photinus_io::results::{FrameRecord, NeighbourRecord, TrackRecord};

use super::Viewpoint;
use super::covariance::{bearing_covariance, bounded_covariance, pose_covariance};
use super::detections::of_mode;
use crate::ros::{
    Header, Matrix3, Neighbour, NeighbourArray, Point, Pose, PoseMode, PoseWithCovariance, Quaternion,
};

/// What nobody knows.
const UNKNOWN: f64 = f64::NAN;

/// Who was measured in this frame.
pub(super) fn measured(record: &FrameRecord, view: &Viewpoint, header: &Header) -> NeighbourArray {
    let neighbours = record.neighbours.iter().map(|neighbour| of_neighbour(neighbour, record)).collect();
    array(record, view, header, neighbours)
}

/// Who is followed.
pub(super) fn followed(record: &FrameRecord, view: &Viewpoint, header: &Header) -> NeighbourArray {
    array(record, view, header, record.tracks.iter().map(|track| of_track(track, record)).collect())
}

fn array(
    record: &FrameRecord,
    view: &Viewpoint,
    header: &Header,
    neighbours: Vec<Neighbour>,
) -> NeighbourArray {
    NeighbourArray {
        header: header.clone(),
        camera: view.camera.clone(),
        frame: record.frame.unwrap_or_default(),
        latency: record.latency_s.unwrap_or(UNKNOWN),
        incomplete: record.incomplete,
        neighbours,
    }
}

fn of_neighbour(neighbour: &NeighbourRecord, record: &FrameRecord) -> Neighbour {
    let attitude = neighbour.orientation_xyzw.zip(neighbour.orientation_covariance_rad2.as_ref());
    let placed = neighbour.position_m.zip(neighbour.position_covariance_m2.as_ref());
    let pose = placed.map_or_else(unknown_pose, |(position_m, covariance_m2)| PoseWithCovariance {
        pose: Pose {
            position: position_m.into(),
            orientation: neighbour.orientation_xyzw.map_or_else(Quaternion::default, Quaternion::from),
        },
        covariance: pose_covariance(
            covariance_m2,
            attitude,
            neighbour.position_orientation_covariance_m_rad.as_ref(),
        ),
    });
    let bearing_covariance = match placed {
        Some((position_m, covariance_m2)) => bearing_covariance(position_m, covariance_m2),
        None => bounded_covariance(neighbour.bearing, bound_rad(neighbour, record)),
    };
    let misfit = neighbour.misfit;
    Neighbour {
        id: neighbour.id.map(|id| id.to_string()).unwrap_or_default(),
        id_probability: neighbour.id_probability.unwrap_or(UNKNOWN),
        track: neighbour.track.unwrap_or(0),
        airframe: neighbour.airframe.clone(),
        probability: neighbour.probability.unwrap_or(UNKNOWN),
        predicted: false,
        bearing: neighbour.bearing.into(),
        bearing_covariance,
        distance: neighbour.distance_m.estimate.unwrap_or(UNKNOWN),
        distance_sigma: neighbour.distance_m.sigma.unwrap_or(UNKNOWN),
        distance_min: neighbour.distance_m.min,
        distance_max: neighbour.distance_m.max.unwrap_or(f64::INFINITY),
        pose,
        velocity: neighbour.velocity_m_s.unwrap_or([UNKNOWN; 3]).into(),
        velocity_covariance: neighbour.velocity_covariance_m2_s2.unwrap_or([[UNKNOWN; 3]; 3]),
        misfit_chi2: misfit.map_or(UNKNOWN, |misfit| misfit.chi2),
        misfit_dof: misfit.map_or(0, |misfit| misfit.dof),
        misfit_p: misfit.map_or(UNKNOWN, |misfit| misfit.p),
        modes: neighbour
            .modes
            .iter()
            .map(|mode| PoseMode { weight: mode.weight, pose: of_mode(mode) })
            .collect(),
    }
}

/// A track is told by what follows it; bounds are those of its neighbour in this frame, where it was measured.
fn of_track(track: &TrackRecord, record: &FrameRecord) -> Neighbour {
    let position = V::from(track.position_m);
    let away_m = position.norm();
    let ahead = position.try_normalize(0.0).unwrap_or_default();
    let covariance: &Matrix3 = &track.position_covariance_m2;
    let along = nalgebra::Matrix3::from_fn(|row, column| covariance[row][column]);
    let measured = record.neighbours.iter().find(|neighbour| neighbour.track == Some(track.track));
    Neighbour {
        id: track.id.map(|id| id.to_string()).unwrap_or_default(),
        id_probability: track.id_probability.unwrap_or(UNKNOWN),
        track: track.track,
        airframe: track.airframe.clone(),
        probability: track.probability,
        predicted: track.predicted,
        bearing: ahead.into(),
        bearing_covariance: bearing_covariance(track.position_m, covariance),
        distance: away_m,
        distance_sigma: ahead.dot(&(along * ahead)).max(0.0).sqrt(),
        distance_min: measured.map_or(0.0, |neighbour| neighbour.distance_m.min),
        distance_max: measured.and_then(|neighbour| neighbour.distance_m.max).unwrap_or(f64::INFINITY),
        pose: PoseWithCovariance {
            pose: Pose { position: track.position_m.into(), orientation: track.orientation_xyzw.into() },
            covariance: pose_covariance(
                covariance,
                Some((track.orientation_xyzw, &track.orientation_covariance_rad2)),
                track.position_orientation_covariance_m_rad.as_ref(),
            ),
        },
        velocity: track.velocity_m_s.into(),
        velocity_covariance: track.velocity_covariance_m2_s2,
        misfit_chi2: UNKNOWN,
        misfit_dof: 0,
        misfit_p: UNKNOWN,
        modes: Vec::new(),
    }
}

/// The widest bound of the spots that a neighbour is seen by.
fn bound_rad(neighbour: &NeighbourRecord, record: &FrameRecord) -> f64 {
    let of_spot = |&spot: &usize| record.spots.get(spot)?.bound_rad;
    neighbour.spots.iter().filter_map(of_spot).fold(0.0, f64::max)
}

fn unknown_pose() -> PoseWithCovariance {
    PoseWithCovariance {
        pose: Pose { position: Point::from([UNKNOWN; 3]), orientation: Quaternion::from([UNKNOWN; 4]) },
        covariance: [[UNKNOWN; 6]; 6],
    }
}
