//! Robots that fly where they are steered, in front of a camera: enters where each is wanted, leaves a frame of the simulator.
//!
//! The camera looks level along x of the world, from its origin. Light, lens and sensor are those of the founding paper's set ([`photinus_sim::preset`]),
//! robots those of swarms ([`photinus_swarm::vehicle`]), which have inertia and tilt to accelerate.

use std::sync::Arc;

use nalgebra::{Isometry3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus_sim::background::{Daylight, Sky};
use photinus_sim::occlusion::Solid;
use photinus_sim::preset::{BLUEFOX_FIT, Preset, bluefox};
use photinus_sim::scene::mounting;
use photinus_sim::snapshot::{LedLight, Moving, Vehicle};
use photinus_sim::{CameraView, Renderer, Snapshot};
use photinus_swarm::vehicle::{Autopilot, Build, State, Wanted};
use serde::Serialize;

use crate::told;

/// A robot goes to where it is wanted as a spring that is damped critically, 1/s.
const STIFFNESS_PER_S: f64 = 2.0;
const HEADING_PER_S: f64 = 1.5;
/// A step of the motion is no longer, s.
const STEP_S: f64 = 0.01;
/// The sun of a clear day: half-way up, behind the camera to its left.
const SUN: Vector3<f64> = Vector3::new(-0.6, 0.4, 0.7);
/// What hides LEDs of a robot: its hub.
const HUB: Solid =
    Solid::Cylinder { centre_m: Vector3::new(0.0, 0.0, 0.0), radius_m: 0.12, half_height_m: 0.08 };

/// What is behind the robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Behind {
    /// Nothing.
    Night,
    /// Clouds.
    Overcast,
    /// Blue sky.
    Clear,
}

/// Where a robot is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Camera frame, m.
    pub position_m: Vector3<f64>,
    /// To the left of the camera's view, rad.
    pub heading_rad: f64,
}

#[derive(Clone, Debug)]
struct Robot {
    state: State,
    goal: Goal,
}

/// A frame's time since the flight began, and where every robot truly is.
#[derive(Debug, Serialize)]
struct Flown {
    time_s: f64,
    robots: Vec<Truth>,
}

/// Where a robot truly is: camera frame, as [`Goal`].
#[derive(Clone, Copy, Debug, Serialize)]
struct Truth {
    position_m: [f64; 3],
    distance_m: f64,
    heading_rad: f64,
}

/// Robots and the camera that sees them.
#[derive(Debug)]
pub struct Flight {
    build: Build,
    robots: Vec<Robot>,
    renderer: Renderer,
    /// The robots are its vehicles, in their order.
    world: Snapshot,
    exposure_s: f64,
    time_s: f64,
    frame: u64,
}

impl Flight {
    /// Robots that hover at their goals.
    pub fn new(camera: Camera, airframe: Airframe, goals: &[Goal], exposure_s: f64, behind: Behind) -> Self {
        let Preset { emitter, lens, sensor } = bluefox(&BLUEFOX_FIT);
        let renderer = Renderer::new(CameraView { camera, lens, sensor }, 1);
        let sky = match behind {
            Behind::Night => None,
            Behind::Overcast => Some(Sky::Overcast),
            Behind::Clear => Some(Sky::Clear),
        };
        let camera = Isometry3::from_parts(Translation3::identity(), world_from_camera());
        let build = Build::default();
        let hover = |goal: &Goal| {
            let state = State::hover(&build, world_from_camera() * goal.position_m, goal.heading_rad);
            Robot { state, goal: *goal }
        };
        let robots: Vec<Robot> = goals.iter().map(hover).collect();
        let leds = vec![LedLight::steady(); airframe.leds().len()];
        let (airframe, solids): (_, Arc<[Solid]>) = (Arc::new(airframe), Arc::new([HUB]));
        let vehicle = |(id, robot): (u32, &Robot)| Vehicle {
            id,
            airframe: Arc::clone(&airframe),
            solids: Arc::clone(&solids),
            looks: Arc::default(),
            motion: Moving::still(robot.state.pose()),
            leds: leds.clone(),
        };
        let world = Snapshot {
            exposure: renderer.view().exposure(0.0, exposure_s),
            camera: Moving::still(camera),
            vehicles: (1..).zip(&robots).map(vehicle).collect(),
            emitter,
            daylight: sky.map(|sky| Daylight::new(sky, Unit::new_normalize(SUN))),
            water: None,
            lamps: Vec::new(),
        };
        Self { build, robots, renderer, world, exposure_s, time_s: 0.0, frame: 0 }
    }

