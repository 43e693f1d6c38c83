//! Observations and hypotheses of one neighbour -> its posterior.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use super::along_yaw;
use super::assignment::Assignment;
use super::hypotheses::Hypotheses;
use super::known::Known;
use super::light_spread::LightSpread;
use super::misfit::Misfit;
use super::mixture::{self, Component, Mode, Summary};
use super::observation::{Observation, Whitened};
use super::problem::{Merging, Pose, Problem};
use super::refine::{Held, MOST_STEPS, Refined, refine};
use super::settings::{Settings, SettingsError};
use super::symmetry::Symmetry;
use super::tilting::Tilting;
use super::visibility::Missed;
use crate::airframe::Airframe;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A mode this much worse than the best, nats, has no weight.
const HOPELESS_NATS: f64 = 8.0;
/// Most rounds of assigning spots to markers and refining the pose.
const MOST_ROUNDS: usize = 10;
/// Most steps of the pose between two such rounds.
const MOST_SETTLING_STEPS: usize = 8;

/// Where a search from a hypothesis ended.
#[derive(Clone, Copy, Debug)]
struct Found {
    hypothesis: usize,
    merging: Merging,
    refined: Refined,
    /// What it costs with what is seen and what is not, nats.
    nats: f64,
}

/// What the spots of one neighbour tell.
#[derive(Clone, Debug, Default)]
pub struct Posterior {
    /// Mean and covariance.
    pub summary: Option<Summary>,
    /// The modes, the heaviest first.
    pub modes: Vec<Mode>,
    /// Logarithm of the density of the observations, given that a neighbour is in this direction and at this distance: per sr of each spot and per
    /// unit of the logarithm of its light, times 1 sr and 1 unit of the logarithm of the neighbour's distance. With how many neighbours a sr and a unit
    /// hold it compares with the density of the same spots as clutter.
    pub log_evidence: f64,
    /// The markers that the spots are in the best hypothesis.
    pub markers: Vec<Option<u16>>,
    /// Largest misfit in the best mode, in sigma: of a spot, or of the bounds on distance.
    pub worst_sigma: f64,
    /// The misfit of the best mode.
    pub misfit: Misfit,
    /// The markers that must show in the best mode, and those of them that do not.
    pub missed: Missed,
    /// How far it tilts in the best mode.
    pub tilting: Tilting,
    /// How far its light is from what the airframe says in the best mode.
    pub light_spread: LightSpread,
    /// Logarithm of the light of an LED of intensity 1 at 1 m in the best mode, where a spot has a light.
    pub log_power: Option<f64>,
}

/// Estimates poses of one kind of airframe. Keeps its room, so that a warm one allocates nothing.
#[derive(Clone, Debug)]
pub struct Estimator {
    airframe: Airframe,
    settings: Settings,
    symmetry: Symmetry,
    whitened: Vec<Whitened>,
    assignment: Assignment,
    modes: Vec<Found>,
    components: Vec<Component>,
    posterior: Posterior,
}

impl Estimator {
    /// An estimator for an airframe.
    ///
    /// # Errors
    /// [`SettingsError`] when a setting has no meaning.
    pub fn new(airframe: &Airframe, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let (spots, modes) = (airframe.markers().len(), 2 * Hypotheses::MOST);
        let symmetry = Symmetry::of(airframe);
        // One mode more is held while it is turned.
        let components = (modes * symmetry.told_apart() + 1) * along_yaw::MOST_COMPONENTS;
        Ok(Self {
            airframe: airframe.clone(),
            settings,
            symmetry,
            whitened: Vec::with_capacity(spots),
            assignment: Assignment::with_room(spots),
            modes: Vec::with_capacity(modes),
            components: Vec::with_capacity(components),
            posterior: Posterior {
                modes: Vec::with_capacity(components),
                markers: Vec::with_capacity(spots),
                ..Posterior::default()
            },
        })
    }

    /// The airframe's symmetry: yaw is told modulo its turns.
    pub fn symmetry(&self) -> &Symmetry {
        &self.symmetry
    }

    /// The posterior that was estimated last.
    pub fn posterior(&self) -> &Posterior {
        &self.posterior
    }

