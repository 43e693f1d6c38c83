//! Centres of spots that are not full against the best that there can be: the mean of the posterior of a point's place, given the point spread and the noise that
//! the frame was rendered with, summed over a grid of places. It shares nothing with the detector but the pixels.
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example centres
//! ```

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

#[path = "../tests/calibrate/rendered_leds/mod.rs"]
mod rendered_leds;

use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};
use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::optics::PointSpread;
use photinus::spots::{Detector, Settings};
use photinus_calibrate::optics::learn;
use rendered_leds::{Eye, FAINTEST_DN, Led, uniform};

const CAMERAS: [&str; 7] = [
    "gaussian-0.3",
    "gaussian-0.4",
    "gaussian-0.6",
    "gaussian-1.0",
    "gaussian-1.5",
    "moffat-0.5",
    "moffat-0.8",
];
const SIZE: (usize, usize) = (320, 240);
/// Summits of the LEDs, were they in the middle of a pixel, grey levels.
const SUMMITS_DN: [f64; 3] = [40.0, 100.0, 200.0];
const FRAMES: u64 = 12;
/// Frames that optics are learned from, and that a detector sees beforehand which knows none.
const OPTICS_FRAMES: u64 = 200;
const FRAMES_BEFORE: u64 = 60;
/// From one LED to the next, px.
const APART_PX: usize = 40;
/// A spot is of an LED that is no further away, px.
const GATE_PX: f64 = 1.5;

fn main() {
    println!(
        "| camera | summit | spots | best rms px | optics measured: rms px | over the best | squared error over claim | frames alone: rms px | over the best | squared error over claim |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for name in CAMERAS {
        let eye = Eye::named(name).cropped(SIZE.0, SIZE.1);
        let optics = learn(&eye.recorded(OPTICS_FRAMES, 6, 1)).expect("optics").optics;
        let model = Model::of(&eye);
        for summit_dn in SUMMITS_DN {
            let mut scores = [Score::default(); 3];
            let mut detectors = [Some(Arc::new(optics.clone())), None]
                .map(|optics| Detector::with_optics(Settings::default(), optics).expect("default settings"));
            eye.each_frame(
                FRAMES_BEFORE,
                2,
                |frame| on_a_grid(frame, [FAINTEST_DN, 250.0]),
                |view, _| {
                    detectors.iter_mut().for_each(|detector| drop(detector.detect(view, None).map(|_| ())));
                },
            );
            eye.each_frame(
                FRAMES,
                3,
                |frame| on_a_grid(frame, [summit_dn; 2]),
                |view, leds| {
                    let found = detectors.each_mut().map(|detector| centres(detector, view, leds));
                    for (number, led) in leds.iter().enumerate() {
                        let [Some(measured), Some(alone)] = [0, 1].map(|which| found[which][number]) else {
                            continue;
                        };
                        scores[0].add(model.mean_place(view, led), led);
                        scores[1].add(measured, led);
                        scores[2].add(alone, led);
                    }
                },
            );
            let [best, measured, alone] = scores.map(|score| score.rms_px());
            println!(
                "| {name} | {summit_dn} | {} | {best:.4} | {measured:.4} | {:.2} | {:.2} | {alone:.4} | {:.2} | {:.2} |",
                scores[0].count,
                measured / best,
                scores[1].nees(),
                alone / best,
                scores[2].nees(),
            );
        }
    }
}

/// LEDs that stand alone, each anywhere in a pixel, with summits between these, evenly by their logarithm.
fn on_a_grid(frame: u64, [least_dn, most_dn]: [f64; 2]) -> Vec<Led> {
    let mut uniform = uniform(frame, 0xce27);
    let at = |index: usize| ((index + 1) * APART_PX) as f64;
    let places = (0..SIZE.1 / APART_PX - 1)
        .flat_map(|row| (0..SIZE.0 / APART_PX - 1).map(move |column| (column, row)));
    places
        .map(|(column, row)| {
            let (u_px, v_px) = (at(column) + uniform(), at(row) + uniform());
            (u_px, v_px, least_dn / FAINTEST_DN * libm::pow(most_dn / least_dn, uniform()))
        })
        .collect()
}

/// A place with its covariance.
type Place = (Vector2<f64>, Matrix2<f64>);

/// The spot of each LED.
fn centres(detector: &mut Detector, view: &FrameView<'_>, leds: &[Led]) -> Vec<Option<Place>> {
    let spots = &detector.detect(view, None).expect("no mask").spots;
    let of = |led: &Led| {
        let off_px = |centre: &Pixel| libm::hypot(centre.u - led.0, centre.v - led.1);
        let near = spots.iter().min_by(|a, b| off_px(&a.centre).total_cmp(&off_px(&b.centre)))?;
        (off_px(&near.centre) < GATE_PX)
            .then(|| (Vector2::new(near.centre.u, near.centre.v), near.covariance_px2))
    };
    leds.iter().map(of).collect()
}

