//! How fast frames are rendered on one core, and where the time goes.
//!
//! `cargo bench -p photinus-sim`: frames of 752x480 with twelve hexarotors; then the same without the targets' light (background,
//! noise and reading alone), and the reading of dark rows alone; then what each effect of a camera or its world costs.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use nalgebra::Vector3;
use photinus_sim::cameras::worlds;
use photinus_sim::occlusion::{Edge, Mirror, OwnAirframe, Solid, Surface};
use photinus_sim::optics::{Aberrations, Gaussian, Lens, PointSpread};
use photinus_sim::scene::SceneLamp;
use photinus_sim::sensor::{Background, Charge, ColumnSmear, Converter, Pattern, Readout, Sensor};
use photinus_sim::source::Lobe;
use photinus_sim::{Scene, Simulator};

const FRAMES: u64 = 300;

/// Milliseconds per frame: the least of five rounds, which other programs disturb least.
fn least_ms(mut round: impl FnMut()) -> f64 {
    let mut time = || {
        let start = Instant::now();
        round();
        start.elapsed().as_secs_f64() * 1e3 / FRAMES as f64
    };
    (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
}

/// What a camera or its world may have more than the plain preset, each alone.
fn effects() -> Vec<(&'static str, Scene)> {
    let camera = |name: &'static str, change: &dyn Fn(&mut Lens, &mut Sensor)| {
        let mut scene = plain();
        change(&mut scene.preset.lens, &mut scene.preset.sensor);
        (name, scene)
    };
    let world = |name: &'static str, change: &dyn Fn(&mut Scene)| {
        let mut scene = plain();
        change(&mut scene);
        (name, scene)
    };
    let bent = |aberrations: Aberrations| {
        move |lens: &mut Lens, _: &mut Sensor| {
            lens.spread = lens.spread.clone().with_aberrations(aberrations).expect("a lens");
        }
    };
    let ball = Surface::Sphere { centre_m: Vector3::new(0.0, 0.0, 0.1), radius_m: 0.05 };
    vec![
        camera("one Gaussian", &|lens, _| {
            let part = Gaussian { share: 1.0, sigma_px: 0.5 };
            lens.spread = PointSpread::new(vec![part], 0.0).expect("one Gaussian");
        }),
        camera("Moffat", &|lens, _| lens.spread = PointSpread::moffat(1.4, 3.0).expect("a profile")),
        camera("coma of 0.8 px per rad", &bent(Aberrations { coma_px_per_rad: 0.8, ..Default::default() })),
        camera("elongation", &bent(Aberrations { elongation_per_rad2: 0.3, ..Default::default() })),
        camera("measured table", &|lens, _| {
            let measured = worlds().into_iter().find(|world| world.name == "measured-960");
            lens.spread = measured.expect("a camera").preset.lens.spread;
        }),
        camera("full at 240, with noise", &|_, sensor| {
            sensor.full_well_e = 240.0 * sensor.electrons_per_dn;
            sensor.well_noise_e = 60.0;
        }),
        camera("unequal pixels", &|_, sensor| {
            sensor.pattern = Pattern { offset_dn: 0.5, column_offset_dn: 0.2, gain: 0.01, well: 0.01 };
        }),
        camera("12 bits", &|_, sensor| sensor.converter = Converter::new(12).expect("12 bits")),
        camera("smear along columns", &|_, sensor| sensor.smear = ColumnSmear { share: 1e-4 }),
        world("cosine cubed", &|scene| {
            scene.targets.iter_mut().for_each(|target| target.lobe = Lobe::cosine(3.0));
        }),
        world("a ball on each that mirrors", &|scene| {
            let mirror = Mirror { surface: ball, reflectance: 0.3 };
            scene.targets.iter_mut().for_each(|target| target.mirrors = vec![mirror]);
        }),
        world("twelve lamps", &|scene| {
            let lamp = |index| SceneLamp {
                position_m: Vector3::new(8.0, index as f64 - 6.0, 6.0),
                power: 1.0,
                radius_m: 5e-3,
                beside: None,
            };
            scene.lamps = (0..12).map(lamp).collect();
        }),
        world("the own airframe in view", &|scene| {
            let centre_m = Vector3::new(0.3, 0.0, -0.1);
            let edge = Edge { from_m: centre_m, to_m: Vector3::new(0.3, 0.1, -0.1), power_per_m: 0.05 };
            let solids = vec![Solid::Sphere { centre_m, radius_m: 0.05 }];
            scene.own_airframe = OwnAirframe { solids, brightness: 0.3, edges: vec![edge] };
        }),
    ]
}

fn plain() -> Scene {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/swarm-12.toml"));
    Scene::read(path).unwrap_or_else(|error| panic!("{error}"))
}

fn main() {
    let scene = plain();
    let mut empty = scene.clone();
    empty.targets.clear();
    let frames = |scene: &Scene| {
        let mut simulator = Simulator::new(scene, 0).expect("a scene has a camera");
        least_ms(|| (0..FRAMES).for_each(|number| drop(black_box(simulator.frame(number)))))
    };
    let (all_ms, empty_ms) = (frames(&scene), frames(&empty));
    let (background, charge) = (Background::new(752, 480), Charge::new(752, 480));
    let mut readout = Readout::new(&scene.preset.sensor);
    let mut pixels = vec![0; 752 * 480];
    let dark_ms = least_ms(|| {
        for key in 0..FRAMES {
            for (v, row) in pixels.chunks_exact_mut(752).enumerate() {
                readout.read_row(v, &background, &charge, key, row);
            }
            black_box(&mut pixels);
        }
    });
    println!("12 hexarotors, sky and sun  {all_ms:6.3} ms  {:7.0} frames/s", 1e3 / all_ms);
    println!("  markers                   {:6.3} ms", all_ms - empty_ms);
    println!("  sky, sun, poses           {:6.3} ms", empty_ms - dark_ms);
    println!("  noise and reading         {dark_ms:6.3} ms  {:7.3} ns/px", dark_ms * 1e6 / (752.0 * 480.0));
    println!("\n| with | time against the plain preset |\n|---|---|");
    for (name, scene) in effects() {
        println!("| {name} | {:.2} |", frames(&scene) / all_ms);
    }
}
