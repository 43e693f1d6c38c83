//! Truth of a flight from two logs of poses: poses of the observer and its target, and results, enter; truth in the camera frame
//! leaves, with what had to be estimated for it and its standard errors.
//!
//! The logs share one world frame, and one clock, as those of GNSS receivers or of a motion capture do; those of two flight
//! controllers have clocks of their own. What nobody measures to the centimetre is estimated from the results themselves: how far the
//! clocks are from each other, how the camera sits on the observer, and where the target's airframe has its origin. These ten or eleven
//! numbers are the only way in which results enter their own truth: an error that is the same in all frames of a flight hides in them,
//! what changes does not.

mod fit;
mod start;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use photinus_io::dataset::{TimedPose, TruthFrame, TruthNeighbour};
use photinus_io::results::{FrameRecord, NeighbourRecord};

/// The fewest frames that an alignment is estimated from.
pub const FEWEST_FRAMES: usize = 30;
/// Clock offsets are looked for this far around the expected ones, s.
const SEARCH_S: f64 = 2.0;

/// How the clocks, the camera and the target's airframe fit the logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Added to the time of a frame it gives the time of the observer's log, s.
    pub clock_offset_s: f64,
    /// Added to a time of the observer's log it gives that of the target's, s; 0 where they share a clock.
    pub target_clock_offset_s: f64,
    /// The rotation body_from_camera of the observer.
    pub body_from_camera: UnitQuaternion<f64>,
    /// The camera's centre in the observer's body frame, m.
    pub camera_m: Vector3<f64>,
    /// The origin of the target's airframe in the body frame of its log, m.
    pub airframe_m: Vector3<f64>,
    /// Standard errors of all of it.
    pub sigma: AlignmentSigma,
    /// Frames that it rests on.
    pub frames: usize,
}

/// Standard errors of an [`Alignment`]. Errors of results that last for a thirtieth of the flight, or a second, are allowed for; those that
/// last longer are not told from what is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignmentSigma {
    /// Of the clock offset, s.
    pub clock_offset_s: f64,
    /// Of the target's clock offset, s; 0 where the logs share a clock.
    pub target_clock_offset_s: f64,
    /// Of the rotation, as a small turn about the camera's axes, rad.
    pub rotation_rad: Vector3<f64>,
    /// Of the camera's centre, m.
    pub camera_m: Vector3<f64>,
    /// Of the airframe's origin, m.
    pub airframe_m: Vector3<f64>,
}

/// Why two logs give no truth for results.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AlignError {
    /// The times have nothing in common.
    #[error(
        "the logs have {:.3} to {:.3} s in common, the frames {:.3} to {:.3} s", logs_s.0, logs_s.1, frames_s.0, frames_s.1
    )]
    Times {
        /// First and last time of both logs, s.
        logs_s: (f64, f64),
        /// First and last time of the frames, s.
        frames_s: (f64, f64),
    },
    /// Too few frames.
    #[error(
        "{0} frames have a time within both logs and a neighbour with a position, {FEWEST_FRAMES} are needed"
    )]
    Few(usize),
    /// The best offsets are not among those that were looked for.
    #[error("no clock offsets within {SEARCH_S} s of the expected ones fit the results")]
    Clocks,
    /// The vehicles hardly move, so that other offsets fit as well.
    #[error("the vehicles move too little to tell how far the clocks are apart")]
    Still,
    /// No clock offset and no turn of the camera make sense of the bearings.
    #[error("no turn of the camera brings the neighbours of the results to where the logs have the target")]
    NoTurn,
}

/// What the clocks of two logs have to do with each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TargetClock {
    /// Both logs tell the same time.
    Shared,
    /// The target's log has a clock of its own.
    Own {
        /// About how much to add to a time of the observer's log to get that of the target's, s.
        near_s: f64,
    },
}

impl TargetClock {
    /// What is known of the offset beforehand, s.
    fn near_s(self) -> f64 {
        match self {
            Self::Shared => 0.0,
            Self::Own { near_s } => near_s,
        }
    }
}

/// Two logs in one world frame.
#[derive(Clone, Copy, Debug)]
pub struct Logs<'a> {
    /// Of the vehicle that carries the camera.
    pub observer: &'a [TimedPose],
    /// Of the vehicle that is seen.
    pub target: &'a [TimedPose],
    /// The clock of the target's log, beside that of the observer's.
    pub target_clock: TargetClock,
}

