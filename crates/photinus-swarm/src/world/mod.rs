//! The world that steps: everybody looks, everybody decides, then time passes.
//!
//! ```text
//! frame k   events; every vehicle reads its instruments and looks           perception (shared out among threads)
//!           every vehicle decides by what it saw in this frame               mind
//! physics   autopilots fly the decisions of the frame before, in small steps vehicle
//! ```
//!
//! A decision takes effect a frame after the exposure that it rests on: that is the time that exposure, read-out and computing take. Nothing depends on
//! the number of threads: each vehicle has its own eyes, its own instruments and its own random numbers.

mod map;
mod robot;

use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector3;
use photinus_control::Seen;
use photinus_io::Error;
use photinus_sim::clock::Clock;
use photinus_sim::source::Blink;

pub use map::Obstacle;
pub use robot::Robot;

use crate::chance::{Chance, Use};
use crate::mind::Truth;
use crate::perception::{Eyes, Grade, Looking, Moment, Present, StandInTable};
use crate::scenario::{Happening, Scenario};
use crate::vehicle::{State, WindField};

/// Physics takes steps no longer than this, s.
const LONGEST_STEP_S: f64 = 1.0 / 240.0;

/// A world that steps.
#[derive(Debug)]
pub struct World {
    scenario: Arc<Scenario>,
    grade: Grade,
    robots: Vec<Robot>,
    present: Vec<Present>,
    wind: WindField,
    exposure_us: f64,
    frame: u64,
    events: usize,
    threads: usize,
}

/// What collided while time passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// When, s.
    pub time_s: f64,
    /// A vehicle.
    pub vehicle: usize,
    /// The other vehicle, or the obstacle.
    pub with: Partner,
    /// Between their centres, or from the centre to the obstacle, m.
    pub distance_m: f64,
}

/// What a vehicle is near to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// Another vehicle.
    Vehicle(usize),
    /// An obstacle of the scenario.
    Obstacle(usize),
}

impl World {
    /// A world at the start of a scenario, under the scenario's seed.
    ///
    /// # Errors
    /// [`Error`] where vehicles do not fit or a locator refuses its settings; `path` is for the messages.
    pub fn new(
        scenario: Arc<Scenario>,
        grade: Grade,
        table: &Arc<StandInTable>,
        threads: usize,
        path: &Path,
    ) -> Result<Self, Error> {
        let starts = scenario.starts(path)?;
        let count = scenario.vehicles.len();
        let make = |index: usize| {
            let eyes = Eyes::new(grade, &scenario, index, table)
                .map_err(|error| Error::format(path, format!("vehicle {index}: {error}")))?;
            Ok(Robot::new(&scenario, index, starts[index], eyes))
        };
        let robots = spread(count, threads, &make)?;
        let present = (0..count).map(|index| present(&scenario, index, &robots[index].state)).collect();
        let wind = WindField::new(scenario.wind, count, scenario.seed);
        let exposure_us = scenario.exposure_us;
        Ok(Self { scenario, grade, robots, present, wind, exposure_us, frame: 0, events: 0, threads })
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// How vehicles see.
    pub fn grade(&self) -> Grade {
        self.grade
    }

    /// Everybody, as of the last frame.
    pub fn robots(&self) -> &[Robot] {
        &self.robots
    }

    /// When the frame that comes next is exposed, s.
    pub fn time_s(&self) -> f64 {
        self.frame as f64 * self.scenario.period_s()
    }

    /// The world as the last frame was exposed, for whoever compares what was seen with it.
    pub fn moment(&self) -> Moment<'_> {
        Moment {
            number: self.frame,
            time_s: self.time_s(),
            exposure_us: self.exposure_us,
            vehicles: &self.present,
            obstacles: &self.scenario.obstacles,
            range_m: self.scenario.range_m,
        }
    }

    /// How long frames are exposed now, us.
    pub fn exposure_us(&self) -> f64 {
        self.exposure_us
    }

