//! Spots of rendered frames against their markers' true places -> errors by class, beside what each spot claims.

use photinus::airframe::Airframe;
use photinus::spots::{Detector, Settings, Spot};
use photinus_io::dataset::TruthLed;
use rand_pcg::Pcg64;

use crate::render::{self, Setup};

/// Spots no further apart stand beside each other, px.
const BESIDE_PX: f64 = 15.0;
/// LEDs no further apart than this may merge into one spot, px.
const MELTED_PX: f64 = 4.0;
/// A spot further from every LED is none of them, px.
const ASTRAY_PX: f64 = 2.0;
/// A squared error larger than this counts as this: one astray must not hide the rest.
const CAP: f64 = 1000.0;

/// What is told apart, in the order of their numbers.
const CLASSES: [&str; 9] = [
    "clear, alone",
    "clear beside fainter",
    "clear beside brighter",
    "saturated, alone",
    "saturated beside fainter",
    "saturated beside brighter",
    "LEDs within 4 px, clear",
    "LEDs within 4 px, saturated",
    "all but those",
];
const ALL: usize = 8;

/// Sums over the spots of one class.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: f64,
    squares_px2: f64,
    claimed_px2: f64,
    squared_errors: f64,
    inside: f64,
    towards_px: f64,
    outwards_px: f64,
}

/// Of the errors of all spots of a frame: what is common to them, and what is not.
#[derive(Clone, Copy, Debug, Default)]
struct Shared {
    common_px2: f64,
    expected_px2: f64,
}

/// Prints errors of the spots of `count` neighbours per range.
pub(crate) fn print(setup: &Setup, airframes: &[Airframe], count: usize) {
    println!("\nSpots, {}, {count} neighbours per range", setup.name);
    println!(
        "airframe         range  class                        spots       rms   claimed  NSE (2)  in 95 %  to neighbour   outwards"
    );
    for airframe in airframes {
        for distance_m in setup.ranges_m {
            let (tallies, shared) = run(setup, airframe, *distance_m, count);
            for (class, tally) in CLASSES.iter().zip(&tallies).filter(|(_, tally)| tally.count >= 20.0) {
                let mean = |sum: f64| sum / tally.count;
                println!(
                    "{:16} {distance_m:3.0} m  {class:27} {:6.0} {:6.4} px {:6.4} px {:8.2} {:6.1} % {:+10.4} px {:+7.4} px",
                    airframe.name(),
                    tally.count,
                    mean(tally.squares_px2 / 2.0).sqrt(),
                    mean(tally.claimed_px2 / 2.0).sqrt(),
                    mean(tally.squared_errors),
                    100.0 * mean(tally.inside),
                    mean(tally.towards_px),
                    mean(tally.outwards_px),
                );
            }
            println!(
                "{:16} {distance_m:3.0} m  common to a frame's spots: {:.2} of what independent errors have in common",
                airframe.name(),
                shared.common_px2 / shared.expected_px2,
            );
        }
    }
}

fn run(setup: &Setup, airframe: &Airframe, distance_m: f64, count: usize) -> ([Tally; 9], Shared) {
    let mut rng = Pcg64::new(7, 11);
    let mut detector = Detector::new(Settings::default()).expect("settings with a meaning");
    let (mut tallies, mut shared) = ([Tally::default(); 9], Shared::default());
    for batch in 0..count.div_ceil(render::BATCH) {
        for (_, frame) in render::batch(setup, airframe, distance_m, (batch * render::BATCH) as u64, &mut rng)
        {
            let middle =
                [frame.image.view().width(), frame.image.view().height()].map(|side| 0.5 * side as f64);
            let leds: Vec<&TruthLed> = frame.truth.neighbours.iter().flat_map(|one| &one.leds).collect();
            let found = detector.detect(&frame.image.view(), None).expect("no mask");
            let mut errors = Vec::new();
            for (index, spot) in found.spots.iter().enumerate() {
                let Some(led) = nearest(spot, &leds) else { continue };
                let off = [spot.centre.u - led.u_px, spot.centre.v - led.v_px];
                let others = found.spots.iter().enumerate().filter(|&(other, _)| other != index);
                let beside =
                    others.map(|(_, other)| other).min_by(|a, b| gap(spot, a).total_cmp(&gap(spot, b)));
                let class = class(spot, beside, led, &leds);
                let beside =
                    beside.map(|beside| [beside.centre.u - spot.centre.u, beside.centre.v - spot.centre.v]);
                let outwards = [led.u_px - middle[0], led.v_px - middle[1]];
                tallies[class].add(spot, off, beside, outwards);
                if class < 6 {
                    tallies[ALL].add(spot, off, beside, outwards);
                    errors.push(off);
                }
            }
            shared.add(&errors);
        }
    }
    (tallies, shared)
}

fn gap(a: &Spot, b: &Spot) -> f64 {
    libm::hypot(a.centre.u - b.centre.u, a.centre.v - b.centre.v)
}

fn nearest<'a>(spot: &Spot, leds: &[&'a TruthLed]) -> Option<&'a TruthLed> {
    let apart = |led: &TruthLed| libm::hypot(led.u_px - spot.centre.u, led.v_px - spot.centre.v);
    let led = leds.iter().copied().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    (apart(led) < ASTRAY_PX).then_some(led)
}

/// Its number in [`CLASSES`].
fn class(spot: &Spot, beside: Option<&Spot>, led: &TruthLed, leds: &[&TruthLed]) -> usize {
    let apart = |other: &TruthLed| libm::hypot(other.u_px - led.u_px, other.v_px - led.v_px);
    // LEDs of one marker shine from one place.
    let merged = leds.iter().any(|other| (0.01..MELTED_PX).contains(&apart(other)));
    let saturated = usize::from(spot.saturated_px > 0);
    let beside = beside.filter(|beside| gap(spot, beside) < BESIDE_PX);
    match beside {
        _ if merged => 6 + saturated,
        None => 3 * saturated,
        Some(beside) => 3 * saturated + if beside.flux < spot.flux { 1 } else { 2 },
    }
}

impl Tally {
    fn add(&mut self, spot: &Spot, off: [f64; 2], beside: Option<[f64; 2]>, outwards: [f64; 2]) {
        let along = |[u, v]: [f64; 2]| (off[0] * u + off[1] * v) / libm::hypot(u, v).max(1e-9);
        let covariance = spot.covariance_px2;
        let [[a, b], [_, d]] = [[covariance.m11, covariance.m12], [covariance.m21, covariance.m22]];
        let squared =
            (off[0] * off[0] * d - 2.0 * off[0] * off[1] * b + off[1] * off[1] * a) / (a * d - b * b);
        self.count += 1.0;
        self.squares_px2 += off[0] * off[0] + off[1] * off[1];
        self.claimed_px2 += covariance.trace();
        self.squared_errors += squared.min(CAP);
        self.inside += f64::from(u8::from(squared < 5.991));
        self.towards_px += beside.map_or(0.0, along);
        self.outwards_px += along(outwards);
    }
}

impl Shared {
    /// The square of the mean of n independent errors is on average the sum of their squares over n^2.
    fn add(&mut self, errors: &[[f64; 2]]) {
        let n = errors.len() as f64;
        if errors.len() < 2 {
            return;
        }
        let sum = |axis: usize| errors.iter().map(|off| off[axis]).sum::<f64>();
        let squares: f64 = errors.iter().flatten().map(|off| off * off).sum();
        self.common_px2 += (sum(0) * sum(0) + sum(1) * sum(1)) / (n * n);
        self.expected_px2 += squares / (n * n);
    }
}