/// Errors of places.
#[derive(Clone, Copy, Default)]
struct Score {
    count: u32,
    squares_px2: f64,
    normalised: f64,
}

impl Score {
    fn add(&mut self, (place, covariance): Place, led: &Led) {
        let error = place - Vector2::new(led.0, led.1);
        self.count += 1;
        self.squares_px2 += error.norm_squared();
        self.normalised += covariance.try_inverse().map_or(f64::NAN, |inverse| error.dot(&(inverse * error)));
    }

    /// Along one axis.
    fn rms_px(&self) -> f64 {
        (self.squares_px2 / f64::from(2 * self.count)).sqrt()
    }

    fn nees(&self) -> f64 {
        self.normalised / f64::from(2 * self.count)
    }
}

/// Pixels to every side of the brightest that tell, and in which a point may be.
const WINDOW_PX: usize = 4;
const REACH_PX: f64 = 1.0;
/// Places that are tried along an axis, first in all of the reach, then where the point was found to be, to so many standard deviations, until these are finer than
/// the centres that are compared.
const TRIED: usize = 33;
const SIGMAS: f64 = 5.0;
const PASSES: usize = 3;

/// What pixels show of a point: the truth of the simulator.
struct Model {
    spread: PointSpread,
    dark: f64,
    shot: f64,
}

impl Model {
    fn of(eye: &Eye) -> Self {
        let sensor = &eye.preset.sensor;
        let read_dn = sensor.read_noise_e / sensor.electrons_per_dn;
        Self {
            spread: eye.truth([0.5 * SIZE.0 as f64, 0.5 * SIZE.1 as f64]),
            dark: read_dn * read_dn + 1.0 / 12.0,
            shot: 1.0 / sensor.electrons_per_dn,
        }
    }

    /// Mean and covariance of the posterior of a point's place, anywhere beforehand; its light is known as far as it makes noise, and else anything, as the level is.
    fn mean_place(&self, view: &FrameView<'_>, led: &Led) -> Place {
        let light = FAINTEST_DN * led.2 / self.spread.share(0.0, 0.0);
        let first = [led.0, led.1].map(|px| px.round() as usize - WINDOW_PX);
        let side = 2 * WINDOW_PX + 1;
        let pixel = |index: usize| {
            let [column, row] = [first[0] + index % side, first[1] + index / side];
            (Vector2::new(column as f64, row as f64), f64::from(view.row(row)[column]))
        };
        let pixels: Vec<(Vector2<f64>, f64)> = (0..side * side).map(pixel).collect();
        let middle = Vector2::from(first.map(|px| (px + WINDOW_PX) as f64));
        let mut reach = Vector2::repeat(REACH_PX);
        let mut told = self.within(&pixels, light, (middle, reach));
        for _ in 1..PASSES {
            let steps = reach * (2.0 / (TRIED - 1) as f64);
            reach = steps.zip_map(&told.1.diagonal(), |step, variance| (SIGMAS * variance.sqrt()).max(step));
            told = self.within(&pixels, light, (told.0, reach));
        }
        told
    }

    /// The same of places no further from `middle` than `reach`.
    fn within(
        &self,
        pixels: &[(Vector2<f64>, f64)],
        light: f64,
        (middle, reach): (Vector2<f64>, Vector2<f64>),
    ) -> Place {
        let place = |index: usize| {
            let along = |at: usize| 2.0 * at as f64 / (TRIED - 1) as f64 - 1.0;
            middle + reach.component_mul(&Vector2::new(along(index % TRIED), along(index / TRIED)))
        };
        let all: Vec<f64> =
            (0..TRIED * TRIED).map(|index| self.log_likelihood(pixels, light, place(index))).collect();
        let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = all.iter().map(|log| libm::exp(log - most)).collect();
        let sum: f64 = weights.iter().sum();
        let each = || weights.iter().enumerate().map(|(index, weight)| (place(index), weight / sum));
        let mean: Vector2<f64> = each().map(|(place, weight)| place * weight).sum();
        let spread = each().map(|(place, weight)| (place - mean) * (place - mean).transpose() * weight);
        (mean, spread.sum())
    }

    fn log_likelihood(&self, pixels: &[(Vector2<f64>, f64)], light: f64, place: Vector2<f64>) -> f64 {
        let (mut information, mut right) = (Matrix2::zeros(), Vector2::zeros());
        let (mut squares, mut logs) = (0.0, 0.0);
        for (at, seen) in pixels {
            let share = self.spread.share(at.x - place.x, at.y - place.y).max(0.0);
            let variance = self.dark + self.shot * light * share;
            let row = Vector2::new(share, 1.0);
            information += row * row.transpose() / variance;
            right += row * (seen / variance);
            squares += seen * seen / variance;
            logs += libm::log(variance);
        }
        let told = information.try_inverse().map_or(0.0, |inverse| right.dot(&(inverse * right)));
        -0.5 * (squares - told + logs + libm::log(information.determinant()))
    }
}