    /// Everybody looks and decides.
    pub fn look(&mut self) {
        self.happen();
        let time_s = self.time_s();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let build = &self.scenario.vehicles[index].kind.build;
            self.present[index].kinematics = robot.state.kinematics(build, &self.wind.at(index));
            robot.read(time_s);
        }
        let mut robots = std::mem::take(&mut self.robots);
        let moment = self.moment();
        each(&mut robots, self.threads, &|index, robot: &mut Robot| {
            robot.look(index, &moment);
        });
        let places_m: Vec<Vector3<f64>> = robots.iter().map(|robot| robot.state.position_m).collect();
        let period_s = self.scenario.period_s();
        for (vehicle, robot) in robots.iter_mut().enumerate() {
            let truth = Truth { time_s, vehicle, start_m: robot.start_m, places_m: &places_m };
            robot.decide(&truth, period_s);
        }
        self.robots = robots;
    }

    /// Time passes until the next frame; `near` is told of every pair and every obstacle at every step, nearest distances and all.
    pub fn pass(&mut self, near: &mut dyn FnMut(Touch)) {
        let period_s = self.scenario.period_s();
        let steps = (period_s / LONGEST_STEP_S).ceil();
        let step_s = period_s / steps;
        let begin_s = self.time_s();
        for step in 1..=steps as u32 {
            self.wind.step(step_s);
            for (index, robot) in self.robots.iter_mut().enumerate() {
                let build = &self.scenario.vehicles[index].kind.build;
                robot.fly(build, &self.wind.at(index), step_s);
            }
            self.tell_near(begin_s + f64::from(step) * step_s, near);
        }
        self.robots.iter_mut().for_each(Robot::obey);
        self.frame += 1;
    }

    fn tell_near(&self, time_s: f64, near: &mut dyn FnMut(Touch)) {
        for (vehicle, robot) in self.robots.iter().enumerate() {
            let here_m = &robot.state.position_m;
            for (other, theirs) in self.robots.iter().enumerate().skip(vehicle + 1) {
                let distance_m = (theirs.state.position_m - here_m).norm();
                near(Touch { time_s, vehicle, with: Partner::Vehicle(other), distance_m });
            }
            for (index, obstacle) in self.scenario.obstacles.iter().enumerate() {
                let distance_m = obstacle.distance_m(here_m);
                near(Touch { time_s, vehicle, with: Partner::Obstacle(index), distance_m });
            }
        }
    }

    /// Lets happen what is due.
    fn happen(&mut self) {
        let due = self.scenario.events.iter().skip(self.events);
        let due = due.take_while(|event| event.at_s <= self.time_s() + 1e-9).count();
        for event in &self.scenario.events[self.events..self.events + due] {
            match &event.what {
                Happening::Exposure(exposure_us) => self.exposure_us = *exposure_us,
                Happening::LedFails { vehicle, led } => self.present[*vehicle].powers[*led] = 0.0,
                Happening::CameraFails { vehicle, camera } => {
                    self.present[*vehicle].cameras_work[*camera] = false;
                }
                Happening::Mind { vehicle, mind } => {
                    self.robots[*vehicle].change_mind(mind, &self.scenario, *vehicle);
                }
            }
        }
        self.events += due;
    }
}

impl Robot {
    fn look(&mut self, vehicle: usize, moment: &Moment<'_>) {
        let looking = Looking { vehicle, own: &self.own, turned: self.turned };
        let mut seen: Vec<Seen> = std::mem::take(&mut self.seen);
        self.eyes.look(&looking, moment, &mut seen);
        self.seen = seen;
        self.level();
    }
}

/// A vehicle as it was built, where it begins.
fn present(scenario: &Scenario, index: usize, state: &State) -> Present {
    let vehicle = &scenario.vehicles[index];
    let mut chance = Chance::new(scenario.seed, Use::Leds, index as u64);
    let leds = vehicle.kind.airframe.leds().len();
    let blink = scenario.codes.as_ref().and_then(|codes| {
        let word = codes.book.words().get(vehicle.id as usize)?;
        let mut clocks = Chance::new(scenario.seed, Use::Clocks, index as u64);
        let clock = Clock { offset_s: clocks.uniform(), ppm: 20.0 * clocks.normal() };
        Blink::new(word.bits().collect(), codes.rate_hz, clock)
    });
    Present {
        kinematics: state.kinematics(&vehicle.kind.build, &Vector3::zeros()),
        kind: Arc::clone(&vehicle.kind),
        powers: (0..leds).map(|_| scenario.preset.emitter.unit_factor(chance.normal())).collect(),
        blink,
        cameras_work: vec![true; vehicle.kind.cameras.len()],
    }
}

/// Does something to each of many, on this many threads; what one does depends on no other.
fn each<T: Send>(items: &mut [T], threads: usize, work: &(dyn Fn(usize, &mut T) + Sync)) {
    let chunk = items.len().div_ceil(threads.max(1)).max(1);
    if threads <= 1 || items.len() <= 1 {
        items.iter_mut().enumerate().for_each(|(index, item)| work(index, item));
        return;
    }
    std::thread::scope(|scope| {
        for (number, part) in items.chunks_mut(chunk).enumerate() {
            scope.spawn(move || {
                part.iter_mut().enumerate().for_each(|(index, item)| work(number * chunk + index, item));
            });
        }
    });
}

/// Makes this many, on this many threads; the first error in their order.
fn spread<T: Send, E: Send>(
    count: usize,
    threads: usize,
    make: &(dyn Fn(usize) -> Result<T, E> + Sync),
) -> Result<Vec<T>, E> {
    let mut made: Vec<Option<Result<T, E>>> = (0..count).map(|_| None).collect();
    each(&mut made, threads, &|index, place| *place = Some(make(index)));
    made.into_iter().flatten().collect()
}
