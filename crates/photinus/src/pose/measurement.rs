//! What the spots of one frame say about a pose, and nothing but them: for a caller that carries a belief of its own from frame to frame.
//!
//! In: an assignment of spots to markers. Out: the cost of a pose with its derivatives, as in [`super::cost`] but without the priors on attitude and
//! distance, which a caller must not count again in every frame; and what it costs that the other markers are not seen.

use super::known::Known;
use super::observation::{Observation, Whitened};
use super::problem::{Merging, Normal, Pose, Problem};
use super::settings::Settings;
use crate::airframe::Airframe;

/// The spots of a frame under one assignment to the markers of an airframe.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measurement<'a> {
    problem: Problem<'a>,
    told: &'a Settings,
}

/// What a measurement is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<'a> {
    pub(crate) airframe: &'a Airframe,
    /// Priors as they are told.
    pub(crate) settings: &'a Settings,
    /// The same with what errs alike from frame to frame as wide as one frame may count it.
    pub(crate) per_frame: &'a Settings,
    pub(crate) observations: &'a [Observation],
    pub(crate) whitened: &'a [Whitened],
    /// In so many frames what errs alike from frame to frame is the same.
    pub(crate) repeats: f64,
    pub(crate) known: &'a Known<'a>,
}

impl<'a> Measurement<'a> {
    /// `markers` has the marker of every observation, `None` for clutter; `near` is where poses are asked for.
    pub(crate) fn new(seen: &Seen<'a>, markers: &'a [Option<u16>], near: &Pose) -> Self {
        let Seen { airframe, settings, per_frame, observations, whitened, repeats, known } = *seen;
        let problem = Problem {
            airframe,
            settings: per_frame,
            observations,
            whitened,
            markers,
            known,
            merging: Merging::Near,
            repeats,
        };
        Self { problem: Problem { merging: problem.merging_near(near), ..problem }, told: settings }
    }

    /// Cost and normal equations of a pose.
    pub(crate) fn at(&self, pose: &Pose) -> Normal {
        let mut normal = self.problem.normal_of_spots(pose);
        normal.finish();
        normal
    }

    /// What it costs, nats, that these markers are seen and the others are not. `tell` is told of each marker that is looked for how likely it was not to be
    /// seen, `None` where it is.
    pub(crate) fn visibility(
        &self,
        pose: &Pose,
        log_power: Option<f64>,
        tell: impl FnMut(usize, Option<f64>),
    ) -> f64 {
        Problem { settings: self.told, ..self.problem }.visibility(pose, log_power, tell)
    }
}
