//! Spots as rows.

use crate::results::{FrameRecord, SpotRecord};

use super::{Cell, Kind, count, number, numbers};

const N: Kind = Kind::Number;
const C: Kind = Kind::Count;
const T: Kind = Kind::Text;

#[rustfmt::skip]
pub(in crate::results) const COLUMNS: [(&str, Kind); 25] = [
    ("frame", C), ("time_s", N), ("source", T), ("camera", T), ("spot", C), ("u_px", N), ("v_px", N), ("area_px", C),
    ("peak", C), ("saturated_px", C), ("flux", N), ("sigma_px", N), ("var_uu_px2", N), ("var_uv_px2", N), ("var_vv_px2", N),
    ("background", N), ("probability", N), ("marker_log_odds", N), ("bearing_x", N), ("bearing_y", N), ("bearing_z", N),
    ("bound_rad", N), ("range_min_m", N), ("range_max_m", N), ("signal", C),
];

/// The spots of a frame.
pub(in crate::results) fn rows(record: &FrameRecord) -> impl Iterator<Item = [Cell<'_>; COLUMNS.len()]> {
    record.spots.iter().enumerate().map(|(index, spot)| row(record, index, spot))
}

#[rustfmt::skip]
fn row<'a>(record: &'a FrameRecord, index: usize, s: &SpotRecord) -> [Cell<'a>; COLUMNS.len()] {
    let [[uu, uv], [_, vv]] = s.covariance_px2.map(|row| row.map(number));
    let [bx, by, bz] = numbers(s.bearing);
    let integer = |value: u32| Cell::Count(Some(value.into()));
    [
        Cell::Count(record.frame), Cell::Number(record.time_s), Cell::Text(Some(&record.source)),
        Cell::Text(record.camera.as_deref()), count(index), number(s.u_px), number(s.v_px), integer(s.area_px),
        integer(s.peak.into()), integer(s.saturated_px), number(s.flux), number(s.sigma_px), uu, uv, vv,
        number(s.background), number(s.probability), number(s.marker_log_odds), bx, by, bz,
        Cell::Number(s.bound_rad), Cell::Number(s.range_m.map(|range| range.0)), Cell::Number(s.range_m.and_then(|range| range.1)),
        Cell::Count(s.signal.map(u64::from)),
    ]
}
