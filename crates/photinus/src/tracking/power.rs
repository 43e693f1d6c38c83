//! The light of vehicles' spots -> how bright the LEDs of the fleet are, and with it how far each vehicle is.
//!
//! LEDs are about as strong on all vehicles, but what a vehicle's light tells of that hangs on where it is: two spots may be neighbouring markers nearby, or
//! outer ones farther away, then of LEDs five times as strong. So each of a vehicle's distributions has its own power; a vehicle says what they say
//! together; and it is told what the others say, itself left out.

use alloc::vec::Vec;

use super::state::State;
use crate::camera::Rig;
use crate::pose::LogLight;

/// LEDs of a fleet differ in power by so much from vehicle to vehicle, as a logarithm, with what distances leave of it.
const SPREAD: f64 = 0.3;
/// A vehicle tells nothing of the fleet's LEDs so often: it is elsewhere than is believed, or has others.
const ODD: f64 = 0.1;
/// So many vehicles tell the power of their LEDs, one of them that of its own.
const FEWEST: usize = 3;
/// A power is the mean of this many frames.
const FRAMES: f64 = 16.0;
/// Powers are told apart by this much, as a logarithm, over so many steps: from faint to bright by a factor of fifteen thousand.
const STEP: f64 = 0.15;
const STEPS: usize = 64;
/// A vehicle's own spread reaches so many steps to either side.
const REACH: usize = 6;

/// Logarithm of the light of an LED of intensity 1 at 1 m in each camera, if a vehicle is where a distribution has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Power {
    mean: [f64; Rig::MOST],
    frames: [f64; Rig::MOST],
}

impl Power {
    /// Nothing is known yet.
    pub(super) const UNKNOWN: Self = Self { mean: [0.0; Rig::MOST], frames: [0.0; Rig::MOST] };

    /// In a camera, where that told it.
    pub(super) fn log_power(&self, camera: usize) -> Option<f64> {
        (self.frames[camera] > 0.0).then_some(self.mean[camera])
    }

    /// A frame of a camera tells it.
    pub(super) fn learn(&mut self, camera: usize, log_power: Option<f64>) {
        if let Some(log_power) = log_power {
            let frames = (self.frames[camera] + 1.0).min(FRAMES);
            self.mean[camera] += (log_power - self.mean[camera]) / frames;
            self.frames[camera] = frames;
        }
    }

    /// Adds what another says of the same vehicle, which has this share of both.
    pub(super) fn add(&mut self, other: &Self, share: f64) {
        for camera in 0..Rig::MOST {
            let own = share * other.frames[camera];
            self.frames[camera] += own;
            if own > 0.0 {
                self.mean[camera] += (other.mean[camera] - self.mean[camera]) * own / self.frames[camera];
            }
        }
    }
}

/// What the vehicles of a fleet say. Keeps its room.
#[derive(Debug)]
pub(super) struct Fleet {
    /// How likely a vehicle so many steps away is of the fleet's power.
    kernel: [f64; REACH + 1],
    /// The power of the first step.
    first: f64,
    /// What each vehicle says, by vehicle and step; and all together.
    said: Vec<[f64; STEPS]>,
    speaks: Vec<bool>,
    together: [f64; STEPS],
    sorted: Vec<f64>,
}

impl Fleet {
    pub(super) fn with_room(vehicles: usize) -> Self {
        let at = |steps: usize| {
            let off = steps as f64 * STEP / SPREAD;
            libm::exp(-0.5 * off * off)
        };
        let mut kernel = [0.0; REACH + 1];
        kernel.iter_mut().enumerate().for_each(|(steps, own)| *own = at(steps));
        Self {
            kernel,
            first: 0.0,
            said: Vec::with_capacity(vehicles),
            speaks: Vec::with_capacity(vehicles),
            together: [1.0; STEPS],
            sorted: Vec::with_capacity(vehicles),
        }
    }

    /// Listens to what all vehicles say in a camera.
    pub(super) fn listen(&mut self, state: &State, camera: usize) {
        self.said.clear();
        self.speaks.clear();
        self.together = [1.0; STEPS];
        self.sorted.clear();
        let likeliest = |target| {
            let told = state.components(target).iter().find_map(|own| own.power.log_power(camera));
            told
        };
        self.sorted.extend(state.targets.iter().filter_map(likeliest));
        self.sorted.sort_unstable_by(f64::total_cmp);
        let Some(&middle) = self.sorted.get(self.sorted.len() / 2) else { return };
        self.first = middle - 0.5 * STEPS as f64 * STEP;
        for target in &state.targets {
            let mut shares = [0.0; STEPS];
            for own in state.components(target) {
                if let Some(log_power) = own.power.log_power(camera) {
                    self.put(&mut shares, log_power, own.weight);
                }
            }
            let speaks = shares.iter().any(|share| *share > 0.0);
            self.speaks.push(speaks);
            self.said.push(if speaks { self.spread(&shares) } else { [1.0; STEPS] });
        }
        for said in &self.said {
            self.together.iter_mut().zip(said).for_each(|(all, own)| *all *= own);
            let most = self.together.iter().copied().fold(0.0, f64::max);
            self.together.iter_mut().for_each(|all| *all /= most);
        }
    }

    /// Puts a share between the two steps that are next to a power.
    fn put(&self, shares: &mut [f64; STEPS], log_power: f64, share: f64) {
        let place = ((log_power - self.first) / STEP).clamp(0.0, (STEPS - 2) as f64);
        let step = place as usize;
        shares[step] += share * (1.0 - (place - step as f64));
        shares[step + 1] += share * (place - step as f64);
    }

    /// What shares at powers say of that of the fleet.
    fn spread(&self, shares: &[f64; STEPS]) -> [f64; STEPS] {
        let mut said = [0.0; STEPS];
        for (step, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            for to in step.saturating_sub(REACH)..=(step + REACH).min(STEPS - 1) {
                said[to] += share * self.kernel[step.abs_diff(to)];
            }
        }
        let sum: f64 = said.iter().sum();
        said.map(|own| (1.0 - ODD) * own / sum + ODD / STEPS as f64)
    }

    /// The power of the LEDs of a vehicle by what all others say, `None` of too few.
    pub(super) fn of(&self, vehicle: usize) -> Option<LogLight> {
        let others = self.speaks.iter().enumerate().filter(|&(other, speaks)| other != vehicle && *speaks);
        if others.count() + 1 < FEWEST {
            return None;
        }
        let own = self.said.get(vehicle).copied().unwrap_or([1.0; STEPS]);
        let weight = |step: usize| self.together[step] / own[step];
        let power = |step: usize| self.first + step as f64 * STEP;
        let (mut all, mut mean) = (0.0, 0.0);
        for step in 0..STEPS {
            all += weight(step);
            mean += weight(step) * power(step);
        }
        mean /= all;
        let square = |step: usize| weight(step) * (power(step) - mean) * (power(step) - mean);
        let variance = (0..STEPS).map(square).sum::<f64>() / all;
        Some(LogLight { value: mean, sigma: libm::hypot(variance.sqrt(), SPREAD) })
    }
}
