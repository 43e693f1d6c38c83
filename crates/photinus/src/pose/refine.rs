//! Downhill from a start to the nearest mode: Levenberg-Marquardt, and Gauss-Newton with the yaw held. Damping follows what a step gained of what it
//! promised; K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for Non-Linear Least Squares Problems" (2004), 3.2.

use nalgebra::{Cholesky, U5, Vector5, Vector6};

use super::problem::{Normal, Pose, Problem};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Most steps towards a mode: sharp bearings make the valley of distance against yaw narrow, and the way along it long.
pub(super) const MOST_STEPS: usize = 80;
/// A step that would gain less than this, nats, is the last.
const SMALL_GAIN: f64 = 1e-4;
/// The same for a slice, which is one of many.
const SMALL_SLICE_GAIN: f64 = 1e-2;
/// A step within a slice that gains less than this, nats, leads to where slope and bend say it does: nothing is worked out anew there.
const FORESEEN_GAIN: f64 = 0.1;
/// From one slice to the next the pose changes by no more than so many times the yaw beyond what the first order has, unless it leaves its valley.
const LEAP: f64 = 3.0;
/// Most steps towards the least cost of a slice.
const MOST_SLICE_STEPS: usize = 12;
/// Longest step of the position, in distances, and of the attitude, rad.
const LONGEST: f64 = 0.5;

/// A pose with its cost and normal equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refined {
    pub(super) pose: Pose,
    pub(super) normal: Normal,
}

impl Refined {
    pub(super) fn at(problem: &Problem<'_>, pose: Pose) -> Self {
        Self { pose, normal: problem.normal(&pose) }
    }

    /// A step of all but yaw further, that gains so much, as slope and bend here foresee it.
    fn foreseen(&self, rest: &Vector5<f64>, gain: f64) -> Self {
        let mut normal = self.normal;
        normal.nats -= 0.5 * gain;
        normal.gradient += normal.information.fixed_columns::<5>(0) * rest;
        Self { pose: self.pose.stepped(&rest.push(0.0)), normal }
    }
}

/// The mode downhill from `start`, or as near to it as so many steps come.
pub(super) fn refine(problem: &Problem<'_>, start: Pose, most_steps: usize) -> Refined {
    let mut here = Refined::at(problem, start);
    let (mut damping, mut growth) = (1e-4, 2.0);
    for _ in 0..most_steps {
        let Normal { nats, gradient, mut information, .. } = here.normal;
        for axis in 0..6 {
            information[(axis, axis)] += damping * information[(axis, axis)] + 1e-9;
        }
        let Some(factor) = information.cholesky() else {
            damping = damping.max(1e-6) * 10.0;
            continue;
        };
        let step = shortened(-factor.solve(&gradient));
        let gain = -gradient.dot(&step);
        if gain.is_nan() || gain <= SMALL_GAIN {
            break;
        }
        let there = Refined::at(problem, here.pose.stepped(&step));
        if there.normal.nats < nats {
            // What was gained of what the slope and the bend promised.
            let promised = gain - 0.5 * step.dot(&(here.normal.information * step));
            let kept = (2.0 * (nats - there.normal.nats) / promised - 1.0).clamp(-1.0, 1.0);
            (damping, growth) = ((damping * (1.0 - kept * kept * kept).max(0.1)).max(1e-9), 2.0);
            here = there;
        } else {
            (damping, growth) = (damping.max(1e-4) * growth, 2.0 * growth);
        }
    }
    here
}

fn shortened(step: Vector6<f64>) -> Vector6<f64> {
    let longest = step.amax();
    if longest > LONGEST { step * (LONGEST / longest) } else { step }
}

/// A pose with its yaw held: what all else is told to.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub(super) at: Refined,
    /// The information of all but yaw, factored.
    pub(super) rest: Cholesky<f64, U5>,
}

impl Held {
    /// `None` where the rest is not determined.
    pub(super) fn of(at: Refined) -> Option<Self> {
        let rest = at.normal.information.fixed_view::<5, 5>(0, 0).into_owned().cholesky()?;
        Some(Self { at, rest })
    }

    /// How the rest is coupled with yaw.
    fn coupling(&self) -> Vector5<f64> {
        self.at.normal.information.fixed_view::<5, 1>(0, 5).into_owned()
    }

    /// The standard deviation of the yaw, all else free, rad.
    pub(super) fn yaw_sigma_rad(&self) -> f64 {
        let coupling = self.coupling();
        let explained = coupling.dot(&self.rest.solve(&coupling));
        1.0 / (self.at.normal.information[(5, 5)] - explained).max(1e-6).sqrt()
    }

    /// The pose with the yaw turned by `yaw_rad`, all else following as far as it is coupled with yaw: [`Self::turned`] to first order.
    pub(super) fn following(&self, yaw_rad: f64) -> Pose {
        self.bending(yaw_rad, &Vector5::zeros())
    }

    /// The same, and by `bend` beside.
    fn bending(&self, yaw_rad: f64, bend: &Vector5<f64>) -> Pose {
        let step = (self.rest.solve(&(self.coupling() * -yaw_rad)) + bend).push(yaw_rad);
        self.at.pose.stepped(&shortened(step))
    }

    /// The pose that costs least beside this one with the yaw turned by `yaw_rad`; `None` where its rest is not determined. `bend` is how far off the
    /// first order was from one slice to the next, and becomes what it is here: valleys bend evenly.
    pub(super) fn turned(
        &self,
        problem: &Problem<'_>,
        yaw_rad: f64,
        bend: &mut Vector5<f64>,
    ) -> Option<Self> {
        let mut there = Self::of(Refined::at(problem, self.bending(yaw_rad, bend)))?;
        let mut off = Vector5::zeros();
        for _ in 0..MOST_SLICE_STEPS {
            let gradient = there.at.normal.gradient.fixed_rows::<5>(0).into_owned();
            let rest = -there.rest.solve(&gradient);
            let gain = -gradient.dot(&rest);
            if gain.is_nan() || gain <= SMALL_SLICE_GAIN {
                break;
            }
            if gain < FORESEEN_GAIN {
                there.at = there.at.foreseen(&rest, gain);
                off += rest;
                break;
            }
            let next = Refined::at(problem, there.at.pose.stepped(&shortened(rest.push(0.0))));
            if next.normal.nats > there.at.normal.nats {
                break;
            }
            there = Self::of(next)?;
            off += rest;
        }
        // A leap, as where a marker turns away, is no bend of the valley.
        *bend = if off.norm() > LEAP * yaw_rad.abs() { Vector5::zeros() } else { *bend + off };
        Some(there)
    }
}
