//! Seeds -> scenes.

use std::f64::consts::TAU;

use photinus_sim::Scene;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::fault::Fault;

pub(crate) const HEXAROTOR: Airframe = Airframe { name: "hexarotor", file: "hexarotor-0.4.toml", leds: 6 };
/// Whose arms blink each a signal of its own.
pub(crate) const SIGNALLED: Airframe =
    Airframe { name: "hexarotor, six words", file: "hexarotor-signals-0.4.toml", leds: 6 };
/// What flies in the faults' scenes.
pub(crate) const AIRFRAMES: [Airframe; 2] =
    [HEXAROTOR, Airframe { name: "quadrotor", file: "quadrotor-0.245.toml", leds: 8 }];

/// An airframe of the scenes' folder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Airframe {
    pub(crate) name: &'static str,
    file: &'static str,
    leds: usize,
}

/// Vehicles of a scene.
const VEHICLES: usize = 4;
/// Middles of vehicles are at least so far apart, m.
const APART_M: f64 = 1.8;
/// Bits per second, as told.
pub(crate) const RATE_HZ: f64 = 60.0;

/// Which word of the book a vehicle blinks, by its number.
pub(crate) fn word(number: usize) -> usize {
    13 * number
}

/// The beginning of a scene: a camera that hovers in some wind.
pub(crate) fn head(seed: u64, duration_s: f64) -> String {
    format!(
        "name = \"time\"\nseed = {seed}\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = {RATE_HZ:?}\nduration_s = {duration_s:?}\nexposure_us = 1000.0\n\
         [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\nwind_m_s = 2.0\n\
         [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n"
    )
}

/// A vehicle of it: how it moves, what of its LEDs is dead, and what else is told of it.
pub(crate) fn target(id: usize, airframe: Airframe, motion: &str, dead: &str, rest: &str) -> String {
    format!(
        "[[target]]\nid = {id}\nairframe = \"airframes/{}\"\nmotion = {{ {motion} }}\nleds = {{ spread = 0.0, dead = [{dead}] }}\n\
         solid = [{{ cylinder = {{ centre_m = [0.0, 0.0, 0.0], radius_m = 0.12, half_height_m = 0.08 }} }}]\n{rest}\n",
        airframe.file,
    )
}

/// What its LEDs blink.
pub(crate) fn blink(words: &[usize], rate_hz: f64, shift_s: f64, ppm: f64) -> String {
    format!(
        "blink = {{ codes = \"codes/l18-d3-r3.txt\", words = {words:?}, rate_hz = {rate_hz:?}, shift_s = {shift_s:?}, ppm = {ppm:?} }}"
    )
}

/// The scene of a text.
pub(crate) fn parse(text: &str) -> Scene {
    Scene::parse(text, concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/time.toml")).expect("a scene")
}

/// A random number of a scene.
pub(crate) fn between(random: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(random)
}

/// Four vehicles with a word each, and what is wrong with them.
pub(crate) fn four(seed: u64, airframe: Airframe, fault: &Fault) -> Scene {
    let mut random = Pcg64::new(u128::from(seed), 0xdead);
    let mut between = |low: f64, high: f64| between(&mut random, low, high);
    let mut text = head(seed, 6.0);
    let mut places: Vec<[f64; 3]> = Vec::new();
    while places.len() < VEHICLES {
        let (distance_m, azimuth_rad) = (between(3.5, 9.0), between(-0.9, 0.9));
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
    for (number, place_m) in places.into_iter().enumerate() {
        let phase_deg = between(0.0, TAU).to_degrees();
        let motion = match number % 2 {
            0 => format!("hover = {{ position_m = {place_m:?} }}"),
            _ => format!(
                "circle = {{ centre_m = {place_m:?}, radius_m = 0.8, speed_m_s = 1.2, phase_deg = {phase_deg:?} }}"
            ),
        };
        let (heading_deg, led) = (between(0.0, 360.0), between(0.0, airframe.leds as f64) as usize);
        let dead = if fault.has_dead_leds { led.to_string() } else { String::new() };
        let word = word(if fault.is_copied && number == 1 { 0 } else { number });
        let (shift_s, ppm) = (between(0.001, 0.3), between(-30.0, 30.0));
        let mut rest = format!("heading_deg = {heading_deg:?}\nwind_m_s = 2.0\n");
        if number == 3 {
            rest += "spin = [{ start_s = 0.0, duration_s = 6.0, turns = 0.5 }]\n";
        }
        rest += &blink(&[word], RATE_HZ * (1.0 + fault.faster), shift_s, ppm);
        text += &target(number + 1, airframe, &motion, &dead, &rest);
    }
    parse(&text)
}
