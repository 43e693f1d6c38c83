//! One vehicle of the world: what it is, knows, sees and wants.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use photinus_control::{Heading, Motion, Normal, OwnState, Seen, Setpoint};

use crate::mind::{Guard, Mind, Needs, OnMap, Plan, Truth, VELOCITY_GAIN_1_S, script_setpoint};
use crate::perception::{Eyes, levelled};
use crate::scenario::{Scenario, Start};
use crate::vehicle::{Autopilot, Build, Instruments, Own, State, Wanted};

/// Gain of what is missing of a velocity for long, 1/s^2, and the most that it adds, m/s^2: what holds a velocity in wind.
const VELOCITY_INTEGRAL_1_S2: f64 = 0.6;
const MOST_INTEGRAL_M_S2: f64 = 4.0;

/// Gain of a height that is kept, 1/s, and the fastest climb towards it, m/s.
const HEIGHT_1_S: f64 = 0.5;
const MOST_CLIMB_M_S: f64 = 0.3;

/// A vehicle.
#[derive(Debug)]
pub struct Robot {
    /// How it moves: the truth.
    pub state: State,
    /// Whom it sees, in its level frame: what its controller was handed last.
    pub seen: Vec<Seen>,
    /// What it decided last; it obeys from the next frame on.
    pub setpoint: Setpoint,
    /// Where it began, m.
    pub start_m: Vector3<f64>,
    pub(super) own: Own,
    /// How its body turned since the frame before, by its gyro: before_from_now.
    pub(super) turned: UnitQuaternion<f64>,
    pub(super) eyes: Eyes,
    instruments: Instruments,
    autopilot: Autopilot,
    mind: Mind,
    height_m: Option<f64>,
    guard: Option<Guard>,
    reached: usize,
    obeys: Setpoint,
    integral_m_s2: Vector3<f64>,
}

impl Robot {
    pub(super) fn new(scenario: &Scenario, index: usize, start: Start, eyes: Eyes) -> Self {
        let vehicle = &scenario.vehicles[index];
        let state = State::hover(&vehicle.kind.build, start.position_m, start.heading_rad);
        let mut instruments = Instruments::new(scenario.accuracy, scenario.seed, index as u64);
        Self {
            own: instruments.read(&state, 0.0),
            state,
            seen: Vec::new(),
            setpoint: Setpoint::stand(),
            start_m: start.position_m,
            turned: UnitQuaternion::identity(),
            eyes,
            instruments,
            autopilot: Autopilot::default(),
            mind: vehicle.mind.mind(&Needs::of(scenario, index)),
            height_m: vehicle.height_m,
            guard: vehicle
                .safety
                .as_ref()
                .and_then(|plan| Guard::new(plan, &vehicle.kind, scenario.period_s(), &scenario.obstacles)),
            reached: 0,
            obeys: Setpoint::stand(),
            integral_m_s2: Vector3::zeros(),
        }
    }

    /// Decides otherwise from now on.
    pub(super) fn change_mind(&mut self, plan: &Plan, scenario: &Scenario, index: usize) {
        self.mind = plan.mind(&Needs::of(scenario, index));
        self.reached = 0;
    }

    /// Whether it flies by what it sees.
    pub fn sees(&self) -> bool {
        matches!(self.mind, Mind::Seeing(_))
    }

    /// Its safety layer, where it has one.
    pub fn guard(&self) -> Option<&Guard> {
        self.guard.as_ref()
    }

    /// What it takes for its velocity, in its level frame, m/s.
    pub fn believed_velocity_m_s(&self) -> Vector3<f64> {
        self.own.velocity_m_s
    }

    /// Reads its instruments.
    pub(super) fn read(&mut self, time_s: f64) {
        self.own = self.instruments.read(&self.state, time_s);
    }

    /// Turns what it saw from its body frame to its level frame.
    pub(super) fn level(&mut self) {
        let level_from_body = Rotation3::from(self.own.level_from_body());
        let accuracy = self.instruments.accuracy();
        let tilt_sigma_rad = libm::hypot(accuracy.tilt_bias_rad, accuracy.tilt_noise_rad);
        self.seen.iter_mut().for_each(|seen| *seen = levelled(seen, &level_from_body, tilt_sigma_rad));
        self.turned = UnitQuaternion::identity();
    }

