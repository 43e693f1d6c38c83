//! From spots to neighbours where there is more to weigh than a few neighbours: clutter by the thousand, and an airframe with
//! many LEDs.

use std::hint::black_box;

use nalgebra::{Matrix2, Unit, Vector3};
use photinus::airframe::{Airframe, Led, Lobe};
use photinus::camera::Pixel;
use photinus::locator::{Input, Locator, Settings};
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::contest::Contest;
use crate::frames::{self, PAPER};

/// LEDs of the airframe with many, spread evenly over a sphere.
const LEDS: usize = 128;
const RADIUS_M: f64 = 0.5;
/// Spots that it shows: the brightest of those that shine towards the camera.
const SHOWN: usize = 30;

pub(crate) fn run() {
    let mut contest = Contest::beside_maximum("From spots, 752x480");
    let mut add = |name: String, airframe: Airframe, spots: Vec<Spot>| {
        let locator = Locator::new(crate::camera(), &airframe, None, Settings::default());
        let mut locator = locator.expect("a locator");
        contest.add(&name, move |_| {
            black_box(
                locator.locate(Input::spots(&spots).gravity(&Vector3::y_axis())).expect("spots have no size"),
            );
        });
    };
    let many = many_leds();
    let mut shown = frames::spots(&crate::camera(), &many, 0.3, 5.0);
    shown.sort_by(|a, b| b.flux.total_cmp(&a.flux));
    shown.truncate(SHOWN);
    add(format!("{LEDS} LEDs, {} spots", shown.len()), many, shown);
    for count in [100, 1_000, 10_000, 50_000] {
        add(format!("{count} spots of clutter"), crate::hexarotor(), clutter(count));
    }
    contest.run_long();
}

/// Spots anywhere, as bright as markers at 1 to 30 m.
pub(crate) fn clutter(count: usize) -> Vec<Spot> {
    let mut rng = Pcg64::new(count as u128, 11);
    let uniform = |low: f64, high: f64| Uniform::new(low, high).expect("a range");
    let (across, down) = (uniform(2.0, PAPER.width as f64 - 3.0), uniform(2.0, PAPER.height as f64 - 3.0));
    let log_distance = uniform(0.0, libm::log(30.0));
    let spot = |_| {
        let centre = Pixel::new(across.sample(&mut rng), down.sample(&mut rng));
        let (u, v) = (centre.u.round() as u32, centre.v.round() as u32);
        Spot {
            centre,
            covariance_px2: Matrix2::identity() * 0.0025,
            area_px: 4,
            peak: 180,
            saturated_px: 0,
            flux: 20_000.0 * libm::exp(-2.0 * log_distance.sample(&mut rng)),
            light: None,
            background: 5.0,
            marker_log_odds: 0.0,
            middle: (u, v),
            extent: Extent { left: u - 1, top: v - 1, right: u + 1, bottom: v + 1 },
        }
    };
    (0..count).map(spot).collect()
}

/// An airframe whose LEDs shine outwards, by the golden angle.
pub(crate) fn many_leds() -> Airframe {
    let golden_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let led = |index: usize| {
        let height = 1.0 - (2 * index + 1) as f64 / LEDS as f64;
        let (sin, cos) = libm::sincos(golden_rad * index as f64);
        let around = (1.0 - height * height).sqrt();
        let out = Vector3::new(around * cos, around * sin, height);
        let axis = Unit::new_normalize(out);
        Led { position_m: out * RADIUS_M, axis, lobe: Lobe::Lambertian, power: 1.0, signal: None }
    };
    Airframe::new("sphere", (0..LEDS).map(led).collect()).expect("128 markers")
}
