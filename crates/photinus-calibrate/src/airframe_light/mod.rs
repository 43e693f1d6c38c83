//! A flight of one neighbour -> how its LEDs shine: their lobes, the power of each, and how well their positions are known.
//!
//! ```text
//! flight   located frames, one neighbour in each -> which spot is which marker (trail), with its light where that can be trusted
//! turns    which of its turns that look the same a symmetric airframe is in, by the powers of its LEDs
//! model    lobes, powers and positions -> what a spot must look like, with the derivatives
//! adjust   poses of all frames and all that they share, by least squares at once
//! scatter  how far claims of centres and of light are off; how far markers sit from where they should
//! ```
//!
//! What is solved, over the frames f, the markers m that each shows and the LEDs l of a marker:
//!
//! ```text
//! direction of m in f = R_f (p_m + d_m) + t_f, over its length
//! ln light of m in f  = c_f + ln sum_l P_l lobe_l(angle_fl) - 2 ln |x_fm|
//! ```
//!
//! Each frame has a light c_f of its own: exposure, distance and a lens that darkens towards its edge, which are much the same
//! for all markers of a neighbour, tell nothing and spoil nothing. Poses follow what they share (a Schur complement), so that the
//! sigmas hold with every pose unknown. Displacements d_m have a normal distribution whose sigma is what the markers themselves
//! say (empirical Bayes by expectation and maximisation: C. N. Morris, J. Am. Stat. Assoc. 78, 1983).
//!
//! Powers are against each other: their geometric mean is as it was. What a flight does not show keeps its prior, and is said to be unseen.

mod adjust;
mod flight;
mod model;
mod scatter;
mod shape;
#[cfg(test)]
mod tests;
mod trail;
mod turns;

use nalgebra::DMatrix;
use photinus::airframe::{Airframe, Led, Lobe};

use adjust::{Adjustment, Equations};
pub use flight::{Flight, Frame, Sighting};
use model::Parameters;
use shape::{COSINE_SIGMA, Shape};

/// Fewest frames with three markers or more.
const FEWEST_FRAMES: usize = 30;
/// Poses, lobes and powers follow each other so often.
const ROUNDS: usize = 4;
/// Powers of the cosine that are started from, as factors on that of the airframe's file.
const STARTS: [f64; 4] = [0.5, 1.0, 2.0, 5.0];
/// Passes after which the best start is chosen.
const START_PASSES: usize = 10;
/// What is known no better than this share of its prior's sigma was not seen.
const UNSEEN_SHARE: f64 = 0.5;
/// Nothing is claimed to be known better, of power as a share: LEDs age and warm up.
const LEAST_POWER_SIGMA: f64 = 0.005;
/// So often frames are turned as powers tell, and powers follow.
const TURNINGS: usize = 3;

/// A number and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The lobe of LEDs of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownLobe {
    /// Which LEDs, as the airframe counts them.
    pub leds: Vec<usize>,
    /// The power of the cosine; `None` where the flight did not tell it, or they shine in every direction: it is as it was.
    pub cosine_power: Option<Known>,
}

/// How the LEDs of an airframe shine, as a flight shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The airframe with its lobes and powers; positions, axes and signals are as they were.
    pub airframe: Airframe,
    /// The kinds of lobes.
    pub lobes: Vec<KnownLobe>,
    /// Power of each LED against the others, sigma as a share of it; `None` for one that the flight did not show.
    pub powers: Vec<Option<Known>>,
    /// How far markers sit from where the airframe's file says, per axis, m; `None` where the flight does not tell.
    pub position_sigma_m: Option<Known>,
    /// Scatter of centres and of light, in the sigmas that were claimed: 1 where those were right.
    pub scatter: [f64; 2],
    /// Frames that were used.
    pub frames: usize,
    /// Spots whose light was used.
    pub lights: usize,
    /// Frames left out because nothing says which way a symmetric airframe was turned in them.
    pub unturned: usize,
}

impl Light {
    /// How well a power is known, over all LEDs that were seen, as a share.
    pub fn power_sigma(&self) -> Option<f64> {
        let seen: Vec<f64> = self.powers.iter().flatten().map(|power| power.sigma * power.sigma).collect();
        let mean = seen.iter().sum::<f64>() / seen.len() as f64;
        (!seen.is_empty()).then(|| mean.sqrt().max(LEAST_POWER_SIGMA))
    }
}

/// Why a flight says nothing about light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// Too few frames that count.
    #[error(
        "{frames} frames show one neighbour alone with enough markers to tell its pose: {FEWEST_FRAMES} are needed"
    )]
    TooFewFrames {
        /// How many do.
        frames: usize,
    },
    /// Hardly any light that can be trusted.
    #[error("{lights} spots by themselves and without a saturated pixel: {least} are needed", least = 3 * FEWEST_FRAMES)]
    TooFewLights {
        /// How many there are.
        lights: usize,
    },
    /// The numbers have no best.
    #[error("the frames contradict each other")]
    DoNotFit,
}

/// Learns how the LEDs of an airframe shine; lobes that depend on the direction become powers of the cosine.
///
/// # Errors
/// [`LightError`] when the flight shows too little, or contradicts itself.
pub fn calibrate(flight: &Flight) -> Result<Light, LightError> {
    check(flight)?;
    let longest = flight.tracks().iter().max_by_key(|track| track.len()).map_or(&[][..], Vec::as_slice);
    let mut adjustment = start(flight, longest)?;
    let mut unturned = 0;
    for _ in 0..TURNINGS {
        (adjustment, unturned) = turns::turned(flight, adjustment);
        adjustment.refine().ok_or(LightError::DoNotFit)?;
    }
    settle(&mut adjustment)?;
    let equations = adjustment.equations().ok_or(LightError::DoNotFit)?;
    tell(flight.airframe(), &adjustment, &equations, unturned)
}

