//! Sights with identities -> a first guess of places and headings, vehicle by vehicle from one that is known.

use nalgebra::Vector3;

use super::group::{Edge, Pose, azimuth_rad};

/// Poses of `vehicles`, the first at the origin; `None` for those that no chain of sights reaches.
pub(super) fn chain(vehicles: usize, edges: &[Edge]) -> Vec<Option<Pose>> {
    let mut poses = vec![None; vehicles];
    poses[0] = Some(Pose { place: Vector3::zeros(), heading_rad: 0.0 });
    while let Some((vehicle, pose)) = (1..vehicles)
        .filter(|vehicle| poses[*vehicle].is_none())
        .find_map(|vehicle| Some((vehicle, next(vehicle, &poses, edges)?)))
    {
        poses[vehicle] = Some(pose);
    }
    poses
}

/// The pose of a vehicle that those whose poses are known determine.
fn next(vehicle: usize, poses: &[Option<Pose>], edges: &[Edge]) -> Option<Pose> {
    let known = |other: usize| poses[other];
    // The places that it sees around itself, with where they are.
    let mut sees =
        edges.iter().filter(|e| e.from == vehicle).filter_map(|e| Some((e.offset_m, known(e.to)?.place)));
    let first = sees.next()?;
    let seen_by = edges.iter().filter(|e| e.to == vehicle).find_map(|e| Some((e, known(e.from)?)));
    if let Some((edge, by)) = seen_by {
        let place = by.place + by.turn(&edge.offset_m);
        return Some(Pose { place, heading_rad: azimuth_rad(&(first.1 - place)) - azimuth_rad(&first.0) });
    }
    // Seen by nobody, it sees two: the line between them tells how it is turned.
    let second = sees.next()?;
    let heading_rad = azimuth_rad(&(second.1 - first.1)) - azimuth_rad(&(second.0 - first.0));
    let turned = Pose { place: Vector3::zeros(), heading_rad };
    Some(Pose { place: first.1 - turned.turn(&first.0), ..turned })
}