    /// Says where a robot is wanted from now on; nothing where there is no such robot.
    pub fn steer(&mut self, robot: usize, goal: &Goal) {
        if let Some(robot) = self.robots.get_mut(robot) {
            robot.goal = *goal;
        }
    }

    /// Flies on for `step_s` and renders what the camera sees then into the picture. When that is and where the robots truly are is told as JSON.
    pub fn fly(&mut self, step_s: f64, picture: &mut [u8]) -> Option<String> {
        let steps = libm::ceil(step_s / STEP_S).max(1.0);
        for _ in 0..steps as usize {
            self.robots.iter_mut().for_each(|robot| robot.step(&self.build, step_s / steps));
        }
        self.time_s += step_s;
        self.frame += 1;
        self.world.exposure = self.renderer.view().exposure(self.time_s, self.exposure_s);
        for (vehicle, robot) in self.world.vehicles.iter_mut().zip(&self.robots) {
            vehicle.motion =
                robot.state.kinematics(&self.build, &Vector3::zeros()).during(0.0, self.exposure_s);
        }
        let rendered = self.renderer.render(&self.world, self.frame);
        picture.copy_from_slice(rendered.image.pixels());
        told::json(&Flown { time_s: self.time_s, robots: self.robots.iter().map(Robot::truth).collect() })
    }
}

impl Robot {
    fn step(&mut self, build: &Build, step_s: f64) {
        let State { position_m, velocity_m_s, attitude, .. } = self.state;
        let heading_rad = self.state.heading_rad();
        let goal_m = world_from_camera() * self.goal.position_m;
        let pull_m_s2 = (goal_m - position_m) * (STIFFNESS_PER_S * STIFFNESS_PER_S)
            - velocity_m_s * (2.0 * STIFFNESS_PER_S);
        let level = Rotation3::from_axis_angle(&Vector3::z_axis(), heading_rad);
        let missing_rad = libm::remainder(self.goal.heading_rad - heading_rad, core::f64::consts::TAU);
        let wanted = Wanted {
            acceleration_m_s2: level.inverse() * pull_m_s2,
            heading_rate_rad_s: HEADING_PER_S * missing_rad,
        };
        let command = Autopilot::default().command(build, &attitude, &wanted);
        self.state.step(build, &command, &Vector3::zeros(), step_s);
    }

    fn truth(&self) -> Truth {
        let position_m = world_from_camera().inverse() * self.state.position_m;
        Truth {
            position_m: position_m.into(),
            distance_m: position_m.norm(),
            heading_rad: self.state.heading_rad(),
        }
    }
}

/// Of a camera that looks level along x of the world.
fn world_from_camera() -> UnitQuaternion<f64> {
    mounting(0.0, 0.0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{Bench, SetUp};
    use photinus::airframe::Ring;

    #[test]
    fn a_robot_flies_where_it_is_steered_and_is_located_there() {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        let mut bench = Bench::new(&SetUp { size_px: [752, 480], focal_px: 265.442, ring }).unwrap();
        let begin = Goal { position_m: Vector3::new(1.0, 0.0, 4.0), heading_rad: 0.0 };
        let (camera, airframe) = (bench.camera().clone(), bench.airframe().clone());
        let mut flight = Flight::new(camera, airframe, &[begin], 1e-3, Behind::Overcast);
        let goal = Goal { position_m: Vector3::new(-1.0, -0.5, 6.0), heading_rad: 0.5 };
        flight.steer(0, &goal);
        flight.steer(1, &goal); // there is none
        let mut most_tilted_rad = 0.0_f64;
        for _ in 0..150 {
            assert!(flight.fly(0.04, bench.picture()).is_some());
            let up = flight.robots[0].state.attitude * Vector3::z();
            most_tilted_rad = most_tilted_rad.max(up.angle(&Vector3::z()));
        }
        assert!((flight.time_s - 6.0).abs() < 1e-9 && most_tilted_rad > 0.1, "{most_tilted_rad}");
        let truth = flight.robots[0].truth();
        assert!((Vector3::from(truth.position_m) - goal.position_m).norm() < 0.05, "{truth:?}");
        assert!((truth.heading_rad - 0.5).abs() < 0.01, "{truth:?}");
        let told: serde_json::Value = serde_json::from_str(&bench.locate(true, None).unwrap()).unwrap();
        let neighbours = told["neighbours"].as_array().unwrap();
        assert_eq!(neighbours.len(), 1);
        let estimate_m = neighbours[0]["distance_m"]["estimate"].as_f64().unwrap();
        assert!((estimate_m - truth.distance_m).abs() < 0.3, "{estimate_m} m, not {} m", truth.distance_m);
    }
}
