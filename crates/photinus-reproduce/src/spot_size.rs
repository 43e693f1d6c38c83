//! Figures 10 and 11: how large the spot of one LED is over distance, for seven exposures, through noise and detector.
//!
//! The LED faces the camera on its axis and falls on random places in a pixel; noise, rendering and detection are those of any
//! frame. Spots are counted as the paper counts them: pixels at or above 200 of 255.

mod envelope;
mod exposures;

use photinus::ranging::Envelope;
use photinus::spots::{Brightness, Detector, Settings};
use photinus_sim::Simulator;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use crate::view::{OUTDOOR_DN, PAPER_DN};
use crate::{Effort, Report, ReproduceError, Rig};

/// What the paper's figure 10 shows: exposures, and the distance past which spots are always single pixels.
const EXPOSURES: [(f64, Option<f64>); 7] = [
    (100.0, Some(2.12)),
    (200.0, Some(3.23)),
    (500.0, Some(5.06)),
    (1000.0, Some(6.62)),
    (2000.0, Some(8.34)),
    (5000.0, Some(14.16)),
    (10_000.0, None),
];
/// Nearest place of the LED, m, and the end of the paper's axes.
const NEAR_M: f64 = 0.5;
const FAR_M: f64 = 15.0;
/// Farthest place of the LED at 1000 us, m: nobody finds it there. For other exposures it goes with their square root.
const LOST_M: f64 = 30.0;
/// (13) of the paper as its equation prints it.
const PRINTED: Envelope = Envelope { offset_px: 1.3398, scale_px_m2: 31.4704, shift_m: -0.0154 };
/// Recordings at 1000 us, for the spread of the fit.
const REPEATS: u64 = 10;

/// One frame of the LED.
#[derive(Clone, Copy, Debug)]
struct Shot {
    distance_m: f64,
    /// Pixels at or above 200; 0 where there are none.
    area_px: u32,
    /// Whether there is a spot at the outdoor threshold.
    is_found_outdoors: bool,
    /// Whether Photinus finds one by contrast.
    is_found_by_contrast: bool,
}

fn shots_each(effort: Effort) -> u64 {
    effort.of(8000, 150)
}

/// How many frames are rendered.
pub(crate) fn frames(effort: Effort) -> u64 {
    shots_each(effort) * (EXPOSURES.len() as u64 + REPEATS)
}

/// Both figures.
pub(crate) fn reports(
    rig: &Rig,
    effort: Effort,
    frame_done: &dyn Fn(),
) -> Result<Vec<Report>, ReproduceError> {
    let record =
        |exposure_us, far_m, seed| record(rig, exposure_us, far_m, shots_each(effort), seed, frame_done);
    let mut by_exposure = Vec::new();
    for (number, (exposure_us, _)) in EXPOSURES.into_iter().enumerate() {
        by_exposure.push(record(exposure_us, LOST_M * (exposure_us / 1000.0).sqrt(), number as u64)?);
    }
    let repeats =
        (0..REPEATS).map(|repeat| record(1000.0, FAR_M, 100 + repeat)).collect::<Result<Vec<_>, _>>()?;
    Ok(vec![exposures::report(&by_exposure), envelope::report(&repeats)])
}

/// Shots at distances spread evenly over their logarithm.
fn record(
    rig: &Rig,
    exposure_us: f64,
    far_m: f64,
    count: u64,
    seed: u64,
    frame_done: &dyn Fn(),
) -> Result<Vec<Shot>, ReproduceError> {
    let mut random = Pcg64::new(u128::from(seed), 10);
    let mut uniform = || -> f64 { StandardUniform.sample(&mut random) };
    let places: Vec<(f64, [f64; 2])> = (0..count)
        .map(|_| (NEAR_M * libm::pow(far_m / NEAR_M, uniform()), [uniform() - 0.5, uniform() - 0.5]))
        .collect();
    let scene = rig.receding(exposure_us, &places, seed)?;
    let mut simulator = Simulator::new(&scene, 0).ok_or(ReproduceError::Lacks("camera"))?;
    let detector = |brightness| {
        let mut settings = Settings::default();
        settings.brightness = brightness;
        // nothing is large enough to be the sun where there is none
        settings.shape.widest_px = 90.0;
        Detector::new(settings)
    };
    let mut paper = detector(Brightness::Threshold(PAPER_DN))?;
    let mut outdoors = detector(Brightness::Threshold(OUTDOOR_DN))?;
    let mut own = detector(Brightness::default())?;
    let shots = places.iter().zip(0..).map(|(&(distance_m, _), number)| {
        let image = simulator.frame(number).image;
        let largest_px = |detector: &mut Detector| {
            let found = detector.detect(&image.view(), None).map(|found| &found.spots);
            found.map_or(0, |spots| spots.iter().map(|spot| spot.area_px).max().unwrap_or(0))
        };
        let shot = Shot {
            distance_m,
            area_px: largest_px(&mut paper),
            is_found_outdoors: largest_px(&mut outdoors) > 0,
            is_found_by_contrast: largest_px(&mut own) > 0,
        };
        frame_done();
        shot
    });
    Ok(shots.collect())
}

/// The farthest shot for which something holds, m; 0 where it never does.
fn farthest_m(shots: &[Shot], holds: impl Fn(&Shot) -> bool) -> f64 {
    shots.iter().filter(|shot| holds(shot)).map(|shot| shot.distance_m).fold(0.0, f64::max)
}