    /// The posterior over all hypotheses; without a summary when none of them leads to a pose.
    pub fn estimate(
        &mut self,
        observations: &[Observation],
        hypotheses: &mut Hypotheses,
        known: &Known<'_>,
    ) -> &Posterior {
        self.posterior.summary = None;
        self.posterior.modes.clear();
        self.posterior.log_evidence = f64::NEG_INFINITY;
        self.find_modes(observations, hypotheses, known);
        let best = (0..self.modes.len()).min_by(|&a, &b| self.modes[a].nats.total_cmp(&self.modes[b].nats));
        let Some(best) = best.filter(|&best| self.modes[best].nats.is_finite()) else {
            return &self.posterior;
        };
        self.posterior.markers.clear();
        self.posterior.markers.extend_from_slice(hypotheses.markers(self.modes[best].hypothesis));
        let limit = self.modes[best].nats + HOPELESS_NATS;
        self.components.clear();
        for index in 0..self.modes.len() {
            let Found { hypothesis, merging, refined: mode, nats } = self.modes[index];
            let markers = hypotheses.markers(hypothesis);
            // Of searches that ended in one mode the best stands for it: the others may have stopped short, and what hardly shines into a spot may as well be dark.
            let is_better_twin = |(place, other): (usize, &Found)| {
                (other.nats, place) < (nats, index)
                    && hypotheses.markers(other.hypothesis) == markers
                    && is_same(&other.refined.pose, &mode.pose)
            };
            if nats > limit || self.modes.iter().enumerate().any(is_better_twin) {
                continue;
            }
            let problem = problem(&self.airframe, &self.settings, observations, &self.whitened, known);
            let problem = Problem { markers, merging, ..problem };
            if index == best {
                let misfit = |(spot, marker)| problem.misfit(&mode.pose, spot, marker);
                self.posterior.misfit = problem.misfit_of_all(&mode.pose);
                self.posterior.missed = problem.missed(&mode.pose, mode.normal.log_power);
                self.posterior.tilting = problem.tilting(&mode);
                self.posterior.light_spread = problem.light_spread(&mode);
                self.posterior.log_power = mode.normal.log_power;
                self.posterior.worst_sigma = problem.used().map(misfit).fold(0.0, f64::max).sqrt();
            }
            let first = self.components.len();
            along_yaw::spread(&problem, &mode, index, &mut self.components);
            self.turn_by_signals(first, observations, markers);
        }
        self.tell(observations, known);
        &self.posterior
    }

    fn find_modes(&mut self, observations: &[Observation], hypotheses: &mut Hypotheses, known: &Known<'_>) {
        self.modes.clear();
        for hypothesis in 0..hypotheses.len() {
            let start = hypotheses.start(hypothesis).pose;
            if hypothesis == 0 {
                let angle_rad = self.settings.marker_sigma_m / start.position_m.norm();
                self.whitened.clear();
                self.whitened
                    .extend(observations.iter().map(|seen| Whitened::of(seen, angle_rad * angle_rad)));
            }
            let problem = problem(&self.airframe, &self.settings, observations, &self.whitened, known);
            let mode = if hypotheses.is_loose(hypothesis) {
                settle(&problem, hypothesis, hypotheses, &self.modes, &mut self.assignment)
            } else {
                refine(
                    &Problem { markers: hypotheses.markers(hypothesis), ..problem }.near(&start),
                    start,
                    MOST_STEPS,
                )
            };
            let markers = hypotheses.markers(hypothesis);
            let signals = observations.iter().map(|seen| seen.signal);
            let wrong = self.symmetry.least_signal_nats(signals, markers);
            let problem = Problem { markers, ..problem };
            let found = |merging: Merging, refined: Refined| {
                let problem = Problem { merging, ..problem };
                let nats = refined.normal.nats + unseen_nats(&problem, refined) + wrong;
                Found { hypothesis, merging, refined, nats }
            };
            let log_power = mode.normal.log_power;
            let misses_beside = |pose: &Pose| problem.misses_beside(pose, log_power);
            // What must show beside a spot and does not shines into it or is dark, which are two modes.
            if misses_beside(&start) || misses_beside(&mode.pose) {
                let dark = Problem { merging: Merging::Dark, ..problem };
                self.modes.push(found(Merging::Dark, refine(&dark, start, MOST_STEPS)));
            }
            self.modes.push(found(problem.near(&mode.pose).merging, mode));
        }
    }

