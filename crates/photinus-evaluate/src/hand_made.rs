//! Truth and results made by hand, for tests.

use photinus_io::dataset::{TruthFrame, TruthLed, TruthNeighbour};
use photinus_io::results::{
    DEFAULT_SIGMA_PX, Distance, FrameRecord, NeighbourRecord, RejectedRecord, SpotRecord, TrackRecord,
};

/// A neighbour of truth with no LED in view.
pub(crate) fn there(id: u32, position_m: [f64; 3]) -> TruthNeighbour {
    let distance_m = nalgebra::Vector3::from(position_m).norm();
    TruthNeighbour {
        id,
        position_m,
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        distance_m,
        velocity_m_s: None,
        leds: vec![],
    }
}

/// A neighbour of truth with LEDs at these pixels.
pub(crate) fn shining(id: u32, position_m: [f64; 3], leds_px: &[[f64; 2]]) -> TruthNeighbour {
    let led = |&[u_px, v_px]: &[f64; 2]| TruthLed { u_px, v_px, led: None };
    TruthNeighbour { leds: leds_px.iter().map(led).collect(), ..there(id, position_m) }
}

/// A neighbour reported just there, with bounds of a tenth around and a variance of 0.01 m^2.
pub(crate) fn found_at(position_m: [f64; 3]) -> NeighbourRecord {
    let position = nalgebra::Vector3::from(position_m);
    let distance_m = position.norm();
    NeighbourRecord {
        track: None,
        id: None,
        id_probability: None,
        velocity_m_s: None,
        velocity_covariance_m2_s2: None,
        airframe: "hexarotor".to_owned(),
        spots: vec![],
        bearing: (position / distance_m).into(),
        distance_m: Distance {
            estimate: Some(distance_m),
            sigma: Some(0.1),
            min: 0.9 * distance_m,
            max: Some(1.1 * distance_m),
            perpendicular: None,
            inline: None,
        },
        position_m: Some(position_m),
        position_covariance_m2: Some([[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]]),
        position_body_m: None,
        position_body_covariance_m2: None,
        orientation_xyzw: None,
        orientation_covariance_rad2: None,
        position_orientation_covariance_m_rad: None,
        probability: None,
        misfit: None,
        airframe_probability: None,
        runner_up: None,
        modes: vec![],
    }
}

/// A track just there that a spot shows, at rest, with variances of 0.01.
pub(crate) fn track(track: u64, position_m: [f64; 3]) -> TrackRecord {
    let covariance = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]];
    TrackRecord {
        track,
        airframe: "hexarotor".to_owned(),
        probability: 1.0,
        id: None,
        id_probability: None,
        ids: vec![],
        predicted: false,
        spots: vec![],
        position_m,
        position_covariance_m2: covariance,
        position_body_m: None,
        position_body_covariance_m2: None,
        velocity_m_s: [0.0; 3],
        velocity_covariance_m2_s2: covariance,
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        orientation_covariance_rad2: covariance,
        position_orientation_covariance_m_rad: None,
    }
}

/// A spot that covers this many pixels.
pub(crate) fn spot(u_px: f64, v_px: f64, area_px: u32) -> SpotRecord {
    let variance_px2 = DEFAULT_SIGMA_PX * DEFAULT_SIGMA_PX;
    SpotRecord {
        extent_px: None,
        u_px,
        v_px,
        area_px,
        peak: 255,
        saturated_px: 0,
        flux: 500.0,
        light: None,
        sigma_px: DEFAULT_SIGMA_PX,
        covariance_px2: [[variance_px2, 0.0], [0.0, variance_px2]],
        middle_px: [u_px.round() as u32, v_px.round() as u32],
        background: 0.0,
        probability: 0.5,
        marker_log_odds: 0.0,
        bearing: None,
        bound_rad: None,
        range_m: None,
        signal: None,
    }
}

/// Something rejected.
pub(crate) fn rejected(u_px: f64, v_px: f64, reason: &str) -> RejectedRecord {
    RejectedRecord { u_px, v_px, area_px: 4, reason: reason.to_owned() }
}

/// Truth of a frame at 10 frames/s.
pub(crate) fn truth(frame: u64, neighbours: Vec<TruthNeighbour>) -> TruthFrame {
    TruthFrame { frame, time_s: frame as f64 / 10.0, neighbours, ..TruthFrame::default() }
}

/// A record of a frame at 10 frames/s.
pub(crate) fn record(frame: u64, spots: Vec<SpotRecord>, neighbours: Vec<NeighbourRecord>) -> FrameRecord {
    FrameRecord {
        frame: Some(frame),
        camera: None,
        time_s: Some(frame as f64 / 10.0),
        latency_s: None,
        tracks: Vec::new(),
        source: String::new(),
        incomplete: false,
        spots,
        rejected: vec![],
        neighbours,
    }
}
