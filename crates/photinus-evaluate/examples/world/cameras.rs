//! The camera table: the paper's camera, and those of `photinus_sim::cameras`, which nothing was tuned to.

use std::path::Path;

use photinus_sim::cameras::{World, worlds};
use photinus_sim::preset::{BLUEFOX_FIT, bluefox};

use crate::row::{Eye, Row};

/// Exposure of all of them, us.
const EXPOSURE_US: f64 = 1000.0;
/// Wide point spreads are faint far away, m.
const RANGES_M: [f64; 2] = [2.0, 10.0];

/// The paper's camera.
pub(crate) fn paper() -> Eye {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cameras/bluefox-dsl215.toml");
    let camera = photinus_io::read_camera(Path::new(file)).expect("a camera of the library").camera;
    Eye { camera, preset: bluefox(&BLUEFOX_FIT), exposure_us: EXPOSURE_US }
}

/// A camera of the list by its name.
pub(crate) fn named(name: &str) -> Eye {
    eye(worlds().into_iter().find(|world| world.name == name).expect("a camera of the list"))
}

fn eye(world: World) -> Eye {
    Eye { camera: world.camera, preset: world.preset, exposure_us: EXPOSURE_US }
}

/// The rows, with optics learned from so many frames.
pub(crate) fn rows(optics_frames: u64) -> Vec<Row> {
    let others = worlds().into_iter().map(|world| (world.name, eye(world)));
    let eyes = std::iter::once(("the paper's", paper())).chain(others);
    let row = |name: &str, eye: &Eye, arms| Row {
        ranges_m: RANGES_M,
        optics_frames,
        ..Row::plain(name, eye, arms)
    };
    eyes.flat_map(|(name, eye)| [6, 4].map(|arms| row(name, &eye, arms))).collect()
}

/// What is particular about each.
pub(crate) fn about() -> String {
    worlds().iter().map(|world| format!("- `{}`: {}\n", world.name, world.about)).collect()
}
