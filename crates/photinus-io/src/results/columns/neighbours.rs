//! Neighbours as rows, by the columns of the CSV table of results.

use crate::results::{FrameRecord, NeighbourRecord};

use super::{Cell, Kind, count, number, numbers};

const N: Kind = Kind::Number;
const C: Kind = Kind::Count;
const T: Kind = Kind::Text;

#[rustfmt::skip]
pub(in crate::results) const COLUMNS: [(&str, Kind); 36] = [
    ("frame", C), ("time_s", N), ("source", T), ("track", C), ("id", C), ("airframe", T), ("spots", C),
    ("bearing_x", N), ("bearing_y", N), ("bearing_z", N),
    ("distance_m", N), ("distance_sigma_m", N), ("distance_min_m", N), ("distance_max_m", N),
    ("perpendicular_m", N), ("inline_m", N), ("x_m", N), ("y_m", N), ("z_m", N),
    ("var_xx_m2", N), ("var_xy_m2", N), ("var_xz_m2", N), ("var_yy_m2", N), ("var_yz_m2", N), ("var_zz_m2", N),
    ("qx", N), ("qy", N), ("qz", N), ("qw", N), ("modes", C), ("camera", T),
    ("x_body_m", N), ("y_body_m", N), ("z_body_m", N), ("probability", N), ("misfit_p", N),
];

/// The neighbours of a frame.
pub(in crate::results) fn rows(record: &FrameRecord) -> impl Iterator<Item = [Cell<'_>; COLUMNS.len()]> {
    record.neighbours.iter().map(|neighbour| row(record, neighbour))
}

#[rustfmt::skip]
fn row<'a>(record: &'a FrameRecord, n: &'a NeighbourRecord) -> [Cell<'a>; COLUMNS.len()] {
    let [bx, by, bz] = n.bearing.map(number);
    let [x, y, z] = numbers(n.position_m);
    let [xx, xy, xz, yy, yz, zz] =
        numbers(n.position_covariance_m2.map(|[[xx, xy, xz], [_, yy, yz], [_, _, zz]]| [xx, xy, xz, yy, yz, zz]));
    let [xb, yb, zb] = numbers(n.position_body_m);
    let [qx, qy, qz, qw] = numbers(n.orientation_xyzw);
    let d = &n.distance_m;
    [
        Cell::Count(record.frame), Cell::Number(record.time_s), Cell::Text(Some(&record.source)), Cell::Count(n.track),
        Cell::Count(n.id.map(u64::from)), Cell::Text(Some(&n.airframe)), count(n.spots.len()), bx, by, bz,
        Cell::Number(d.estimate), Cell::Number(d.sigma), number(d.min), Cell::Number(d.max),
        Cell::Number(d.perpendicular), Cell::Number(d.inline), x, y, z, xx, xy, xz, yy, yz, zz, qx, qy, qz, qw,
        count(n.modes.len()), Cell::Text(record.camera.as_deref()), xb, yb, zb,
        Cell::Number(n.probability), Cell::Number(n.misfit.map(|misfit| misfit.p)),
    ]
}