    /// With decoded signals the turns of a symmetric airframe differ: each that fits is a mode of its own.
    fn turn_by_signals(&mut self, first: usize, observations: &[Observation], markers: &[Option<u16>]) {
        if observations.iter().all(|seen| seen.signal.is_none()) {
            return;
        }
        let last = self.components.len();
        let turns = self.symmetry.told_apart();
        for turn in 0..turns {
            let signals = observations.iter().map(|seen| seen.signal);
            let nats = self.symmetry.signal_nats(turn, signals, markers) + libm::log(turns as f64);
            for index in first..last {
                let mut component = self.components[index].turned(self.symmetry.turn(turn));
                component.log_weight -= nats;
                component.hypothesis += turn * self.modes.len();
                self.components.push(component);
            }
        }
        self.components.drain(first..last);
    }

    fn tell(&mut self, observations: &[Observation], known: &Known<'_>) {
        let Self { components, posterior, .. } = self;
        posterior.worst_sigma = posterior.worst_sigma.max(mixture::beyond_sigmas(components, &known.bounds));
        mixture::truncate(components, &known.bounds);
        // Any yaw is as likely as any other, and hypotheses are one of those that symmetry makes equal.
        let log_yaws = libm::log(TAU / self.symmetry.turns() as f64);
        posterior.log_evidence = mixture::log_evidence(components) - log_yaws;
        if !mixture::normalise(components) {
            return;
        }
        let anonymous = observations.iter().all(|seen| seen.signal.is_none());
        let turns = if anonymous { self.symmetry.turns() } else { self.symmetry.turns_with_signals() };
        posterior.summary = mixture::summarise(components, turns);
        mixture::modes(components, turns, &mut posterior.modes);
    }
}

/// What it costs at a mode that these markers are seen and the others are not, nats.
fn unseen_nats(problem: &Problem<'_>, mode: Refined) -> f64 {
    let nats = |pose: &Pose| problem.visibility_nats(pose, mode.normal.log_power);
    let unseen = nats(&mode.pose);
    if unseen <= HOPELESS_NATS {
        return unseen;
    }
    // Light pulls little on a marker that hardly shows: the mode may sit where it no longer does, a sigma beside where it must.
    let Some(held) = Held::of(mode) else { return unseen };
    let sigma_rad = held.yaw_sigma_rad();
    let beside = [sigma_rad, -sigma_rad].map(|side| 0.5 + nats(&held.following(side)));
    beside.into_iter().fold(unseen, f64::min)
}

fn problem<'a>(
    airframe: &'a Airframe,
    settings: &'a Settings,
    observations: &'a [Observation],
    whitened: &'a [Whitened],
    known: &'a Known<'a>,
) -> Problem<'a> {
    Problem {
        airframe,
        settings,
        observations,
        whitened,
        known,
        markers: &[],
        merging: Merging::Near,
        repeats: 1.0,
    }
}

/// Assigns spots to the nearest markers and refines the pose in turns, until nothing changes; a few steps each turn, for what is nearest changes on the way.
/// A search that comes to where one before it ended has ended there.
fn settle(
    problem: &Problem<'_>,
    index: usize,
    hypotheses: &mut Hypotheses,
    modes: &[Found],
    assignment: &mut Assignment,
) -> Refined {
    let mut pose = hypotheses.start(index).pose;
    for _ in 0..MOST_ROUNDS {
        let markers = hypotheses.markers_mut(index);
        let changed = assignment.assign(problem.airframe, &pose, problem.observations, markers);
        let markers = hypotheses.markers(index);
        let is_there = |there: &&Found| {
            there.merging != Merging::Dark
                && hypotheses.markers(there.hypothesis) == markers
                && is_same(&there.refined.pose, &pose)
        };
        if let Some(there) = modes.iter().find(is_there) {
            return there.refined;
        }
        if !changed {
            break;
        }
        // Who is nearest does not hang on what merges.
        pose =
            refine(&Problem { markers, merging: Merging::Far, ..*problem }, pose, MOST_SETTLING_STEPS).pose;
    }
    refine(&Problem { markers: hypotheses.markers(index), ..*problem }.near(&pose), pose, MOST_STEPS)
}

impl Problem<'_> {
    /// The problem near a pose.
    fn near(&self, pose: &Pose) -> Self {
        let near = Self { merging: Merging::Near, ..*self };
        Self { merging: near.merging_near(pose), ..near }
    }
}

/// Whether two searches are in one mode.
fn is_same(a: &Pose, b: &Pose) -> bool {
    let moved = (a.position_m - b.position_m).norm() / a.position_m.norm();
    let turn = (a.camera_from_body.matrix() - b.camera_from_body.matrix()).norm();
    moved < 1e-2 && turn < 3e-2
}
