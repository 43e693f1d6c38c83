//! A seed -> a scene of six quadrotors with four words each.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;

use photinus_sim::Scene;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

/// How a vehicle flies, by its number: two of each in a scene.
pub(crate) const MOTIONS: [&str; 3] = ["hovering", "circling", "turning"];
/// Vehicles of a scene.
const VEHICLES: usize = 6;
/// Middles of vehicles are at least so far apart, m.
const APART_M: f64 = 1.8;

/// Whether LEDs sit and shine as the airframe's file says.
#[derive(Clone, Copy)]
pub(crate) enum Built {
    AsTold,
    /// Off by as much as the program believes beforehand: 3 mm along each axis, a fifth of their power.
    ByHand,
}

impl Built {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::AsTold => "as told",
            Self::ByHand => "by hand",
        }
    }

    fn leds(self) -> &'static str {
        match self {
            Self::AsTold => "spread = 0.0",
            Self::ByHand => "spread = 0.2, misplaced_m = 0.003",
        }
    }
}

/// The scene of a seed.
pub(crate) fn scene(seed: u64, built: Built) -> Scene {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let mut random = Pcg64::new(u128::from(seed), 0xf1ee7);
    let mut between = |low: f64, high: f64| Uniform::new(low, high).expect("a range").sample(&mut random);
    let mut text = format!(
        "name = \"fleet\"\nseed = {seed}\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 60.0\nduration_s = 3.0\nexposure_us = 1000.0\n\
         [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\nwind_m_s = 2.0\n\
         [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n"
    );
    let mut places: Vec<[f64; 3]> = Vec::new();
    while places.len() < VEHICLES {
        let (distance_m, azimuth_rad) = (between(3.5, 10.5), between(-0.9, 0.9));
        let place = [
            distance_m * libm::cos(azimuth_rad),
            distance_m * libm::sin(azimuth_rad),
            5.0 + 0.12 * distance_m * between(-1.0, 1.0),
        ];
        let is_apart = |other: &[f64; 3]| libm::hypot(other[0] - place[0], other[1] - place[1]) > APART_M;
        if places.iter().all(is_apart) {
            places.push(place);
        }
    }
    for (number, [x_m, y_m, z_m]) in places.into_iter().enumerate() {
        let motion = match number % MOTIONS.len() {
            0 => format!("hover = {{ position_m = [{x_m}, {y_m}, {z_m}] }}"),
            _ => format!(
                "circle = {{ centre_m = [{x_m}, {y_m}, {z_m}], radius_m = 0.7, speed_m_s = 1.0, phase_deg = {} }}",
                between(0.0, TAU).to_degrees()
            ),
        };
        let spin = match number % MOTIONS.len() {
            2 => "spin = [{ start_s = 0.0, duration_s = 3.0, turns = 0.25 }]\n",
            _ => "",
        };
        let first = 4 * number;
        write!(
            text,
            "[[target]]\nid = {}\nairframe = \"airframes/quadrotor-pairs-0.3.toml\"\nmotion = {{ {motion} }}\nwind_m_s = 2.0\nheading_deg = {}\n{spin}\
             leds = {{ {} }}\nsolid = [{{ cylinder = {{ centre_m = [0.0, 0.0, 0.0], radius_m = 0.12, half_height_m = 0.08 }} }}]\n\
             blink = {{ codes = \"codes/l18-d3-r3.txt\", words = [{first}, {}, {}, {}], rate_hz = 60.0, shift_s = {} }}\n",
            number + 1,
            between(0.0, 4.0 * FRAC_PI_2).to_degrees(),
            built.leds(),
            first + 1,
            first + 2,
            first + 3,
            between(0.001, 0.016),
        )
        .expect("a text grows");
    }
    Scene::parse(&text, format!("{scenes}/fleet.toml")).expect("a scene")
}
