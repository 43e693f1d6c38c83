//! Truth from two logs of poses, and what was estimated for it as a table and as JSON.

use std::collections::BTreeSet;

use photinus_evaluate::alignment::{AlignError, Alignment, Logs, TargetClock};
use photinus_io::Error;
use photinus_io::results::FrameRecord;
use serde::Serialize;

use super::pose_log::PoseLog;
use super::truth::{GroundTruth, tolerance};
use crate::aligned::{Aligned, Side};
use crate::failure::Failure;

/// Truth of the results' frames whose times lie within both logs.
///
/// # Errors
/// [`Failure`] when a log cannot be read, when results come from several cameras, or when the logs do not fit the results.
pub(super) fn truth(
    observer: &PoseLog,
    target: &PoseLog,
    results: &[FrameRecord],
    near_s: f64,
    target_clock: TargetClock,
) -> Result<GroundTruth, Failure> {
    let cameras: BTreeSet<&Option<String>> = results.iter().map(|record| &record.camera).collect();
    if cameras.len() > 1 {
        let told =
            "results of several cameras: with logs, give those of one, as `locate --only NAME` writes them";
        return Err(Failure::Input(told.to_owned()));
    }
    let [observed, followed] = [observer, target].map(|log| log.read().map_err(Failure::input));
    let logs = Logs { observer: &observed?, target: &followed?, target_clock };
    let refuse = |error: AlignError| {
        let advice = match error {
            AlignError::Times { .. } => {
                "give the logs of this flight, or about how far the clocks differ as --clock-offset S, and as \
                 --target-clock-offset S where the target's log has a clock of its own"
            }
            AlignError::Clocks => {
                "give about how far the clocks differ as --clock-offset S and --target-clock-offset S"
            }
            AlignError::Still => {
                "give logs of a flight in which both vehicles move, or, of logs on one clock, leave out --target-clock-offset"
            }
            AlignError::Few(_) => "give results of a longer flight, with positions",
            _ => "check that the logs share one world frame and which vehicle is which",
        };
        Failure::input(Error::format(observer.to_string(), error.to_string()).advise(advice))
    };
    let alignment = logs.align(results, near_s).map_err(refuse)?;
    let frames = logs.truth(&alignment, results);
    let listed = frames.iter().map(|frame| frame.frame).collect();
    Ok(GroundTruth {
        time_tolerance_s: tolerance(&frames, &observer.file).map_err(Failure::input)?,
        frames,
        camera: cameras.first().and_then(|camera| (*camera).clone()),
        files: vec![observer.file.clone(), target.file.clone()],
        path: observer.file.clone(),
        listed: (observer.file.clone(), listed),
        alignment: Some(alignment),
    })
}

/// What was estimated, each with its standard error.
pub(super) fn table(alignment: &Alignment) -> String {
    let sigma = &alignment.sigma;
    let mut table = Aligned::new(2, &[Side::Left, Side::Right, Side::Right]);
    let mut row =
        |name: &str, value: String, error: String| table.row([name.to_owned(), value, format!("+- {error}")]);
    let offset = (alignment.clock_offset_s, sigma.clock_offset_s);
    row("clock offset s", format!("{:.4}", offset.0), format!("{:.4}", offset.1));
    // A clock that both logs share has no offset to be unsure of.
    if sigma.target_clock_offset_s > 0.0 {
        let (offset_s, error_s) = (alignment.target_clock_offset_s, sigma.target_clock_offset_s);
        row("target's clock offset s", format!("{offset_s:.4}"), format!("{error_s:.4}"));
    }
    let places = [
        ("camera on the observer", &alignment.camera_m, &sigma.camera_m),
        ("airframe on the target", &alignment.airframe_m, &sigma.airframe_m),
    ];
    for (name, place, error) in places {
        for (axis, (metres, error)) in ["x", "y", "z"].iter().zip(place.iter().zip(error)) {
            row(&format!("{name}, {axis} m"), format!("{metres:.3}"), format!("{error:.3}"));
        }
    }
    let turn = alignment.body_from_camera.coords.map(|part| format!("{part:.4}"));
    let worst_deg = sigma.rotation_rad.max().to_degrees();
    format!(
        "alignment of the logs, estimated from {} frames\n{table}\n  body_from_camera xyzw  {}  +- {worst_deg:.2} deg\n  \
         what is the same in all frames hides in it and not in the scores\n\n",
        alignment.frames,
        turn.as_slice().join(" ")
    )
}

/// What `--json` says of it.
#[derive(Serialize)]
pub(super) struct AlignmentReport {
    frames: usize,
    clock_offset_s: f64,
    clock_offset_sigma_s: f64,
    target_clock_offset_s: f64,
    target_clock_offset_sigma_s: f64,
    body_from_camera_xyzw: [f64; 4],
    rotation_sigma_rad: [f64; 3],
    camera_m: [f64; 3],
    camera_sigma_m: [f64; 3],
    airframe_m: [f64; 3],
    airframe_sigma_m: [f64; 3],
}

impl AlignmentReport {
    pub(super) fn of(alignment: &Alignment) -> Self {
        let sigma = &alignment.sigma;
        Self {
            frames: alignment.frames,
            clock_offset_s: alignment.clock_offset_s,
            clock_offset_sigma_s: sigma.clock_offset_s,
            target_clock_offset_s: alignment.target_clock_offset_s,
            target_clock_offset_sigma_s: sigma.target_clock_offset_s,
            body_from_camera_xyzw: alignment.body_from_camera.coords.into(),
            rotation_sigma_rad: sigma.rotation_rad.into(),
            camera_m: alignment.camera_m.into(),
            camera_sigma_m: sigma.camera_m.into(),
            airframe_m: alignment.airframe_m.into(),
            airframe_sigma_m: sigma.airframe_m.into(),
        }
    }
}
