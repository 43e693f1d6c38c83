//! The fault table: one thing wrong at a time, on two airframes.

use photinus::airframe::Airframe;
use photinus_sim::faults::{Fault, Lamp};

use crate::priors::Build;
use crate::row::{Eye, Row};

/// The rows. Where light is concerned the simulator does it (dead LED, power, places of markers, motion during the exposure);
/// the rest wraps the frames it gives.
pub(crate) fn rows(eye: &Eye) -> Vec<Row> {
    let hexarotor_and_quadrotor = |change: &dyn Fn(&mut Row), name: &str| {
        [6, 4].map(|arms| {
            let mut row = Row::plain(name, eye, arms);
            change(&mut row);
            row
        })
    };
    let mut rows = Vec::new();
    let mut built = |name: &str, change: fn(&mut Build)| {
        rows.extend(hexarotor_and_quadrotor(&|row| change(&mut row.build), name));
    };
    built("none", |_| ());
    built("dead LED", |build| build.dead_led = true);
    built("LED power +-30 %", |build| build.unit_sigma = 0.3);
    built("markers 3 mm off", |build| build.marker_sigma_m = 0.003);
    built("one arm 10 % too long", |build| build.long_arm = 1.1);
    for smear_px in [3.0, 6.0] {
        let name = format!("smear of {smear_px} px");
        rows.extend(hexarotor_and_quadrotor(&|row| row.smear_px = smear_px, &name));
    }
    for (name, fault) in injected() {
        rows.extend(hexarotor_and_quadrotor(&|row| row.faults = vec![fault], name));
    }
    let mut blinking = Row::plain("three that blink", eye, 4);
    blinking.vehicles = 3;
    blinking.build.blinks = true;
    blinking.airframe = signalled(&blinking.airframe);
    rows.push(blinking);
    rows
}

/// An airframe of which each arm has a signal of its own.
fn signalled(airframe: &Airframe) -> Airframe {
    let mut leds = airframe.leds().to_vec();
    for (signal, marker) in (0..).zip(airframe.markers()) {
        marker.leds.iter().for_each(|&led| leds[led].signal = Some(signal));
    }
    Airframe::new(airframe.name(), leds).expect("the same markers")
}

fn injected() -> [(&'static str, Fault); 14] {
    let degrees = std::f64::consts::PI / 180.0;
    [
        ("foreign lamp, fixed", Fault::Lamp(Lamp::Somewhere)),
        ("foreign lamp 25 px beside", Fault::Lamp(Lamp::Beside { gap_px: 25.0 })),
        ("30 hot pixels", Fault::Hot(30)),
        ("noise of 8 levels", Fault::Noise(8.0)),
        ("noise of 20 levels", Fault::Noise(20.0)),
        ("JPEG of quality 50", Fault::Jpeg(50)),
        ("blur of 1.5 px", Fault::Blur(1.5)),
        ("half the gain", Fault::Gain(0.5)),
        ("gravity 5 deg wrong", Fault::Gravity(5.0 * degrees)),
        ("gravity 20 deg wrong", Fault::Gravity(20.0 * degrees)),
        ("airframe told 2 % too large", Fault::Airframe(1.02)),
        ("focal length told 2 % too long", Fault::Focal(1.02)),
        ("mirrored", Fault::Mirrored),
        ("torn", Fault::Torn(0.5)),
    ]
}