fn check(flight: &Flight) -> Result<(), LightError> {
    let frames = flight.tracks().iter().map(Vec::len).sum();
    if frames < FEWEST_FRAMES {
        return Err(LightError::TooFewFrames { frames });
    }
    let lights = flight.tracks().iter().flatten().map(Frame::lights).sum();
    if lights < 3 * FEWEST_FRAMES {
        return Err(LightError::TooFewLights { lights });
    }
    Ok(())
}

/// The best of several starts: poses that follow a wrong lobe can make it fit.
fn start<'a>(flight: &'a Flight, frames: &[Frame]) -> Result<Adjustment<'a>, LightError> {
    let refined = |power: f64| {
        let shapes = shape::kinds(flight.airframe()).into_iter().map(|shape| shape.narrowed(power));
        let mut adjustment = Adjustment::new(flight.airframe(), frames.to_vec(), shapes.collect());
        adjustment.approach(START_PASSES)?;
        Some((adjustment.cost()?, adjustment))
    };
    let all = STARTS.into_iter().filter_map(refined);
    let (_, mut best) = all.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(LightError::DoNotFit)?;
    best.refine().ok_or(LightError::DoNotFit)?;
    Ok(best)
}

/// Goes to the least cost, with the scatter and the spread of positions that it shows.
fn settle(adjustment: &mut Adjustment<'_>) -> Result<(), LightError> {
    for _ in 0..ROUNDS {
        adjustment.refine().ok_or(LightError::DoNotFit)?;
        adjustment.leave_out_strangers();
        let equations = adjustment.equations().ok_or(LightError::DoNotFit)?;
        scatter::update(adjustment, &equations).ok_or(LightError::DoNotFit)?;
    }
    adjustment.refine().ok_or(LightError::DoNotFit)
}

fn tell(
    nominal: &Airframe,
    adjustment: &Adjustment<'_>,
    equations: &Equations,
    unturned: usize,
) -> Result<Light, LightError> {
    let covariance = adjustment.covariance(equations).ok_or(LightError::DoNotFit)?;
    let parameters = &adjustment.parameters;
    let powers = powers(parameters, &covariance);
    let lobes = lobes(parameters, &covariance);
    let mut leds: Vec<Led> = nominal.leds().to_vec();
    for KnownLobe { leds: of, cosine_power } in &lobes {
        let Some(known) = cosine_power else { continue };
        of.iter().for_each(|&led| leds[led].lobe = Lobe::Cosine { power: known.value });
    }
    for (led, power) in leds.iter_mut().zip(&powers) {
        led.power = power.map_or(led.power, |power| power.value);
    }
    Ok(Light {
        airframe: Airframe::new(nominal.name(), leds).map_err(|_| LightError::DoNotFit)?,
        lobes,
        powers,
        position_sigma_m: scatter::position_sigma_m(adjustment, &covariance),
        scatter: adjustment.spread.scatter,
        frames: adjustment.frames().len(),
        lights: adjustment.frames().iter().map(Frame::lights).sum(),
        unturned,
    })
}

/// The lobes, those that were not seen as the airframe's file has them.
fn lobes(parameters: &Parameters, covariance: &DMatrix<f64>) -> Vec<KnownLobe> {
    let mut numbers = parameters.log_powers.len()..;
    let known = |shape: &Shape| {
        let number = shape.log_power.and_then(|_| numbers.next());
        let sigma = number.map(|number| covariance[(number, number)].sqrt());
        let seen = sigma.filter(|sigma| *sigma < UNSEEN_SHARE * COSINE_SIGMA);
        let cosine_power = match (shape.lobe(), seen) {
            (Lobe::Cosine { power }, Some(sigma)) => Some(Known { value: power, sigma: power * sigma }),
            _ => None,
        };
        KnownLobe { leds: shape.leds.clone(), cosine_power }
    };
    parameters.shapes.iter().map(known).collect()
}

/// Powers of the LEDs that were seen, in the mean as they were.
fn powers(parameters: &Parameters, covariance: &DMatrix<f64>) -> Vec<Option<Known>> {
    let Parameters { log_powers, told_log_powers, .. } = parameters;
    let all: Vec<usize> = (0..log_powers.len()).collect();
    let seen: Vec<usize> = all
        .iter()
        .copied()
        .filter(|&led| centred_variance(covariance, led, &all).sqrt() < UNSEEN_SHARE * model::POWER_SIGMA)
        .collect();
    let more = seen.iter().map(|&led| log_powers[led] - told_log_powers[led]).sum::<f64>();
    let mean = more / seen.len() as f64;
    let known = |&led: &usize| {
        let sigma = centred_variance(covariance, led, &seen).max(0.0).sqrt();
        seen.contains(&led).then(|| Known { value: libm::exp(log_powers[led] - mean), sigma })
    };
    all.iter().map(known).collect()
}

/// Variance of one less the mean of some.
fn centred_variance(covariance: &DMatrix<f64>, of: usize, some: &[usize]) -> f64 {
    let count = some.len() as f64;
    let with_mean = some.iter().map(|&other| covariance[(of, other)]).sum::<f64>() / count;
    let of_mean = some.iter().flat_map(|&a| some.iter().map(move |&b| covariance[(a, b)])).sum::<f64>();
    covariance[(of, of)] - 2.0 * with_mean + of_mean / (count * count)
}