    /// Decides by what it sees, or by its script.
    pub(super) fn decide(&mut self, truth: &Truth<'_>, period_s: f64) {
        let own = self.own_state();
        self.setpoint = match &mut self.mind {
            Mind::Seeing(controller) => {
                let wanted = controller.command(&own, &self.seen, period_s);
                let wanted = self
                    .height_m
                    .map_or(wanted, |height_m| at_height(wanted, height_m - self.own.height_m, &own));
                let (position_m, heading_rad) = (self.state.position_m, self.state.heading_rad());
                let on_map = OnMap { position_m, heading_rad };
                self.guard
                    .as_mut()
                    .map_or(wanted, |guard| guard.guard(&own, &self.seen, &on_map, &wanted, period_s))
            }
            Mind::Scripted(script) => {
                let velocity = script.velocity_m_s(truth, &mut self.reached);
                script_setpoint(&velocity, self.state.heading_rad())
            }
        };
    }

    /// What it decided takes effect.
    pub(super) fn obey(&mut self) {
        self.obeys = self.setpoint;
    }

    /// Flies on for a step.
    pub(super) fn fly(&mut self, build: &Build, wind_m_s: &Vector3<f64>, step_s: f64) {
        let own = self.instruments.read(&self.state, self.own.time_s);
        let wanted = self.wanted(build, &own, step_s);
        let command = self.autopilot.command(build, &own.attitude, &wanted);
        self.state.step(build, &command, wind_m_s, step_s);
        self.turned *= UnitQuaternion::from_scaled_axis(own.turn_rad_s * step_s);
    }

    /// The set-point as an acceleration.
    fn wanted(&mut self, build: &Build, own: &Own, step_s: f64) -> Wanted {
        let heading_rate_rad_s = self.obeys.yaw_rate_rad_s;
        let acceleration_m_s2 = match self.obeys.motion {
            Motion::Acceleration(acceleration) => acceleration,
            Motion::Velocity(velocity) => {
                let speed = velocity.norm();
                let most = build.speed_m_s;
                let velocity = if speed > most { velocity * (most / speed) } else { velocity };
                let missing = velocity - own.velocity_m_s;
                self.integral_m_s2 += missing * (VELOCITY_INTEGRAL_1_S2 * step_s);
                let length = self.integral_m_s2.norm();
                self.integral_m_s2 *= (MOST_INTEGRAL_M_S2 / length.max(MOST_INTEGRAL_M_S2)).min(1.0);
                missing * VELOCITY_GAIN_1_S + self.integral_m_s2
            }
        };
        Wanted { acceleration_m_s2, heading_rate_rad_s }
    }

    /// What a controller is told of its vehicle.
    fn own_state(&self) -> OwnState {
        let accuracy = self.instruments.accuracy();
        let velocity_sigma = libm::hypot(accuracy.velocity_bias_m_s, accuracy.velocity_noise_m_s);
        let ahead = self.own.attitude * Vector3::x();
        OwnState {
            level_from_body: Rotation3::from(self.own.level_from_body()),
            rates_rad_s: self.own.turn_rad_s,
            velocity_m_s: Some(Normal {
                mean: self.own.velocity_m_s,
                covariance: nalgebra::Matrix3::identity() * (velocity_sigma * velocity_sigma),
            }),
            heading: Some(Heading {
                angle_rad: libm::atan2(ahead.y, ahead.x),
                sigma_rad: accuracy.heading_bias_rad,
            }),
            height_m: Some(self.own.height_m),
        }
    }
}

/// The same along the ground, and up and down only to where a height is missing, m.
fn at_height(wanted: Setpoint, missing_m: f64, own: &OwnState) -> Setpoint {
    let climb_m_s = (missing_m * HEIGHT_1_S).clamp(-MOST_CLIMB_M_S, MOST_CLIMB_M_S);
    let motion = match wanted.motion {
        Motion::Velocity(velocity) => Motion::Velocity(Vector3::new(velocity.x, velocity.y, climb_m_s)),
        Motion::Acceleration(acceleration) => {
            let climbs_m_s = own.velocity_m_s.map_or(0.0, |velocity| velocity.mean.z);
            let up_m_s2 = (climb_m_s - climbs_m_s) * VELOCITY_GAIN_1_S;
            Motion::Acceleration(Vector3::new(acceleration.x, acceleration.y, up_m_s2))
        }
    };
    Setpoint { motion, ..wanted }
}
