//! The light of vehicles' spots -> how bright the LEDs of the fleet are, and with it how far each vehicle is.
//!
//! LEDs are about as strong on all vehicles, but what a vehicle's light tells of that hangs on where it is: two spots may be neighbouring markers nearby, or
//! outer ones farther away, then of LEDs five times as strong. So each of a vehicle's distributions has its own power; a vehicle says what they say
//! together; and it is told what the others say, itself left out.

use alloc::vec::Vec;

use super::state::State;
use crate::camera::Rig;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
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
        self.sorted.extend(state.targets.iter().filter_map(|target| {
            state.components(target).iter().find_map(|own| own.power.log_power(camera))
        }));
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
            let first = step.saturating_sub(REACH);
            let near = said.iter_mut().enumerate().skip(first).take(step + REACH + 1 - first);
            near.for_each(|(to, said)| *said += share * self.kernel[step.abs_diff(to)]);
        }
        let sum: f64 = said.iter().sum();
        said.map(|own| (1.0 - ODD) * own / sum + ODD / STEPS as f64)
    }

    /// The power of the LEDs by what all say but this vehicle, `None` of too few.
    pub(super) fn but_for(&self, vehicle: Option<usize>) -> Option<LogLight> {
        let is_other = |other: usize| Some(other) != vehicle;
        let others = self.speaks.iter().enumerate().filter(|&(other, speaks)| is_other(other) && *speaks);
        if others.count() + 1 < FEWEST {
            return None;
        }
        let own = vehicle.and_then(|vehicle| self.said.get(vehicle)).copied().unwrap_or([1.0; STEPS]);
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

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::super::component::Component;
    use super::super::state::Target;
    use super::*;
    use crate::normal;

    /// Vehicles whose distributions have these weights and powers.
    fn state(vehicles: &[&[(f64, f64)]]) -> State {
        let mut state = State::empty(0.0, 0);
        for modes in vehicles {
            let first_component = state.components.len();
            state.components.extend(modes.iter().map(|&(weight, log_power)| {
                let mut power = Power::UNKNOWN;
                power.learn(0, Some(log_power));
                Component { weight, power, ..Component::somewhere(Vector3::z(), 1.0) }
            }));
            state.targets.push(Target { first_component, components: modes.len(), ..Target::somebody(0.0) });
        }
        state
    }

    fn of(vehicles: &[&[(f64, f64)]], vehicle: impl Into<Option<usize>>) -> Option<LogLight> {
        let mut fleet = Fleet::with_room(4);
        fleet.listen(&state(vehicles), 0);
        fleet.but_for(vehicle.into())
    }

    /// The mean and the standard deviation of what the others say, by sums over a fine grid.
    fn summed(vehicles: &[&[(f64, f64)]], vehicle: usize) -> (f64, f64) {
        let said = |modes: &[(f64, f64)], at: f64| {
            let density = |&(weight, log_power): &(f64, f64)| {
                weight * normal::density((at - log_power) / SPREAD, SPREAD)
            };
            (1.0 - ODD) * modes.iter().map(density).sum::<f64>() + ODD / (STEPS as f64 * STEP)
        };
        let (mut all, mut mean, mut square) = (0.0, 0.0, 0.0);
        for step in 0..4000 {
            let at = 5.0 + 0.0025 * f64::from(step);
            let others = vehicles.iter().enumerate().filter(|own| own.0 != vehicle);
            let weight: f64 = others.map(|(_, modes)| said(modes, at)).product();
            (all, mean, square) = (all + weight, mean + weight * at, square + weight * at * at);
        }
        mean /= all;
        (mean, (square / all - mean * mean).sqrt())
    }

    #[test]
    fn a_vehicle_is_told_what_the_others_say() {
        let (near, far): (&[_], &[_]) = (&[(0.97, 8.6), (0.03, 10.0)], &[(1.0, 10.1)]);
        // Two say so plainly; its own 97 % do not count.
        let told = of(&[near, far, far], 0).unwrap();
        assert!((told.value - 10.1).abs() < 0.15 && told.sigma < 0.5, "{told:?}");
        // Who is unsure itself says little: the others stay with theirs.
        assert!((of(&[near, far, far], 1).unwrap().value - 10.0).abs() < 0.5);
        // Two nearby ones that agree with each other do not outvote what they might be.
        let all: [&[(f64, f64)]; 4] = [near, &[(0.5, 8.5), (0.5, 10.0)], far, far];
        assert!((of(&all, 0).unwrap().value - 10.1).abs() < 0.15);
        assert_eq!(of(&[near, far], 0), None);
        assert_eq!(of(&[near, far, &[]], 0), None);
        // Nobody's own.
        assert!(of(&[far, far, far], None).is_some_and(|told| (told.value - 10.1).abs() < 0.1));
    }

    #[test]
    fn a_power_is_the_mean_of_its_last_frames_and_of_distributions_that_become_one() {
        let mut power = Power::UNKNOWN;
        assert_eq!(power.log_power(0), None);
        [9.0, 10.0, 11.0].into_iter().for_each(|log_power| power.learn(0, Some(log_power)));
        power.learn(0, None);
        assert!((power.log_power(0).unwrap() - 10.0).abs() < 1e-12 && power.log_power(1).is_none());
        (0..200).for_each(|_| power.learn(0, Some(12.0)));
        assert!((power.log_power(0).unwrap() - 12.0).abs() < 1e-4);
        let (mut both, mut other) = (Power::UNKNOWN, Power::UNKNOWN);
        (0..20).for_each(|_| other.learn(0, Some(10.0)));
        both.add(&power, 0.25);
        both.add(&other, 0.75);
        assert!((both.log_power(0).unwrap() - 10.5).abs() < 1e-4);
    }

    proptest! {
        #[test]
        fn what_others_say_is_as_summed_finely(
            powers in prop::array::uniform3(prop::array::uniform2(8.0..11.0_f64)),
            weights in prop::array::uniform3(0.0..1.0_f64),
        ) {
            let modes = |of: usize| [(weights[of], powers[of][0]), (1.0 - weights[of], powers[of][1])];
            let all = [modes(0), modes(1), modes(2)];
            let all = [&all[0][..], &all[1][..], &all[2][..]];
            let (told, (mean, sigma)) = (of(&all, 0).unwrap(), summed(&all, 0));
            prop_assert!((told.value - mean).abs() < 0.12, "{told:?} {mean} {sigma}");
            prop_assert!((told.sigma - libm::hypot(sigma, SPREAD)).abs() < 0.12, "{told:?} {mean} {sigma}");
        }
    }
}