impl Logs<'_> {
    /// Estimates how the logs fit results; clock offsets are looked for within two seconds of `near_s` and of what `target_clock` says.
    ///
    /// # Errors
    /// [`AlignError`] when too little is in common.
    pub fn align(&self, results: &[FrameRecord], near_s: f64) -> Result<Alignment, AlignError> {
        let seen: Vec<Seen> = results.iter().filter_map(Seen::of).collect();
        let common = self.common_s();
        let within = |seen: &&Seen| (common.0..=common.1).contains(&(seen.time_s + near_s));
        match seen.iter().filter(within).count() {
            0 => {
                let frames_s = span_s(results.iter().filter_map(|record| record.time_s));
                Err(AlignError::Times { logs_s: common, frames_s })
            }
            few if few < FEWEST_FRAMES => Err(AlignError::Few(few)),
            _ => {
                let start = start::from_bearings(self, &seen, near_s).ok_or(AlignError::NoTurn)?;
                let found = fit::refined(self, &seen, start)?;
                self.check_clocks(&found, near_s).map(|()| found)
            }
        }
    }

    fn check_clocks(&self, found: &Alignment, near_s: f64) -> Result<(), AlignError> {
        let sigma = &found.sigma;
        let clocks = [
            (found.clock_offset_s - near_s, sigma.clock_offset_s),
            (found.target_clock_offset_s - self.target_clock.near_s(), sigma.target_clock_offset_s),
        ];
        // Where nothing tells an offset its variance is huge, or rounding makes it negative.
        if clocks.iter().any(|clock| clock.1.is_nan() || clock.1 > SEARCH_S) {
            return Err(AlignError::Still);
        }
        match clocks.iter().any(|clock| clock.0.abs() > SEARCH_S) {
            true => Err(AlignError::Clocks),
            false => Ok(()),
        }
    }

    /// Truth of every result whose time lies within both logs.
    pub fn truth(&self, alignment: &Alignment, results: &[FrameRecord]) -> Vec<TruthFrame> {
        let camera_from_body =
            Isometry3::from_parts(Translation3::from(alignment.camera_m), alignment.body_from_camera)
                .inverse();
        let frame = |(record, index): (&FrameRecord, u64)| {
            let time_s = record.time_s?;
            let [observer, target] =
                self.at(time_s + alignment.clock_offset_s, alignment.target_clock_offset_s)?;
            let airframe = target * Translation3::from(alignment.airframe_m);
            let seen = camera_from_body * observer.inv_mul(&airframe);
            let position_m = seen.translation.vector;
            let neighbour = TruthNeighbour {
                id: 0,
                position_m: position_m.into(),
                orientation_xyzw: seen.rotation.coords.into(),
                distance_m: position_m.norm(),
                velocity_m_s: None,
                leds: Vec::new(),
            };
            let (frame, camera) = (record.frame.unwrap_or(index), record.camera.clone());
            Some(TruthFrame { frame, camera, time_s, true_time_s: None, neighbours: vec![neighbour] })
        };
        results.iter().zip(0..).filter_map(frame).collect()
    }

    /// First and last time of both, by the observer's clock.
    fn common_s(&self) -> (f64, f64) {
        let [observer, target] =
            [self.observer, self.target].map(|log| span_s(log.iter().map(|row| row.time_s)));
        let later_s = self.target_clock.near_s();
        (observer.0.max(target.0 - later_s), observer.1.min(target.1 - later_s))
    }

    /// The poses of both at a time of the observer's log; nothing outside of them.
    fn at(&self, time_s: f64, target_clock_offset_s: f64) -> Option<[Isometry3<f64>; 2]> {
        Some([between(self.observer, time_s)?, between(self.target, time_s + target_clock_offset_s)?])
    }
}

/// A neighbour of a result, as an alignment needs it.
struct Seen {
    time_s: f64,
    /// Position in the camera frame, m, and its covariance, m^2, the likeliest neighbour of the frame first.
    neighbours: Vec<(Vector3<f64>, Matrix3<f64>)>,
}

impl Seen {
    fn of(record: &FrameRecord) -> Option<Self> {
        let mut likely: Vec<&NeighbourRecord> = record.neighbours.iter().collect();
        let doubt = |neighbour: &NeighbourRecord| 1.0 - neighbour.probability.unwrap_or(1.0);
        likely.sort_by(|a, b| doubt(a).total_cmp(&doubt(b)));
        let place = |neighbour: &NeighbourRecord| {
            let covariance = Matrix3::from(neighbour.position_covariance_m2?);
            Some((Vector3::from(neighbour.position_m?), covariance))
        };
        let neighbours: Vec<_> = likely.into_iter().filter_map(place).collect();
        if neighbours.is_empty() { None } else { Some(Self { time_s: record.time_s?, neighbours }) }
    }
}

fn span_s(times_s: impl Iterator<Item = f64>) -> (f64, f64) {
    times_s.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), time_s| (from.min(time_s), to.max(time_s)))
}

/// The pose of a log at a time, between its rows.
fn between(log: &[TimedPose], time_s: f64) -> Option<Isometry3<f64>> {
    let after = log.partition_point(|row| row.time_s < time_s);
    let to = log.get(after)?;
    let Some(from) = after.checked_sub(1).and_then(|before| log.get(before)) else {
        return (to.time_s <= time_s).then_some(to.pose);
    };
    let share = (time_s - from.time_s) / (to.time_s - from.time_s);
    let place = from.pose.translation.vector.lerp(&to.pose.translation.vector, share);
    // Between rows of a log a vehicle turns little: the chord is the arc.
    Some(Isometry3::from_parts(place.into(), from.pose.rotation.nlerp(&to.pose.rotation, share)))
}
